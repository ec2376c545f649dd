//! Transport, cached as hits: what every element sees, by number.
//!
//! The indirect irradiance of an element is the mean radiosity over cosine-distributed directions,
//! `E = ∫ L cos θ dω ≈ (1/N) Σ B(hit)` (the cosine and the 1/π of L = B/π cancel against the
//! density), so a ray is worth one element number and a sweep is one gather of numbers. Lamps can
//! change without a ray being cast again. Not form factors in a matrix: that grows with the square
//! of the elements; not hemicubes: their raster aliases.
//!
//! A hit draws one of the four elements it lies between with the interpolation weight as
//! probability, so the mean is that of the interpolated radiosity. Neighbouring nodes of a grid use
//! consecutive stretches of one R₂ sequence: between them the interpolated value has the error of
//! many more directions than each has. Neither is true of independently scrambled nodes.
//!
//! A ray that meets something polished goes on, see `super::specular`.

use super::{
    RadiosityError,
    rims::{Fills, fills, mark_rims, redirect},
    specular::{Lobes, Seen},
    surface_map::{Element, SurfaceMap, UNSOLVED},
};
use crate::{
    math::{
        frame::{cosine_direction, frame_from_normal},
        progress::Progress,
        random::{Rng, fold, hash2, r2_point, unit_f32},
    },
    scene::{
        accel::{Hit, Ray},
        world::World,
    },
};
use glam::{Mat3, Vec3, Vec3A};
use rayon::prelude::*;
use std::{collections::BTreeMap, ops::Range};

/// What every element sees.
#[derive(Clone, Debug, Default)]
pub struct Transport {
    /// Where the elements are.
    pub map: SurfaceMap,
    /// Hits of all elements: element numbers, or the number of elements where a ray meets nothing that reflects.
    pub hits: Vec<u32>,
    /// Stretch of `hits` that is each element's; empty where it is not solved.
    rows: Vec<Range<usize>>,
    /// Rays an element; on quadtrees of one that stands for as much as a finest leaf, more on larger ones.
    pub rays: u32,
    /// Largest row sum of transport times reflectance, per channel: how much a sweep can amplify.
    pub norm: Vec3,
    /// What rays are followed by.
    pub(super) lobes: Lobes,
    /// What each element sees by way of lobes; empty where nothing is specular.
    pub(super) seen: Vec<Option<Box<Seen>>>,
    /// Elements without light of their own and the solved neighbours they take it from, in order.
    fills: Fills,
}

/// What the rays of the elements met, while elements are still being chosen.
#[derive(Clone)]
pub(super) struct Gathering {
    /// Where the elements are.
    pub map: SurfaceMap,
    rays: u32,
    seed: u64,
    /// Grid nodes and vertex elements as they were hit, solved or not.
    hits: Vec<u32>,
    /// Stretch of `hits` that is each element's; empty where its rays are not cast.
    rows: Vec<Range<usize>>,
    lobes: Lobes,
    seen: Vec<Option<Box<Seen>>>,
    buried: Vec<bool>,
}

impl Gathering {
    /// Casts `rays` rays from every element that is to be solved.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`].
    pub fn new(
        world: &World,
        map: SurfaceMap,
        rays: u32,
        seed: u64,
        progress: &Progress,
    ) -> Result<Self, RadiosityError> {
        let count = map.elements.len();
        let mut gathering = Self {
            rays: rays.max(1),
            seed,
            hits: Vec::new(),
            rows: vec![0..0; count],
            buried: vec![false; count],
            lobes: Lobes::new(world),
            seen: Vec::new(),
            map,
        };
        if gathering.lobes.any() {
            gathering.seen.resize_with(count, || None);
        }
        progress.begin("gathering light paths");
        gathering.cast(world, progress)?;
        Ok(gathering)
    }

    /// Rays of an element, on quadtrees as the root of the area it stands for: noise weighs by area and falls with
    /// the root of rays, so that for all rays together this leaves the least (Neyman 1934). `rays` are those of an
    /// area as large as a finest leaf; none has less than a quarter.
    fn rays_of(&self, element: u32) -> u32 {
        const LEAST_SHARE: f32 = 0.25;
        /// Rays are multiples of it, so that few lengths of rows are cast in turn.
        const STEP: f32 = 8.0;
        let Some(finest) = self.map.finest_leaf_area() else { return self.rays };
        let rays = self.rays as f32;
        let wanted = rays * (self.map.area_stood_for(element) / finest).sqrt().max(LEAST_SHARE);
        (STEP * (wanted / STEP).round()).max(1.0) as u32
    }

