//! Which mirrored views a frame needs: a tree of eyes, each mirrored at the reflector that it looks through.
//!
//! A view exists only where its reflector faces the eye before it and covers part of the picture that the
//! view before it covers (Bastos 1999, §6.3; culling as in §6.4). Every view keeps the pixels of the
//! picture: pixel p of a mirrored view shows what is mirrored at pixel p.

use super::{
    MOST_VIEWS,
    culling::Portal,
    reflectors::{BLURRED_ALPHA, Reflector, Reflectors},
};
use crate::scene::{camera::Camera, geometry::Geometry};
use glam::{Vec2, Vec3};

/// Nothing nearer to an eye or to a reflector is seen, as a share of the scene's size.
pub const NEAR: f32 = 1e-5;

/// An eye and the axes of its picture; mirrored an odd number of times, they are left-handed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Position, m.
    pub position: Vec3,
    /// Unit direction to the right.
    pub right: Vec3,
    /// Unit direction upwards in the picture.
    pub up: Vec3,
    /// Unit direction through the middle of the picture.
    pub forward: Vec3,
    /// Slopes of the picture's right and upper edge.
    pub half_size: Vec2,
}

impl Eye {
    /// That of a camera.
    pub fn new(camera: &Camera, aspect: f32) -> Self {
        let view = camera.view_from_world();
        let row = |i: usize| view.row(i).truncate();
        let half = (0.5 * camera.vertical_fov).tan();
        Self {
            position: camera.eye,
            right: row(0),
            up: row(1),
            forward: -row(2),
            half_size: Vec2::new(half * aspect, half),
        }
    }

    /// The same mirrored at a reflector.
    pub fn mirrored(&self, at: &Reflector) -> Self {
        Self {
            position: at.mirror_point(self.position),
            right: at.mirror_direction(self.right),
            up: at.mirror_direction(self.up),
            forward: at.mirror_direction(self.forward),
            half_size: self.half_size,
        }
    }
}

/// A rectangle in the picture, both coordinates from −1 to 1, y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Left and lower edge.
    pub low: Vec2,
    /// Right and upper edge.
    pub high: Vec2,
}

impl Rectangle {
    /// The whole picture.
    pub const ALL: Self = Self { low: Vec2::NEG_ONE, high: Vec2::ONE };

    fn within(self, other: Self) -> Option<Self> {
        let cut = Self { low: self.low.max(other.low), high: self.high.min(other.high) };
        (cut.low.x < cut.high.x && cut.low.y < cut.high.y).then_some(cut)
    }

    /// The smallest around both.
    pub fn around(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn area(self) -> f32 {
        let size = self.high - self.low;
        size.x * size.y
    }
}

/// What is seen in one reflector from one eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirroredView {
    /// Number of the reflector.
    pub reflector: u32,
    /// View it is seen in: 0 is the picture, n the view n − 1 of the list.
    pub parent: u32,
    /// Mirrors on the way: 1 for what the picture shows.
    pub depth: u32,
    /// The eye, mirrored.
    pub eye: Eye,
    /// Clip plane: shown is what has n·x > d; the normal.
    pub clip_normal: Vec3,
    /// Its offset, m.
    pub clip_offset: f32,
    /// Where in the picture.
    pub rectangle: Rectangle,
}

/// The mirrored views of a frame, those of small depth first.
pub fn mirrored_views(
    geometry: &Geometry,
    reflectors: &Reflectors,
    eye: Eye,
    depth: u32,
) -> Vec<MirroredView> {
    mirrored_views_of(geometry, reflectors, eye, depth, |_| true)
}

/// The same of those reflectors in the picture that are wanted.
pub fn mirrored_views_of(
    geometry: &Geometry,
    reflectors: &Reflectors,
    eye: Eye,
    depth: u32,
    is_wanted: impl Fn(&Reflector) -> bool,
) -> Vec<MirroredView> {
    let near = NEAR * reflectors.scene_size;
    let mut views: Vec<MirroredView> = Vec::new();
    let mut level = 0..1u32;
    for depth in 1..=depth {
        let mut found = Vec::new();
        for parent in level {
            let seen_from = parent.checked_sub(1).map(|i| views[i as usize]);
            found.extend(seen_in(geometry, reflectors, eye, seen_from, parent, depth, near));
        }
        if depth == 1 {
            found.retain(|view| is_wanted(&reflectors.list[view.reflector as usize]));
        }
        // The largest first; equal ones stay in order.
        found.sort_by(|a, b| b.rectangle.area().total_cmp(&a.rectangle.area()));
        found.truncate(MOST_VIEWS - views.len());
        level = views.len() as u32 + 1..(views.len() + found.len()) as u32 + 1;
        views.extend(found);
    }
    views
}

/// The views that one view, or the picture, shows.
fn seen_in(
    geometry: &Geometry,
    reflectors: &Reflectors,
    eye: Eye,
    seen_from: Option<MirroredView>,
    parent: u32,
    depth: u32,
    near: f32,
) -> Vec<MirroredView> {
    let (eye, rectangle) = seen_from.map_or((eye, Rectangle::ALL), |v| (v.eye, v.rectangle));
    let clip = seen_from.map(|v| (v.clip_normal, v.clip_offset));
    let numbered = reflectors.list.iter().enumerate();
    let is_sharp =
        |r: &Reflector| geometry.materials[r.material as usize].alpha().is_some_and(|a| a < BLURRED_ALPHA);
    numbered
        .filter(|(i, r)| seen_from.is_none_or(|v| v.reflector != *i as u32 && is_sharp(r)))
        .filter_map(|(i, reflector)| {
            let clip_normal = reflector.facing(eye.position)?;
            let covered = covered(geometry, reflector, (&eye, rectangle), clip, near)?;
            let side = clip_normal.dot(reflector.normal);
            Some(MirroredView {
                reflector: i as u32,
                parent,
                depth,
                eye: eye.mirrored(reflector),
                clip_normal,
                clip_offset: side * reflector.offset,
                rectangle: covered,
            })
        })
        .collect()
}

/// Part of a rectangle of the picture that a reflector covers, as a rectangle; `None` where it is out of sight.
fn covered(
    geometry: &Geometry,
    reflector: &Reflector,
    (eye, within): (&Eye, Rectangle),
    clip: Option<(Vec3, f32)>,
    near: f32,
) -> Option<Rectangle> {
    let mut bounds: Option<Rectangle> = None;
    let portal = Portal::new(eye, within, Vec2::ZERO);
    for &t in &reflector.triangles {
        let mut polygon = geometry.positions[t as usize].to_vec();
        if let Some((normal, offset)) = clip {
            polygon = above(&polygon, normal, offset);
        }
        polygon = above(&polygon, eye.forward, eye.forward.dot(eye.position) + near);
        for corner in portal.cut(polygon) {
            let away = corner - eye.position;
            let z = away.dot(eye.forward).max(near);
            let at = Vec2::new(away.dot(eye.right), away.dot(eye.up)) / (z * eye.half_size);
            let so_far = bounds.unwrap_or(Rectangle { low: at, high: at });
            bounds = Some(Rectangle { low: so_far.low.min(at), high: so_far.high.max(at) });
        }
    }
    bounds?.within(within)
}

/// The part of a convex polygon with n·x ≥ offset.
pub(super) fn above(polygon: &[Vec3], normal: Vec3, offset: f32) -> Vec<Vec3> {
    let height = |p: Vec3| normal.dot(p) - offset;
    let mut cut = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            cut.push(a);
        }
        if (ha < 0.0) != (hb < 0.0) {
            cut.push(a.lerp(b, ha / (ha - hb)));
        }
    }
    cut
}
