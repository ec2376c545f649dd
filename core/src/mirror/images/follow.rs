//! Images after something has moved: all are kept, and those rays traced anew that meet what moved, where it stood or
//! where it stands.
//!
//! A ray met it where it stood if its pixel has one of its triangles. Where it stands it meets it only if it crosses
//! the box around it, before what it met so far. All other rays meet what they met, so the images are those that would
//! be taken of nothing, bit by bit; a test says so.

use super::{
    MirrorImages, ReflectorImages,
    sample::{ImageWithDepth, NOTHING, Surroundings, place},
    sets::{Side, sides},
    visible::{LEAF, Quadtree},
};
use crate::{
    math::progress::{Cancelled, Progress},
    scene::{geometry::Geometry, world::World},
};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::{ops::Range, sync::Arc};

/// Rays by which a reflector that has moved itself is sampled at once, at most: about a tenth of a second.
const MOST_RAYS: u64 = 200_000;

/// Share of the largest coordinate that boxes are grown by: a movable object's tree is met in its own coordinates.
const SLACK: f32 = 1e-5;

/// What has moved since images were taken.
struct Moved {
    /// Its triangles, an object each.
    triangles: Vec<Range<u32>>,
    /// Boxes around them where they now are, m.
    boxes: Vec<[Vec3; 2]>,
    /// Whether the scene has another size, and what is nothing another distance.
    resized: bool,
}

impl Moved {
    fn new(geometry: &Geometry, objects: &[usize], resized: bool) -> Self {
        let triangles: Vec<Range<u32>> =
            objects.iter().map(|&o| geometry.object_triangles[o].clone()).filter(|t| !t.is_empty()).collect();
        let around = |t: &Range<u32>| {
            let corners = geometry.positions[t.start as usize..t.end as usize].iter().flatten();
            let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let (low, high) = corners.fold(empty, |(low, high), &p| (low.min(p), high.max(p)));
            let slack = SLACK * low.abs().max(high.abs()).max_element();
            [low - slack, high + slack]
        };
        Self { boxes: triangles.iter().map(around).collect(), triangles, resized }
    }

    fn was_met(&self, triangle: u32) -> bool {
        self.triangles.iter().any(|t| t.contains(&triangle)) || self.resized && triangle == NOTHING
    }
}

impl MirrorImages {
    /// The images with everything where it now stands: of reflectors that stayed they are kept, others are taken anew
    /// unless that takes more rays than `most`; then there are none.
    ///
    /// Materials must be those that the images were taken with. Colours are left as they were.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn followed(&self, world: &World, most: u64, progress: &Progress) -> Result<Option<Self>, Cancelled> {
        let geometry = &world.geometry;
        let around = Surroundings::new(world);
        let (asked, placed, far_m) = (self.asked, geometry.world_from_object.clone(), around.far_m);
        let moved: Vec<usize> =
            (0..placed.len()).filter(|&i| self.placed.get(i) != Some(&placed[i])).collect();
        let sides = sides(geometry, asked.as_ref());
        let kept = |side: &Side| {
            let stayed = !moved.contains(&(side.reflector.object as usize));
            self.sets.iter().find(|set| stayed && set.are_of(side))
        };
        let anew = sides.iter().filter(|side| kept(side).is_none()).map(|side| side.points(geometry));
        if anew.sum::<u64>() > most {
            return Ok(None);
        }
        progress.begin("mirror images");
        let what = Moved::new(geometry, &moved, far_m != self.far_m);
        let (mut sets, mut rays) = (Vec::new(), 0);
        for (i, side) in sides.iter().enumerate() {
            progress.report(i as f32 / sides.len() as f32)?;
            let (set, traced) = kept(side).map_or_else(
                || {
                    let set = ReflectorImages::new(&around, side);
                    let points = set.points();
                    (set, points)
                },
                |set| set.followed(&around, &what),
            );
            sets.push(set);
            rays += traced;
        }
        progress.report(1.0)?;
        Ok(Some(Self { sets, rays, asked, placed, far_m }))
    }

    /// The same at once, while something moves; as they were, and out of use, where a reflector has moved that is too
    /// large for that.
    pub fn moved(self: &Arc<Self>, world: &World) -> Arc<Self> {
        if self.hold(&world.geometry) {
            return self.clone();
        }
        let followed = self.followed(world, MOST_RAYS, &Progress::silent());
        followed.ok().flatten().map_or_else(|| self.clone(), Arc::new)
    }
}

