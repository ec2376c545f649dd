//! A picture at rest: the mean of frames that look through other places in the pixels and at other points of
//! the lamps.

use super::{
    accumulator::Accumulator,
    layers::Layers,
    moved::MovedLight,
    pass::{PassSettings, render_lit},
};
use crate::{
    math::progress::{Cancelled, Progress},
    scene::camera::Camera,
    transport::LightTransportSolution,
};

/// Mean of `frames` frames (at least one) of a solution, cd/m² by layer. Each frame has its own random numbers
/// and, where there is more than one, its own place inside the pixels; light on moved objects is made once.
///
/// # Errors
/// [`Cancelled`].
pub fn mean_of_frames(
    solution: &LightTransportSolution,
    camera: &Camera,
    [width, height]: [u32; 2],
    frames: u32,
    settings: &PassSettings,
    progress: &Progress,
) -> Result<Layers, Cancelled> {
    progress.begin("picture");
    let moved = MovedLight::new(solution, true);
    let mut mean = Accumulator::new();
    for frame in 0..frames.max(1) {
        progress.report(frame as f32 / frames.max(1) as f32)?;
        let settings = PassSettings { frame, jitter: frames > 1, ..*settings };
        mean.add(&render_lit(solution, &moved, camera, width, height, &settings).1);
    }
    progress.report(1.0)?;
    Ok(mean.mean())
}
