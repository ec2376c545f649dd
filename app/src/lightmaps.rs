//! A lightmap baked elsewhere, held against our light: reading it, and what is shown and said of it.

use anyhow::{Context, Result, bail};
use glam::{Vec2, Vec3};
use lumenscope_core::{
    io::panorama as files,
    math::{
        colour::{linear_from_srgb, luminance, srgb8},
        false_colour::{FalseColour, Palette},
        image::LinearImage,
        progress::Progress,
    },
    measure::irradiance::{ErrorStatistics, relative_errors},
    radiosity::lightmap::{JudgedTexel, LightmapError, LightmapReport, judge},
    scene::world::World,
    transport::LightTransportSolution,
};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// The job that holds a lightmap against the light, as the journal names it.
pub const JUDGING: &str = "Judging a lightmap";

/// A lightmap that is looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct LightmapFile {
    /// `.exr` or `.hdr` with irradiance in lx, or `.png`.
    pub path: PathBuf,
    /// Irradiance of white in a `.png`, or of 1 in the others, lx.
    pub white: f32,
}

impl LightmapFile {
    /// Whether a file can be one, by its name.
    pub fn is_one(path: &Path) -> bool {
        let extension = path.extension().unwrap_or_default();
        EXTENSIONS.iter().any(|e| extension.eq_ignore_ascii_case(e))
    }

    /// Irradiance of each texel, lx, as the file has it.
    ///
    /// # Errors
    /// With the file's name, if it cannot be read, or white is no illuminance.
    pub fn read(&self) -> Result<LinearImage> {
        if !(self.white > 0.0 && self.white.is_finite()) {
            bail!("white must be a positive illuminance, got {} lx", self.white);
        }
        let mut map = files::read_as_written(&self.path)?;
        let encoded = self.path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        for pixel in &mut map.pixels {
            let linear = if encoded { Vec3::from(pixel.to_array().map(linear_from_srgb)) } else { *pixel };
            *pixel = linear * self.white;
        }
        Ok(map)
    }
}

/// Corners of every triangle on a lightmap.
pub fn coordinates(world: &World) -> Vec<Option<[Vec2; 3]>> {
    world.geometry.lightmap_uvs.iter().map(|uvs| Some(*uvs)).collect()
}

/// Views of the registry that show it in the scene.
pub const LIGHTMAPS: [&str; 2] = ["radiosity.lightmap", "radiosity.lightmap_difference"];

/// Extensions of lightmaps.
pub const EXTENSIONS: [&str; 3] = ["exr", "hdr", "png"];

/// What can be wrong with a lightmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Dark in ours, lit in the lightmap.
    Leak,
    /// Black in the lightmap, light in ours.
    Dark,
    /// Covered by more than one triangle.
    Overlap,
    /// Infinite or not a number in the lightmap.
    NotFinite,
    /// The light jumps between coplanar triangles.
    Seam,
    /// Mapped with a ratio of more than 4 between the directions.
    Stretched,
}

impl Fault {
    /// Every kind; of those that meet in a texel the first is shown.
    pub const ALL: [Self; 6] =
        [Self::Overlap, Self::NotFinite, Self::Leak, Self::Dark, Self::Seam, Self::Stretched];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Leak => "leaks",
            Self::Dark => "dark",
            Self::Overlap => "overlaps",
            Self::NotFinite => "not finite",
            Self::Seam => "seams",
            Self::Stretched => "stretched",
        }
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
                "Edges between coplanar triangles across which the lightmap jumps by more than 10 %"
            }
            Self::Stretched => "Triangles mapped with a ratio of more than 4 between the directions",
        }
    }

    /// The colour it is marked in.
    pub fn colour(self) -> [u8; 3] {
        match self {
            Self::Leak => [255, 140, 0],
            Self::Dark => [40, 90, 255],
            Self::Overlap => [255, 0, 220],
            Self::NotFinite => [230, 30, 30],
            Self::Seam => [60, 220, 90],
            Self::Stretched => [240, 225, 60],
        }
    }
}

/// A lightmap, our light on the same texels, and what is wrong.
#[derive(Clone, Debug)]
pub struct JudgedLightmap {
    /// The file.
    pub file: LightmapFile,
    /// Its irradiance, lx; black where that is negative or not a finite number.
    pub map: LinearImage,
    /// What was found.
    pub report: LightmapReport,
    /// (E − ours) / max(ours, 5 % of the mean) over the covered texels.
    pub errors: ErrorStatistics,
    /// The fault of each texel, if any.
    faults: Vec<Option<Fault>>,
}

impl JudgedLightmap {
    /// Reads a lightmap over the scene's texture coordinates and holds it against its light.
    ///
    /// # Errors
    /// With the file's name, if it cannot be read or does not fit the scene's coordinates; if cancelled.
    pub fn new(file: &LightmapFile, solution: &LightTransportSolution, progress: &Progress) -> Result<Self> {
        let mut map = file.read()?;
        let world = &solution.world;
        let report = match judge(world, &solution.radiosity, &map, &coordinates(world), progress) {
            Err(LightmapError::Cancelled(cancelled)) => return Err(cancelled.into()),
            judged => judged.with_context(|| file.path.display().to_string())?,
        };
        map.clear_invalid();
        let column = |value: fn(&JudgedTexel) -> Vec3| report.texels.iter().map(value).collect::<Vec<_>>();
        let errors = relative_errors(&column(|t| t.found), &column(|t| t.ours))?;
        let faults = faults(&report, &map, solution);
        Ok(Self { file: file.clone(), map, report, errors, faults })
    }

