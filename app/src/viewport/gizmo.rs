//! The handles on a selected target: arrows that move it, a ring that turns it about y.
//!
//! `transform-gizmo` computes them from its own number types; matrices go in as plain arrays and
//! triangles come out, so its egui version need not be ours.

use super::screen::Screen;
use egui::epaint::{Mesh, Vertex, WHITE_UV};
use glam::{Affine3A, DMat4, DQuat, DVec3, Quat, Vec3};
use lumenscope_core::scene::Target;
use transform_gizmo::{
    Gizmo, GizmoConfig, GizmoInteraction, GizmoMode, GizmoVisuals,
    math::{Pos2, Transform},
    mint,
};

/// Handles on one target.
#[derive(Debug, Default)]
pub struct Handles {
    gizmo: Gizmo,
    target: Option<Target>,
    pivot: Vec3,
    rotation: DQuat,
    active: bool,
}

/// What the mouse does to the handles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mouse {
    /// Cursor, points.
    pub at: egui::Pos2,
    /// Whether nothing else is under it.
    pub hovered: bool,
    /// Whether the primary button went down this frame.
    pub pressed: bool,
    /// Whether it is down.
    pub down: bool,
}

impl Handles {
    /// Whether the cursor is on a handle, or holds one.
    pub fn wants_mouse(&self) -> bool {
        self.active || self.gizmo.is_focused()
    }

    /// Whether a handle is held.
    pub fn is_active(&self) -> bool {
        self.active
    }

    /// Puts the handles on a target whose turning point is `pivot`, and answers with its new
    /// placement when one is dragged.
    pub fn update(
        &mut self,
        screen: &Screen,
        target: Target,
        placement: Affine3A,
        pivot: Vec3,
        mouse: Mouse,
    ) -> Option<Affine3A> {
        if self.target != Some(target) {
            *self = Self { target: Some(target), rotation: DQuat::IDENTITY, ..Self::default() };
        }
        if !self.active {
            self.pivot = pivot;
            self.rotation = DQuat::IDENTITY;
        }
        self.gizmo.update_config(config(screen));
        let before = Transform::from_scale_rotation_translation(
            vector(DVec3::ONE),
            quaternion(self.rotation),
            vector(self.pivot.as_dvec3()),
        );
        let interaction = GizmoInteraction {
            cursor_pos: (mouse.at.x, mouse.at.y),
            hovered: mouse.hovered,
            drag_started: mouse.pressed && mouse.hovered,
            dragging: mouse.down,
        };
        let result = self.gizmo.update(interaction, &[before]);
        self.active = result.is_some();
        let (_, after) = result?;
        let after = after.first()?;
        let (t, r) = (after.translation, after.rotation);
        let pivot = DVec3::new(t.x, t.y, t.z).as_vec3();
        let rotation = DQuat::from_xyzw(r.v.x, r.v.y, r.v.z, r.s);
        let change = (rotation * self.rotation.inverse()).as_quat();
        let moved = moved(placement, self.pivot, pivot, change);
        self.pivot = pivot;
        self.rotation = rotation;
        (moved.is_finite() && moved != placement).then_some(moved)
    }

    /// Paints the handles.
    pub fn paint(&self, painter: &egui::Painter) {
        let data = self.gizmo.draw();
        let mut mesh = Mesh::default();
        for (at, colour) in data.vertices.iter().zip(&data.colors) {
            let [r, g, b, a] = *colour;
            let color = egui::Rgba::from_rgba_premultiplied(r, g, b, a).into();
            mesh.vertices.push(Vertex { pos: egui::Pos2::new(at[0], at[1]), uv: WHITE_UV, color });
        }
        mesh.indices = data.indices;
        painter.add(egui::Shape::mesh(mesh));
    }
}

/// Placement after its pivot moved and turned.
fn moved(placement: Affine3A, from: Vec3, to: Vec3, turn: Quat) -> Affine3A {
    if turn.angle_between(Quat::IDENTITY) < 1e-7 {
        let mut moved = placement;
        moved.translation += glam::Vec3A::from(to - from);
        return moved;
    }
    Affine3A::from_translation(to)
        * Affine3A::from_quat(turn.normalize())
        * Affine3A::from_translation(-from)
        * placement
}

