//! One grid of elements as a texture, stage by stage, held against the path tracer.
//!
//! What the solver stores is stage 1: the nodes of a grid, looked up nearest or bilinearly. Stage 2 is the smooth
//! function through them ([`hermite`](crate::radiosity::texture::hermite)), sampled more finely; stage 3 a
//! low pass over those texels and the lookup that shows them. Nodes that the solver interpolates between corners
//! of leaves are left open, so that the smooth function closes them its own way.
//!
//! The grid is shown as one sees it who stands before its surface.
//!
//! The reference is irradiance by the path tracer at the middles of equal cells over the grid, so that no
//! stage is asked only where it is right by construction. Limits: a point beside a node outside the
//! region has no light of its own and is not judged; surfaces lit at their corners have no grid, but for balls
//! (`ball_texture`) and sides of cylinders (`tube_texture`). A triangle has its own (`triangle_texture`).

use super::{
    MeasureError, ball_texture::BallPatches, image, perceptual, triangle_texture::TrianglePatch,
    tube_texture::TubePatch,
};
use crate::{
    math::{
        colour::luminance,
        image::LinearImage,
        part::Part,
        progress::{Cancelled, Progress},
        relative::floor_of,
    },
    radiosity::{
        RadiositySolution,
        reconstruct::{lattice, resampled, smooth},
        surface_map::{Chart, Element, INTERPOLATED, OUTSIDE},
        texture::{
            Border, Quadtree, RadiosityTexture,
            convert::Gaps,
            display::Filter,
            hermite::HermiteSurface,
            prefilter::{WIDEST, adaptive, gaussian},
        },
    },
    reference::{irradiance::irradiance_with, path::PathTracer},
    scene::{direct::Receiver, world::World},
};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Nodes of a grid along an edge, at most: a texture is a square of that edge.
const MOST_NODES: u32 = 2048;

/// Points along each edge at which a grid is judged: at least, and at most.
pub(super) const POINTS: [u32; 2] = [8, 48];

/// How the stages are made and shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct StageSettings {
    /// What stage 1 shows.
    pub conversion: Conversion,
    /// Lookup of the stored nodes; each order has its own.
    pub stored: Filter,
    /// Texels of stage 2 a step between nodes, 1 to 4.
    pub factor: u32,
    /// The low pass of stage 3.
    pub prefilter: Prefilter,
    /// Lookup of the texels of stage 3.
    pub shown: Filter,
}

impl Default for StageSettings {
    fn default() -> Self {
        Self {
            conversion: Conversion::Nodes,
            stored: Filter::Bilinear,
            factor: 2,
            prefilter: Prefilter::Adaptive,
            shown: Filter::Bilinear,
        }
    }
}

/// What of a grid the first stage shows (Bastos 1999, §5.2 and 5.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Conversion {
    /// The nodes, as the solver has them.
    #[default]
    Nodes,
    /// A texel a leaf.
    ZeroOrder,
    /// The mean of the leaves around each corner.
    FirstOrder,
}

/// A low pass over texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Prefilter {
    /// A Gaussian of this many texels a side, 1 to 6; 1 changes nothing; on what goes round, of one less where even.
    Gaussian(u32),
    /// The widest up to 5 × 5 that moves no texel by more than 2 %.
    Adaptive,
}

/// One stage of a grid's texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Its texels, lx.
    pub texture: RadiosityTexture,
    /// How they are looked up.
    pub filter: Filter,
}

/// How far a stage is from the reference.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct StageError {
    /// Relative mean squared error over the points judged.
    pub rel_mse: f64,
    /// Perceptual difference of the pictures.
    pub perceptual: f64,
    /// Largest difference of luminance, lx, signed.
    pub largest_lx: f32,
}

