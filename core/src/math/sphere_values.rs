//! Values by direction, one a bin: read by bin or smoothly, and drawn as a ball or as maps.
//!
//! Smooth reading interpolates over the equal-area squares, in whose cells a bin's value stands at the
//! centre. It is continuous everywhere, across the equator too, and differs from the bins by what the
//! light changes within one: a bin as bright as a lamp becomes a tent.

use super::{
    colour::luminance,
    image::{LinearImage, bilinear},
    sphere_map::DirectionBins,
};
use glam::{Mat3, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Values by direction.
#[derive(Clone, Copy, Debug)]
pub struct SphereValues<'a> {
    /// Layout of the bins.
    pub bins: DirectionBins,
    /// One value a bin.
    pub values: &'a [Vec3],
}

impl SphereValues<'_> {
    /// Value of the bin that holds a direction.
    pub fn nearest(&self, direction: Vec3) -> Vec3 {
        self.values.get(self.bins.bin(direction)).copied().unwrap_or(Vec3::ZERO)
    }

    /// Bilinear value over a hemisphere's square; across the equator lies the same cell of the other.
    pub fn smooth(&self, direction: Vec3) -> Vec3 {
        let n = self.bins.n() as i32;
        let (square, lower) = self.bins.square(direction);
        let value = |x: i32, y: i32| {
            let outside = (x < 0 || x >= n) != (y < 0 || y >= n);
            let cell = y.clamp(0, n - 1) * n + x.clamp(0, n - 1);
            let bin = cell + if lower != outside { n * n } else { 0 };
            self.values.get(bin as usize).copied().unwrap_or(Vec3::ZERO)
        };
        bilinear(square * n as f32 - Vec2::splat(0.5), value)
    }

    /// Value by bin or smooth.
    pub fn value(&self, direction: Vec3, smooth: bool) -> Vec3 {
        if smooth { self.smooth(direction) } else { self.nearest(direction) }
    }

    /// How far the smooth values are from those of `other`: the root mean square of the difference of
    /// luminance over the centres of `other`'s bins, as a share of its mean; 0 where that is dark.
    pub fn relative_difference(&self, other: &SphereValues<'_>) -> f32 {
        let (mut square, mut sum) = (0.0f64, 0.0f64);
        for (bin, value) in other.values.iter().enumerate() {
            let (own, wanted) = (luminance(self.smooth(other.bins.centre(bin))), luminance(*value));
            square += f64::from(own - wanted).powi(2);
            sum += f64::from(wanted);
        }
        let count = other.values.len().max(1) as f64;
        if sum > 0.0 { ((square / count).sqrt() / (sum / count)) as f32 } else { 0.0 }
    }

    /// The ball as it is seen from outside, orthographic: the colour at a point of it is the value in
    /// the direction that points there from its middle. Columns of `world_from_view`: right, up and
    /// towards the viewer. Pixels are premultiplied sRGB with coverage, so that the rim is soft.
    pub fn ball(
        &self,
        world_from_view: Mat3,
        size: usize,
        smooth: bool,
        colour: impl Fn(Vec3) -> [u8; 3],
    ) -> Vec<[u8; 4]> {
        let radius = 0.5 * size as f32 - 1.0;
        let centre = 0.5 * size as f32;
        let mut pixels = Vec::with_capacity(size * size);
        for row in 0..size {
            for column in 0..size {
                let offset = Vec2::new(column as f32 + 0.5 - centre, centre - row as f32 - 0.5);
                let coverage = (radius + 0.5 - offset.length()).clamp(0.0, 1.0);
                if coverage == 0.0 {
                    pixels.push([0; 4]);
                    continue;
                }
                let at = (offset / radius).clamp_length_max(0.9999);
                let direction = direction_at(at, world_from_view).unwrap_or(Vec3::Y);
                let [r, g, b] = colour(self.value(direction, smooth));
                pixels.push([r, g, b, 255].map(|v| (f32::from(v) * coverage + 0.5) as u8));
            }
        }
        pixels
    }

    /// Both hemispheres' squares side by side, upper left and lower right: 2n × n pixels, a bin each,
    /// u to the right and v down.
    pub fn unfolded(&self) -> LinearImage {
        let n = self.bins.n();
        LinearImage::from_fn(2 * n, n, |x, y| {
            let bin = y * n + x % n + if x >= n { n * n } else { 0 };
            self.values.get(bin as usize).copied().unwrap_or(Vec3::ZERO)
        })
    }

    /// The sphere as a latitude–longitude map of `height` rows, twice as many columns, as
    /// [`latitude_longitude`] lays it out.
    pub fn map(&self, height: u32, smooth: bool) -> LinearImage {
        LinearImage::from_fn(2 * height, height, |x, y| {
            let at = Vec2::new((x as f32 + 0.5) / (2 * height) as f32, (y as f32 + 0.5) / height as f32);
            self.value(latitude_longitude(at), smooth)
        })
    }
}

