//! Tests of rays.
