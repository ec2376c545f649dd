//! Tests of twins.
