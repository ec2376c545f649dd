//! The pinhole camera, and its rays.

use glam::{Mat4, Vec2, Vec3};

/// A pinhole camera looking at a point.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Camera {
    /// Eye, m.
    pub eye: Vec3,
    /// Point in the middle of the picture, m.
    pub target: Vec3,
    /// Direction that is up in the picture.
    pub up: Vec3,
    /// Vertical field of view, rad.
    pub vertical_fov: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: Vec3::new(0.0, 1.6, 4.0),
            target: Vec3::new(0.0, 1.0, 0.0),
            up: Vec3::Y,
            vertical_fov: 50f32.to_radians(),
        }
    }
}

impl Camera {
    /// View matrix, right-handed, −z forward.
    pub fn view_from_world(&self) -> Mat4 {
        glam::camera::rh::view::look_at_mat4(self.eye, self.target, self.safe_up())
    }

    /// Projection with depth in [0, 1], reversed never; `near` and `far` in m.
    pub fn clip_from_view(&self, aspect: f32, near: f32, far: f32) -> Mat4 {
        glam::camera::rh::proj::directx::perspective(self.vertical_fov, aspect, near, far)
    }

    /// Unit direction through picture position `uv` in [0, 1]², origin at the top left.
    pub fn ray_direction(&self, uv: Vec2, aspect: f32) -> Vec3 {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(self.safe_up()).normalize();
        let up = right.cross(forward);
        let half = (0.5 * self.vertical_fov).tan();
        (forward + right * ((2.0 * uv.x - 1.0) * half * aspect) + up * ((1.0 - 2.0 * uv.y) * half))
            .normalize()
    }

    fn safe_up(&self) -> Vec3 {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        if forward.cross(self.up).length_squared() > 1e-8 { self.up } else { Vec3::Z }
    }
}
