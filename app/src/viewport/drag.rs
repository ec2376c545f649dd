//! Dragging an object or lamp with the cursor: along the horizontal plane through the grabbed point,
//! or up and down.

use glam::{Affine3A, Vec3};
use lumenscope_core::scene::{Target, accel::Ray};

/// Farthest from the eye that a drag takes a point, m, as a multiple of the distance it was grabbed at.
const REACH: f32 = 8.0;

/// A drag in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// What is dragged.
    pub target: Target,
    /// Where it now is.
    pub placement: Affine3A,
    /// The grabbed point, which moves along.
    grabbed: Vec3,
    vertical: bool,
    /// Offset between where the cursor's ray met the plane and the grabbed point.
    slip: Vec3,
    reach: f32,
}

impl Drag {
    /// Grabs a target at a point under the cursor.
    pub fn new(target: Target, placement: Affine3A, grabbed: Vec3, ray: &Ray) -> Self {
        let reach = REACH * (grabbed - ray.origin).length().max(0.1);
        Self { target, placement, grabbed, vertical: false, slip: Vec3::ZERO, reach }
    }

    /// Follows the cursor; true if the target moved.
    pub fn follow(&mut self, ray: &Ray, vertical: bool) -> bool {
        if vertical != self.vertical {
            self.vertical = vertical;
            self.slip = self.meet(ray).map_or(Vec3::ZERO, |met| self.grabbed - met);
            return false;
        }
        let Some(met) = self.meet(ray) else { return false };
        let wanted = met + self.slip;
        let step = if vertical {
            Vec3::Y * (wanted.y - self.grabbed.y)
        } else {
            Vec3::new(wanted.x - self.grabbed.x, 0.0, wanted.z - self.grabbed.z)
        };
        if !step.is_finite() || step.length_squared() < 1e-10 {
            return false;
        }
        self.grabbed += step;
        self.placement.translation += glam::Vec3A::from(step);
        true
    }

    /// Where the cursor's ray meets the plane of the drag.
    fn meet(&self, ray: &Ray) -> Option<Vec3> {
        let normal = if self.vertical {
            let level = Vec3::new(ray.direction.x, 0.0, ray.direction.z);
            level.try_normalize()?
        } else {
            Vec3::Y
        };
        let t = (self.grabbed - ray.origin).dot(normal) / ray.direction.dot(normal);
        (t.is_finite() && t > 0.0 && t < self.reach).then(|| ray.origin + ray.direction * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_keeps_the_grabbed_point_under_the_cursor() {
        let eye = Vec3::new(0.0, 2.0, 4.0);
        let start = Vec3::new(0.2, 0.5, 0.0);
        let mut drag = Drag::new(Target::Object(0), Affine3A::IDENTITY, start, &Ray::new(eye, start - eye));
        let goal = Vec3::new(-0.7, 0.5, 1.0);
        assert!(drag.follow(&Ray::new(eye, (goal - eye).normalize()), false));
        assert!((drag.grabbed - goal).length() < 1e-5);
        assert!((Vec3::from(drag.placement.translation) - (goal - start)).length() < 1e-5);
    }

    #[test]
    fn shift_lifts_without_a_jump() {
        let eye = Vec3::new(0.0, 2.0, 4.0);
        let start = Vec3::new(0.0, 0.5, 0.0);
        let mut drag = Drag::new(Target::Lamp(0), Affine3A::IDENTITY, start, &Ray::new(eye, start - eye));
        let ray = |to: Vec3| Ray::new(eye, (to - eye).normalize());
        assert!(!drag.follow(&ray(start), true));
        assert!(drag.follow(&ray(start + Vec3::Y), true));
        assert!((drag.grabbed - (start + Vec3::Y)).length() < 1e-5);
        assert!(!drag.follow(&ray(start + Vec3::Y), false), "letting go of shift moved it");
    }

    #[test]
    fn a_ray_above_the_horizon_moves_nothing() {
        let eye = Vec3::new(0.0, 2.0, 4.0);
        let mut drag = Drag::new(Target::Lamp(0), Affine3A::IDENTITY, Vec3::ZERO, &Ray::new(eye, -eye));
        assert!(!drag.follow(&Ray::new(eye, Vec3::new(0.0, 0.1, -1.0)), false));
        assert!(!drag.follow(&Ray::new(eye, Vec3::new(0.0, -1e-6, -1.0)), false));
    }
}
