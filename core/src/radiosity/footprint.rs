//! The area an element stands for: how large it is, what it reflects, and points spread over it.

use super::{
    lookup::{SideMap, blend},
    subdivide::Between,
    surface_map::{FOOTPRINT, SurfaceMap},
};
use crate::scene::{direct::Receiver, geometry::Geometry};
use glam::{Vec2, Vec3};

impl SurfaceMap {
    /// Areas, mean reflectances and footprints, by points spread over every triangle. What lies `between`
    /// corners of leaves counts to them.
    pub(super) fn weigh(&mut self, geometry: &Geometry, between: &[Between]) {
        let mut lent = vec![u32::MAX; if between.is_empty() { 0 } else { self.elements.len() }];
        for (i, b) in between.iter().enumerate() {
            lent[b.element as usize] = i as u32;
        }
        for element in &mut self.elements {
            element.area = 0.0;
        }
        let mut weighted = vec![Vec3::ZERO; self.elements.len()];
        let mut points: Vec<Receiver> = Vec::new();
        let mut shares: Vec<(u32, f32, u32)> = Vec::new();
        let mut counts = vec![0u32; self.elements.len() + 1];
        for t in 0..geometry.len() as u32 {
            let area = 0.5 * geometry.area_normal(t).length();
            let textured = geometry.material_of(t).reflectance_texture.is_some();
            let taps = if textured { 4.0 } else { 3.0 };
            let barycentric = triangle_points(edges_in_nodes(&self.sides[2 * t as usize]).map(|e| taps * e));
            for back in [false, true] {
                let side = self.sides[2 * t as usize + usize::from(back)];
                if side == SideMap::NONE {
                    continue;
                }
                let share = area / barycentric.len() as f32;
                let towards = geometry.area_normal(t) * if back { 1.0 } else { -1.0 };
                for &barycentric in &barycentric {
                    let surface = geometry.surface(t, barycentric, towards);
                    let reflectance = geometry.material_of(t).diffuse_at(surface.uv, &geometry.textures);
                    let blend = blend(&side, barycentric);
                    let mut add = |element: u32, weight: f32| {
                        self.elements[element as usize].area += share * weight;
                        weighted[element as usize] += reflectance * (share * weight);
                        counts[element as usize + 1] += 1;
                        shares.push((element, share * weight, points.len() as u32));
                    };
                    for (&element, &weight) in blend.elements.iter().zip(&blend.weights) {
                        match lent.get(element as usize) {
                            _ if weight <= 0.0 => {}
                            None | Some(&u32::MAX) => add(element, weight),
                            Some(&lent) => {
                                let b = &between[lent as usize];
                                b.corners.iter().zip(&b.weights).for_each(|(c, w)| add(*c, weight * w));
                            }
                        }
                    }
                    points.push(Receiver {
                        position: surface.position,
                        normal: surface.normal,
                        geometric_normal: surface.geometric_normal,
                    });
                }
            }
        }
        for (element, sum) in self.elements.iter_mut().zip(weighted) {
            element.reflectance = if element.area > 0.0 { sum / element.area } else { Vec3::ZERO };
        }
        self.footprints = self
            .elements
            .iter()
            .flat_map(|e| {
                let own =
                    Receiver { position: e.position, normal: e.normal, geometric_normal: e.geometric_normal };
                [own; FOOTPRINT]
            })
            .collect();
        // A counting sort by element; points keep the order of their triangles.
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut places = counts.clone();
        let mut sorted = vec![(0.0f32, 0u32); shares.len()];
        for (element, share, point) in shares {
            let place = &mut places[element as usize];
            sorted[*place as usize] = (share, point);
            *place += 1;
        }
        for (element, range) in counts.windows(2).enumerate() {
            let of_one = &sorted[range[0] as usize..range[1] as usize];
            let step = of_one.iter().map(|(share, _)| share).sum::<f32>() / FOOTPRINT as f32;
            let (mut passed, mut k) = (0.0, 0);
            for &(share, point) in of_one {
                passed += share;
                while k < FOOTPRINT && passed >= (k as f32 + 0.5) * step {
                    self.footprints[element * FOOTPRINT + k] = points[point as usize];
                    k += 1;
                }
            }
        }
    }
}

/// Edges of a triangle opposite to corners 0, 1 and 2, in grid steps; 1 for vertex elements.
fn edges_in_nodes(side: &SideMap) -> [f32; 3] {
    if side.size == 0 {
        return [1.0; 3];
    }
    let corner =
        |i: usize| Vec2::new(f32::from_bits(side.corners[2 * i]), f32::from_bits(side.corners[2 * i + 1]));
    [(1, 2), (2, 0), (0, 1)].map(|(i, k)| (corner(i) - corner(k)).abs().max_element())
}

/// Points that stand for equal shares of a triangle's area, as barycentric weights of corners 1 and 2;
/// `taps` wanted along the edges opposite to corners 0, 1 and 2.
///
/// The centroids of the n² equal triangles it splits into; for a sliver, the middles of cells of a square
/// mapped onto it with equal areas, many along it and few across.
fn triangle_points(taps: [f32; 3]) -> Vec<Vec2> {
    const SLIVER: f32 = 4.0;
    let count = |taps: f32| taps.ceil().clamp(2.0, 512.0) as u32;
    let [a, b, c] = taps;
    let (shortest, longest) = (a.min(b).min(c), a.max(b).max(c));
    let n = count(longest);
    if longest > SLIVER * shortest && n > 2 {
        let across = count(shortest);
        let apex = [a, b, c].iter().position(|e| *e == shortest).unwrap_or(0);
        let point = |x: u32, y: u32| {
            let root = ((x as f32 + 0.5) / n as f32).sqrt();
            let next = root * (y as f32 + 0.5) / across as f32;
            let mut weights = [0.0; 3];
            weights[apex] = 1.0 - root;
            weights[(apex + 1) % 3] = root - next;
            weights[(apex + 2) % 3] = next;
            Vec2::new(weights[1], weights[2])
        };
        return (0..n).flat_map(|x| (0..across).map(move |y| point(x, y))).collect();
    }
    let step = 1.0 / n as f32;
    (0..n)
        .flat_map(|y| {
            (0..n - y).flat_map(move |x| {
                let corner = Vec2::new(x as f32, y as f32) * step;
                let upright = Some(corner + Vec2::splat(step / 3.0));
                let inverted = (x + y + 1 < n).then(|| corner + Vec2::splat(step * 2.0 / 3.0));
                upright.into_iter().chain(inverted)
            })
        })
        .collect()
}