    /// Casts rays from the elements that are to be solved and have none yet.
    fn cast(&mut self, world: &World, progress: &Progress) -> Result<(), RadiosityError> {
        // Between two looks at whether the user gave up.
        const RAYS_A_BLOCK: usize = 1 << 18;
        let count = self.map.elements.len() as u32;
        let mut by_rays: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for element in 0..count {
            let i = element as usize;
            if self.map.elements[i].flags & UNSOLVED == 0 && self.rows[i].is_empty() {
                by_rays.entry(self.rays_of(element)).or_default().push(element);
            }
        }
        let all = by_rays.values().map(Vec::len).sum::<usize>();
        self.hits.reserve_exact(by_rays.iter().map(|(rays, list)| *rays as usize * list.len()).sum());
        let mut done = 0;
        for (rays, list) in by_rays {
            let rays = rays as usize;
            for block in list.chunks((RAYS_A_BLOCK / rays).clamp(16, 1024)) {
                progress.report(done as f32 / all as f32)?;
                done += block.len();
                let first = self.hits.len();
                self.hits.resize(first + rays * block.len(), count);
                let (map, lobes, seed) = (&self.map, &self.lobes, self.seed);
                let cast = |(row, &element): (&mut [u32], &u32)| {
                    let mut seen = Seen::default();
                    let buried = gather_row(world, map, lobes, element, seed, (row, &mut seen));
                    (buried, seen)
                };
                let found: Vec<(bool, Seen)> =
                    self.hits[first..].par_chunks_mut(rays).zip(block).map(cast).collect();
                for (k, (&element, (buried, seen))) in block.iter().zip(found).enumerate() {
                    let element = element as usize;
                    self.rows[element] = first + k * rays..first + (k + 1) * rays;
                    self.buried[element] = buried;
                    if seen.bytes() > 0 {
                        self.seen[element] = Some(Box::new(seen));
                    }
                }
            }
        }
        Ok(())
    }

    /// Hits of one element, before those on nodes that are not solved are lent.
    pub fn row(&self, element: usize) -> &[u32] {
        &self.hits[self.rows[element].clone()]
    }

    /// Splits the leaves of a level that `wanted` names by their corners, and casts rays from what is new;
    /// whether anything was split. Leaves all of whose corners are buried or outside stay.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`].
    pub fn subdivide(
        &mut self,
        world: &World,
        level: u8,
        restricted: bool,
        wanted: impl Fn(&[usize], [f32; 2]) -> bool,
        progress: &Progress,
    ) -> Result<bool, RadiosityError> {
        let buried = &self.buried;
        let open = |corners: &[usize], sides: [f32; 2]| {
            corners.iter().any(|c| !buried[*c]) && wanted(corners, sides)
        };
        let grown = self.map.subdivide(level, restricted, open);
        if grown {
            progress.begin("subdividing");
            self.cast(world, progress)?;
        }
        Ok(grown)
    }

    /// The transport of what was chosen.
    pub fn transport(self, world: &World) -> Transport {
        let Self { mut map, mut hits, rows, rays, buried, lobes, mut seen, .. } = self;
        mark_rims(&mut map, &buried);
        let between = map.between();
        if between.len() > 0 {
            map.weigh(&world.geometry, &between);
        }
        let fills = fills(&map, between);
        redirect(&mut map, &mut hits, &mut seen, &fills);
        let mut transport = Transport { map, hits, rows, rays, norm: Vec3::ZERO, lobes, seen, fills };
        let reflectance: Vec<Vec3> = transport.map.elements.iter().map(|e| e.reflectance).collect();
        transport.norm = transport.gather(&reflectance).into_iter().fold(Vec3::ZERO, Vec3::max);
        transport
    }
}

impl Transport {
    /// Casts `rays` rays from every element that is to be solved.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`].
    pub fn new(
        world: &World,
        map: SurfaceMap,
        rays: u32,
        seed: u64,
        progress: &Progress,
    ) -> Result<Self, RadiosityError> {
        Ok(Gathering::new(world, map, rays, seed, progress)?.transport(world))
    }

    /// Mean over the hits of every element of a value an element; a sweep of the transport.
    /// Unsolved elements give zero.
    ///
    /// # Panics
    /// If there is not one value an element.
    pub fn gather(&self, values: &[Vec3]) -> Vec<Vec3> {
        assert_eq!(values.len(), self.map.elements.len(), "one value an element");
        let padded: Vec<Vec3A> =
            values.iter().map(|v| Vec3A::from(*v)).chain(std::iter::once(Vec3A::ZERO)).collect();
        self.rows
            .par_iter()
            .with_min_len(64)
            .enumerate()
            .map(|(element, row)| {
                let hits = &self.hits[row.clone()];
                let mut sum = hits.iter().fold(Vec3A::ZERO, |sum, &hit| sum + padded[hit as usize]);
                if let Some(Some(seen)) = self.seen.get(element) {
                    let by_lobes = seen.elements.iter();
                    sum += by_lobes
                        .map(|&(hit, share)| padded[hit as usize] * Vec3A::from(share))
                        .sum::<Vec3A>();
                }
                Vec3::from(sum * (1.0 / hits.len().max(1) as f32))
            })
            .collect()
    }

