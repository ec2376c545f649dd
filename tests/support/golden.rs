//! Reference irradiance at fixed points of shipped scenes, traced once with many paths and kept as text.
//!
//! At the thousands of paths a test can afford, the office's irradiance carries 4 % of noise a point, as
//! much as the errors that are to be found. `tests/golden/*.csv` holds 1,000 points with a tenth of that;
//! `tests/reference.rs` traces some of them again and rewrites the files on request.

use glam::Vec3;
use lumenscope_core::{
    math::{frame::uniform_direction, random::Rng, sphere_map::DirectionBins},
    measure::irradiance::points_on_surfaces,
    scene::{accel::Ray, direct::Receiver, geometry::Surface, import, world::World},
};
use std::{
    fmt::{self, Write},
    path::PathBuf,
};

/// Points in a file.
pub const POINTS: usize = 1000;

/// Luminance of the irradiance at one point, lx.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Straight from the emitters.
    pub direct: f32,
    /// After at least one bounce.
    pub indirect: f32,
    /// Standard error of the sum.
    pub standard_error: f32,
}

impl Truth {
    /// Direct and indirect.
    pub fn all(&self) -> f32 {
        self.direct + self.indirect
    }
}

/// A scene the program ships, by its path under `scenes/`.
pub fn shipped(path: &str) -> World {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    World::new(&import::load(&root.join(path)).expect("a shipped scene loads"))
}

/// Points on surfaces that can be seen.
pub fn surface_points(world: &World, count: usize) -> Vec<Surface> {
    points_on_surfaces(world, count, 11)
}

/// Points in the open air, no quarter of whose rays meets a back, with random directions.
pub fn air_points(world: &World, count: usize) -> Vec<Receiver> {
    let bins = DirectionBins::new(4);
    let (low, high) = world.geometry.bounds();
    let open = |p: Vec3| {
        let back = |b: &usize| {
            world.accel.trace(&Ray::new(p, bins.centre(*b))).is_some_and(|hit| {
                !world.geometry.is_lit(&world.geometry.surface(
                    hit.triangle,
                    hit.barycentric,
                    bins.centre(*b),
                ))
            })
        };
        4 * (0..bins.len()).filter(back).count() <= bins.len()
    };
    (0..)
        .map(|i| {
            let mut rng = Rng::new(9, i);
            let at = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            Receiver::new(low + (high - low) * at, uniform_direction(rng.next_vec2()))
        })
        .filter(|r| open(r.position))
        .take(count)
        .collect()
}

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(name).with_extension("csv")
}

/// Reads one file: `surface` belongs to [`surface_points`] of the office, `air` and `cornell_air` to
/// [`air_points`] of the office and of the Cornell box.
pub fn read(name: &str) -> Vec<Truth> {
    let text = std::fs::read_to_string(path(name)).expect("the golden file is there");
    text.lines()
        .skip(1)
        .map(|line| {
            let mut columns = line.split(',').map(|c| c.parse().expect("a number"));
            let mut next = || columns.next().expect("three columns");
            Truth { direct: next(), indirect: next(), standard_error: next() }
        })
        .collect()
}

/// Writes one file.
pub fn write(name: &str, truths: &[Truth]) {
    let mut text = String::from("direct_lx,indirect_lx,standard_error_lx\n");
    for t in truths {
        let _ = writeln!(text, "{:.3},{:.3},{:.3}", t.direct, t.indirect, t.standard_error);
    }
    std::fs::write(path(name), text).expect("the golden file is written");
}

/// Errors of estimates against the truth, relative to max(E_ref, 5 % of the mean of E_ref).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Median of |E − E_ref|, relative.
    pub median: f32,
    /// 95th percentile of the same.
    pub high: f32,
    /// Mean of the relative error with its sign.
    pub signed: f32,
    /// Mean of E − E_ref over the mean of E_ref.
    pub flux: f32,
    /// Mean standard error of the reference, relative.
    pub noise: f32,
}

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [median, high, signed, flux, noise] =
            [self.median, self.high, self.signed, self.flux, self.noise].map(|e| 100.0 * e);
        write!(
            f,
            "median {median:.2} %, 95th {high:.1} %, signed {signed:+.2} %, flux {flux:+.2} %; the reference \
             is known to {noise:.2} %"
        )
    }
}

/// Compares estimates with (truth, its standard error).
pub fn errors(estimates: &[f32], truths: &[(f32, f32)]) -> Errors {
    assert_eq!(estimates.len(), truths.len(), "one truth an estimate");
    let count = truths.len() as f32;
    let mean = truths.iter().map(|t| t.0).sum::<f32>() / count;
    let scale = |t: &(f32, f32)| t.0.max(0.05 * mean);
    let relative: Vec<f32> = estimates.iter().zip(truths).map(|(e, t)| (e - t.0) / scale(t)).collect();
    let mut sizes: Vec<f32> = relative.iter().map(|e| e.abs()).collect();
    sizes.sort_by(f32::total_cmp);
    Errors {
        median: sizes[sizes.len() / 2],
        high: sizes[sizes.len() * 95 / 100],
        signed: relative.iter().sum::<f32>() / count,
        flux: estimates.iter().sum::<f32>() / count / mean - 1.0,
        noise: truths.iter().map(|t| t.1 / scale(t)).sum::<f32>() / count,
    }
}
