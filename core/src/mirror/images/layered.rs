//! A layered image: the points of many samples, each surface kept once (Bastos 1999, §6.8).

use super::sample::{ImageWithDepth, NOTHING, Point};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Share of the distance within which two points in one pixel are the same surface.
const SAME_SURFACE: f32 = 0.01;

/// Points of several samples as one of them sees them: several in a pixel where its ray crosses several surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredImage {
    /// The points.
    pub points: Vec<Point>,
    /// Points on surfaces before they were merged.
    pub merged_from: usize,
    /// Most points in one pixel.
    pub layers: usize,
}

impl LayeredImage {
    /// Merges samples of one element into the view of the first.
    ///
    /// A point is dropped where one of the same pixel stands for it already: of the same triangle, or nearly as far
    /// away. What falls outside the view is kept, each as it is.
    pub fn new(images: &[Arc<ImageWithDepth>]) -> Self {
        let mut layered = Self { points: Vec::new(), merged_from: 0, layers: 0 };
        let Some(view) = images.first() else { return layered };
        let mut pixels: Vec<Vec<(f32, u32)>> = vec![Vec::new(); view.triangle.len()];
        for point in images.iter().flat_map(|image| image.points()) {
            layered.merged_from += usize::from(point.triangle != NOTHING);
            if let Some((pixel, distance)) = seen_from(view, point.position) {
                let same = |&(d, triangle): &(f32, u32)| {
                    (d - distance).abs() <= SAME_SURFACE * distance || triangle == point.triangle
                };
                if pixels[pixel].iter().any(same) {
                    continue;
                }
                pixels[pixel].push((distance, point.triangle));
                layered.layers = layered.layers.max(pixels[pixel].len());
            }
            layered.points.push(point);
        }
        layered
    }

    /// Bytes of its points: position, sides' scale, colour and id.
    pub fn bytes(&self) -> usize {
        self.points.len() * (12 + 4 + 12 + 4)
    }
}

/// The pixel of a sample's view that a place falls into, and its distance, m.
fn seen_from(view: &ImageWithDepth, position: Vec3) -> Option<(usize, f32)> {
    let at = view.seen_at(position)?;
    let inside = at.cmpge(Vec2::ZERO).all() && at.cmplt(Vec2::splat(view.resolution as f32)).all();
    let pixel = || at.y as usize * view.resolution as usize + at.x as usize;
    inside.then(|| (pixel(), (position - view.eye).length()))
}
