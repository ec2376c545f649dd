//! Particles around a point: a grid for each glossy surface, and the sum that makes radiance of them.

use super::trace::{ParticleHit, Particles, tilt};
use crate::scene::{geometry::Surface, world::World};
use glam::{IVec3, Vec3};
use std::{collections::BTreeMap, f32::consts::PI};

/// Cosine between two normals below which a particle met another side than the point is on.
const SAME_SIDE: f32 = 0.5;

/// How particles are splatted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplatSettings {
    /// C of Eq. 7.6, h = C √(A / n): π C² particles lie under a Gaussian.
    pub scale: f32,
    /// Radius h wherever it is given, m, instead of that.
    pub radius_m: Option<f32>,
    /// Bounces of the particles that count: from 1 on without straight light.
    pub least_bounces: u32,
}

impl Default for SplatSettings {
    fn default() -> Self {
        Self { scale: 12.0, radius_m: None, least_bounces: 0 }
    }
}

/// A particle ready to be looked at from anywhere.
#[derive(Clone, Copy, Debug)]
struct Splat {
    position: Vec3,
    normal: Vec3,
    wi: Vec3,
    /// Flux about the shading normal, lm per channel.
    power: Vec3,
    /// Base colour of the material there.
    base: Vec3,
}

/// Cells along an axis, at most, and two: their numbers stay below 2³².
const MOST_CELLS: f32 = 1000.0;

/// The particles of one material on one object, in cells at least as wide as their radius.
#[derive(Clone, Debug)]
pub struct SurfaceSplats {
    /// Radius h of the Gaussians, m.
    pub radius_m: f32,
    /// Area A of the surface, m².
    pub area: f32,
    low: Vec3,
    /// Edge of a cell, m.
    cell_m: f32,
    cells: IVec3,
    /// Cell of each splat, sorted.
    keys: Vec<u32>,
    splats: Vec<Splat>,
}

/// The particles on glossy surfaces.
#[derive(Clone, Debug, Default)]
pub struct SplatMap {
    /// By object and material.
    pub surfaces: BTreeMap<(u32, u32), SurfaceSplats>,
}

impl SplatMap {
    /// Sorts the hits on glossy surfaces.
    pub fn new(world: &World, particles: &Particles, settings: &SplatSettings) -> Self {
        Self::of(world, particles, settings, |t| world.geometry.material_of(t).is_glossy())
    }

    /// Sorts the hits on the triangles that `takes` names.
    pub fn of(
        world: &World,
        particles: &Particles,
        settings: &SplatSettings,
        takes: impl Fn(u32) -> bool,
    ) -> Self {
        let geometry = &world.geometry;
        let surface_of = |t: u32| (geometry.object[t as usize], geometry.material[t as usize]);
        let mut splats: BTreeMap<(u32, u32), Vec<Splat>> = BTreeMap::new();
        let counts = |hit: &ParticleHit| hit.bounces >= settings.least_bounces && takes(hit.triangle);
        for (hit, power) in particles.hits().filter(|(hit, _)| counts(hit)) {
            let surface = geometry.surface(hit.triangle, hit.barycentric, -hit.wi);
            splats.entry(surface_of(hit.triangle)).or_default().push(Splat {
                position: surface.position,
                normal: surface.normal,
                wi: hit.wi,
                power: power * tilt(&surface, hit.wi),
                base: geometry.material_of(hit.triangle).reflectance_at(surface.uv, &geometry.textures),
            });
        }
        let mut areas: BTreeMap<(u32, u32), f32> = BTreeMap::new();
        for t in (0..geometry.len() as u32).filter(|&t| takes(t)) {
            let sides = if geometry.material_of(t).double_sided { 2.0 } else { 1.0 };
            *areas.entry(surface_of(t)).or_default() += 0.5 * sides * geometry.area_normal(t).length();
        }
        let sorted = |(key, splats): ((u32, u32), Vec<Splat>)| {
            let area = areas.get(&key).copied().unwrap_or(0.0);
            let radius_m = settings.radius_m.unwrap_or(settings.scale * (area / splats.len() as f32).sqrt());
            (radius_m > 0.0).then(|| (key, SurfaceSplats::new(area, radius_m, splats)))
        };
        Self { surfaces: splats.into_iter().filter_map(sorted).collect() }
    }

    /// Radiance of a surface towards the eye by its Lambertian part and by its lobe, cd/m² per channel:
    /// L = 1/h² Σ f(xⱼ, ωᵢⱼ, ωₒⱼ) φⱼ k((x − xⱼ)/h) (Eq. 7.5), ωₒⱼ from each particle to the eye.
    pub fn radiance(&self, world: &World, surface: &Surface, eye: Vec3) -> [Vec3; 2] {
        let t = surface.triangle as usize;
        let key = (world.geometry.object[t], world.geometry.material[t]);
        let Some(around) = self.surfaces.get(&key) else { return [Vec3::ZERO; 2] };
        let material = world.geometry.material_of(surface.triangle);
        let mut sum = [Vec3::ZERO; 2];
        around.each(surface, |splat, weight| {
            let wo = (eye - splat.position).normalize_or(splat.normal);
            let [diffuse, lobe] = material.brdf_of(splat.base).value(splat.normal, splat.wi, wo);
            sum = [sum[0] + diffuse * splat.power * weight, sum[1] + lobe * splat.power * weight];
        });
        sum
    }

