//! A kernel of its own at every pixel: spatially variant convolution (Bastos 1999, §7.4.2.2).
//!
//! Gathered, not splatted, and normalised. Near its pixel a kernel reads pixels, further out coarser and
//! coarser texels of a [`Pyramid`]: each level is read in a window of ten by ten texels but for the middle,
//! which the level before has read. So a kernel over the whole picture costs some hundreds of reads, and a
//! small one is as fine as the picture.

use super::{
    kernel::{GlossyPoint, Lens},
    pyramid::{Pyramid, Texel, around},
};
use glam::{Vec2, Vec3};

/// Level whose nearness, if it is farther than the pixel's own, says how far the kernel reaches: beyond the
/// edge of something near, what is far behind it is blurred more.
pub const REACH_LEVEL: usize = 4;

/// A normalised sum, and how it came about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gathered {
    /// Weighted mean of the radiance, cd/m².
    pub radiance: Vec3,
    /// Texels read.
    pub taps: u32,
    /// Radius of the kernel, pixels.
    pub radius: f32,
}

/// Sums the mirror image around a pixel; `support` is tan β of its lobe. Has a twin in
/// `shaders/glossy/convolve.wgsl`.
pub fn gather(
    pyramid: &Pyramid,
    lens: &Lens,
    point: &GlossyPoint,
    pixel: [i32; 2],
    reflector: u32,
    support: f32,
) -> Gathered {
    let radius = reach(pyramid, lens, point, pixel, reflector, support);
    let (mut sum, mut weights, mut taps) = (Vec3::ZERO, 0.0, 0);
    each_tap(pyramid, pixel, radius, |texel, centre, scale| {
        taps += 1;
        if texel.reflector == reflector {
            let angle = lens.pixel_angle() * scale;
            let direction = lens.direction(centre + lens.subpixel - Vec2::splat(0.5));
            let area = scale * scale * texel.coverage;
            let weight = area * point.weight(direction, texel.nearness, angle);
            sum += texel.radiance * weight;
            weights += weight;
        }
    });
    let own = pyramid.levels[0].at(pixel[0], pixel[1]).radiance;
    let radiance = if weights > 0.0 && weights.is_finite() { sum / weights } else { own };
    Gathered { radiance, taps, radius }
}

/// Radius of the kernel at a pixel, in pixels: that of what it shows, or of what is around it if that is farther.
pub fn reach(
    pyramid: &Pyramid,
    lens: &Lens,
    point: &GlossyPoint,
    [x, y]: [i32; 2],
    reflector: u32,
    support: f32,
) -> f32 {
    let own = pyramid.levels[0].at(x, y).nearness;
    let number = REACH_LEVEL.min(pyramid.levels.len() - 1);
    let (mut sum, mut weights) = (0.0, 0.0);
    // Between the texels, so that the radius does not change in blocks.
    for ([tx, ty], share) in around([x, y], number) {
        let texel = pyramid.levels[number].at(tx, ty);
        if texel.reflector == reflector {
            let weight = share * texel.coverage;
            sum += texel.nearness * weight;
            weights += weight;
        }
    }
    let nearness = if weights > 0.0 { own.min(sum / weights) } else { own };
    point.radius_pixels(nearness, support, lens.pixel_angle())
}

/// Visits the texels of a kernel: the texel, its centre in pixels, its edge in pixels.
fn each_tap(pyramid: &Pyramid, [x, y]: [i32; 2], radius: f32, mut visit: impl FnMut(Texel, Vec2, f32)) {
    let last = pyramid.levels.len() - 1;
    for (number, level) in pyramid.levels.iter().enumerate() {
        let scale = (1u32 << number) as f32;
        // Texels of this level that the next one's window leaves to it, and those the one before has read.
        let window = |c: i32| (2 * (c >> (number + 1)) - 4, 2 * (c >> (number + 1)) + 6);
        let ((x0, x1), (y0, y1)) = (window(x), window(y));
        let read = |c: i32| (c >> number) - 2..(c >> number) + 3;
        let (skip_x, skip_y) = (read(x), read(y));
        for ty in y0..y1 {
            for tx in x0..x1 {
                if number > 0 && skip_x.contains(&tx) && skip_y.contains(&ty) {
                    continue;
                }
                let texel = level.at(tx, ty);
                if texel.coverage > 0.0 {
                    visit(texel, (Vec2::new(tx as f32, ty as f32) + 0.5) * scale, scale);
                }
            }
        }
        // The window reaches at least four texels to every side.
        if 4.0 * scale >= radius || number == last {
            break;
        }
    }
}