    /// How many there are of a fault: texels, triangles or edges.
    pub fn count(&self, fault: Fault) -> (usize, &'static str) {
        let report = &self.report;
        match fault {
            Fault::Leak => (report.leaks.len(), "texels"),
            Fault::NotFinite => (report.not_finite.len(), "texels"),
            Fault::Dark => (report.dark.len(), "texels"),
            Fault::Overlap => (report.overlapping.len(), "texels"),
            Fault::Seam => (report.seams.len(), "edges"),
            Fault::Stretched => (report.stretched.len(), "triangles"),
        }
    }

    /// Our light on its texels, lx; black on those that nothing covers.
    pub fn ours(&self) -> LinearImage {
        let mut ours = LinearImage::new(self.map.width, self.map.height);
        for texel in &self.report.texels {
            ours.pixels[self.place(texel.at)] = texel.ours;
        }
        ours
    }

    /// Colours of the difference, red where the lightmap has more.
    pub fn difference_colours(&self) -> FalseColour {
        FalseColour::over(self.report.difference_range(), Palette::Diverging)
    }

    /// The lightmap less our light by luminance, lx; `None` where nothing covers a texel.
    pub fn difference(&self) -> Vec<Option<f32>> {
        let mut difference = vec![None; self.map.pixels.len()];
        for texel in &self.report.texels {
            difference[self.place(texel.at)] = Some(luminance(texel.found - texel.ours));
        }
        difference
    }

    /// The faults in their colours over the lightmap in grey.
    pub fn fault_pixels(&self) -> Vec<[u8; 3]> {
        let white = 2.0 * self.report.mean_lx().max(f32::MIN_POSITIVE);
        let grey = |p: &Vec3| srgb8(Vec3::splat(luminance(*p) / white));
        let shown = self.map.pixels.iter().zip(&self.faults);
        shown.map(|(pixel, fault)| fault.map_or_else(|| grey(pixel), Fault::colour)).collect()
    }

    fn place(&self, at: [u32; 2]) -> usize {
        (at[1] * self.map.width + at[0]) as usize
    }
}

/// The fault of each texel: of those that meet in one, the first of [`Fault::ALL`].
fn faults(
    report: &LightmapReport,
    map: &LinearImage,
    solution: &LightTransportSolution,
) -> Vec<Option<Fault>> {
    let mut faults = vec![None; map.pixels.len()];
    let mut mark = |at: [u32; 2], fault: Fault| {
        faults[(at[1] * map.width + at[0]) as usize].get_or_insert(fault);
    };
    for fault in Fault::ALL {
        match fault {
            Fault::Overlap => report.overlapping.iter().for_each(|&at| mark(at, fault)),
            Fault::NotFinite => report.not_finite.iter().for_each(|&i| mark(report.texels[i].at, fault)),
            Fault::Leak => report.leaks.iter().for_each(|&i| mark(report.texels[i].at, fault)),
            Fault::Dark => report.dark.iter().for_each(|&i| mark(report.texels[i].at, fault)),
            Fault::Stretched => {
                let stretched = |t: &&JudgedTexel| report.stretched.binary_search(&t.triangle).is_ok();
                report.texels.iter().filter(stretched).for_each(|t| mark(t.at, fault));
            }
            Fault::Seam => seam_texels(report, solution).for_each(|at| mark(at, fault)),
        }
    }
    faults
}

/// Texels within about one of an edge that is a seam.
fn seam_texels<'a>(
    report: &'a LightmapReport,
    solution: &'a LightTransportSolution,
) -> impl Iterator<Item = [u32; 2]> + 'a {
    let geometry = &solution.world.geometry;
    let mut counts = HashMap::<u32, u32>::new();
    for texel in &report.texels {
        *counts.entry(texel.triangle).or_default() += 1;
    }
    // An edge of a square texel, m.
    let size = move |triangle: u32| {
        let area = 0.5 * geometry.area_normal(triangle).length();
        (area / counts.get(&triangle).copied().unwrap_or(1) as f32).sqrt()
    };
    let mut seams = HashMap::<u32, Vec<[Vec3; 2]>>::new();
    for seam in &report.seams {
        seam.triangles.into_iter().for_each(|t| seams.entry(t).or_default().push(seam.ends));
    }
    let near = move |texel: &&JudgedTexel| {
        let reach = 0.75 * size(texel.triangle);
        seams.get(&texel.triangle).is_some_and(|seams| {
            seams.iter().any(|&[a, b]| {
                let along = (b - a).length_squared().max(f32::MIN_POSITIVE);
                let share = ((texel.position - a).dot(b - a) / along).clamp(0.0, 1.0);
                texel.position.distance_squared(a.lerp(b, share)) < reach * reach
            })
        })
    };
    report.texels.iter().filter(near).map(|t| t.at)
}
