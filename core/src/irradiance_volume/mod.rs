//! The irradiance volume: light at points in the air, for every direction.
//!
//! Idea (Greger 1996; Greger, Shirley, Hubbard and Greenberg 1998). At each sample of a bilevel [`grid`]
//! the radiance is sampled in 2n² equal bins and turned into the irradiance of 2n² normals by Eq. 4.3
//! ([`quadrature`]). A surface anywhere in the air is then lit by one lookup: cell, bin, and trilinear
//! interpolation between eight samples. Direct and indirect light are kept apart, so that a renderer can
//! take the indirect part here and the direct part, with sharp shadows, from the lamps.
//!
//! Where this departs from the thesis, and why:
//! - Emitters do not go through the bins but through [`direct`]: small luminaires are never missed.
//! - Rows of Eq. 4.3 are normalised, so that constant radiance reads πL exactly.
//! - A query interpolates between four bins (a setting of the query): at n = 17 a bin is 8° wide, and
//!   reading the nearest one costs up to 10 % on the flank of a lamp's cosine.
//! - Samples inside solids are found by the back faces they see, and are left out, filled or moved, by
//!   choice ([`trust`]).
//! - Queries can be told to use only samples that see the point ([`visibility`]), and then have samples of a
//!   third level where the corners of a cell mislead ([`pockets`]).
//! - Several orders of moments (Eq. 4.8) live in one volume ([`moments`]).
//! - Rays remember which surface element they met, so that new light needs no rays ([`solve`]).
//!
//! Limits: light is interpolated between samples, so a shadow edge is as wide as a cell, light leaks by
//! up to a cell through thin walls where queries are not guarded, and direct light within a cell of a
//! lamp is off. Solids modelled with double-sided materials have no back faces to be found by. Spherical
//! harmonics ([`harmonics`]) are kept beside the bins, to choose from: several times faster to ask and 36
//! times smaller, but bins hold any function and show it as it is.

pub mod adaptive;
pub mod bases;
mod batch;
pub mod budget;
mod cache;
pub mod codec;
pub mod detail;
pub mod difference;
pub mod direct;
pub mod directions;
pub mod dynamic_object;
pub mod file;
mod given;
pub mod grid;
pub mod guard;
pub mod harmonics;
pub mod ignored;
pub mod inspect;
pub mod inspect_sampling;
mod leaves;
pub mod lighting;
pub mod lobe;
pub mod moments;
pub mod overlap;
pub mod panorama;
pub mod placement;
pub mod pockets;
pub mod probe;
pub mod quadrature;
pub mod query;
pub mod rays;
mod received;
pub mod self_occlusion;
pub mod settings;
mod sight;
pub mod slice;
pub mod solve;
pub mod trust;
pub mod visibility;

pub use query::SampleWeights;
pub use settings::{Basis, VolumeError, VolumeSettings};
pub use solve::SurfaceLight;

use crate::{
    math::sphere_map::DirectionBins,
    radiosity::{
        RadiositySolution,
        surface_map::{Element, UNSOLVED},
    },
};
use cache::Transport;
use codec::Texel;
use direct::Arrivals;
use directions::Directions;
use glam::{Vec2, Vec3};
use grid::BilevelGrid;
use guard::Guard;
use harmonics::Harmonics;
use moments::{MomentKernel, MomentTable};
use rays::Patch;
use std::sync::{Arc, OnceLock};
use trust::{Fills, SampleState};

/// Irradiance at points in the air for every direction, on a bilevel grid and in its pockets. Cheap to clone.
#[derive(Clone, Debug)]
pub struct IrradianceVolume {
    settings: VolumeSettings,
    grid: Arc<BilevelGrid>,
    samples: Arc<Vec<Sample>>,
    directions: Arc<Directions>,
    /// What rays met; `None` when the volume comes from a file.
    transport: Option<Arc<Transport>>,
    /// What arrives from each emitter of the world.
    arrivals: Vec<Arc<Arrivals>>,
    /// Of the orders in the settings.
    kernels: Arc<Vec<MomentKernel>>,
    /// Samples that hold the light of others.
    fills: Arc<Fills>,
    guard: Option<Guard>,
    /// Of each sample, changes of its light since its rays were traced.
    ages: Arc<Vec<u32>>,
    tables: Tables,
}

/// A point where light is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Position, m; not the grid's where the sample was relocated.
    pub position: Vec3,
    /// 1 when it is a corner of the first-level grid, 3 in a pocket ([`pockets`]), else 2.
    pub level: u8,
    /// Share of its rays that met the back of a single-sided surface.
    pub back_face_fraction: f32,
    /// Whether queries may use it: few of its rays met backs, or it was repaired.
    pub valid: bool,
    /// How it came to its light.
    pub state: SampleState,
}

