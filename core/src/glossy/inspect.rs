//! The kernel of a point of a glossy surface: its footprint in the scene, its lobe, its image, its spectrum.

use super::lobes::LobeTable;
use crate::{
    inspection::{ColouredMesh, Curve, InspectionScene, Legend, Line, NamedImage},
    math::{
        fourier::transform,
        frame::{frame_from_normal, mirrored},
        image::LinearImage,
    },
    mirror::reflectors::{Reflector, Reflectors},
    scene::{
        accel::Ray,
        brdf::Lobe,
        geometry::{Geometry, offset_origin},
        world::World,
    },
};
use glam::{Mat3, Vec2, Vec3};
use rustfft::num_complex::Complex;
use std::f32::consts::TAU;

/// Width and height of the kernel's image.
pub const KERNEL_SIZE: u32 = 64;
/// Rings and spokes of the footprint.
const RINGS: u32 = 10;
const SPOKES: u32 = 40;
/// Share of the spectrum's peak below which a frequency does not matter.
const CUT: f64 = 0.02;

/// A glossy point, as an eye sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelPoint {
    /// The point, m.
    pub position: Vec3,
    /// Unit normal on the side seen.
    pub normal: Vec3,
    /// Unit direction to the eye.
    pub wo: Vec3,
    /// Width α of its lobe.
    pub alpha: f32,
}

impl KernelPoint {
    /// The point of a flat glossy reflector nearest to a place, or the middle of the largest; seen from an eye.
    /// `None` where nothing is glossy or it faces away.
    pub fn near(geometry: &Geometry, eye: Vec3, place: Option<Vec3>) -> Option<Self> {
        let reflectors = Reflectors::new(geometry);
        let glossy = |r: &&Reflector| {
            let alpha = geometry.materials[r.material as usize].alpha();
            alpha.is_some_and(|a| a > 0.0) && r.facing(eye).is_some()
        };
        let nearest_on = |r: &Reflector, p: Vec3| {
            let on = |&t: &u32| nearest_in(p, geometry.positions[t as usize]);
            r.triangles.iter().map(on).min_by(|a, b| a.distance(p).total_cmp(&b.distance(p)))
        };
        let middle = |r: &Reflector| {
            let sum: Vec3 = r.triangles.iter().flat_map(|&t| geometry.positions[t as usize]).sum();
            sum / (3 * r.triangles.len()) as f32
        };
        let candidates = reflectors.list.iter().filter(glossy);
        let (reflector, position) = match place {
            Some(p) => candidates
                .filter_map(|r| Some((r, nearest_on(r, p)?)))
                .min_by(|a, b| a.1.distance(p).total_cmp(&b.1.distance(p)))?,
            None => candidates.map(|r| (r, middle(r))).next()?,
        };
        Some(Self {
            position,
            normal: reflector.facing(eye)?,
            wo: (eye - position).normalize_or(reflector.normal),
            alpha: geometry.materials[reflector.material as usize].alpha()?,
        })
    }

    /// Axes about the mirrored direction: in the plane of incidence, across it, along it.
    fn axes(&self) -> Mat3 {
        let along = mirrored(self.wo, self.normal);
        let across = along.cross(self.normal).normalize_or(frame_from_normal(along).x_axis);
        Mat3::from_cols(across.cross(along), across, along)
    }

    /// f cos θᵢ with F = 1 in the direction of a slope about the mirrored one.
    fn value(&self, axes: &Mat3, slope: Vec2) -> f32 {
        let wi = (*axes * slope.extend(1.0)).normalize();
        Lobe::Ggx { alpha: self.alpha }.value(self.normal, wi, self.wo) * wi.dot(self.normal).max(0.0)
    }

    /// Slope tan β that its light comes from within.
    pub fn support(&self) -> f32 {
        LobeTable::new(self.alpha).at(self.wo.dot(self.normal)).support.min(8.0)
    }

