//! The picture as a sum of layers, one radiance image per term of the light transport equation.
//!
//! One G-buffer says what each pixel sees; every term is evaluated over it by itself and kept as a
//! linear image, so that terms can be shown alone, weighted and exported, and their sum is the
//! picture. Not one shaded image: a student could not take it apart again. What is here is the
//! specification of the passes in [`crate::gpu`].

pub mod accumulator;
pub mod composite;
pub mod frames;
pub mod gbuffer;
pub mod layers;
pub mod moved;
pub mod overlay;
pub mod panorama;
pub mod pass;
pub mod plan;
pub mod streamed;

pub use frames::mean_of_frames;
pub use pass::{PassSettings, render, render_lit};
