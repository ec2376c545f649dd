//! Furniture placement: illuminance on a plane or on an object's top, and whether it is enough.
//!
//! Idea (Greger 1996, §5.4): move a desk about in a lit room and read off, live, what falls on it. Points
//! lie on a grid ([`grid`]); at each the direct light is evaluated exactly and the indirect light comes
//! from the volume while things move, or from gathered rays once they rest ([`measure`]). The values are
//! summed up as lighting design does and held against a task's requirement ([`requirement`]), joined to
//! lines of equal illuminance ([`contours`]) and shown ([`inspect`]).
//!
//! Why direct light does not come from the volume, as in the thesis: it would be blurred over a cell, and
//! the minimum and the uniformity live in shadow edges. Limits: illuminance is that of the lamps as the
//! scene has them; the maintenance factor stands for ageing and dirt.

pub mod contours;
pub mod grid;
pub mod inspect;
pub mod requirement;

use super::{IrradianceVolume, SurfaceLight};
use crate::{
    math::{
        colour::luminance,
        frame::{cosine_direction, frame_from_normal},
        part::Part,
        random::{fold, hash2, r2_point},
    },
    scene::{
        accel::Ray,
        direct::{Receiver, total_irradiance},
        world::World,
    },
};
use glam::Vec3;
use grid::MeasuringGrid;
use rayon::prelude::*;

/// Rays that tell whether a point is inside something, where none are gathered.
const INSIDE_RAYS: u32 = 16;

/// Share of back faces seen from which a point counts as inside a solid.
const INSIDE_SHARE: f32 = 0.25;

/// Height over a point at which is looked around for what stands on it, and the farthest that may be, m.
const AROUND_M: [f32; 2] = [0.005, 0.25];

/// Directions that are looked in.
const AROUND: u32 = 16;

/// How illuminance is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MeasureSettings {
    /// Shadow rays an area emitter and point.
    pub shadow_rays: u32,
    /// Rays that gather the indirect light of a point; 0 asks the volume instead, where there is one.
    pub gather_rays: u32,
    /// Factor on every value: illuminance kept in use over that of new, clean lamps (EN 12464-1, 4.3.1).
    pub maintenance_factor: f32,
    /// Seed of every random number.
    pub seed: u64,
}

impl Default for MeasureSettings {
    fn default() -> Self {
        Self { shadow_rays: 16, gather_rays: 256, maintenance_factor: 1.0, seed: 1 }
    }
}

impl MeasureSettings {
    /// For while something moves: the volume for indirect light, few shadow rays.
    pub fn moving(self) -> Self {
        Self { shadow_rays: self.shadow_rays.min(4), gather_rays: 0, ..self }
    }
}

/// Illuminance at the points of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// What was measured: the plane's or the object's name.
    pub name: String,
    /// Where.
    pub grid: MeasuringGrid,
    /// Illuminance of each point, row by row, lx; `None` where nothing is measured: beside the object's
    /// top, or inside a solid.
    pub values: Vec<Option<f32>>,
    /// Points left out because they lie inside something.
    pub inside: usize,
    /// Rays that gathered the indirect light of a point; 0 where it came from the volume.
    pub gather_rays: u32,
}

/// What is said of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Statistics {
    /// Smallest illuminance, lx.
    pub min_lx: f32,
    /// Mean illuminance Ē, lx.
    pub mean_lx: f32,
    /// Largest illuminance, lx.
    pub max_lx: f32,
    /// Uniformity U₀ = E_min / Ē (EN 12665).
    pub uniformity: f32,
    /// Diversity E_min / E_max.
    pub diversity: f32,
    /// Points counted.
    pub points: usize,
    /// Where it is darkest, m.
    pub darkest: Vec3,
    /// Where it is brightest, m.
    pub brightest: Vec3,
}

