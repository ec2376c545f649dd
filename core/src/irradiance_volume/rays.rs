//! The rays of one point: what each bin sees, by way of mirrors too, and extra ones aimed at what is bright.
//!
//! Every bin gets `supersample` rays (Greger 1996, §4.2.1). A ray that meets a mirror is reflected on
//! until it meets a diffuse surface or until less than a cut-off is left of it (§4.2.2); what is then
//! seen, an emitter included, counts as light that has bounced.
//!
//! Bins miss what is small, which matters only where it is bright. So some more rays go to points on
//! elements that are known to be bright before anything is traced (§6.1.1): [`Targets`]. Both kinds of
//! ray are weighted by the balance heuristic (Veach and Guibas 1995), which leaves the mean as it is:
//! where the first surface seen is target e, aimed rays have the density p = q_e d² / (A_e cos θ_e) per
//! solid angle; N of them and the n rays of a bin of solid angle Ω count 1 / (n + N Ω p) each, and an
//! aimed ray that meets something else first counts nothing. Not importance sampling of every ray:
//! the bins must each keep their own value, dark ones too.

use super::{VolumeSettings, solve::SurfaceLight};
use crate::{
    math::{
        colour::luminance,
        random::{fold, hash2, r2_point},
        sphere_map::DirectionBins,
    },
    scene::{
        accel::{Hit, Ray},
        geometry::Surface,
        glass::Side,
        world::World,
    },
};
use glam::{Vec2, Vec3};

/// No element: the ray left the scene or met a black back.
pub const NO_ELEMENT: u32 = u32::MAX;

/// Position in a bin of the ray that stands in for one that left the scene.
const BESIDE: Vec2 = Vec2::new(0.537, 0.471);

/// Reflections after which a chain of mirrors ends, whatever is left of it.
const MOST_REFLECTIONS: u32 = 64;

/// Elements aimed at, at most.
pub const MOST_TARGETS: usize = 1024;

/// An element is aimed at when its radiosity exceeds the mean by this factor.
pub const BRIGHT: f32 = 2.0;

/// What the rays of one point met.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointHits {
    /// Element of each ray, `supersample` of them a bin, or [`NO_ELEMENT`].
    pub elements: Vec<u32>,
    /// What bins see beside whole rays of their own.
    pub extras: Vec<Extra>,
    /// Rays that met an emitting side: number of the ray, triangle, texture coordinates.
    pub emitters: Vec<(u32, u32, Vec2)>,
    /// Elements met and the triangle they were met on, once or more each.
    pub owners: Vec<(u32, u32)>,
    /// Share of the rays that met the back of a single-sided surface.
    pub back_face_fraction: f32,
}

/// Light that a bin sees in a mirror, by an aimed ray, or has to give up to one: the bin's mean radiance
/// grows by `factor` times that of the source, cd/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extra {
    /// The bin.
    pub bin: u32,
    /// What is seen.
    pub source: Source,
    /// Attenuation and weight, per channel; negative where another ray takes over.
    pub factor: Vec3,
}

/// What sends light along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// Light reflected by an element.
    Element(u32),
    /// Light emitted at texture coordinates of a triangle, seen in a mirror.
    Emission(u32, Vec2),
}

/// A flat piece of surface with a number, as [`SurfaceLight::patch`] gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Its middle, m.
    pub centre: Vec3,
    /// Edges of the parallelogram around the middle that holds every place of its number, m.
    pub edges: [Vec3; 2],
    /// Unit normal on the side that reflects.
    pub normal: Vec3,
}

/// Elements worth aiming at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Targets {
    list: Vec<BrightElement>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct BrightElement {
    element: u32,
    patch: Patch,
    area: f32,
    /// Flux it reflects, lm.
    flux: f32,
}

