//! Tests of radiosity.