/// A grid's light, and the points at which it is judged.
#[derive(Clone, Debug)]
pub struct GridTexture {
    /// Number of the grid; `u32::MAX` for what is curved.
    pub chart: u32,
    /// Object that it belongs to.
    pub object: u32,
    /// Columns and rows of nodes.
    pub nodes: [u32; 2],
    /// Width and height of the grid, m.
    pub size_m: Vec2,
    /// Columns and rows of points judged.
    pub points: [u32; 2],
    pub(super) stored: RadiosityTexture,
    /// Whether each node is interpolated by the solver and not solved, row by row.
    pub(super) open: Vec<bool>,
    pub(super) smooth: Smooth,
    pub(super) receivers: Vec<Option<Receiver>>,
}

/// What a texture is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A flat region, by its grid.
    Grid,
    /// A flat region that is a triangle: the half of the texture below its diagonal.
    Triangle,
    /// A ball, by longitude and latitude.
    Ball,
    /// The side of a cylinder, by angle and height.
    Tube,
}

/// The smooth function through what is stored.
#[derive(Clone, Debug)]
pub(super) enum Smooth {
    /// Of a grid, and the share of its square that the grid takes.
    Grid(HermiteSurface, Vec2),
    /// Of a triangle.
    Triangle(Box<TrianglePatch>),
    /// Of the six patches of a ball.
    Ball(Box<BallPatches>),
    /// Of the side of a cylinder.
    Tube(Box<TubePatch>),
}

impl GridTexture {
    /// The grid, triangle, ball or side of a cylinder that an element belongs to; `None` where it is none's, or the
    /// grid is a line or too long.
    pub fn of_element(solution: &RadiositySolution, world: &World, element: u32) -> Option<Self> {
        let Element { chart: number, object, .. } = *solution.elements().get(element as usize)?;
        let Some(chart) = solution.transport().map.charts.get(number as usize) else {
            let ball = Self::of_ball(solution, world, element);
            return ball.or_else(|| Self::of_tube(solution, world, element));
        };
        if chart.nx.max(chart.ny) > MOST_NODES {
            return None;
        }
        if chart.nx < 2 || chart.ny < 2 {
            return None;
        }
        if let Some(triangle) = Self::of_triangle(solution, world, number) {
            return Some(triangle);
        }
        let seen = Seen::new(solution, chart);
        let [nx, ny] = seen.nodes;
        let light = |x: u32, y: u32| {
            let node = seen.element(x, y);
            solution.direct[node] + solution.indirect[node]
        };
        let image = LinearImage::from_fn(nx, ny, light);
        let judged = |n: u32| (2 * (n - 1)).clamp(POINTS[0], POINTS[1]);
        let points = [judged(nx), judged(ny)];
        let mut root = solution.transport().map.trees[number as usize].as_ref().map_or([1, 1], |t| t.root);
        if seen.turned {
            root.reverse();
        }
        let open = |x: u32, y: u32| {
            let element = &solution.elements()[seen.element(x, y)];
            element.flags & INTERPOLATED != 0 && !(x.is_multiple_of(root[0]) && y.is_multiple_of(root[1]))
        };
        let (surface, window) = smooth(seen.nodes, &open, &light);
        Some(Self {
            chart: number,
            object,
            nodes: [nx, ny],
            size_m: Vec2::new(
                seen.steps[0].length() * (nx - 1) as f32,
                seen.steps[1].length() * (ny - 1) as f32,
            ),
            points,
            stored: lattice(image),
            open: (0..nx * ny).map(|i| open(i % nx, i / nx)).collect(),
            smooth: Smooth::Grid(surface, window),
            receivers: receivers(solution, &seen, points),
        })
    }

    /// What it is of.
    pub fn kind(&self) -> Kind {
        match self.smooth {
            Smooth::Grid(..) => Kind::Grid,
            Smooth::Triangle(_) => Kind::Triangle,
            Smooth::Ball(_) => Kind::Ball,
            Smooth::Tube(_) => Kind::Tube,
        }
    }

    /// Whether a point of the unit square is of its surface: all are, but for a triangle's other half.
    pub fn covers(&self, at: Vec2) -> bool {
        self.kind() != Kind::Triangle || at.element_sum() <= 1.0
    }

