//! How near each way of reconstructing radiosity from few samples comes to the light itself.
//!
//! The report's kind of case: a bright spot, sampled at 5 × 5 vertices, shown large. Here the light is the
//! closed form of a point lamp over a plane instead of a solution on a deep quadtree, so the reference is
//! exact. It is judged as a picture of 513 × 513 points, the samples of a quadtree of height 9.

use super::{MeasureError, image, perceptual};
use crate::{
    math::image::LinearImage,
    radiosity::texture::{
        RadiosityTexture, Shape,
        convert::Gaps,
        display::Filter,
        hermite::HermiteSurface,
        prefilter::{WIDEST, adaptive, gaussian},
    },
};
use glam::{UVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::time::Instant;

/// Points a side of the picture that is judged.
pub const REFERENCE_SIDE: u32 = 513;

/// How far the adaptive prefilter may move a texel, as a share of it: as in pictures.
pub const ADAPTIVE_TOLERANCE: f32 = crate::radiosity::reconstruct::TOLERANCE;

/// Irradiance of the unit square under an isotropic point lamp: E = E₀ (h² / (h² + d²))^{3/2}, which is
/// I cos θ / r² with E₀ = I / h².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Foot of the lamp in the square.
    pub centre: Vec2,
    /// Height of the lamp over the plane, in sides of the square.
    pub height: f32,
    /// Irradiance at its foot, lx.
    pub peak_lx: f32,
}

impl Default for Spot {
    /// Upper left, about two of 4 × 4 cells across at half its peak, between the samples.
    fn default() -> Self {
        Self { centre: Vec2::new(0.3, 0.28), height: 0.3, peak_lx: 1000.0 }
    }
}

impl Spot {
    /// Irradiance at a point, lx.
    pub fn irradiance(&self, at: Vec2) -> Vec3 {
        let h2 = self.height * self.height;
        Vec3::splat(self.peak_lx * (h2 / (h2 + at.distance_squared(self.centre))).powf(1.5))
    }

    /// The reference, lx.
    pub fn picture(&self) -> LinearImage {
        picture(|p| self.irradiance(p))
    }
}

/// One way of reconstruction, judged.
#[derive(Clone, Debug)]
pub struct Reconstruction {
    /// What was done.
    pub way: Way,
    /// What is shown, lx.
    pub picture: LinearImage,
    /// Looking it up at every point of the picture, s.
    pub show_seconds: f64,
    /// Mean squared error, lx².
    pub mse: f64,
    /// Relative mean squared error.
    pub rel_mse: f64,
    /// Symmetric mean absolute percentage error as a fraction.
    pub smape: f64,
    /// Mean FLIP of the pictures with the peak as white.
    pub flip: f64,
    /// Perceptual difference of the report.
    pub perceptual: f64,
    /// Root mean square error of the second difference, lx a pixel²: creases, which show as Mach bands.
    pub crease: f64,
}

/// One way of reconstruction.
#[derive(Clone, Debug)]
pub struct Way {
    /// What is done, whatever the number of samples.
    pub kind: String,
    /// The same with numbers of samples and texels.
    pub name: String,
    /// What it makes of the samples.
    pub texture: RadiosityTexture,
    /// How that is looked up.
    pub filter: Filter,
    /// Time from samples to texture, s.
    pub build_seconds: f64,
}

