//! A glossy point as an eye sees it: its lobe over slopes, as an image and as a spectrum.

use super::lobes::LobeEntry;
use crate::{
    math::{
        fourier::transform,
        frame::{frame_from_normal, mirrored},
        image::LinearImage,
    },
    mirror::reflectors::{Reflector, Reflectors},
    scene::{
        brdf::Lobe,
        geometry::{Geometry, Surface},
    },
};
use glam::{Mat3, Vec2, Vec3};
use rustfft::num_complex::Complex;

/// Width and height of the kernel's image.
pub const KERNEL_SIZE: u32 = 64;
/// Share of the spectrum's peak below which a frequency does not matter.
const CUT: f64 = 0.02;

/// A glossy point, as an eye sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelPoint {
    /// The point, m.
    pub position: Vec3,
    /// Unit normal on the side seen.
    pub normal: Vec3,
    /// Unit geometric normal on that side; `normal` on flat surfaces.
    pub geometric_normal: Vec3,
    /// Unit direction to the eye.
    pub wo: Vec3,
    /// Its lobe.
    pub lobe: Lobe,
}

impl KernelPoint {
    /// The point of a flat glossy reflector nearest to a place, or the middle of the largest; seen from an eye.
    /// `None` where nothing is glossy or it faces away.
    pub fn near(
        geometry: &Geometry,
        reflectors: &Reflectors,
        eye: Vec3,
        place: Option<Vec3>,
    ) -> Option<Self> {
        let lobe = |r: &Reflector| geometry.materials[r.material as usize].lobe();
        let glossy = |r: &&Reflector| lobe(r).is_some() && r.facing(eye).is_some();
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
        let normal = reflector.facing(eye)?;
        Some(Self {
            position,
            normal,
            geometric_normal: normal,
            wo: (eye - position).normalize_or(reflector.normal),
            lobe: lobe(reflector)?,
        })
    }

    /// A point of a surface, flat or curved, seen from an eye. `None` where it has no lobe, is dark on the side seen
    /// or its shading normal faces away.
    pub fn on(geometry: &Geometry, surface: &Surface, eye: Vec3) -> Option<Self> {
        let specular =
            geometry.brdf(surface).specular.filter(|s| !s.is_mirror() && geometry.is_lit(surface))?;
        let wo = (eye - surface.position).normalize_or(surface.normal);
        let &Surface { position, normal, geometric_normal, .. } = surface;
        let lobe = specular.lobe();
        (normal.dot(wo) > 0.0).then_some(Self { position, normal, geometric_normal, wo, lobe })
    }

    /// Whether light from a direction arrives from outside of the surface and its lobe takes any of it.
    pub(super) fn takes(&self, wi: Vec3) -> bool {
        wi.dot(self.geometric_normal) > 0.0 && wi.dot(self.normal) > 0.0
    }

    /// Axes about the mirrored direction: in the plane of incidence, across it, along it.
    pub(super) fn axes(&self) -> Mat3 {
        let along = mirrored(self.wo, self.normal);
        let across = along.cross(self.normal).normalize_or(frame_from_normal(along).x_axis);
        Mat3::from_cols(across.cross(along), across, along)
    }

    /// f cos θᵢ with F = 1 in the direction of a slope about the mirrored one.
    pub(super) fn value(&self, axes: &Mat3, slope: Vec2) -> f32 {
        let wi = (*axes * slope.extend(1.0)).normalize();
        self.lobe.value(self.normal, wi, self.wo) * wi.dot(self.normal).max(0.0)
    }

    /// Slope tan β that its light comes from within.
    pub fn support(&self) -> f32 {
        LobeEntry::new(self.lobe, self.wo.dot(self.normal)).support.min(8.0)
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

    /// Amplitude of the spectrum of a kernel's image over that at 0, by cycles a radian, in the plane of incidence
    /// and across it; and the frequencies above which they do not matter.
    pub fn spectrum(image: &LinearImage, support: f32) -> [(Vec<Vec2>, f32); 2] {
        let n = KERNEL_SIZE as usize;
        let mut plane: Vec<Complex<f64>> =
            image.pixels.iter().map(|p| Complex::new(f64::from(p.x), 0.0)).collect();
        transform(&mut plane, n, n, true);
        let zero = plane[0].norm().max(f64::MIN_POSITIVE);
        let step = 1.0 / (2.0 * f64::from(support));
        let amplitude = |i: usize| (plane[i].norm() / zero) as f32;
        let frequency = |i: usize| (i as f64 * step) as f32;
        [1, n].map(|stride| {
            let at = |i: usize| Vec2::new(frequency(i), amplitude(i * stride));
            let curve: Vec<Vec2> = (0..n / 2).map(at).collect();
            let band = curve.iter().rposition(|p| f64::from(p.y) > CUT).map_or(0.0, |i| curve[i].x);
            (curve, band)
        })
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
