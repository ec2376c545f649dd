//! What can be wrong with a lightmap, and which of its texels it is wrong with.

use super::lightmap::{JudgedTexel, LightmapReport};
use crate::{
    math::{colour::srgb8, false_colour::FalseColour},
    scene::geometry::Geometry,
};
use glam::Vec3;
use std::collections::HashMap;

/// What can be wrong with a lightmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Covered by more than one triangle.
    Overlap,
    /// Infinite or not a number in the lightmap.
    NotFinite,
    /// Dark in ours, lit in the lightmap.
    Leak,
    /// Black in the lightmap, light in ours.
    Dark,
    /// The light jumps where a flat or smooth surface goes on.
    Seam,
    /// Mapped with a ratio of more than 4 between the directions.
    Stretched,
    /// Mapped with less than half or more than twice the median of texels a metre.
    Uneven,
}

/// Names of a texel without a fault and of the faults, by their [kinds](Fault::kind).
pub const KINDS: [&str; 8] =
    ["no fault", "overlap", "not finite", "leak", "dark", "seam", "stretched", "uneven"];

impl Fault {
    /// Every kind; of those that meet in a texel the first is shown.
    pub const ALL: [Self; 7] =
        [Self::Overlap, Self::NotFinite, Self::Leak, Self::Dark, Self::Seam, Self::Stretched, Self::Uneven];

    /// Its place in [`KINDS`].
    pub fn kind(self) -> usize {
        self as usize + 1
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        KINDS[self.kind()]
    }

    /// What it means.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Leak => {
                "Texels lit in the lightmap by more than a fifth of the mean where our light is dark"
            }
            Self::Dark => "Texels black in the lightmap where there is light",
            Self::Overlap => "Texels that more than one triangle covers",
            Self::NotFinite => "Texels that hold an infinite value or none",
            Self::Seam => {
                "Edges across which a flat or smoothly curved surface goes on, but the lightmap jumps by more than \
                 10 %"
            }
            Self::Stretched => "Triangles mapped with a ratio of more than 4 between the directions",
            Self::Uneven => {
                "Triangles with less than half or more than twice the median of texels a metre, so that light is \
                 coarser or finer there than elsewhere"
            }
        }
    }

    /// The colour it is marked in, sRGB.
    pub fn colour(self) -> [u8; 3] {
        srgb8(FalseColour::of_kinds().colour(self.kind() as f32))
    }
}

impl LightmapReport {
    /// How many there are of a fault: texels, triangles or edges.
    pub fn count(&self, fault: Fault) -> (usize, &'static str) {
        match fault {
            Fault::Leak => (self.leaks.len(), "texels"),
            Fault::NotFinite => (self.not_finite.len(), "texels"),
            Fault::Dark => (self.dark.len(), "texels"),
            Fault::Overlap => (self.overlapping.len(), "texels"),
            Fault::Seam => (self.seams.len(), "edges"),
            Fault::Stretched => (self.stretched.len(), "triangles"),
            Fault::Uneven => (self.uneven.len(), "triangles"),
        }
    }

    /// The fault of each texel of the map, row by row: of those that meet in one, the first of [`Fault::ALL`].
    pub fn faults(&self, geometry: &Geometry) -> Vec<Option<Fault>> {
        let [width, height] = self.size;
        let mut faults = vec![None; (width * height) as usize];
        let mut mark = |at: [u32; 2], fault: Fault| {
            faults[(at[1] * width + at[0]) as usize].get_or_insert(fault);
        };
        for fault in Fault::ALL {
            let mut mark_triangles = |triangles: &[u32]| {
                let of_them = |t: &&JudgedTexel| triangles.binary_search(&t.triangle).is_ok();
                self.texels.iter().filter(of_them).for_each(|t| mark(t.at, fault));
            };
            match fault {
                Fault::Stretched => mark_triangles(&self.stretched),
                Fault::Uneven => mark_triangles(&self.uneven),
                Fault::Overlap => self.overlapping.iter().for_each(|&at| mark(at, fault)),
                Fault::NotFinite => self.not_finite.iter().for_each(|&i| mark(self.texels[i].at, fault)),
                Fault::Leak => self.leaks.iter().for_each(|&i| mark(self.texels[i].at, fault)),
                Fault::Dark => self.dark.iter().for_each(|&i| mark(self.texels[i].at, fault)),
                Fault::Seam => self.seam_texels(geometry).for_each(|at| mark(at, fault)),
            }
        }
        faults
    }

    /// An edge of a texel on each triangle that is covered, m, as if it were square.
    pub(super) fn texel_sizes(&self, geometry: &Geometry) -> HashMap<u32, f32> {
        let mut counts = HashMap::<u32, u32>::new();
        for texel in &self.texels {
            *counts.entry(texel.triangle).or_default() += 1;
        }
        let size =
            |(t, count): (u32, u32)| (t, (0.5 * geometry.area_normal(t).length() / count as f32).sqrt());
        counts.into_iter().map(size).collect()
    }

    /// Texels within about one of an edge that is a seam.
    fn seam_texels<'a>(&'a self, geometry: &'a Geometry) -> impl Iterator<Item = [u32; 2]> + 'a {
        let sizes = self.texel_sizes(geometry);
        let mut seams = HashMap::<u32, Vec<[Vec3; 2]>>::new();
        for seam in &self.seams {
            seam.triangles.into_iter().for_each(|t| seams.entry(t).or_default().push(seam.ends));
        }
        let near = move |texel: &&JudgedTexel| {
            let reach = 0.75 * sizes.get(&texel.triangle).copied().unwrap_or(0.0);
            seams.get(&texel.triangle).is_some_and(|seams| {
                seams.iter().any(|&[a, b]| {
                    let along = (b - a).length_squared().max(f32::MIN_POSITIVE);
                    let share = ((texel.position - a).dot(b - a) / along).clamp(0.0, 1.0);
                    texel.position.distance_squared(a.lerp(b, share)) < reach * reach
                })
            })
        };
        self.texels.iter().filter(near).map(|t| t.at)
    }
}
