//! Camera control as plain functions of a camera: orbit, pan, dolly, fly, frame.

use glam::{Quat, Vec3};
use lumenscope_core::scene::camera::Camera;
use std::f32::consts::FRAC_PI_2;

/// Nearest a camera comes to its target, m.
const CLOSEST: f32 = 0.02;

/// Right, up and forward of a camera's picture.
pub fn axes(camera: &Camera) -> [Vec3; 3] {
    let forward = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
    let right = forward.cross(camera.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
    [right, right.cross(forward), forward]
}

/// Turns the eye about the target by angles to the right and down, rad, never over the pole.
pub fn orbit(camera: Camera, right: f32, down: f32) -> Camera {
    let arm = camera.eye - camera.target;
    let turned = turn(arm, camera.up, -right, down);
    Camera { eye: camera.target + turned, ..camera }
}

/// Turns the view about the eye by angles to the right and down, rad, never over the pole.
pub fn look(camera: Camera, right: f32, down: f32) -> Camera {
    let arm = camera.target - camera.eye;
    let turned = turn(arm, camera.up, -right, -down);
    Camera { target: camera.eye + turned, ..camera }
}

fn turn(arm: Vec3, up: Vec3, azimuth: f32, rise: f32) -> Vec3 {
    let up = up.normalize_or(Vec3::Y);
    let length = arm.length().max(CLOSEST);
    let height = (arm.dot(up) / length).clamp(-1.0, 1.0).asin();
    let level = (arm - up * arm.dot(up)).try_normalize().unwrap_or_else(|| up.any_orthonormal_vector());
    let limit = FRAC_PI_2 - 0.01;
    let (sin, cos) = (height + rise).clamp(-limit, limit).sin_cos();
    let level = Quat::from_axis_angle(up, azimuth) * level;
    (level * cos + up * sin) * length
}

/// Moves eye and target sideways by metres to the right and up.
pub fn pan(camera: Camera, right: f32, up: f32) -> Camera {
    let [x, y, _] = axes(&camera);
    shifted(camera, x * right + y * up)
}

/// Moves eye and target along the camera's right, up and forward, m.
pub fn fly(camera: Camera, step: Vec3) -> Camera {
    let [x, y, z] = axes(&camera);
    shifted(camera, x * step.x + y * step.y + z * step.z)
}

fn shifted(camera: Camera, by: Vec3) -> Camera {
    Camera { eye: camera.eye + by, target: camera.target + by, ..camera }
}

/// Scales the view about a point that keeps its place on screen; `factor` below 1 comes closer.
pub fn dolly(camera: Camera, about: Vec3, factor: f32) -> Camera {
    let factor = factor.clamp(0.2, 5.0);
    let distance = (camera.eye - camera.target).length();
    let least = if factor < 1.0 { (CLOSEST / distance.max(1e-6)).min(1.0) } else { 0.0 };
    let factor = factor.max(least);
    Camera {
        eye: about + (camera.eye - about) * factor,
        target: about + (camera.target - about) * factor,
        ..camera
    }
}

/// Looks from the same side at a box so that all of it is seen.
pub fn frame(camera: Camera, low: Vec3, high: Vec3, aspect: f32) -> Camera {
    let [_, _, forward] = axes(&camera);
    let radius = (0.5 * (high - low).length()).max(0.05);
    let half = (0.5 * camera.vertical_fov).min((0.5 * camera.vertical_fov).tan().mul_add(aspect, 0.0).atan());
    let target = 0.5 * (low + high);
    Camera { target, eye: target - forward * (radius / half.sin().max(0.05)), ..camera }
}

/// Looks at the same target along an axis, from `side`.
pub fn from_side(camera: Camera, side: Vec3) -> Camera {
    let distance = (camera.eye - camera.target).length().max(CLOSEST);
    let arm = turn(side * distance, camera.up, 0.0, 0.0);
    Camera { eye: camera.target + arm, ..camera }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-4 * b.abs().max(1.0)
    }

    #[test]
    fn orbit_keeps_the_distance_and_stops_at_the_pole() {
        let camera = Camera::default();
        let mut turned = camera;
        for _ in 0..200 {
            turned = orbit(turned, 0.1, 0.1);
            assert!(close(turned.eye.distance(turned.target), camera.eye.distance(camera.target)));
            assert!(turned.eye.is_finite());
        }
        assert!(turned.eye.y > turned.target.y);
        assert_eq!(turned.target, camera.target);
    }

    #[test]
    fn orbit_to_the_right_moves_the_eye_to_the_left() {
        let turned = orbit(Camera::default(), 0.3, 0.0);
        assert!(turned.eye.x < 0.0 && close(turned.eye.y, Camera::default().eye.y));
    }

    #[test]
    fn dolly_keeps_its_point_in_place_and_never_passes_the_target() {
        let camera = Camera::default();
        let about = Vec3::new(1.0, 0.5, -1.0);
        let nearer = dolly(camera, about, 0.5);
        let before = (about - camera.eye).normalize();
        let after = (about - nearer.eye).normalize();
        assert!(before.distance(after) < 1e-5);
        let mut close_up = camera;
        for _ in 0..500 {
            close_up = dolly(close_up, close_up.target, 0.5);
        }
        assert!(close_up.eye.distance(close_up.target) >= CLOSEST * 0.99);
    }

    #[test]
    fn framing_puts_every_corner_inside_the_picture() {
        let (low, high) = (Vec3::new(-3.0, 0.0, -2.0), Vec3::new(1.0, 2.5, 4.0));
        for aspect in [0.4, 1.0, 2.4] {
            let camera = frame(Camera::default(), low, high, aspect);
            let clip = camera.clip_from_view(aspect, 0.01, 1000.0) * camera.view_from_world();
            for i in 0..8 {
                let pick = |bit: usize, a: f32, b: f32| if i >> bit & 1 == 0 { a } else { b };
                let corner =
                    Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
                let ndc = clip.project_point3(corner);
                assert!(ndc.x.abs() <= 1.0 && ndc.y.abs() <= 1.0, "aspect {aspect}: {ndc}");
            }
        }
    }

    #[test]
    fn looking_straight_down_stays_finite() {
        let above = from_side(Camera::default(), Vec3::Y);
        assert!(above.eye.is_finite() && above.eye.y > above.target.y + 1.0);
        assert!(axes(&above).iter().all(|a| a.is_finite() && close(a.length(), 1.0)));
    }
}
