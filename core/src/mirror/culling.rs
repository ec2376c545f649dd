//! What of the scene a view can see: blocks of triangles in boxes, held against the view's portal.
//!
//! A mirrored view shows only what lies beyond its reflector and inside the pyramid from the mirrored eye
//! through the reflector's place in the picture (Bastos 1999, §6.4: "avoid putting into the rendering
//! pipeline polygons that you cannot finally see"). A block is left out only where its whole box lies
//! outside one of those planes, so no pixel changes; a test says so.

use super::views::{Eye, MirroredView, Rectangle, above};
use crate::scene::geometry::Geometry;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// Triangles of a block, at most.
const BLOCK: u32 = 128;
/// Triangles left out between two blocks, up to which both are drawn as one: a draw has its price too.
const GAP: u32 = 64;

/// Consecutive triangles of one object, all single-sided or all double-sided, and their box, m.
#[derive(Clone, Debug, PartialEq)]
struct Block {
    triangles: Range<u32>,
    double_sided: bool,
    low: Vec3,
    high: Vec3,
}

/// The blocks of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Blocks {
    list: Vec<Block>,
    /// Blocks of each object.
    of_object: Vec<Range<usize>>,
}

impl Blocks {
    /// Those of a scene.
    pub fn new(geometry: &Geometry) -> Self {
        let mut blocks = Self::default();
        for triangles in &geometry.object_triangles {
            let first = blocks.list.len();
            let mut start = triangles.start;
            while start < triangles.end {
                let sides = |t: u32| geometry.material_of(t).double_sided;
                let most = (start + BLOCK).min(triangles.end);
                let end = (start + 1..most).find(|t| sides(*t) != sides(start)).unwrap_or(most);
                blocks.list.push(block(geometry, start..end));
                start = end;
            }
            blocks.of_object.push(first..blocks.list.len());
        }
        blocks
    }

    /// Follows an object that was placed anew.
    pub fn moved(&mut self, geometry: &Geometry, object: usize) {
        for block in &mut self.list[self.of_object[object].clone()] {
            *block = self::block(geometry, block.triangles.clone());
        }
    }

    /// Ranges of triangles that may show in a view, the single-sided ones and the double-sided ones; neighbours
    /// of a kind are joined.
    pub fn seen(&self, portal: &Portal) -> [Vec<Range<u32>>; 2] {
        let mut seen = [Vec::<Range<u32>>::new(), Vec::new()];
        // Whether triangles of the other kind lie between a kind's last range and here.
        let mut parted = [false; 2];
        for block in &self.list {
            let kind = usize::from(block.double_sided);
            parted[1 - kind] = true;
            if !portal.touches(block.low, block.high) {
                continue;
            }
            match seen[kind].last_mut() {
                Some(last) if !parted[kind] && block.triangles.start - last.end <= GAP => {
                    last.end = block.triangles.end;
                }
                _ => seen[kind].push(block.triangles.clone()),
            }
            parted[kind] = false;
        }
        seen
    }
}

fn block(geometry: &Geometry, triangles: Range<u32>) -> Block {
    let corners = geometry.positions[triangles.start as usize..triangles.end as usize].iter().flatten();
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = corners.fold(empty, |(low, high), &p| (low.min(p), high.max(p)));
    let double_sided = geometry.material_of(triangles.start).double_sided;
    Block { triangles, double_sided, low, high }
}

/// The planes that bound what a view shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Portal {
    /// Kept is what has n·x ≥ d: normal and offset.
    planes: Vec<(Vec3, f32)>,
}

impl Portal {
    /// One that shuts nothing out.
    pub const OPEN: Self = Self { planes: Vec::new() };

    /// The pyramid from an eye through a rectangle of its picture, grown by `margin` on all sides.
    pub fn new(eye: &Eye, rectangle: Rectangle, margin: Vec2) -> Self {
        let (low, high) = (rectangle.low - margin, rectangle.high + margin);
        let axes = [(eye.right, eye.half_size.x, low.x, high.x), (eye.up, eye.half_size.y, low.y, high.y)];
        let mut planes = vec![(eye.forward, eye.forward.dot(eye.position))];
        for (axis, half, low, high) in axes {
            // Seen at x is what has axis·v = x · half · forward·v, v from the eye.
            for normal in [axis - eye.forward * (low * half), eye.forward * (high * half) - axis] {
                planes.push((normal, normal.dot(eye.position)));
            }
        }
        Self { planes }
    }

    /// Margin of two pixels: frames that are averaged look through other places of their pixels.
    pub fn margin([width, height]: [u32; 2]) -> Vec2 {
        Vec2::new(4.0 / width.max(1) as f32, 4.0 / height.max(1) as f32)
    }

    /// That of a mirrored view: what lies before its reflector too.
    pub fn of_view(view: &MirroredView, margin: Vec2) -> Self {
        let mut portal = Self::new(&view.eye, view.rectangle, margin);
        portal.planes.push((view.clip_normal, view.clip_offset));
        portal
    }

    /// The part of a convex polygon that lies inside; empty where none does.
    pub fn cut(&self, mut polygon: Vec<Vec3>) -> Vec<Vec3> {
        for &(normal, offset) in &self.planes {
            if polygon.iter().any(|&p| normal.dot(p) < offset) {
                polygon = above(&polygon, normal, offset);
            }
        }
        polygon
    }

    /// Whether a box may reach inside; false only where it lies outside one plane.
    pub fn touches(&self, low: Vec3, high: Vec3) -> bool {
        let slack = 1e-5 * (high.abs().max(low.abs()).max_element() + 1.0);
        self.planes.iter().all(|&(normal, offset)| {
            let farthest = Vec3::select(normal.cmpge(Vec3::ZERO), high, low);
            normal.dot(farthest) >= offset - slack * normal.length().max(1.0) * 4.0
        })
    }
}
