//! What the solvers produce, and how it follows the user.

pub mod guests;
pub mod live;
pub mod solution;

pub use solution::LightTransportSolution;