    /// Elements to be looked up and not to be lit: nothing is known of what they see.
    pub(super) fn to_be_shown(map: SurfaceMap) -> Self {
        Self { map, ..Self::default() }
    }

    /// Hits of one element.
    pub fn row(&self, element: u32) -> &[u32] {
        &self.hits[self.rows[element as usize].clone()]
    }

    /// Gives unsolved elements the mean of their solved neighbours.
    pub fn fill(&self, values: &mut [Vec3]) {
        for (element, sources) in self.fills.iter() {
            values[element as usize] =
                sources.iter().fold(Vec3::ZERO, |sum, &(s, weight)| sum + values[s as usize] * weight);
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let seen: usize = self.seen.iter().map(|s| 8 + s.as_ref().map_or(0, |s| s.bytes())).sum();
        self.map.bytes() + 4 * self.hits.len() + size_of_val(&self.rows[..]) + self.fills.bytes() + seen
    }
}

/// Hits of one element, what it sees by way of lobes, and whether it is buried: most rays meet a black back close
/// by, as inside a solid, or nearly all meet something at once, as under a rug or behind a skirting board. In a
/// corner of three walls three quarters do.
fn gather_row(
    world: &World,
    map: &SurfaceMap,
    lobes: &Lobes,
    number: u32,
    seed: u64,
    (row, seen): (&mut [u32], &mut Seen),
) -> bool {
    const NEAR_SPACINGS: f32 = 4.0;
    const AT_ONCE_SPACINGS: f32 = 0.25;
    let element = &map.elements[number as usize];
    let seed = fold(seed);
    let (scramble, first) = sequence(map, element, number, seed, row.len() as u32);
    // A grid interpolates values at its nodes; a vertex element is the mean over what it stands for.
    let node = [element.receiver()];
    let from = if element.chart == u32::MAX { map.footprint(number as usize) } else { &node[..] };
    let frames: Vec<(Mat3, Vec3)> = from.iter().map(|f| (frame_from_normal(f.normal), f.origin())).collect();
    let draw = |hit: &Hit, direction: Vec3, xi: f32| {
        let back = world.geometry.area_normal(hit.triangle).dot(direction) > 0.0;
        let drawn = map.blend(hit.triangle, hit.barycentric, back).draw(xi);
        (drawn != super::lookup::NO_ELEMENTS).then_some(drawn)
    };
    let (mut near_backs, mut at_once) = (0, 0);
    for (j, hit) in row.iter_mut().enumerate() {
        let local = cosine_direction(r2_point(first.wrapping_add(j as u32), scramble));
        let (frame, origin) = frames[j % frames.len()];
        let mut direction = frame * local;
        // Below the facet's own plane there is only the facet: such a direction is mirrored up.
        let geometric_normal = from[j % frames.len()].geometric_normal;
        let below = direction.dot(geometric_normal);
        if below <= 0.0 {
            direction -= 2.0 * below * geometric_normal;
        }
        let Some(found) = world.accel.trace(&Ray::new(origin, direction)) else { continue };
        let material = world.geometry.material_of(found.triangle);
        at_once += usize::from(found.t < AT_ONCE_SPACINGS * map.spacing_m && !material.is_glass());
        let xi = unit_f32(hash2(hash2(number, seed), j as u32));
        match draw(&found, direction, xi) {
            Some(drawn) => *hit = drawn,
            None if material.is_glass() => {}
            None => near_backs += u32::from(found.t < NEAR_SPACINGS * map.spacing_m),
        }
        if lobes.any() && material.is_specular() {
            let mut rng = Rng::new(u64::from(seed), u64::from(number) << 32 | j as u64);
            lobes.follow(world, (found, direction), &mut rng, draw, seen);
        }
    }
    2 * near_backs > row.len() as u32 || 100 * at_once > 85 * row.len()
}

/// Scramble and first index of an element's stretch of the R₂ sequence.
fn sequence(map: &SurfaceMap, element: &Element, number: u32, seed: u32, rays: u32) -> (u32, u32) {
    if element.chart == u32::MAX {
        return (hash2(number, seed), 0);
    }
    let chart = &map.charts[element.chart as usize];
    let local = number - chart.first_element;
    let [u, v] = map.stride(element.chart as usize, number as usize).map(|stride| stride as u32);
    let (x, y) = (local % chart.nx / u, local / chart.nx / v);
    let morton = (x & 1) | ((y & 1) << 1) | ((x & 2) << 1) | ((y & 2) << 2);
    (hash2(chart.first_element, seed), morton * rays)
}
