//! The path tracer: ground truth.
