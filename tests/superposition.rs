//! Tests of superposition.