    /// Samples that quadtrees grown a posteriori took, and how many full ones would; `None` of the solver's grids.
    pub fn samples(&self) -> Option<[usize; 2]> {
        let count = |tree: &Quadtree, samples: &Gaps| {
            let full = Quadtree::full(tree.shape(), tree.height());
            let all = full.vertices().into_iter().filter(|used| *used).count();
            [samples.texels.iter().flatten().count(), all]
        };
        match &self.smooth {
            Smooth::Grid(..) => None,
            Smooth::Triangle(patch) => Some(count(&patch.tree, &patch.samples)),
            Smooth::Tube(tube) => Some(count(&tube.tree, &tube.samples)),
            Smooth::Ball(ball) => {
                let counts = ball.patches.each_ref().map(|(tree, samples)| count(tree, samples));
                let most = counts.iter().map(|c| c[1]).max().unwrap_or(0);
                Some([counts.iter().map(|c| c[0]).sum(), counts.len() * most])
            }
        }
    }

    /// The three stages.
    pub fn stages(&self, settings: &StageSettings) -> [Stage; 3] {
        let factor = settings.factor.clamp(1, 4);
        let smooth = match &self.smooth {
            Smooth::Grid(surface, window) => {
                resampled(surface, *window, self.nodes.map(|n| (n - 1) * factor + 1))
            }
            Smooth::Triangle(patch) => patch.smooth.resampled((self.nodes[0] - 1) * factor + 1),
            Smooth::Tube(tube) => tube.smooth.sampled(self.nodes[0] * factor),
            Smooth::Ball(ball) => ball.smooth.sampled(self.nodes[0] / 4 * factor),
        };
        let filtered = match settings.prefilter {
            // An even one lies aside, which what goes round cannot.
            Prefilter::Gaussian(width) if smooth.border != Border::Clamp => {
                gaussian(&smooth, (width.clamp(1, WIDEST) - 1) | 1)
            }
            Prefilter::Gaussian(width) => gaussian(&smooth, width.clamp(1, WIDEST)),
            Prefilter::Adaptive => adaptive(&smooth, super::reconstruction::ADAPTIVE_TOLERANCE),
        };
        let nodes = || Stage { texture: self.stored.clone(), filter: settings.stored };
        let stored = match settings.conversion {
            Conversion::Nodes => nodes(),
            Conversion::ZeroOrder => self.orders().map_or_else(nodes, |[zero, _]| zero),
            Conversion::FirstOrder => self.orders().map_or_else(nodes, |[_, first]| first),
        };
        [
            stored,
            Stage { texture: smooth, filter: Filter::Bilinear },
            Stage { texture: filtered, filter: settings.shown },
        ]
    }

    /// What a stage shows at the points that are judged, lx; black where none is.
    pub fn at_points(&self, stage: &Stage) -> LinearImage {
        let mut picture = stage.picture(self.points);
        for (pixel, receiver) in picture.pixels.iter_mut().zip(&self.receivers) {
            if receiver.is_none() {
                *pixel = Vec3::ZERO;
            }
        }
        picture
    }

    /// Whether each point is judged, row by row.
    pub fn is_judged(&self, point: usize) -> bool {
        self.receivers[point].is_some()
    }

    /// How far a stage is from the reference.
    ///
    /// # Errors
    /// [`MeasureError`] where no point is judged, or a value is not finite.
    pub fn judge(&self, stage: &Stage, reference: &LinearImage) -> Result<StageError, MeasureError> {
        let picture = self.at_points(stage);
        let judged = |image: &LinearImage| {
            let pixels: Vec<Vec3> = (0..image.pixels.len())
                .filter(|&i| self.receivers[i].is_some())
                .map(|i| image.pixels[i])
                .collect();
            LinearImage { width: pixels.len() as u32, height: 1, pixels }
        };
        let (found, wanted) = (judged(&picture), judged(reference));
        let off = found.pixels.iter().zip(&wanted.pixels).map(|(a, b)| luminance(*a - *b));
        let largest = |most: f32, d: f32| if d.abs() > most.abs() { d } else { most };
        Ok(StageError {
            rel_mse: image::rel_mse(&found, &wanted)?,
            perceptual: perceptual::difference(&picture, reference, image::PIXELS_PER_DEGREE)?,
            largest_lx: off.fold(0.0, largest),
        })
    }
}

