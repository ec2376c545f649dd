//! Between the picture on screen and the scene: pixels to rays, points to pixels.

use egui::{Pos2, Rect};
use glam::{Vec2, Vec3};
use lumenscope_core::scene::{accel::Ray, camera::Camera};

/// A camera and the rectangle it fills, in egui points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Rectangle of the picture, points.
    pub rect: Rect,
    /// Camera of the picture.
    pub camera: Camera,
}

impl Screen {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        (self.rect.width() / self.rect.height().max(1.0)).max(1e-3)
    }

    /// Ray from the eye through a point of the screen; its direction is a unit vector.
    pub fn ray(&self, at: Pos2) -> Ray {
        let uv = (at - self.rect.min) / self.rect.size().max(egui::Vec2::splat(1.0));
        Ray::new(self.camera.eye, self.camera.ray_direction(Vec2::new(uv.x, uv.y), self.aspect()))
    }

    /// Where a point of the scene is on screen, and its depth along the view, m; `None` behind the eye.
    pub fn project(&self, point: Vec3) -> Option<(Pos2, f32)> {
        let seen = self.camera.view_from_world().transform_point3(point);
        let depth = -seen.z;
        if depth.is_nan() || depth <= 1e-4 {
            return None;
        }
        let scale = self.points_per_metre(depth);
        let centre = self.rect.center();
        Some((Pos2::new(centre.x + seen.x * scale, centre.y - seen.y * scale), depth))
    }

    /// Points on screen that one metre takes at a depth.
    pub fn points_per_metre(&self, depth: f32) -> f32 {
        0.5 * self.rect.height() / ((0.5 * self.camera.vertical_fov).tan() * depth).max(1e-6)
    }

    /// Both ends of a segment on screen, cut at the eye's plane; `None` if all of it is behind.
    pub fn segment(&self, a: Vec3, b: Vec3) -> Option<[Pos2; 2]> {
        let forward = (self.camera.target - self.camera.eye).normalize_or(Vec3::NEG_Z);
        let (da, db) = ((a - self.camera.eye).dot(forward), (b - self.camera.eye).dot(forward));
        const NEAR: f32 = 1e-2;
        let cut = |from: Vec3, to: Vec3, d0: f32, d1: f32| {
            if d0 < NEAR { from.lerp(to, (NEAR - d0) / (d1 - d0)) } else { from }
        };
        if da < NEAR && db < NEAR {
            return None;
        }
        Some([self.project(cut(a, b, da, db))?.0, self.project(cut(b, a, db, da))?.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_projected_point_lies_on_the_ray_through_its_pixel() {
        let screen = Screen {
            rect: Rect::from_min_size(Pos2::new(20.0, 40.0), egui::vec2(640.0, 360.0)),
            camera: Camera::default(),
        };
        for point in [Vec3::ZERO, Vec3::new(1.0, 2.0, -1.0), Vec3::new(-0.7, 0.3, 2.0)] {
            let (at, depth) = screen.project(point).unwrap();
            let ray = screen.ray(at);
            let along = (point - ray.origin).dot(ray.direction);
            // f32 over a few metres and hundreds of pixels.
            assert!((ray.origin + ray.direction * along - point).length() < 1e-4, "{point}");
            assert!(depth > 0.0 && depth <= along + 1e-4);
        }
        assert!(screen.project(Vec3::new(0.0, 1.0, 9.0)).is_none());
    }
}