/// Direction from the middle of a ball to where `at` in [−1, 1]² (y up) is seen on it.
///
/// Columns of `world_from_view`: right, up and towards the viewer.
pub fn direction_at(at: Vec2, world_from_view: Mat3) -> Option<Vec3> {
    let rest = 1.0 - at.length_squared();
    (rest >= 0.0).then(|| (world_from_view * at.extend(rest.sqrt())).normalize_or(Vec3::Y))
}

/// Direction at a place in [0, 1]² of a latitude–longitude map, as OpenEXR defines it: +y on top, +z in
/// the middle, +x in the middle of the left half (`ImfEnvmap.h`, longitude π at the left, −π at the right).
pub fn latitude_longitude(at: Vec2) -> Vec3 {
    let (latitude, longitude) = (PI * (0.5 - at.y), TAU * (0.5 - at.x));
    let (sin, cos) = latitude.sin_cos();
    Vec3::new(longitude.sin() * cos, sin, longitude.cos() * cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_values_meet_across_the_equator_and_hit_bin_centres() {
        let bins = DirectionBins::new(9);
        let values: Vec<Vec3> = (0..bins.len()).map(|b| bins.centre(b) * 0.5 + Vec3::splat(0.5)).collect();
        let sphere = SphereValues { bins, values: &values };
        for (bin, value) in values.iter().enumerate() {
            assert!((sphere.smooth(bins.centre(bin)) - *value).length() < 1e-4);
        }
        for i in 0..360 {
            let (sin, cos) = (i as f32).to_radians().sin_cos();
            let above = sphere.smooth(Vec3::new(cos, 1e-4, sin).normalize());
            let below = sphere.smooth(Vec3::new(cos, -1e-4, sin).normalize());
            // Two sides of one line, 2e-4 apart, values that change by at most ~1 a radian.
            assert!((above - below).length() < 0.02, "at {i}: {above} {below}");
        }
    }

    #[test]
    fn the_ball_shows_the_side_that_faces_the_viewer() {
        let towards_viewer = direction_at(Vec2::ZERO, Mat3::IDENTITY);
        assert_eq!(towards_viewer, Some(Vec3::Z));
        assert!(direction_at(Vec2::new(0.8, 0.8), Mat3::IDENTITY).is_none());
    }

    #[test]
    fn the_map_has_the_sky_on_top_and_openexr_s_axes() {
        for (at, direction) in [
            ([0.5, 0.5], Vec3::Z),
            ([0.25, 0.5], Vec3::X),
            ([0.75, 0.5], Vec3::NEG_X),
            ([0.0, 0.5], Vec3::NEG_Z),
            ([0.3, 0.0], Vec3::Y),
            ([0.3, 1.0], Vec3::NEG_Y),
        ] {
            // Sines and cosines of multiples of π/2 in f32.
            assert!((latitude_longitude(at.into()) - direction).length() < 1e-6, "{at:?}");
        }
    }

    #[test]
    fn the_mean_over_the_sphere_survives_the_map() {
        let bins = DirectionBins::new(9);
        let values: Vec<Vec3> = (0..bins.len()).map(|b| Vec3::splat((b % 7) as f32)).collect();
        let sphere = SphereValues { bins, values: &values };
        let image = sphere.map(180, false);
        let (mut sum, mut weight) = (0.0f64, 0.0f64);
        for (i, pixel) in image.pixels.iter().enumerate() {
            let row = (i as u32 / image.width) as f64;
            let cos = (std::f64::consts::PI * (0.5 - (row + 0.5) / 180.0)).cos();
            sum += f64::from(pixel.x) * cos;
            weight += cos;
        }
        let mean = values.iter().map(|v| f64::from(v.x)).sum::<f64>() / values.len() as f64;
        // Pixels of 1° on the edges of bins of 16° go to one side or the other: errors of either sign.
        assert!((sum / weight - mean).abs() < 0.01 * mean, "{} on the map, {mean} in the bins", sum / weight);
    }
}
