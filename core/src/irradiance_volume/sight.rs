//! Who sees what of a cell, remembered leaf by leaf.
//!
//! A cell is cut into 8³ leaves. What samples see of a leaf that nothing stands in is found at its middle by the
//! first query that comes there, and holds for all its points: where a sample comes into sight is known to
//! half a leaf. A leaf in which triangles of up to three planes stand is cut along those planes first, so
//! that nothing is ever taken from behind a thin wall; one with more planes is cut into 4³ smaller ones. Only what
//! has more planes still, and points on a plane, are asked by rays each time.
//!
//! What is remembered depends on the leaf alone, not on the query that came first.

use super::overlap::triangle_meets_box;
use glam::{UVec3, Vec3, Vec4};
use std::sync::atomic::{AtomicU32, Ordering};

/// Leaves along each edge of a cell, and smaller ones along each edge of a leaf.
const LEAVES: [u32; 2] = [8, 4];
/// Planes that a leaf is cut along at most.
const PLANES: usize = 3;
/// Places along each edge of a leaf, one of which speaks for each side: more where a side is thin.
const PLACES: [u32; 2] = [4, 16];
/// Share of a leaf's shortest edge: nearer to a plane than this, a point lies on it.
const THIN: f32 = 1e-3;

/// Everything is far in front of it.
const NO_PLANE: Vec4 = Vec4::new(0.0, 0.0, 0.0, f32::INFINITY);

/// What is known of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Look {
    /// Samples of the cell that see it, a bit each.
    Samples(u8),
    /// No usable sample of the cell sees it; this one around does.
    Lender(u32),
    /// No sample around sees it.
    Nothing,
    /// Nothing: rays must tell.
    Ask,
}

const UNKNOWN: u32 = 0;
const SAMPLES: u32 = 1 << 30;
const LENDER: u32 = 2 << 30;
const NOTHING: u32 = 3 << 30;
const ASK: u32 = NOTHING + 1;
/// The number of a cut follows.
const CUT: u32 = NOTHING + 2;
/// The number of a finer part follows.
const FINER: u32 = NOTHING + (1 << 29);

impl Look {
    fn code(self) -> u32 {
        match self {
            Self::Samples(bits) => SAMPLES | u32::from(bits),
            Self::Lender(sample) => LENDER | sample,
            Self::Nothing => NOTHING,
            Self::Ask => ASK,
        }
    }

    fn of(code: u32) -> Self {
        match code & NOTHING {
            SAMPLES => Self::Samples(code as u8),
            LENDER => Self::Lender(code & !NOTHING),
            _ if code == NOTHING => Self::Nothing,
            _ => Self::Ask,
        }
    }
}

/// A leaf cut along planes.
struct Cut {
    /// Unit normal and offset of each; the last may be [`NO_PLANE`].
    planes: [Vec4; PLANES],
    /// Code of each side, or [`UNKNOWN`].
    sides: [AtomicU32; 1 << PLANES],
}

/// Where is remembered what is known of a point.
struct Slot<'a> {
    part: &'a Sight,
    leaf: Vec3,
    /// Of which `code` is a side.
    cut: Option<&'a Cut>,
    code: &'a AtomicU32,
}

/// What is known of a cell, or of a leaf of it.
pub(super) struct Sight {
    low: Vec3,
    /// Leaves along each edge.
    count: u32,
    /// Leaves a metre.
    scale: Vec3,
    /// Nearer to a plane than this a point lies on it, m.
    thin: f32,
    /// Code of each leaf, x fastest: of what is seen, [`UNKNOWN`], or [`CUT`] or [`FINER`] with a number.
    leaves: Box<[AtomicU32]>,
    cuts: Vec<Cut>,
    finer: Vec<Sight>,
}

/// What stands in a leaf.
#[derive(Clone, Default)]
struct Leaf {
    planes: Vec<Vec4>,
    /// Numbers of its triangles.
    triangles: Vec<u32>,
}

impl Sight {
    /// Of a cell's box that `triangles` meet.
    pub fn new(bounds: [Vec3; 2], triangles: &[[Vec3; 3]]) -> Self {
        Self::of_depth(bounds, triangles, 0)
    }

    fn of_depth([low, high]: [Vec3; 2], triangles: &[[Vec3; 3]], depth: usize) -> Self {
        let count = LEAVES[depth];
        let step = (high - low) / count as f32;
        let corner = |leaf: u32| low + place(leaf, count) * step;
        let mut cuts = Vec::new();
        let mut finer = Vec::new();
        let leaves = filled(low, step, count, triangles).into_iter().zip(0..).map(|(leaf, number)| {
            AtomicU32::new(match leaf.planes[..] {
                [] => UNKNOWN,
                [a] => cut(&mut cuts, [a, NO_PLANE, NO_PLANE]),
                [a, b] => cut(&mut cuts, [a, b, NO_PLANE]),
                [a, b, c] => cut(&mut cuts, [a, b, c]),
                _ if depth + 1 < LEAVES.len() => {
                    let triangles: Vec<_> = leaf.triangles.iter().map(|&t| triangles[t as usize]).collect();
                    let bounds = [corner(number), corner(number) + step];
                    finer.push(Self::of_depth(bounds, &triangles, depth + 1));
                    FINER + (finer.len() - 1) as u32
                }
                _ => ASK,
            })
        });
        let leaves = leaves.collect();
        Self { low, count, scale: step.recip(), thin: THIN * step.min_element(), leaves, cuts, finer }
    }