impl Stage {
    /// What it shows at the middles of equal cells, lx; never negative.
    pub fn picture(&self, [width, height]: [u32; 2]) -> LinearImage {
        let size = Vec2::new(width as f32, height as f32);
        LinearImage::from_fn(width, height, |x, y| {
            let at = (Vec2::new(x as f32, y as f32) + Vec2::splat(0.5)) / size;
            self.texture.sample(at, self.filter).max(Vec3::ZERO)
        })
    }

    /// Number of its texels.
    pub fn texels(&self) -> usize {
        self.texture.image.pixels.len()
    }

    /// Bytes they take in single precision.
    pub fn bytes(&self) -> usize {
        size_of_val(self.texture.image.pixels.as_slice())
    }
}

/// A grid as one sees it who stands before its surface: columns to the right, rows downwards; on level
/// surfaces rows come nearer along +z.
struct Seen {
    /// Columns and rows of nodes.
    nodes: [u32; 2],
    /// First node, m.
    origin: Vec3,
    /// From a column to the next and from a row to the next, m.
    steps: [Vec3; 2],
    /// Whether columns are the grid's v.
    turned: bool,
    /// Element of the first node, and steps in elements.
    first: i64,
    strides: [i64; 2],
}

impl Seen {
    fn new(solution: &RadiositySolution, chart: &Chart) -> Self {
        let normal = solution.elements()[chart.first_element as usize].geometric_normal;
        let down = if normal.y.abs() < 0.9 { Vec3::NEG_Y } else { Vec3::Z };
        let mut seen = Self {
            nodes: [chart.nx, chart.ny],
            origin: chart.origin,
            steps: [chart.step_u, chart.step_v],
            turned: false,
            first: i64::from(chart.first_element),
            strides: [1, i64::from(chart.nx)],
        };
        let along = |step: Vec3| step.normalize_or_zero().dot(down).abs();
        if along(chart.step_u) > along(chart.step_v) {
            seen.turned = true;
            seen.nodes.reverse();
            seen.steps.reverse();
            seen.strides.reverse();
        }
        if seen.steps[1].dot(down) < 0.0 {
            seen.flip(1);
        }
        // Right × up is towards who looks.
        if seen.steps[0].cross(-seen.steps[1]).dot(normal) < 0.0 {
            seen.flip(0);
        }
        seen
    }

    fn flip(&mut self, axis: usize) {
        let last = self.nodes[axis] - 1;
        self.origin += self.steps[axis] * last as f32;
        self.first += self.strides[axis] * i64::from(last);
        self.steps[axis] = -self.steps[axis];
        self.strides[axis] = -self.strides[axis];
    }

    /// Number of a node's element.
    fn element(&self, x: u32, y: u32) -> usize {
        (self.first + self.strides[0] * i64::from(x) + self.strides[1] * i64::from(y)) as usize
    }
}

fn receivers(solution: &RadiositySolution, seen: &Seen, [w, h]: [u32; 2]) -> Vec<Option<Receiver>> {
    let node = |x: u32, y: u32| &solution.elements()[seen.element(x, y)];
    let [nx, ny] = seen.nodes;
    let receiver = |i: u32| {
        let at = (Vec2::new((i % w) as f32, (i / w) as f32) + Vec2::splat(0.5))
            * Vec2::new((nx - 1) as f32 / w as f32, (ny - 1) as f32 / h as f32);
        let (x, y) = ((at.x as u32).min(nx - 2), (at.y as u32).min(ny - 2));
        let around = [node(x, y), node(x + 1, y), node(x, y + 1), node(x + 1, y + 1)];
        let inside = around.iter().all(|e| e.flags & OUTSIDE == 0);
        let position = seen.origin + seen.steps[0] * at.x + seen.steps[1] * at.y;
        inside.then(|| Receiver::new(position, around[0].geometric_normal))
    };
    (0..w * h).map(receiver).collect()
}

