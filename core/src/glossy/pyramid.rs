//! The mirror image at halves of its resolution: each level holds the means of two by two texels.

use crate::mirror::{pass::MirrorImage, reflectors::NO_REFLECTOR};
use glam::{Vec2, Vec3};

/// Levels of a pyramid, at most.
pub const MOST_LEVELS: usize = 12;

/// A texel of a mirror image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// Mean radiance that arrives, cd/m².
    pub radiance: Vec3,
    /// Mean of 1 over the distance from the eye to what is mirrored, along the unfolded ray, 1/m: 0 for
    /// infinitely far. Over a plane it is linear in the picture.
    pub nearness: f32,
    /// Share of the texel's pixels that show its reflector.
    pub coverage: f32,
    /// The reflector.
    pub reflector: u32,
}

impl Texel {
    /// A texel that shows no reflector.
    pub const NONE: Self =
        Self { radiance: Vec3::ZERO, nearness: 0.0, coverage: 0.0, reflector: NO_REFLECTOR };

    /// Four texels as one: those of the reflector that covers most; the first of equals. Has a twin in
    /// `shaders/glossy/pyramid.wgsl`.
    pub fn merged(four: [Self; 4]) -> Self {
        let mut best = (0.0, NO_REFLECTOR);
        for a in four {
            let sum: f32 = four.iter().filter(|b| b.reflector == a.reflector).map(|b| b.coverage).sum();
            if a.reflector != NO_REFLECTOR && sum > best.0 {
                best = (sum, a.reflector);
            }
        }
        let (sum, reflector) = best;
        if sum <= 0.0 {
            return Self::NONE;
        }
        let own = four.iter().filter(|t| t.reflector == reflector);
        let (mut radiance, mut nearness) = (Vec3::ZERO, 0.0);
        for t in own {
            radiance += t.radiance * (t.coverage / sum);
            nearness += t.nearness * (t.coverage / sum);
        }
        Self { radiance, nearness, coverage: 0.25 * sum, reflector }
    }
}

/// One level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// The texels, row-major.
    pub texels: Vec<Texel>,
}

impl Level {
    /// A texel, [`Texel::NONE`] outside.
    pub fn at(&self, x: i32, y: i32) -> Texel {
        if x < 0 || y < 0 || x >= self.width as i32 || y >= self.height as i32 {
            return Texel::NONE;
        }
        self.texels[y as usize * self.width as usize + x as usize]
    }
}

/// The four texels around the middle of one of a level finer by some steps, and their bilinear weights.
pub(super) fn around([x, y]: [i32; 2], steps: usize) -> [([i32; 2], f32); 4] {
    let at = (Vec2::new(x as f32, y as f32) + 0.5) / (1u32 << steps) as f32 - 0.5;
    let (low, f) = (at.floor(), at - at.floor());
    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
        let weight = (if dx == 1 { f.x } else { 1.0 - f.x }) * (if dy == 1 { f.y } else { 1.0 - f.y });
        ([low.x as i32 + dx, low.y as i32 + dy], weight)
    })
}

/// Size of a level: halves, rounded up.
pub fn level_size([width, height]: [u32; 2], level: usize) -> [u32; 2] {
    [width, height].map(|n| (0..level).fold(n, |n, _| n.div_ceil(2)))
}

/// A mirror image at every resolution, the finest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pyramid {
    /// The levels.
    pub levels: Vec<Level>,
}

impl Pyramid {
    /// Halves what some reflectors of a mirror image show until one texel is left; `eye_distance` is that from the eye
    /// to the reflector at each pixel, m.
    pub fn new(image: &MirrorImage, eye_distance: &[f32], holds: impl Fn(u32) -> bool) -> Self {
        use rayon::prelude::*;
        let texels = (0..image.reflector.len())
            .map(|i| match image.reflector[i] {
                reflector if reflector == NO_REFLECTOR || !holds(reflector) => Texel::NONE,
                reflector => Texel {
                    radiance: image.radiance[i],
                    nearness: 1.0 / (eye_distance[i] + image.distance[i]),
                    coverage: 1.0,
                    reflector,
                },
            })
            .collect();
        let mut levels = vec![Level { width: image.width, height: image.height, texels }];
        while levels.len() < MOST_LEVELS {
            let fine = &levels[levels.len() - 1];
            if fine.width.max(fine.height) <= 1 {
                break;
            }
            let [width, height] = level_size([fine.width, fine.height], 1);
            let texels = (0..(width * height) as i32)
                .into_par_iter()
                .map(|i| {
                    let (x, y) = (2 * (i % width as i32), 2 * (i / width as i32));
                    Texel::merged([
                        fine.at(x, y),
                        fine.at(x + 1, y),
                        fine.at(x, y + 1),
                        fine.at(x + 1, y + 1),
                    ])
                })
                .collect();
            levels.push(Level { width, height, texels });
        }
        Self { levels }
    }
}