/// Irradiance of every bin of every sample, encoded; bin b of sample s is entry s · 2n² + b.
#[derive(Clone, Debug)]
struct Tables {
    bins: DirectionBins,
    direct: Arc<Vec<Texel>>,
    indirect: Arc<Vec<Texel>>,
    /// The same in nine coefficients, once somebody asks: a drag lit by the bins does without.
    harmonics: Arc<OnceLock<Harmonics>>,
    /// Moments of higher order.
    moments: Vec<MomentTable>,
}

impl Tables {
    fn new(bins: DirectionBins, direct: Arc<Vec<Texel>>, indirect: Arc<Vec<Texel>>) -> Self {
        Self { bins, direct, indirect, harmonics: Arc::default(), moments: Vec::new() }
    }

    fn harmonics(&self) -> &Harmonics {
        self.harmonics.get_or_init(|| Harmonics::new(self.bins, &self.direct, &self.indirect))
    }
}

impl IrradianceVolume {
    /// What it was built with.
    pub fn settings(&self) -> &VolumeSettings {
        &self.settings
    }

    /// Layout of the direction bins.
    pub fn bins(&self) -> DirectionBins {
        self.directions.bins()
    }

    /// Cells and levels: what a lookup walks through.
    pub fn grid(&self) -> &BilevelGrid {
        &self.grid
    }

    /// The samples; their numbers are those of [`SampleWeights`].
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Encoded direct and indirect irradiance, bin b of sample s at s · 2n² + b; see [`codec`].
    pub fn tables(&self) -> [&[Texel]; 2] {
        [&self.tables.direct, &self.tables.indirect]
    }

    /// Nine coefficients a sample and channel: the bins in another basis.
    pub fn harmonics(&self) -> &Harmonics {
        self.tables.harmonics()
    }

    /// The same volume with another basis asked by queries.
    pub fn with_basis(&self, basis: Basis) -> Self {
        Self { settings: VolumeSettings { basis, ..self.settings.clone() }, ..self.clone() }
    }

    /// How often the light that a sample holds changed since its rays were traced. Rays that met what has been
    /// moved since still see it where it was: the older a sample, the less it is to be trusted.
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn age(&self, sample: usize) -> u32 {
        self.ages[sample]
    }

    /// Whether [`Self::relight`] can follow the light: it cannot in a volume read from a file.
    pub fn can_relight(&self) -> bool {
        self.transport.is_some()
    }

    /// The same volume without what its rays met: to be asked and shown whatever becomes of the scene.
    pub fn detached(&self) -> Self {
        Self { transport: None, arrivals: Vec::new(), ..self.clone() }
    }

    /// Bytes of the irradiance of one part, direct or indirect.
    pub fn table_bytes(&self) -> usize {
        size_of_val(&self.tables.direct[..])
    }

    /// Bytes held, without the tree that the guard's rays are asked of: it is the scene's.
    pub fn bytes(&self) -> usize {
        let transport = self.transport.as_ref().map_or(0, |t| t.bytes());
        2 * self.table_bytes()
            + self.tables.harmonics.get().map_or(0, Harmonics::bytes)
            + 2 * self.tables.moments.len() * self.table_bytes()
            + transport
            + self.grid.bytes()
            + self.directions.bytes()
            + size_of_val(&self.samples[..])
            + size_of_val(&self.ages[..])
            + self.fills.bytes()
            + self.kernels.iter().map(MomentKernel::bytes).sum::<usize>()
            + self.arrivals.iter().map(|a| a.bytes()).sum::<usize>()
            + self.guard.as_ref().map_or(0, Guard::bytes)
    }
}

impl SurfaceLight for RadiositySolution {
    fn element_at(&self, triangle: u32, barycentric: Vec2, back: bool) -> u32 {
        self.element_at(triangle, barycentric, back)
    }

    fn radiosity(&self) -> &[Vec3] {
        self.radiosity()
    }

    fn patch(&self, element: u32) -> Option<Patch> {
        let Element { chart, geometric_normal: normal, flags, .. } =
            *self.elements().get(element as usize)?;
        let chart = self.transport().map.charts.get(chart as usize).filter(|_| flags & UNSOLVED == 0)?;
        let node = element - chart.first_element;
        let [x, y] = [node % chart.nx, node / chart.nx].map(|i| i as f32);
        let centre = chart.origin + chart.step_u * x + chart.step_v * y;
        Some(Patch { centre, edges: [chart.step_u, chart.step_v], normal })
    }
}
