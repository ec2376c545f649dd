//! The kernel of the glossy surface under the pointer, as the window's camera sees it.
//!
//! Made on the window's own thread, only when the pointer, the camera, the light or the open probe changes: 441 rays
//! into the lobe, 880 from the eye to what is painted, the lobe's value at 4,096 slopes and their Fourier transform,
//! 512 draws from the lobe; and, until something is pointed at, once a scene its flat reflectors. Painted over the
//! picture, not into it: it follows the pointer at once, however long the picture takes.

use super::{
    pick::{Glance, first_surface},
    request::Same,
    screen::Screen,
};
use egui::{Color32, Mesh, Painter, Shape, Stroke};
use glam::Vec3;
use lumenscope_core::{
    glossy::{inspect::KernelView, inspect_point::KernelPoint},
    inspection::{ColouredMesh, InspectionScene},
    math::{
        colour::{luminance, srgb8},
        false_colour::FalseColour,
    },
    mirror::reflectors::Reflectors,
    scene::{accel::Ray, world::World},
    superposition::gbuffer::first_visible,
};
use std::sync::Arc;

/// What is shown, and what it is shown of.
#[derive(Default)]
pub struct PointedKernel {
    shown: Option<Arc<KernelView>>,
    /// Which vertices of its meshes the eye sees.
    visible: Vec<Vec<bool>>,
    /// Where it was seen from, in what, and the open probe's place.
    seen: Option<(Vec3, Same<World>, Option<Vec3>)>,
    /// Whether anything glossy was pointed at yet.
    was_pointed: bool,
    /// What `KernelPoint::near` chooses from, and the scene it is of.
    reflectors: Option<(Same<World>, Reflectors)>,
}

impl PointedKernel {
    /// The kernel of what the pointer is on. Where that is not glossy it is the last one, as long as the eye sees
    /// its point; before anything glossy was pointed at, that of the flat glossy surface nearest to `place`.
    pub fn follow(
        &mut self,
        world: &Arc<World>,
        eye: Vec3,
        glance: Option<&Glance>,
        place: Option<Vec3>,
    ) -> Option<Arc<KernelView>> {
        let seen = Some((eye, Same(Some(world.clone())), place));
        let geometry = &world.geometry;
        let pointed = glance.and_then(|g| KernelPoint::on(geometry, &g.surface, eye));
        let last = self.shown.as_ref().map(|k| k.point);
        if self.seen == seen && (pointed.is_none() || pointed == last) {
            return self.shown.clone();
        }
        let point = match (pointed, last) {
            (Some(point), _) => Some(point),
            (None, _) if !self.was_pointed => {
                KernelPoint::near(geometry, self.reflectors_of(world), eye, place)
            }
            (None, Some(last)) => again(world, eye, &last),
            (None, None) => None,
        };
        self.was_pointed |= pointed.is_some();
        self.seen = seen;
        self.shown = point.map(|point| Arc::new(KernelView::new(world, point, eye)));
        let is_visible = |p: &Vec3| first_visible(world, eye, *p - eye).is_none_or(|hit| hit.t > NEARLY);
        let meshes = self.shown.iter().flat_map(|k| &k.scene.meshes);
        self.visible = meshes.map(|m| m.positions.iter().map(is_visible).collect()).collect();
        self.shown.clone()
    }

    /// The flat reflectors of a scene, found once.
    fn reflectors_of(&mut self, world: &Arc<World>) -> &Reflectors {
        let of = Same(Some(world.clone()));
        let known = self.reflectors.take().filter(|(known, _)| *known == of);
        &self.reflectors.insert(known.unwrap_or_else(|| (of, Reflectors::new(&world.geometry)))).1
    }

    /// What is painted, with its legend.
    pub fn scene(&self) -> Option<&InspectionScene> {
        self.shown.as_ref().map(|k| &k.scene)
    }

    /// Paints the footprint, the lobe and the mirrored ray where the eye sees them.
    pub fn paint(&self, painter: &Painter, screen: &Screen, colours: &FalseColour) {
        let Some(kernel) = &self.shown else { return };
        for (mesh, visible) in kernel.scene.meshes.iter().zip(&self.visible) {
            painter.add(Shape::mesh(projected(mesh, visible, screen, colours)));
        }
        for line in &kernel.scene.lines {
            if let Some(ends) = screen.segment(line.ends[0], line.ends[1]) {
                painter.line_segment(ends, Stroke::new(3.0, Color32::from_black_alpha(90)));
                painter.line_segment(ends, Stroke::new(1.4, Color32::from_gray(235)));
            }
        }
    }
}

/// Share of the way to a point at which what is met is the point's own surface.
const NEARLY: f32 = 0.995;

/// The triangles whose corners are all seen, the farthest first.
fn projected(mesh: &ColouredMesh, visible: &[bool], screen: &Screen, colours: &FalseColour) -> Mesh {
    let mut out = Mesh::default();
    let depths: Vec<Option<f32>> = (mesh.positions.iter().zip(&mesh.values).zip(visible))
        .map(|((position, value), visible)| {
            let [r, g, b] = srgb8(colours.colour(luminance(*value)));
            let (at, depth) = screen.project(*position).unwrap_or_default();
            out.colored_vertex(at, Color32::from_rgba_unmultiplied(r, g, b, 215));
            (*visible && depth > 0.0).then_some(depth)
        })
        .collect();
    let depth = |t: &[u32; 3]| t.iter().try_fold(0.0, |sum, &i| Some(sum + depths[i as usize]?));
    let mut seen: Vec<(f32, [u32; 3])> =
        mesh.triangles.iter().filter_map(|t| Some((depth(t)?, *t))).collect();
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    seen.iter().for_each(|(_, [a, b, c])| out.add_triangle(*a, *b, *c));
    out
}

/// The same point under another eye or in another light; `None` where it is not seen any more.
fn again(world: &World, eye: Vec3, point: &KernelPoint) -> Option<KernelPoint> {
    /// Share of the distance by which the point may have moved: rounding.
    const SAME: f32 = 1e-3;
    let (surface, distance) = first_surface(world, &Ray::new(eye, point.position - eye))?;
    ((distance - 1.0).abs() < SAME).then(|| KernelPoint::on(&world.geometry, &surface, eye))?
}