/// Irradiance of a grid by the path tracer, in the making.
#[derive(Clone, Debug)]
pub struct GridReference {
    sums: Vec<DVec3>,
    /// Sum of the squared standard errors of luminance a point, lx².
    variances: Vec<f64>,
    passes: u32,
    seed: u64,
}

impl GridReference {
    /// Paths a point of one pass.
    pub const PATHS: u32 = 64;
    /// Passes after which it rests.
    pub const ENOUGH: u32 = 16;

    /// Nothing traced yet.
    pub fn new(grid: &GridTexture, seed: u64) -> Self {
        let count = grid.receivers.len();
        Self { sums: vec![DVec3::ZERO; count], variances: vec![0.0; count], passes: 0, seed }
    }

    /// Adds [`Self::PATHS`] paths to every point that is judged.
    ///
    /// # Errors
    /// [`Cancelled`]; the passes so far stay.
    pub fn more(&mut self, grid: &GridTexture, world: &World, progress: &Progress) -> Result<(), Cancelled> {
        let tracer = PathTracer::new(world);
        let (count, done) = (grid.receivers.len() as u32, AtomicU32::new(0));
        let found: Vec<(DVec3, f64)> = (0..count)
            .into_par_iter()
            .map(|i| {
                progress.report(done.fetch_add(1, Ordering::Relaxed) as f32 / count as f32)?;
                let Some(receiver) = &grid.receivers[i as usize] else { return Ok((DVec3::ZERO, 0.0)) };
                let seed = self.seed ^ (u64::from(self.passes) << 32) ^ u64::from(i);
                let estimate = irradiance_with(&tracer, receiver, Part::All, Self::PATHS, seed);
                let error = f64::from(luminance(estimate.standard_error));
                Ok((estimate.mean.as_dvec3(), error * error))
            })
            .collect::<Result<_, Cancelled>>()?;
        for (i, (mean, variance)) in found.into_iter().enumerate() {
            self.sums[i] += mean;
            self.variances[i] += variance;
        }
        self.passes += 1;
        Ok(())
    }

    /// Whether it has all its passes.
    pub fn is_done(&self) -> bool {
        self.passes >= Self::ENOUGH
    }

    /// Paths a point so far.
    pub fn paths(&self) -> u32 {
        self.passes * Self::PATHS
    }

    /// Mean irradiance at the points of a grid, lx; black where none is judged.
    pub fn mean(&self, grid: &GridTexture) -> LinearImage {
        let scale = 1.0 / f64::from(self.passes.max(1));
        let pixels = self.sums.iter().map(|s| (*s * scale).as_vec3()).collect();
        LinearImage { width: grid.points[0], height: grid.points[1], pixels }
    }

    /// Median over the points judged of the standard error over max(E, 5 % of its mean).
    pub fn noise(&self, grid: &GridTexture) -> f64 {
        let n = f64::from(self.passes.max(1));
        let judged: Vec<(f64, f64)> = (0..self.sums.len())
            .filter(|&i| grid.is_judged(i))
            .map(|i| (f64::from(luminance((self.sums[i] / n).as_vec3())), self.variances[i].sqrt() / n))
            .collect();
        let floor = floor_of(judged.iter().map(|j| j.0).sum::<f64>() / judged.len().max(1) as f64);
        let mut errors: Vec<f64> = judged.iter().map(|(mean, error)| error / mean.max(floor)).collect();
        errors.sort_by(f64::total_cmp);
        errors.get(errors.len() / 2).copied().unwrap_or(0.0)
    }
}