    /// The particles as `shaders/glossy/particles.wgsl` reads them, sixteen bytes a row: how many surfaces there are; for
    /// each its object, material, first row and count, its lowest corner and edge of a cell, its cells and radius; for
    /// each particle position and cell, normal, direction and power, each with a channel of the base colour.
    pub fn table(&self) -> Vec<[u32; 4]> {
        let row = |v: Vec3, last: u32| [v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), last];
        let mut table = vec![[self.surfaces.len() as u32, 0, 0, 0]];
        let mut first = 1 + 3 * self.surfaces.len() as u32;
        for (&(object, material), s) in &self.surfaces {
            let cells = s.cells.to_array().map(|c| c as u32);
            table.push([object, material, first, s.splats.len() as u32]);
            table.push(row(s.low, s.cell_m.to_bits()));
            table.push([cells[0], cells[1], cells[2], s.radius_m.to_bits()]);
            first += 4 * s.splats.len() as u32;
        }
        for s in self.surfaces.values() {
            table.extend(s.keys.iter().zip(&s.splats).flat_map(|(&key, splat)| {
                let base = splat.base.to_array().map(f32::to_bits);
                [
                    row(splat.position, key),
                    row(splat.normal, base[0]),
                    row(splat.wi, base[1]),
                    row(splat.power, base[2]),
                ]
            }));
        }
        table
    }

    /// Particles a square metre around a point, by the same Gaussians.
    pub fn density(&self, world: &World, surface: &Surface) -> f32 {
        let t = surface.triangle as usize;
        let key = (world.geometry.object[t], world.geometry.material[t]);
        let mut sum = 0.0;
        if let Some(around) = self.surfaces.get(&key) {
            around.each(surface, |_, weight| sum += weight);
        }
        sum
    }
}

impl SurfaceSplats {
    fn new(area: f32, radius_m: f32, mut splats: Vec<Splat>) -> Self {
        let low = splats.iter().fold(Vec3::INFINITY, |low, s| low.min(s.position));
        let high = splats.iter().fold(Vec3::NEG_INFINITY, |high, s| high.max(s.position));
        let cell_m = radius_m.max((high - low).max_element() / MOST_CELLS);
        // Cells keep a margin of one, so that neighbours of those at the rim have numbers too.
        let cells = ((high - low) / cell_m).as_ivec3() + 3;
        let mut grid = Self { radius_m, area, low, cell_m, cells, keys: Vec::new(), splats: Vec::new() };
        splats.sort_by_cached_key(|s| grid.key(grid.cell(s.position)));
        grid.keys = splats.iter().map(|s| grid.key(grid.cell(s.position))).collect();
        grid.splats = splats;
        grid
    }

    /// How many particles there are.
    pub fn count(&self) -> usize {
        self.splats.len()
    }

    fn cell(&self, position: Vec3) -> IVec3 {
        ((position - self.low) / self.cell_m).floor().as_ivec3() + 1
    }

    fn key(&self, cell: IVec3) -> u32 {
        let [x, y, z] = cell.to_array().map(|c| c as u32);
        (z * self.cells.y as u32 + y) * self.cells.x as u32 + x
    }

    /// Visits the particles within the radius on the same side, each with k((x − xⱼ)/h)/h², 1/m².
    fn each(&self, surface: &Surface, mut visit: impl FnMut(&Splat, f32)) {
        let middle = self.cell(surface.position);
        if middle.cmplt(IVec3::ZERO).any() || middle.cmpgt(self.cells).any() {
            return;
        }
        let (low, high) = ((middle - 1).max(IVec3::ZERO), (middle + 1).min(self.cells - 1));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                // Cells along x are neighbours in the list too.
                let first = self.key(IVec3::new(low.x, y, z));
                let last = self.key(IVec3::new(high.x, y, z));
                let from = self.keys.partition_point(|k| *k < first);
                for splat in
                    self.splats[from..].iter().zip(&self.keys[from..]).take_while(|(_, k)| **k <= last)
                {
                    let splat = splat.0;
                    let u2 = surface.position.distance_squared(splat.position) / self.radius_m.powi(2);
                    if u2 < 1.0 && surface.normal.dot(splat.normal) > SAME_SIDE {
                        visit(splat, gaussian(u2) / self.radius_m.powi(2));
                    }
                }
            }
        }
    }
}

/// The normalised Gaussian k(u) of standard deviation ½, cut off at |u| = 1, of u²:
/// 2 exp(−2 u²) / (π (1 − e⁻²)), with ∫ k du = 1 over the disc.
pub fn gaussian(u_squared: f32) -> f32 {
    const CUT_OFF: f32 = 0.135_335_28;
    2.0 * (-2.0 * u_squared).exp() / (PI * (1.0 - CUT_OFF))
}