fn config(screen: &Screen) -> GizmoConfig {
    let camera = &screen.camera;
    let focal = 1.0 / f64::from((0.5 * camera.vertical_fov).tan());
    let (near, far) = (0.01, 1000.0);
    let projection = DMat4::from_cols_array(&[
        focal / f64::from(screen.aspect()),
        0.0,
        0.0,
        0.0,
        0.0,
        focal,
        0.0,
        0.0,
        0.0,
        0.0,
        (far + near) / (near - far),
        -1.0,
        0.0,
        0.0,
        2.0 * far * near / (near - far),
        0.0,
    ]);
    let corner = |p: egui::Pos2| Pos2::new(p.x, p.y);
    GizmoConfig {
        view_matrix: matrix(camera.view_from_world().as_dmat4()),
        projection_matrix: matrix(projection),
        viewport: transform_gizmo::Rect::from_min_max(corner(screen.rect.min), corner(screen.rect.max)),
        modes: GizmoMode::TranslateX
            | GizmoMode::TranslateY
            | GizmoMode::TranslateZ
            | GizmoMode::TranslateXZ
            | GizmoMode::RotateY,
        visuals: GizmoVisuals {
            x_color: transform_gizmo::Color32::from_rgb(232, 84, 88),
            y_color: transform_gizmo::Color32::from_rgb(118, 190, 76),
            z_color: transform_gizmo::Color32::from_rgb(76, 142, 240),
            stroke_width: 3.0,
            gizmo_size: 64.0,
            ..GizmoVisuals::default()
        },
        ..GizmoConfig::default()
    }
}

fn vector(v: DVec3) -> mint::Vector3<f64> {
    v.to_array().into()
}

fn quaternion(q: DQuat) -> mint::Quaternion<f64> {
    mint::Quaternion { v: [q.x, q.y, q.z].into(), s: q.w }
}

fn matrix(m: DMat4) -> mint::RowMatrix4<f64> {
    m.transpose().to_cols_array_2d().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Pos2, Rect};
    use lumenscope_core::scene::camera::Camera;

    #[test]
    fn dragging_the_x_arrow_moves_along_x_alone() {
        let screen = Screen {
            rect: Rect::from_min_size(Pos2::ZERO, egui::vec2(800.0, 600.0)),
            camera: Camera { eye: Vec3::new(1.0, 1.5, 4.0), target: Vec3::ZERO, ..Camera::default() },
        };
        let pivot = Vec3::new(0.1, 0.2, 0.0);
        let placement = Affine3A::from_scale(Vec3::splat(2.0));
        let mut handles = Handles::default();
        let (centre, depth) = screen.project(pivot).unwrap();
        let arrow = pivot + Vec3::X * (45.0 / screen.points_per_metre(depth));
        let (start, _) = screen.project(arrow).unwrap();
        assert!(start.x > centre.x);
        let target = Target::Object(3);
        let mouse = |at: Pos2, pressed: bool, down: bool| Mouse { at, hovered: true, pressed, down };
        handles.update(&screen, target, placement, pivot, mouse(start, false, false));
        assert!(handles.wants_mouse(), "no handle under the arrow");
        handles.update(&screen, target, placement, pivot, mouse(start, true, true));
        let (end, _) = screen.project(arrow + Vec3::X * 0.5).unwrap();
        let moved = handles.update(&screen, target, placement, pivot, mouse(end, false, true)).unwrap();
        let step = Vec3::from(moved.translation - placement.translation);
        assert!((step - Vec3::new(0.5, 0.0, 0.0)).length() < 0.02, "{step}");
        assert_eq!(moved.matrix3, placement.matrix3);
        handles.update(&screen, target, moved, pivot, mouse(end, false, false));
        assert!(!handles.is_active());
    }

    #[test]
    fn turning_leaves_the_pivot_in_place() {
        let pivot = Vec3::new(3.0, 1.0, -2.0);
        let turned = moved(Affine3A::IDENTITY, pivot, pivot, Quat::from_rotation_y(0.7));
        assert!((turned.transform_point3(pivot) - pivot).length() < 1e-5);
        assert!((turned.transform_vector3(Vec3::X) - Quat::from_rotation_y(0.7) * Vec3::X).length() < 1e-6);
    }
}