impl Targets {
    /// The elements of radiosity over [`BRIGHT`] times the mean by area, at most [`MOST_TARGETS`] of the
    /// largest flux. Curved ones are left to the bins: they have no flat [`Patch`] to draw points on.
    pub fn new(light: &impl SurfaceLight) -> Self {
        let (mut flux, mut total) = (0.0f64, 0.0f64);
        let mut list: Vec<BrightElement> = Vec::new();
        for (element, b) in light.radiosity().iter().enumerate() {
            let Some(patch) = light.patch(element as u32) else { continue };
            let (area, b) = (patch.edges[0].cross(patch.edges[1]).length(), luminance(*b));
            if area > 0.0 && area.is_finite() && b.is_finite() {
                flux += f64::from(b * area);
                total += f64::from(area);
                list.push(BrightElement { element: element as u32, patch, area, flux: b * area });
            }
        }
        let bright = BRIGHT * (flux / total.max(f64::MIN_POSITIVE)) as f32;
        list.retain(|t| t.flux > bright * t.area);
        list.sort_by(|a, b| b.flux.total_cmp(&a.flux).then(a.element.cmp(&b.element)));
        list.truncate(MOST_TARGETS);
        list.sort_by_key(|t| t.element);
        Self { list }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether nothing is worth aiming at.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Points that so many rays from a position are aimed at; none where there is nothing to aim at.
    pub fn aim(&self, position: Vec3, rays: u32, scramble: u32) -> Vec<Vec3> {
        let chances = self.seen_from(position);
        let rays = if self.is_empty() { 0 } else { rays };
        (0..rays).map(|j| chances.draw(r2_point(j, scramble)).1).collect()
    }

    /// The chance of each as seen from a point, about in proportion to the light it sends there if
    /// nothing is between.
    fn seen_from(&self, position: Vec3) -> Chances<'_> {
        let mut sum = 0.0;
        let mut cumulative: Vec<f32> = self
            .list
            .iter()
            .map(|t| {
                let away = position - t.patch.centre;
                // From close by it is not a point: its own size bounds what it can matter.
                let d2 = away.length_squared() + t.area;
                let cosine = t.patch.normal.dot(away) / d2.sqrt();
                // An edge may see the point where the middle does not: never quite nothing.
                sum += t.flux * cosine.max(0.02) / d2;
                sum
            })
            .collect();
        cumulative.iter_mut().for_each(|c| *c /= sum.max(f32::MIN_POSITIVE));
        Chances { list: &self.list, cumulative }
    }
}

/// Targets with their cumulative probability.
struct Chances<'a> {
    list: &'a [BrightElement],
    cumulative: Vec<f32>,
}

impl Chances<'_> {
    fn probability(&self, place: usize) -> f32 {
        self.cumulative[place] - if place == 0 { 0.0 } else { self.cumulative[place - 1] }
    }

    /// Density per solid angle with which aimed rays go to a point of an element; 0 for no target.
    fn density(&self, element: u32, direction: Vec3, distance: f32) -> f32 {
        let Ok(place) = self.list.binary_search_by_key(&element, |t| t.element) else { return 0.0 };
        let target = &self.list[place];
        let cosine = target.patch.normal.dot(direction).abs();
        let density = self.probability(place) * distance * distance / (target.area * cosine);
        if density.is_finite() { density } else { 0.0 }
    }

    /// A target, and a point uniform over it, from two numbers in [0, 1).
    fn draw(&self, u: Vec2) -> (u32, Vec3) {
        let place = self.cumulative.partition_point(|c| *c <= u.x).min(self.list.len() - 1);
        let low = if place == 0 { 0.0 } else { self.cumulative[place - 1] };
        let x = ((u.x - low) / self.probability(place)).clamp(0.0, 1.0);
        let Patch { centre, edges: [a, b], .. } = self.list[place].patch;
        (self.list[place].element, centre + a * (x - 0.5) + b * (u.y - 0.5))
    }
}

