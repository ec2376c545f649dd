//! Which samples stand for a mirrored view (Bastos 1999, §6.6.2).

use super::{sample::ImageWithDepth, sets::ReflectorImages};
use glam::Vec3;

/// What makes a sample near.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// The angle between the directions in which it and the mirrored eye see the element's middle.
    #[default]
    Angle,
    /// The distance between its centre of projection and the mirrored eye.
    Distance,
}

impl Selection {
    /// Smaller is nearer: minus the cosine of the angle, or the distance in m.
    fn measure(self, image: &ImageWithDepth, eye: Vec3) -> f32 {
        match self {
            Self::Angle => {
                let towards = |from: Vec3| (image.middle() - from).normalize_or_zero();
                -towards(image.eye).dot(towards(eye))
            }
            Self::Distance => image.eye.distance(eye),
        }
    }

    /// The numbers of the `count` nearest samples of each element, nearest first; equal ones in their order.
    pub fn nearest(self, images: &ReflectorImages, eye: Vec3, count: usize) -> Vec<usize> {
        let mut chosen = Vec::new();
        let mut first = 0;
        for element in &images.elements {
            let mut order: Vec<usize> = (0..element.len()).collect();
            order.sort_by(|&a, &b| self.measure(&element[a], eye).total_cmp(&self.measure(&element[b], eye)));
            chosen.extend(order.into_iter().take(count).map(|i| first + i));
            first += element.len();
        }
        chosen
    }
}
