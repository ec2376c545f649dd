//! The kernel of a point of a glossy surface: its footprint in the scene, its lobe, its image, its spectrum.

use super::{inspect_point::KernelPoint, lobes::LobeEntry};
use crate::{
    inspection::{ColouredMesh, Curve, InspectionScene, Legend, Line, NamedImage},
    scene::{accel::Ray, brdf::Lobe, geometry::offset_origin, world::World},
};
use glam::{Mat3, Vec2, Vec3};
use std::f32::consts::TAU;

/// Rings and spokes of the footprint.
const RINGS: u32 = 10;
const SPOKES: u32 = 40;

/// Weight over the peak below which the footprint is not filled: where 95 % of the lobe end is an outline, so that
/// what lies beneath is seen.
const FAINT: f32 = 0.05;

/// What a kernel asks of the light that it convolves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelNumbers {
    /// The lobe.
    pub lobe: Lobe,
    /// glTF's roughness, √α.
    pub roughness: f32,
    /// Angle between view and normal, °.
    pub view_degrees: f32,
    /// Share of uniform light that the lobe keeps, F = 1.
    pub albedo: f32,
    /// Angle from the mirrored direction within which 95 % of its light comes, °.
    pub support_degrees: f32,
    /// Distance to what the mirrored direction meets, m; that across the scene where it meets nothing or
    /// goes below a facet of a curved surface.
    pub reach_m: f32,
    /// Diameter of the support there, across the mirrored direction, m.
    pub footprint_m: f32,
    /// Frequencies above which the kernel passes nothing, cycles a radian: in the plane of incidence, across it.
    pub band: [f32; 2],
}

impl KernelNumbers {
    /// Samples a radian that the light needs: two a cycle of the higher frequency.
    pub fn samples_a_radian(&self) -> f32 {
        2.0 * self.band[0].max(self.band[1]).max(1e-3)
    }

    /// Angle from one sample to the next, °.
    pub fn spacing_degrees(&self) -> f32 {
        (1.0 / self.samples_a_radian()).to_degrees()
    }
}

/// A kernel with all that is shown of it.
#[derive(Clone, Debug)]
pub struct KernelView {
    /// Its point.
    pub point: KernelPoint,
    /// Its numbers.
    pub numbers: KernelNumbers,
    /// In the scene its footprint, coloured by weight over that of the peak and outlined where 95 % of the lobe end,
    /// its lobe as a solid and the mirrored ray; beside it the kernel as an image, the lobe in the plane of incidence
    /// and the spectrum as curves.
    pub scene: InspectionScene,
}

