//! What a lightmap should hold, by the path tracer: irradiance at the middle of every texel that is judged.

use crate::{
    math::{
        colour::luminance,
        part::Part,
        progress::{Cancelled, Progress},
        relative::floor_of,
    },
    radiosity::lightmap::LightmapReport,
    reference::{Estimate, irradiance::irradiance_with, path::PathTracer},
    scene::{direct::Receiver, world::World},
};
use rayon::prelude::*;

/// Texels between two looks at whether to go on.
const CHUNK: usize = 1024;

/// Irradiance of the fronts at each texel of a report with its standard error, lx, by at least `paths` paths each.
///
/// # Errors
/// [`Cancelled`].
pub fn traced(
    report: &LightmapReport,
    world: &World,
    paths: u32,
    seed: u64,
    progress: &Progress,
) -> Result<Vec<Estimate>, Cancelled> {
    progress.begin("path tracing a lightmap");
    let tracer = PathTracer::new(world);
    let mut found = Vec::with_capacity(report.texels.len());
    for (chunk, first) in report.texels.chunks(CHUNK).zip((0..).step_by(CHUNK)) {
        progress.report(first as f32 / report.texels.len() as f32)?;
        found.par_extend(chunk.par_iter().enumerate().map(|(i, texel)| {
            let front = -world.geometry.area_normal(texel.triangle);
            let surface = world.geometry.surface(texel.triangle, texel.barycentric, front);
            let receiver = Receiver {
                position: surface.position,
                normal: surface.normal,
                geometric_normal: surface.geometric_normal,
            };
            irradiance_with(&tracer, &receiver, Part::All, paths, seed ^ (first + i) as u64)
        }));
    }
    Ok(found)
}

/// Median of the standard errors over max(E, 5 % of the mean), on luminance.
pub fn noise(traced: &[Estimate]) -> f64 {
    let value = |e: &Estimate| f64::from(luminance(e.mean));
    let floor = floor_of(traced.iter().map(value).sum::<f64>() / traced.len().max(1) as f64);
    let error = |e: &Estimate| f64::from(luminance(e.standard_error)) / value(e).max(floor);
    let mut errors: Vec<f64> = traced.iter().map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied().unwrap_or(0.0)
}