/// Sends the rays of a point in the air; `item` decorrelates points.
pub fn trace_point(
    world: &World,
    light: &impl SurfaceLight,
    bins: DirectionBins,
    settings: &VolumeSettings,
    targets: &Targets,
    position: Vec3,
    item: u32,
) -> PointHits {
    let rays = settings.supersample;
    let aimed = if targets.is_empty() { 0 } else { settings.informed_rays };
    let nothing = Targets::default();
    let chances = if aimed > 0 { targets } else { &nothing }.seen_from(position);
    let mut walk = Walk {
        world,
        light,
        cutoff: settings.specular_cutoff,
        hits: PointHits {
            elements: Vec::with_capacity(bins.len() * rays as usize),
            owners: Vec::with_capacity(bins.len() * rays as usize),
            ..PointHits::default()
        },
    };
    // A ray of a bin counts 1 / (n + N Ω p), an aimed one as much in the bin that it goes through.
    let weight = |density: f32| 1.0 / (rays as f32 + aimed as f32 * bins.solid_angle() * density);
    let share = 1.0 / rays as f32;
    let mut backs = 0u32;
    for bin in 0..bins.len() as u32 {
        let scramble = hash2(item ^ fold(settings.seed), bin);
        for ray in 0..rays {
            let jitter = if rays == 1 { Vec2::splat(0.5) } else { r2_point(ray, scramble) };
            let mut direction = bins.direction(bin as usize, jitter);
            let mut hit = world.accel.trace(&Ray::new(position, direction));
            if hit.is_none() {
                // Bin centres and rooms are symmetric, so rays do go exactly through the seam between
                // two triangles: ask once more beside it.
                direction = bins.direction(bin as usize, BESIDE);
                hit = world.accel.trace(&Ray::new(position, direction));
            }
            let number = walk.hits.elements.len() as u32;
            let mut element = NO_ELEMENT;
            if let Some(hit) = hit {
                let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
                let lit = world.geometry.is_lit(&surface);
                if !lit {
                    backs += 1;
                } else if passes_on(world, hit.triangle) {
                    walk.pass_on(bin, direction, &surface, Vec3::splat(share));
                }
                if lit && is_dull(world, hit.triangle) {
                    element = walk.element(&hit, &surface);
                    if world.geometry.material_of(hit.triangle).emission != Vec3::ZERO {
                        walk.hits.emitters.push((number, hit.triangle, surface.uv));
                    }
                    let density = chances.density(element, direction, hit.t);
                    if density > 0.0 {
                        let factor = Vec3::splat(weight(density) - share);
                        walk.hits.extras.push(Extra { bin, source: Source::Element(element), factor });
                    }
                }
            }
            walk.hits.elements.push(element);
        }
    }
    let scramble = hash2(hash2(item, fold(settings.seed)), 0x5EED);
    for j in 0..aimed {
        let (target, point) = chances.draw(r2_point(j, scramble));
        let direction = (point - position).normalize_or_zero();
        let Some(hit) = world.accel.trace(&Ray::new(position, direction)) else { continue };
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
        if !world.geometry.is_lit(&surface) || walk.element(&hit, &surface) != target {
            continue;
        }
        let factor = Vec3::splat(weight(chances.density(target, direction, hit.t)));
        let bin = bins.bin(direction) as u32;
        walk.hits.extras.push(Extra { bin, source: Source::Element(target), factor });
    }
    let mut hits = walk.hits;
    hits.owners.sort_unstable();
    hits.owners.dedup_by_key(|o| o.0);
    hits.back_face_fraction = backs as f32 / hits.elements.len() as f32;
    hits
}

/// Whether rays go on from a surface: by a mirror, or through glass.
fn passes_on(world: &World, triangle: u32) -> bool {
    let material = world.geometry.material_of(triangle);
    material.is_mirror() || material.is_glass()
}

/// Whether a surface's own light counts: it is dull, or glass that is so in part. What glass reflects outward is
/// left out.
fn is_dull(world: &World, triangle: u32) -> bool {
    let material = world.geometry.material_of(triangle);
    !passes_on(world, triangle) || material.is_glass() && material.diffuse_share() > 0.0
}

