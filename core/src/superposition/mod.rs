//! The picture as a sum of layers, one radiance image per term of the light transport equation.

pub mod composite;
pub mod layers;
