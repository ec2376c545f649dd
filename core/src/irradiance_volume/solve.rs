//! Building: rays from every sample into every bin, once; then light through them, as often as it changes.
//!
//! A ray's result is not a radiance but the number of the surface element it met. Radiance is that
//! element's B/π, so when the light changes nothing is traced again but the shadow rays of the emitters
//! that did. The radiosity B holds reflected light alone: what an emitter sends straight to the sample
//! comes from [`super::direct`], never from a bin.

use super::{
    IrradianceVolume, Sample, Tables, Transport, VolumeError, VolumeSettings,
    codec::{Texel, encode, encode_rgb},
    direct::{Arrivals, Centres, add_irradiance},
    directions::Directions,
    quadrature::{BLOCK, LANES, Lanes, Quadrature},
};
use crate::{
    math::{
        progress::Progress,
        random::{hash2, r2_point},
        sphere_map::DirectionBins,
    },
    scene::{Target, accel::Ray, world::World},
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::{
    f32::consts::FRAC_1_PI,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

/// No element: the ray left the scene or met a black back.
pub const NO_ELEMENT: u32 = u32::MAX;

/// Position in a bin of the ray that stands in for one that left the scene.
const BESIDE: Vec2 = Vec2::new(0.537, 0.471);

/// What the volume asks of light on surfaces: a number for every place, and the radiosity there.
pub trait SurfaceLight: Sync {
    /// Element at barycentric weights of a triangle, on its front or back.
    fn element_at(&self, triangle: u32, barycentric: Vec2, back: bool) -> u32;

    /// Radiosity of every element, reflected light only, lx per channel.
    fn radiosity(&self) -> &[Vec3];
}

/// What the rays of one point met.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointHits {
    /// Element of each ray, `supersample` of them a bin, or [`NO_ELEMENT`].
    pub elements: Vec<u32>,
    /// Rays that met an emitting side: number of the ray, triangle, texture coordinates.
    pub emitters: Vec<(u32, u32, Vec2)>,
    /// Share of the rays that met the back of a single-sided surface.
    pub back_face_fraction: f32,
}

/// Sends `supersample` rays into each bin from a point in the air; `item` decorrelates points.
pub fn trace_point(
    world: &World,
    light: &impl SurfaceLight,
    bins: DirectionBins,
    settings: &VolumeSettings,
    position: Vec3,
    item: u32,
) -> PointHits {
    let rays = settings.supersample;
    let mut hits =
        PointHits { elements: Vec::with_capacity(bins.len() * rays as usize), ..Default::default() };
    let mut backs = 0u32;
    for bin in 0..bins.len() {
        let scramble = hash2(item ^ settings.seed as u32, bin as u32);
        for ray in 0..rays {
            let jitter = if rays == 1 { Vec2::splat(0.5) } else { r2_point(ray, scramble) };
            let mut direction = bins.direction(bin, jitter);
            let mut element = NO_ELEMENT;
            let mut hit = world.accel.trace(&Ray::new(position, direction));
            if hit.is_none() {
                // Bin centres and rooms are symmetric, so rays do go exactly through the seam between
                // two triangles: ask once more beside it.
                direction = bins.direction(bin, BESIDE);
                hit = world.accel.trace(&Ray::new(position, direction));
            }
            if let Some(hit) = hit {
                let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
                if world.geometry.is_lit(&surface) {
                    element = light.element_at(hit.triangle, hit.barycentric, surface.back);
                    if world.geometry.material_of(hit.triangle).emission != Vec3::ZERO {
                        hits.emitters.push((hits.elements.len() as u32, hit.triangle, surface.uv));
                    }
                } else {
                    backs += 1;
                }
            }
            hits.elements.push(element);
        }
    }
    hits.back_face_fraction = backs as f32 / hits.elements.len() as f32;
    hits
}

/// Reflected radiance of an element, cd/m².
pub fn element_radiance(radiosity: &[Vec3], element: u32) -> Vec3 {
    radiosity.get(element as usize).map_or(Vec3::ZERO, |b| *b * FRAC_1_PI)
}

impl IrradianceVolume {
    /// Places the samples, traces their rays and lights them.
    ///
    /// # Errors
    /// [`VolumeError`] for settings out of range, bounds that are not finite, and cancellation.
    pub fn build(
        world: &World,
        light: &impl SurfaceLight,
        settings: &VolumeSettings,
        progress: &Progress,
    ) -> Result<Self, VolumeError> {
        progress.begin("irradiance volume");
        let mut grid = settings.grid(world)?;
        let bins = DirectionBins::new(settings.bins_n);
        let done = AtomicUsize::new(0);
        let count = grid.places().len();
        let hits: Vec<PointHits> = grid
            .places()
            .par_iter()
            .enumerate()
            .map(|(i, place)| {
                progress.report(0.8 * done.fetch_add(1, Ordering::Relaxed) as f32 / count as f32)?;
                Ok(trace_point(world, light, bins, settings, place.position, i as u32))
            })
            .collect::<Result<_, VolumeError>>()?;
        let samples: Vec<Sample> = grid
            .places()
            .iter()
            .zip(&hits)
            .map(|(place, hit)| Sample {
                position: place.position,
                level: place.level,
                back_face_fraction: hit.back_face_fraction,
                valid: hit.back_face_fraction <= settings.back_face_limit,
            })
            .collect();
        grid.set_valid(&samples.iter().map(|s| s.valid).collect::<Vec<_>>());

        let positions: Vec<Vec3> = samples.iter().map(|s| s.position).collect();
        let mut arrivals = Vec::with_capacity(world.emitters.len());
        for (i, emitter) in world.emitters.list.iter().enumerate() {
            arrivals.push(Arc::new(Arrivals::gather(world, emitter, &positions, settings)));
            progress.report(0.8 + 0.1 * (i + 1) as f32 / world.emitters.len() as f32)?;
        }
        let mut emitters_seen = vec![Vec::new(); count];
        let mut elements = Vec::with_capacity(count * bins.len() * settings.supersample as usize);
        for (seen, hit) in emitters_seen.iter_mut().zip(hits) {
            elements.extend(hit.elements);
            *seen = hit.emitters;
        }
        let transport = Arc::new(Transport {
            elements,
            emitters_seen,
            quadrature: Quadrature::new(bins),
            centres: Centres::new(bins),
        });
        let tables = light_samples(&transport, &arrivals, light.radiosity(), settings, count);
        progress.report(1.0)?;
        Ok(Self {
            settings: settings.clone(),
            grid: Arc::new(grid),
            samples: Arc::new(samples),
            directions: Arc::new(Directions::new(bins)),
            transport: Some(transport),
            arrivals,
            tables,
        })
    }

    /// The same samples under changed light; a new volume would also refine where a lamp now is. No radiance ray is traced: bins keep the elements they saw.
    ///
    /// Direct light is asked again of the emitters named by `changed`, or of all of them where something
    /// changed that does not emit, because it may shadow any. What a moved object reflected from where it was stays in the
    /// bins until the volume is built anew. A volume that came from a file keeps its indirect part.
    pub fn relight(&self, world: &World, light: &impl SurfaceLight, changed: &[Target]) -> Self {
        let emits = |t: &Target| world.emitters.list.iter().any(|e| e.target() == *t);
        let all = self.arrivals.len() != world.emitters.len() || !changed.iter().all(emits);
        let positions: Vec<Vec3> = self.samples.iter().map(|s| s.position).collect();
        let arrivals: Vec<Arc<Arrivals>> = world
            .emitters
            .list
            .iter()
            .enumerate()
            .map(|(i, emitter)| {
                if all || changed.contains(&emitter.target()) {
                    Arc::new(Arrivals::gather(world, emitter, &positions, &self.settings))
                } else {
                    self.arrivals[i].clone()
                }
            })
            .collect();
        let tables = match &self.transport {
            Some(t) => light_samples(t, &arrivals, light.radiosity(), &self.settings, self.samples.len()),
            None => self.tables.clone(),
        };
        Self { arrivals, tables, ..self.clone() }
    }
}

/// Irradiance of every bin of every sample, from what they see and what arrives.
fn light_samples(
    transport: &Transport,
    arrivals: &[Arc<Arrivals>],
    radiosity: &[Vec3],
    settings: &VolumeSettings,
    count: usize,
) -> Tables {
    let bins = transport.quadrature.bins().len();
    let rays = settings.supersample as usize;
    let radiance: Vec<[f32; 3]> =
        radiosity.iter().map(|b| (*b * (FRAC_1_PI / rays as f32)).to_array()).collect();
    let mut indirect = vec![Texel::default(); count * bins];
    let mut direct = vec![Texel::default(); count * bins];
    indirect.par_chunks_mut(BLOCK * bins).zip(direct.par_chunks_mut(BLOCK * bins)).enumerate().for_each_init(
        || Scratch::new(bins),
        |scratch, (block, (indirect, direct))| {
            let first = block * BLOCK;
            let here = indirect.len() / bins;
            for s in 0..here {
                let seen = &transport.elements[(first + s) * bins * rays..][..bins * rays];
                for (lanes, elements) in scratch.radiance.iter_mut().zip(seen.chunks_exact(rays)) {
                    let mut sum = [0.0f32; 3];
                    for &e in elements {
                        let l = radiance.get(e as usize).copied().unwrap_or_default();
                        sum = [sum[0] + l[0], sum[1] + l[1], sum[2] + l[2]];
                    }
                    for c in 0..3 {
                        lanes[c * BLOCK + s] = sum[c];
                    }
                }
            }
            transport.quadrature.irradiance(&scratch.radiance, &mut scratch.irradiance);
            for s in 0..here {
                let out = &mut indirect[s * bins..][..bins];
                for (texel, lanes) in out.iter_mut().zip(&scratch.irradiance) {
                    *texel = [encode(lanes[s]), encode(lanes[BLOCK + s]), encode(lanes[2 * BLOCK + s]), 0];
                }
                scratch.direct.iter_mut().for_each(|channel| channel.fill(0.0));
                for emitter in arrivals {
                    add_irradiance(&transport.centres, emitter.of(first + s), &mut scratch.direct);
                }
                let [r, g, b] = &scratch.direct;
                for (i, texel) in direct[s * bins..][..bins].iter_mut().enumerate() {
                    *texel = encode_rgb(Vec3::new(r[i], g[i], b[i]));
                }
            }
        },
    );
    Tables::new(transport.quadrature.bins(), direct, indirect)
}

/// One thread's working memory.
struct Scratch {
    radiance: Vec<Lanes>,
    irradiance: Vec<Lanes>,
    direct: [Vec<f32>; 3],
}

impl Scratch {
    fn new(bins: usize) -> Self {
        Self {
            radiance: vec![[0.0; LANES]; bins],
            irradiance: vec![[0.0; LANES]; bins],
            direct: std::array::from_fn(|_| vec![0.0; bins]),
        }
    }
}