/// Every way of reconstruction from `samples` × `samples` vertex samples of a spot, samples being a power of
/// two plus 1: displayed bilinearly; stage 1 alone; and stage 1 resampled to twice as many texels, displayed
/// bilinearly, bicubically, or bilinearly after each prefilter.
///
/// # Panics
/// If `samples` is not a power of two plus 1 from 3 to 257.
pub fn ways(spot: &Spot, samples: u32) -> Vec<Way> {
    assert!(is_sampling(samples), "{samples} samples a side");
    let last = (samples - 1) as f32;
    let pixels: Vec<Vec3> = (0..samples * samples)
        .map(|i| spot.irradiance(UVec2::new(i % samples, i / samples).as_vec2() / last))
        .collect();
    let gaps = Gaps { side: samples, texels: pixels.iter().copied().map(Some).collect() };
    let sampled = || {
        let image = LinearImage { width: samples, height: samples, pixels: pixels.clone() };
        RadiosityTexture::at_vertices(image)
    };
    let surface = || HermiteSurface::new(Shape::Quadrilateral, &gaps);
    let side = 2 * (samples - 1);
    let doubled = || surface().resampled(side);
    let mut ways = Vec::new();
    let mut add = |size: u32, kind: String, filter, make: &dyn Fn() -> RadiosityTexture| {
        let start = Instant::now();
        let texture = make();
        let build_seconds = start.elapsed().as_secs_f64();
        let name = match kind.strip_prefix("Hermite, ") {
            Some(rest) => format!("Hermite {size} x {size}, {rest}"),
            None if kind == "Hermite" => kind.clone(),
            None => format!("{size} x {size} {kind}"),
        };
        ways.push(Way { kind, name, texture, filter, build_seconds });
    };
    for (kind, filter) in
        [("nearest", Filter::Nearest), ("bilinear", Filter::Bilinear), ("Mitchell", Filter::Mitchell)]
    {
        add(samples, format!("samples, {kind}"), filter, &sampled);
    }
    add(REFERENCE_SIDE, "Hermite".into(), Filter::Bilinear, &|| surface().resampled(REFERENCE_SIDE));
    add(side, "Hermite, bilinear".into(), Filter::Bilinear, &doubled);
    add(side, "Hermite, Mitchell".into(), Filter::Mitchell, &doubled);
    for width in 2..=WIDEST {
        let kind = format!("Hermite, Gauss {width} x {width}, bilinear");
        add(side, kind, Filter::Bilinear, &|| gaussian(&doubled(), width));
    }
    let kind = "Hermite, Gauss adaptive, bilinear".into();
    add(side, kind, Filter::Bilinear, &|| adaptive(&doubled(), ADAPTIVE_TOLERANCE));
    ways
}

/// Every one of [`ways`], judged; one after the other where it is timed.
///
/// # Errors
/// [`MeasureError`] if the light is not finite.
///
/// # Panics
/// As [`ways`].
pub fn reconstructions(spot: &Spot, samples: u32) -> Result<Vec<Reconstruction>, MeasureError> {
    let reference = spot.picture();
    let shown_ways: Vec<(Way, LinearImage, f64)> = ways(spot, samples)
        .into_iter()
        .map(|way| {
            let start = Instant::now();
            let picture = shown(&way.texture, way.filter);
            (way, picture, start.elapsed().as_secs_f64())
        })
        .collect();
    shown_ways.into_par_iter().map(|shown| judged(shown, &reference)).collect()
}

/// What is shown of a texture, lx; never negative.
pub fn shown(texture: &RadiosityTexture, filter: Filter) -> LinearImage {
    picture(|p| texture.sample(p, filter).max(Vec3::ZERO))
}

/// Whether a number of samples a side is one of a full quadtree that is judged: 3, 5, 9, … 257.
pub fn is_sampling(samples: u32) -> bool {
    (3..=257).contains(&samples) && (samples - 1).is_power_of_two()
}

fn judged(
    (way, picture, show_seconds): (Way, LinearImage, f64),
    reference: &LinearImage,
) -> Result<Reconstruction, MeasureError> {
    let white = reference.pixels.iter().map(|p| p.max_element()).fold(f32::MIN_POSITIVE, f32::max);
    let eye = image::PIXELS_PER_DEGREE;
    Ok(Reconstruction {
        mse: image::mse(&picture, reference)?,
        rel_mse: image::rel_mse(&picture, reference)?,
        smape: image::smape(&picture, reference)?,
        flip: image::flip(&picture, reference, 1.0 / white, eye)?.mean,
        perceptual: perceptual::difference(&picture, reference, eye)?,
        crease: image::mse(&image::second_difference(&picture), &image::second_difference(reference))?.sqrt(),
        way,
        picture,
        show_seconds,
    })
}

fn picture(value: impl Fn(Vec2) -> Vec3 + Sync) -> LinearImage {
    let last = (REFERENCE_SIDE - 1) as f32;
    LinearImage::from_fn(REFERENCE_SIDE, REFERENCE_SIDE, |x, y| value(Vec2::new(x as f32, y as f32) / last))
}
