//! The mirrored views of a frame as the shaders have them.

use super::{MOST_VIEWS, views::MirroredView};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// `MirroredView` of `shaders/mirror/views.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ViewInfo {
    /// Mirrored eye, m.
    pub eye: Vec3,
    /// Reflector.
    pub reflector: u32,
    /// Unit direction to the right.
    pub right: Vec3,
    /// View it is seen in, counted from 1; 0 is the picture.
    pub parent: u32,
    /// Unit direction upwards in the picture.
    pub up: Vec3,
    /// Mirrors on the way.
    pub depth: u32,
    /// Unit direction through the middle of the picture.
    pub forward: Vec3,
    /// Nothing.
    pub padding: u32,
    /// Normal of the clip plane.
    pub clip_normal: Vec3,
    /// Its offset, m.
    pub clip_offset: f32,
}

impl ViewInfo {
    pub(super) fn new(view: &MirroredView) -> Self {
        Self {
            eye: view.eye.position,
            reflector: view.reflector,
            right: view.eye.right,
            parent: view.parent,
            up: view.eye.up,
            depth: view.depth,
            forward: view.eye.forward,
            padding: 0,
            clip_normal: view.clip_normal,
            clip_offset: view.clip_offset,
        }
    }
}

/// `MirroredViews` of `shaders/mirror/views.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ViewTable {
    /// Views there are.
    pub count: u32,
    /// Nothing nearer to a reflector than this is seen in it, m.
    pub near: f32,
    /// Whether what is glossy is made of particles, and needs no view.
    pub by_particles: u32,
    /// Nothing.
    pub padding: u32,
    /// The views.
    pub list: [ViewInfo; MOST_VIEWS],
}