/// Where a ray goes on from a surface that mirrors or lets pass, with what share of the light, and whether it only
/// met a pane.
fn onward(world: &World, surface: &Surface, direction: Vec3) -> (Ray, Vec3, bool) {
    let brdf = world.geometry.brdf(surface);
    if let Some(glass) = brdf.glass {
        let passed = glass.pass_or_reflect(surface, direction);
        return (passed.ray, passed.share, glass.side == Side::Pane);
    }
    let share = brdf.specular.map_or(Vec3::ZERO, |s| s.reflectance(-direction.dot(surface.normal)));
    (surface.mirrored(direction), share, false)
}

/// Where a ray goes, by way of mirrors and through glass until a dull surface or until less than `cutoff` is left of
/// it: the places from its origin on, and whether it ends on a side that sends light. `None` where it meets nothing.
pub fn chain(world: &World, cutoff: f32, origin: Vec3, direction: Vec3) -> Option<(Vec<Vec3>, bool)> {
    let (mut places, mut ray) = (vec![origin], Ray::new(origin, direction));
    let mut left = Vec3::ONE;
    for _ in 0..MOST_REFLECTIONS {
        let Some(hit) = world.accel.trace(&ray) else { break };
        let surface = world.geometry.surface(hit.triangle, hit.barycentric, ray.direction);
        places.push(surface.position);
        if !world.geometry.is_lit(&surface) {
            return Some((places, false));
        }
        if !passes_on(world, hit.triangle) {
            return Some((places, true));
        }
        let (onward, share, _) = onward(world, &surface, ray.direction);
        left *= share;
        if left.max_element() < cutoff {
            return Some((places, false));
        }
        ray = onward;
    }
    (places.len() > 1).then_some((places, false))
}

/// Rays on their way.
struct Walk<'a, L> {
    world: &'a World,
    light: &'a L,
    cutoff: f32,
    hits: PointHits,
}

impl<L: SurfaceLight> Walk<'_, L> {
    /// Element at a hit on a side that reflects.
    fn element(&mut self, hit: &Hit, surface: &Surface) -> u32 {
        let element = self.light.element_at(hit.triangle, hit.barycentric, surface.back);
        if element != NO_ELEMENT {
            self.hits.owners.push((element, hit.triangle));
        }
        element
    }

    /// Follows a ray that met a mirror or glass, until it meets something diffuse or little is left of it. Lamps
    /// straight behind panes are direct light.
    fn pass_on(&mut self, bin: u32, direction: Vec3, surface: &Surface, share: Vec3) {
        let (mut direction, mut surface) = (direction, *surface);
        let (mut attenuation, mut straight) = (Vec3::ONE, true);
        for _ in 0..MOST_REFLECTIONS {
            let (ray, passed, pane) = onward(self.world, &surface, direction);
            attenuation *= passed;
            straight &= pane;
            if attenuation.max_element() < self.cutoff || attenuation == Vec3::ZERO {
                return;
            }
            direction = ray.direction;
            let Some(hit) = self.world.accel.trace(&ray) else { return };
            surface = self.world.geometry.surface(hit.triangle, hit.barycentric, direction);
            if !self.world.geometry.is_lit(&surface) {
                return;
            }
            let material = self.world.geometry.material_of(hit.triangle);
            let factor = attenuation * share;
            if material.emission != Vec3::ZERO && !straight {
                let source = Source::Emission(hit.triangle, surface.uv);
                self.hits.extras.push(Extra { bin, source, factor });
            }
            if is_dull(self.world, hit.triangle) {
                let element = self.element(&hit, &surface);
                if element != NO_ELEMENT {
                    self.hits.extras.push(Extra { bin, source: Source::Element(element), factor });
                }
            }
            if !passes_on(self.world, hit.triangle) {
                return;
            }
        }
    }
}
