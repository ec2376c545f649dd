//! What in a scene would make light wrong: defects that are legal in a file and lie to a solver.
//!
//! Each check is one question to the triangles as placed. Whether a normal is flipped cannot be known
//! for an open surface alone, so that check asks what the camera and the lamps see: the back of a
//! single-sided surface is black, and a scene that shows mostly backs was not meant so.

mod coincident;
mod shells;

pub(super) use shells::with_dark_sides;

use super::{Scene, accel::Ray, emitters::Emitter, lamp::LampKind, world::World};
use crate::math::random::r2_point;
use glam::Vec3;
use std::{collections::BTreeMap, f32::consts::TAU, fmt};

/// Reflectance above which light bounces so often that solvers settle slowly.
pub const HIGH_REFLECTANCE: f32 = 0.9;

/// Diagonals outside this range suggest a wrong unit, m.
pub const LIKELY_DIAGONAL: std::ops::RangeInclusive<f32> = 0.05..=500.0;

/// Rays cast from each viewpoint to see which sides of surfaces show.
const SIGHT_RAYS: u32 = 4096;

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// May be meant so.
    Note,
    /// Light will likely be wrong.
    Warning,
}

/// One thing found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How much it matters.
    pub severity: Severity,
    /// Object, material or lamp it concerns; the scene's name where it concerns everything.
    pub object: String,
    /// What is the case.
    pub what: String,
    /// What to do about it.
    pub advice: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let severity = match self.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
        };
        write!(f, "{severity}: {}: {}; {}", self.object, self.what, self.advice)
    }
}

impl Finding {
    fn note(object: &str, what: String, advice: &str) -> Self {
        Self { severity: Severity::Note, object: object.into(), what, advice: advice.into() }
    }

    fn warning(object: &str, what: String, advice: &str) -> Self {
        Self { severity: Severity::Warning, ..Self::note(object, what, advice) }
    }
}

/// Looks a scene over; warnings first, each group in the order of the checks and of the scene.
pub fn check(scene: &Scene) -> Vec<Finding> {
    let world = World::new(scene);
    let mut findings = Vec::new();
    check_size(scene, &world, &mut findings);
    check_emitters(scene, &world, &mut findings);
    check_materials(scene, &mut findings);
    shells::check(scene, &world.geometry, &mut findings);
    check_sides_seen(scene, &world, &mut findings);
    coincident::check(scene, &world.geometry, &mut findings);
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    findings
}

fn check_size(scene: &Scene, world: &World, findings: &mut Vec<Finding>) {
    let (low, high) = world.geometry.bounds();
    let diagonal = (high - low).length();
    if world.geometry.is_empty() {
        findings.push(Finding::warning(&scene.name, "contains no triangles".into(), "add a model"));
    } else if !LIKELY_DIAGONAL.contains(&diagonal) {
        let what = format!("measures {diagonal:.3} m from corner to corner");
        findings.push(Finding::warning(&scene.name, what, "check the unit: files are read in metres"));
    }
}

fn check_emitters(scene: &Scene, world: &World, findings: &mut Vec<Finding>) {
    if world.emitters.is_empty() {
        findings.push(Finding::warning(&scene.name, "nothing emits light".into(), "add a lamp"));
    }
    let advice = "give it light or remove it";
    for lamp in &scene.lamps {
        let value = match lamp.kind {
            LampKind::Point { intensity } | LampKind::Spot { intensity, .. } => intensity,
            LampKind::Directional { illuminance } => illuminance,
        };
        if value == Vec3::ZERO {
            findings.push(Finding::warning(&lamp.name, "lamp of no light".into(), advice));
        }
    }
    for emitter in &world.emitters.list {
        let Emitter::Area(area) = emitter else { continue };
        let material = world.geometry.material_of(area.triangles[0]);
        let black = |i: usize| scene.textures[i].pixels.iter().all(|p| *p == Vec3::ZERO);
        if material.emission_texture.is_some_and(black) {
            let name = &scene.objects[area.object as usize].name;
            findings.push(Finding::warning(name, "its emission texture is black".into(), advice));
        }
    }
}

fn check_materials(scene: &Scene, findings: &mut Vec<Finding>) {
    let mut users: BTreeMap<usize, &str> = BTreeMap::new();
    for object in &scene.objects {
        for part in &object.parts {
            users.entry(part.material).or_insert(&object.name);
        }
    }
    for (index, user) in users {
        let material = &scene.materials[index];
        let peak = match material.reflectance_texture {
            Some(i) => scene.textures[i].pixels.iter().fold(Vec3::ZERO, |m, p| m.max(*p)),
            None => Vec3::ONE,
        };
        // Of glass the colour is that of what passes.
        let kept = 1.0 - material.passes();
        let reflectance = (material.reflectance * peak * kept).max_element();
        let what = format!("material \"{}\" reflects {reflectance:.3} of the light", material.name);
        if reflectance >= 1.0 {
            findings.push(Finding::warning(
                user,
                what,
                "no surface reflects all: interreflection will not settle",
            ));
        } else if reflectance > HIGH_REFLECTANCE {
            findings.push(Finding::warning(
                user,
                what,
                "white paint reflects about 0.85; light settles slowly above",
            ));
        }
    }
}

/// Casts rays from the camera and the lamps and reports objects that show their black back.
fn check_sides_seen(scene: &Scene, world: &World, findings: &mut Vec<Finding>) {
    let mut seen = vec![[0u32; 2]; scene.objects.len()];
    let lamps = scene.lamps.iter().filter(|l| !matches!(l.kind, LampKind::Directional { .. }));
    let viewpoints = std::iter::once(scene.camera.eye).chain(lamps.map(|l| l.position()));
    for (viewpoint, origin) in viewpoints.enumerate() {
        for i in 0..SIGHT_RAYS {
            let u = r2_point(i, viewpoint as u32);
            let z = 1.0 - 2.0 * u.y;
            let radius = (1.0 - z * z).max(0.0).sqrt();
            let direction = Vec3::new(radius * (TAU * u.x).cos(), z, radius * (TAU * u.x).sin());
            let Some(hit) = world.accel.trace(&Ray::new(origin, direction)) else { continue };
            let surface = world.geometry.surface(hit.triangle, hit.barycentric, direction);
            let object = world.geometry.object[hit.triangle as usize] as usize;
            seen[object][usize::from(!world.geometry.is_lit(&surface))] += 1;
        }
    }
    for (object, [lit, black]) in scene.objects.iter().zip(seen) {
        if black > lit && black >= 8 {
            let share = 100 * black / (black + lit);
            let what = format!("{share} % of what the camera and the lamps see of it is its black back");
            findings.push(Finding::warning(&object.name, what, "flip its normals or make it double-sided"));
        }
    }
}