    /// What is known of a point; `find` tells what holds at a place of a leaf that nobody asked of before.
    pub fn look(&self, point: Vec3, find: impl Fn(Vec3) -> Look) -> Look {
        let Some(Slot { part, leaf, cut, code }) = self.slot(point) else { return Look::Ask };
        match code.load(Ordering::Relaxed) {
            UNKNOWN => {
                let place = match cut {
                    Some(cut) => part.place(leaf, &cut.planes, point),
                    None => Some(part.low + (leaf + 0.5) / part.scale),
                };
                remember(code, place.map_or(Look::Ask, find))
            }
            code => Look::of(code),
        }
    }

    /// What was found before of a point, if anything was.
    #[inline(always)]
    pub fn known(&self, point: Vec3) -> Look {
        self.slot(point).map_or(Look::Ask, |slot| Look::of(slot.code.load(Ordering::Relaxed)))
    }

    /// Where is remembered what is known of a point; nowhere for one on a plane.
    #[inline(always)]
    fn slot(&self, point: Vec3) -> Option<Slot<'_>> {
        let mut part = self;
        loop {
            let leaf = part.leaf(point);
            let code = &part.leaves[number(leaf, part.count)];
            let found = code.load(Ordering::Relaxed);
            if found < CUT {
                return Some(Slot { part, leaf, cut: None, code });
            }
            if found < FINER {
                let cut = &part.cuts[(found - CUT) as usize];
                let away = cut.planes.map(|p| distance(p, point));
                let side = side(away);
                let on = away.iter().any(|d| d.abs() <= part.thin);
                return (!on).then_some(Slot { part, leaf, cut: Some(cut), code: &cut.sides[side] });
            }
            part = &part.finer[(found - FINER) as usize];
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.cuts[..])
            + self.finer.iter().map(Self::bytes).sum::<usize>()
    }

    /// Place of the leaf that holds a point, or the nearest one.
    #[inline(always)]
    fn leaf(&self, point: Vec3) -> Vec3 {
        let last = Vec3::splat(self.count as f32 - 1.0);
        ((point - self.low) * self.scale).floor().clamp(Vec3::ZERO, last)
    }

    /// The place of a leaf that is farthest from its planes on the side of a point; `None` where a side is too
    /// thin to have one.
    fn place(&self, leaf: Vec3, planes: &[Vec4; PLANES], point: Vec3) -> Option<Vec3> {
        let side_of = |p: Vec3| side(planes.map(|k| distance(k, p)));
        let wanted = side_of(point);
        let free = |p: Vec3| planes.iter().map(|k| distance(*k, p).abs()).fold(f32::INFINITY, f32::min);
        PLACES.into_iter().find_map(|count| {
            let at = |i: u32| self.low + (leaf + (place(i, count) + 0.5) / count as f32) / self.scale;
            let places = (0..count.pow(3)).map(at).filter(|p| side_of(*p) == wanted);
            places.max_by(|a, b| free(*a).total_cmp(&free(*b)))
        })
    }
}

fn cut(cuts: &mut Vec<Cut>, planes: [Vec4; PLANES]) -> u32 {
    cuts.push(Cut { planes, sides: Default::default() });
    CUT + (cuts.len() - 1) as u32
}

fn remember(slot: &AtomicU32, look: Look) -> Look {
    slot.store(look.code(), Ordering::Relaxed);
    look
}

/// What stands in each of the leaves of a box.
fn filled(low: Vec3, step: Vec3, count: u32, triangles: &[[Vec3; 3]]) -> Vec<Leaf> {
    let thin = THIN * step.min_element();
    let mut leaves = vec![Leaf::default(); count.pow(3) as usize];
    for (triangle, i) in triangles.iter().zip(0..) {
        let [a, b, c] = *triangle;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let plane = normal.extend(-normal.dot(a));
        let leaf_at = |p: Vec3| ((p - low) / step).max(Vec3::ZERO).as_uvec3().min(UVec3::splat(count - 1));
        let (first, last) = (leaf_at(a.min(b).min(c)), leaf_at(a.max(b).max(c)));
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let at = UVec3::new(x, y, z).as_vec3();
                    if !triangle_meets_box(*triangle, low + (at + 0.5) * step, 0.5 * step) {
                        continue;
                    }
                    let leaf = &mut leaves[number(at, count)];
                    leaf.triangles.push(i);
                    let in_plane = |k: &Vec4| triangle.iter().all(|p| distance(*k, *p).abs() <= thin);
                    if leaf.planes.len() <= PLANES && !leaf.planes.iter().any(in_plane) {
                        leaf.planes.push(plane);
                    }
                }
            }
        }
    }
    leaves
}

#[inline(always)]
fn number(at: Vec3, count: u32) -> usize {
    let [x, y, z] = at.to_array().map(|v| v as u32);
    ((z * count + y) * count + x) as usize
}

fn place(number: u32, count: u32) -> Vec3 {
    UVec3::new(number % count, number / count % count, number / count.pow(2)).as_vec3()
}

#[inline(always)]
fn distance(plane: Vec4, point: Vec3) -> f32 {
    plane.dot(point.extend(1.0))
}

/// On which side of each plane, of the distances from them.
#[inline(always)]
fn side(away: [f32; PLANES]) -> usize {
    away.into_iter().enumerate().fold(0, |s, (i, d)| s | usize::from(d > 0.0) << i)
}