impl ReflectorImages {
    /// The images, and how many rays were traced.
    fn followed(&self, around: &Surroundings, moved: &Moved) -> (Self, u64) {
        let images: Vec<&Arc<ImageWithDepth>> = self.elements.iter().flatten().collect();
        let followed: Vec<(Arc<ImageWithDepth>, u64)> =
            images.into_par_iter().map(|image| followed(image, around, moved)).collect();
        let rays = followed.iter().map(|(_, rays)| rays).sum();
        let mut images = followed.into_iter().map(|(image, _)| image);
        let elements = self.elements.iter().map(|e| images.by_ref().take(e.len()).collect()).collect();
        (Self { elements, ..self.clone() }, rays)
    }
}

/// An image, itself where it is as it was, and how many rays were traced.
fn followed(image: &Arc<ImageWithDepth>, around: &Surroundings, moved: &Moved) -> (Arc<ImageWithDepth>, u64) {
    let doubtful = image.doubtful(moved);
    let rays = doubtful.len() as u64;
    let mut now: Option<ImageWithDepth> = None;
    for pixel in doubtful {
        let (i, seen) = (pixel as usize, image.see(around, pixel));
        if seen != (image.scale[i], image.triangle[i]) {
            let now = now.get_or_insert_with(|| (**image).clone());
            (now.scale[i], now.triangle[i]) = seen;
        }
    }
    let renewed = now.map(|mut now| {
        now.tree = Quadtree::new(&now);
        Arc::new(now)
    });
    (renewed.unwrap_or_else(|| image.clone()), rays)
}

impl ImageWithDepth {
    /// Pixels that saw what moved, or may see it.
    fn doubtful(&self, moved: &Moved) -> Vec<u32> {
        let windows: Vec<Option<[Vec2; 2]>> = moved.boxes.iter().map(|b| self.window(*b)).collect();
        let side = LEAF.isqrt() as f32;
        let mut doubtful = Vec::new();
        for (first, triangles) in (0..).step_by(LEAF as usize).zip(self.triangle.chunks(LEAF as usize)) {
            let corner = place(first).as_vec2();
            let meets = |window: &Option<[Vec2; 2]>| {
                window.is_none_or(|[low, high]| low.cmple(corner + side).all() && high.cmpge(corner).all())
            };
            let near = windows.iter().any(meets);
            if !near && !triangles.iter().any(|&t| moved.was_met(t)) {
                continue;
            }
            doubtful.extend((first..).zip(triangles).filter_map(|(pixel, &t)| {
                let may_meet = || near && moved.boxes.iter().any(|b| self.crosses(pixel, b));
                (moved.was_met(t) || may_meet()).then_some(pixel)
            }));
        }
        doubtful
    }

    /// Columns and rows between which a box is seen, a pixel more on each side; `None` for all.
    fn window(&self, [low, high]: [Vec3; 2]) -> Option<[Vec2; 2]> {
        let mut window = [Vec2::INFINITY, Vec2::NEG_INFINITY];
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] };
            let at = self.seen_at(Vec3::new(pick(0), pick(1), pick(2)))?;
            window = [window[0].min(at - 1.0), window[1].max(at + 1.0)];
        }
        Some(window)
    }

    /// Whether a pixel's ray crosses a box between the element and what it sees.
    fn crosses(&self, pixel: u32, [low, high]: &[Vec3; 2]) -> bool {
        let (eye, inverse) = (self.eye, self.out(pixel).recip());
        let (a, b) = ((low - eye) * inverse, (high - eye) * inverse);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        enter.max(1.0 - SLACK) <= leave.min(self.scale[pixel as usize] * (1.0 + SLACK))
    }
}