impl KernelView {
    /// The kernel of a point, the eye at some distance along `point.wo`.
    ///
    /// A spectrum with nothing above f cycles a radian needs 2 f samples a radian of what it convolves.
    pub fn new(world: &World, point: KernelPoint, eye: Vec3) -> Self {
        let geometry = &world.geometry;
        let entry = LobeEntry::new(point.lobe, point.wo.dot(point.normal));
        let support = point.support();
        let axes = point.axes();
        // Not the mirrored direction's: at grazing angles f cos is larger beside it.
        let peak = rings(support).map(|slope| point.value(&axes, slope)).fold(f32::MIN_POSITIVE, f32::max);
        let (low, high) = geometry.bounds();
        let far = (high - low).length();
        let origin = offset_origin(point.position, point.geometric_normal);
        let meets = |wi: Vec3| world.accel.trace(&Ray::new(origin, wi)).filter(|_| point.takes(wi));
        let mut scene = InspectionScene::default();
        let white = Vec3::splat(0.9);
        let mut footprint = ColouredMesh::default();
        let mut solid = ColouredMesh::default();
        let mut hits = Vec::new();
        for slope in rings(support) {
            let wi = (axes * slope.extend(1.0)).normalize();
            let weight = point.value(&axes, slope) / peak;
            let hit = meets(wi).map(|h| h.t);
            let distance = hit.unwrap_or(far);
            hits.push(hit);
            // A little nearer than the surface, so that it is seen.
            footprint.positions.push(origin + wi * (distance * 0.998));
            footprint.values.push(Vec3::splat(weight));
            solid.positions.push(point.position + wi * (0.08 * far * weight));
            solid.values.push(Vec3::splat(weight));
        }
        // Not across the edge of something that stands in front.
        let is_one = |corners: &[u32]| {
            let distances = corners.iter().map(|&i| hits[i as usize].unwrap_or(f32::INFINITY));
            let (near, most) = distances.fold((f32::MAX, 0.0f32), |(l, h), t| (l.min(t), h.max(t)));
            most < 1.5 * near + 0.02 * far
        };
        for ring in 0..RINGS {
            for spoke in 0..SPOKES {
                let next = (spoke + 1) % SPOKES;
                let [a, b, c, d] = [(ring, spoke), (ring, next), (ring + 1, spoke), (ring + 1, next)]
                    .map(|(r, s)| r * SPOKES + s);
                let quad = [[a, c, b], [b, c, d]];
                solid.triangles.extend(quad);
                let weight = |i: u32| footprint.values[i as usize].x;
                if [a, b, c, d].into_iter().map(weight).fold(0.0, f32::max) >= FAINT && is_one(&[a, b, c, d])
                {
                    footprint.triangles.extend(quad);
                }
                if ring + 1 == RINGS && is_one(&[c, d]) {
                    let ends = [c, d].map(|i| footprint.positions[i as usize]);
                    scene.lines.push(Line { ends, colour: white });
                }
            }
        }
        let reach = meets(axes.z_axis).map_or(far, |h| h.t);
        scene.lines.push(Line { ends: [eye.lerp(point.position, 0.2), point.position], colour: white });
        if point.takes(axes.z_axis) {
            scene.lines.push(Line { ends: [point.position, origin + axes.z_axis * reach], colour: white });
        }
        scene.meshes = vec![footprint, solid];
        let image = point.image(support);
        let spectra = KernelPoint::spectrum(&image, support);
        scene.images.push(NamedImage { name: "kernel over slopes".into(), image });
        scene.curves.push(lobe_curve(&point, &axes, support));
        let numbers = KernelNumbers {
            lobe: point.lobe,
            roughness: point.lobe.alpha().sqrt(),
            view_degrees: point.wo.dot(point.normal).clamp(-1.0, 1.0).acos().to_degrees(),
            albedo: entry.albedo,
            support_degrees: support.atan().to_degrees(),
            reach_m: reach,
            footprint_m: 2.0 * support * reach,
            band: [spectra[0].1, spectra[1].1],
        };
        for (name, (points, _)) in ["in the plane of incidence", "across it"].into_iter().zip(spectra) {
            scene.curves.push(Curve {
                name: format!("spectrum {name}"),
                axes: ["cycles a radian".into(), "amplitude".into()],
                points,
                radial: false,
            });
        }
        scene.legend = Some(Legend {
            quantity: "weight over the peak".into(),
            unit: String::new(),
            range: [0.0, 1.0],
            names: &[],
        });
        scene.notes.push(format!(
            "{} of roughness {:.2}, seen at {:.0}°: 95 % of the lobe within {:.1}° of the mirrored direction, which meets \
             something at {reach:.2} m; nothing above {:.1} cycles a radian, so a sample every {:.2}° is enough",
            numbers.lobe.name(),
            numbers.roughness,
            numbers.view_degrees,
            numbers.support_degrees,
            0.5 * numbers.samples_a_radian(),
            numbers.spacing_degrees()
        ));
        Self { point, numbers, scene }
    }
}

/// Slopes of the footprint's corners, ring by ring from the middle, denser there.
fn rings(support: f32) -> impl Iterator<Item = Vec2> {
    (0..=RINGS).flat_map(move |ring| {
        let radius = support * (ring as f32 / RINGS as f32).powi(2);
        (0..SPOKES).map(move |spoke| Vec2::from_angle(TAU * spoke as f32 / SPOKES as f32) * radius)
    })
}

/// The lobe in the plane of incidence, as a radial plot: the normal upwards, its peak 1.
fn lobe_curve(point: &KernelPoint, axes: &Mat3, support: f32) -> Curve {
    let sideways = (axes.z_axis - point.normal * axes.z_axis.dot(point.normal)).normalize_or(axes.x_axis);
    let mut points: Vec<Vec2> = (0..=120)
        .map(|i| {
            let t = i as f32 / 60.0 - 1.0;
            let slope = Vec2::new(t.abs().powi(2).copysign(t) * support, 0.0);
            let wi = (*axes * slope.extend(1.0)).normalize();
            point.value(axes, slope) * Vec2::new(wi.dot(sideways), wi.dot(point.normal))
        })
        .collect();
    let peak = points.iter().map(|p| p.length()).fold(f32::MIN_POSITIVE, f32::max);
    points.iter_mut().for_each(|p| *p /= peak);
    Curve {
        name: "lobe in the plane of incidence".into(),
        axes: ["along the surface".into(), "along the normal".into()],
        points,
        radial: true,
    }
}