    /// The kernel over slopes from −`support` to `support`, in the plane of incidence to the right, its peak 1.
    pub fn image(&self, support: f32) -> LinearImage {
        let axes = self.axes();
        let half = 0.5 * KERNEL_SIZE as f32;
        let mut image = LinearImage::from_fn(KERNEL_SIZE, KERNEL_SIZE, |x, y| {
            // A texel's middle on the axis, so that the peak of a smooth lobe is met.
            let slope = (Vec2::new(x as f32, y as f32) - half) / half * support;
            Vec3::splat(self.value(&axes, slope))
        });
        let peak = image.pixels.iter().map(|p| p.x).fold(f32::MIN_POSITIVE, f32::max);
        image.pixels.iter_mut().for_each(|p| *p /= peak);
        image
    }

    /// Amplitude of the kernel's spectrum over that at 0, by cycles a radian, in the plane of incidence and
    /// across it; and the frequency above which neither matters.
    pub fn spectrum(&self, support: f32) -> ([Vec<Vec2>; 2], f32) {
        let n = KERNEL_SIZE as usize;
        let image = self.image(support);
        let mut plane: Vec<Complex<f64>> =
            image.pixels.iter().map(|p| Complex::new(f64::from(p.x), 0.0)).collect();
        transform(&mut plane, n, n, true);
        let zero = plane[0].norm().max(f64::MIN_POSITIVE);
        let step = 1.0 / (2.0 * f64::from(support));
        let amplitude = |i: usize| (plane[i].norm() / zero) as f32;
        let frequency = |i: usize| (i as f64 * step) as f32;
        let along = (0..n / 2).map(|i| Vec2::new(frequency(i), amplitude(i))).collect();
        let across = (0..n / 2).map(|i| Vec2::new(frequency(i), amplitude(i * n))).collect();
        let last =
            |curve: &Vec<Vec2>| curve.iter().rposition(|p| f64::from(p.y) > CUT).map_or(0.0, |i| curve[i].x);
        let curves: [Vec<Vec2>; 2] = [along, across];
        let band = last(&curves[0]).max(last(&curves[1]));
        (curves, band)
    }
}