/// Measures illuminance E = ∫ L(ω) max(0, n·ω) dω at every point of a grid, lx.
///
/// Direct light by `shadow_rays` rays an area emitter; indirect light as the mean radiosity that
/// `gather_rays` cosine-distributed rays meet, since ∫ L cos θ dω = π ⟨L⟩ = ⟨B⟩, or from the volume.
/// Points inside a solid, known by the back faces they see, and inside hollow things that stand there (a
/// mug, a vase) are left out. The same arguments give the same
/// bytes at any thread count.
pub fn measure(
    world: &World,
    light: &impl SurfaceLight,
    volume: Option<&IrradianceVolume>,
    name: &str,
    grid: MeasuringGrid,
    settings: &MeasureSettings,
) -> Measurement {
    let gathers = settings.gather_rays > 0 || volume.is_none();
    let rays = if gathers { settings.gather_rays.max(INSIDE_RAYS) } else { INSIDE_RAYS };
    let at = |(i, position): (usize, &Option<Vec3>)| -> Point {
        let Some(position) = *position else { return Point::Beside };
        let scramble = hash2(i as u32, fold(settings.seed));
        if stands_in_something(world, &grid, position) {
            return Point::Inside;
        }
        let receiver = Receiver::new(position, grid.normal);
        let (gathered, backs) = gather(world, light, &receiver, rays, scramble);
        if backs > INSIDE_SHARE {
            return Point::Inside;
        }
        let indirect = match volume {
            Some(volume) if !gathers => volume.irradiance(position, grid.normal, Part::Indirect),
            _ => gathered,
        };
        let direct = total_irradiance(world, &receiver, settings.shadow_rays, scramble);
        Point::Lit(luminance(direct + indirect) * settings.maintenance_factor)
    };
    let points: Vec<Point> = grid.points.par_iter().enumerate().map(at).collect();
    let inside = points.iter().filter(|p| matches!(p, Point::Inside)).count();
    let values = points.iter().map(|p| if let Point::Lit(e) = p { Some(*e) } else { None }).collect();
    Measurement { name: name.to_owned(), grid, values, inside, gather_rays: if gathers { rays } else { 0 } }
}

enum Point {
    Beside,
    Inside,
    Lit(f32),
}

/// Whether one thing that is not measured itself is near all around a point: the point lies inside it.
fn stands_in_something(world: &World, grid: &MeasuringGrid, position: Vec3) -> bool {
    let origin = position + grid.normal * AROUND_M[0];
    let frame = frame_from_normal(grid.normal);
    let met = |i: u32| {
        let (sin, cos) = (std::f32::consts::TAU * (i as f32 + 0.5) / AROUND as f32).sin_cos();
        let hit = world.accel.trace(&Ray::new(origin, frame * Vec3::new(cos, sin, 0.0)))?;
        (hit.t < AROUND_M[1]).then(|| world.geometry.object[hit.triangle as usize])
    };
    let first = met(0).filter(|o| grid.object != Some(*o));
    first.is_some() && (1..AROUND).all(|i| met(i) == first)
}

/// Mean radiosity met by cosine-distributed rays, lx per channel, and the share of rays that met a back.
fn gather(
    world: &World,
    light: &impl SurfaceLight,
    receiver: &Receiver,
    rays: u32,
    scramble: u32,
) -> (Vec3, f32) {
    let frame = frame_from_normal(receiver.normal);
    let (mut sum, mut backs) = (Vec3::ZERO, 0u32);
    for ray in 0..rays {
        let direction = frame * cosine_direction(r2_point(ray, scramble));
        let Some(hit) = world.accel.trace(&Ray::new(receiver.origin(), direction)) else { continue };
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
        if world.geometry.is_lit(&surface) {
            let element = light.element_at(hit.triangle, hit.barycentric, surface.back);
            sum += light.radiosity().get(element as usize).copied().unwrap_or(Vec3::ZERO);
        } else {
            backs += 1;
        }
    }
    (sum / rays as f32, backs as f32 / rays as f32)
}

impl Measurement {
    /// Smallest, mean and largest illuminance and their ratios; `None` where no point was measured.
    pub fn statistics(&self) -> Option<Statistics> {
        let lit = || {
            self.values.iter().zip(&self.grid.points).filter_map(|(v, p)| {
                let (v, p) = ((*v)?, (*p)?);
                v.is_finite().then_some((v, p))
            })
        };
        let (min_lx, darkest) = lit().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (max_lx, brightest) = lit().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let points = lit().count();
        let mean = lit().map(|(v, _)| f64::from(v)).sum::<f64>() / points as f64;
        let ratio = |a: f32, b: f32| if b > 0.0 { a / b } else { 0.0 };
        let mean_lx = mean as f32;
        Some(Statistics {
            min_lx,
            mean_lx,
            max_lx,
            uniformity: ratio(min_lx, mean_lx),
            diversity: ratio(min_lx, max_lx),
            points,
            darkest,
            brightest,
        })
    }
}