/// The kernel of a glossy point in the scene: where its lobe meets it, coloured by weight over that of the
/// peak; the lobe itself as a solid; the mirrored ray; the kernel as an image, its lobe in the plane of
/// incidence and its spectrum as curves.
///
/// A spectrum with nothing above f cycles a radian needs 2 f samples a radian of what it convolves.
pub fn kernel(world: &World, eye: Vec3, place: Option<Vec3>) -> Option<InspectionScene> {
    let geometry = &world.geometry;
    let point = KernelPoint::near(geometry, eye, place)?;
    let support = point.support();
    let axes = point.axes();
    let peak = point.value(&axes, Vec2::ZERO).max(f32::MIN_POSITIVE);
    let (low, high) = geometry.bounds();
    let far = (high - low).length();
    let origin = offset_origin(point.position, point.normal);
    let mut scene = InspectionScene::default();
    let mut footprint = ColouredMesh::default();
    let mut solid = ColouredMesh::default();
    let mut hits = Vec::new();
    for ring in 0..=RINGS {
        let radius = support * (ring as f32 / RINGS as f32).powi(2);
        for spoke in 0..SPOKES {
            let (sin, cos) = (TAU * spoke as f32 / SPOKES as f32).sin_cos();
            let slope = Vec2::new(cos, sin) * radius;
            let wi = (axes * slope.extend(1.0)).normalize();
            let weight = point.value(&axes, slope) / peak;
            let hit = world.accel.trace(&Ray::new(origin, wi));
            let distance = hit.map_or(far, |h| h.t);
            let above = wi.dot(point.normal) > 0.0;
            hits.push(hit.filter(|_| above).map(|h| h.t));
            // A little nearer than the surface, so that it is seen.
            footprint.positions.push(origin + wi * (distance * 0.998));
            footprint.values.push(Vec3::splat(weight));
            solid.positions.push(point.position + wi * (0.08 * far * weight));
            solid.values.push(Vec3::splat(weight));
        }
    }
    for ring in 0..RINGS {
        for spoke in 0..SPOKES {
            let next = (spoke + 1) % SPOKES;
            let [a, b, c, d] = [(ring, spoke), (ring, next), (ring + 1, spoke), (ring + 1, next)]
                .map(|(r, s)| r * SPOKES + s);
            let quad = [[a, c, b], [b, c, d]];
            solid.triangles.extend(quad);
            let distances = [a, b, c, d].map(|i| hits[i as usize]);
            let known: Vec<f32> = distances.into_iter().flatten().collect();
            let (near, most) = known.iter().fold((f32::MAX, 0.0f32), |(l, h), t| (l.min(*t), h.max(*t)));
            // Not across the edge of something that stands in front.
            if known.len() == 4 && most < 1.5 * near + 0.02 * far {
                footprint.triangles.extend(quad);
            }
        }
    }
    let reach = world.accel.trace(&Ray::new(origin, axes.z_axis)).map_or(far, |h| h.t);
    let white = Vec3::splat(0.9);
    scene.lines.push(Line { ends: [eye.lerp(point.position, 0.2), point.position], colour: white });
    scene.lines.push(Line { ends: [point.position, origin + axes.z_axis * reach], colour: white });
    scene.meshes = vec![footprint, solid];
    scene.images.push(NamedImage { name: "kernel over slopes".into(), image: point.image(support) });
    scene.curves.push(lobe_curve(&point, &axes, support, peak));
    let (spectra, band) = point.spectrum(support);
    for (name, points) in ["in the plane of incidence", "across it"].into_iter().zip(spectra) {
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
    let degrees = point.wo.dot(point.normal).clamp(-1.0, 1.0).acos().to_degrees();
    scene.notes.push(format!(
        "roughness {:.2}, seen at {degrees:.0}°: 95 % of the lobe within {:.1}° of the mirrored direction, \
         which meets something at {reach:.2} m; nothing above {band:.1} cycles a radian, so a sample every \
         {:.2}° is enough",
        point.alpha.sqrt(),
        support.atan().to_degrees(),
        (0.5 / band.max(1e-3)).to_degrees()
    ));
    Some(scene)
}

/// The lobe in the plane of incidence, as a radial plot: the normal upwards, its peak 1.
fn lobe_curve(point: &KernelPoint, axes: &Mat3, support: f32, peak: f32) -> Curve {
    let sideways = (axes.z_axis - point.normal * axes.z_axis.dot(point.normal)).normalize_or(axes.x_axis);
    let points = (0..=120)
        .map(|i| {
            let t = i as f32 / 60.0 - 1.0;
            let slope = Vec2::new(t.abs().powi(2).copysign(t) * support, 0.0);
            let wi = (*axes * slope.extend(1.0)).normalize();
            let value = point.value(axes, slope) / peak;
            value * Vec2::new(wi.dot(sideways), wi.dot(point.normal))
        })
        .collect();
    Curve {
        name: "lobe in the plane of incidence".into(),
        axes: ["along the surface".into(), "along the normal".into()],
        points,
        radial: true,
    }
}

/// The point of a triangle nearest to a place (Ericson, *Real-Time Collision Detection* 2005, §5.1.5, by
/// clamping to the plane and to each edge).
fn nearest_in(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let on_plane = p - normal * normal.dot(p - a);
    let inside = |u: Vec3, v: Vec3| (v - u).cross(on_plane - u).dot(normal) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        return on_plane;
    }
    let on_edge = |u: Vec3, v: Vec3| {
        let d = v - u;
        u + d * ((p - u).dot(d) / d.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)
    };
    [on_edge(a, b), on_edge(b, c), on_edge(c, a)]
        .into_iter()
        .min_by(|x, y| x.distance(p).total_cmp(&y.distance(p)))
        .unwrap_or(a)
}
