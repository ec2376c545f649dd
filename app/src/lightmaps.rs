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
    measure::{
        irradiance::{ErrorStatistics, relative_errors},
        lightmap::{noise, traced},
    },
    radiosity::{
        faults::Fault,
        lightmap::{JudgedTexel, LightmapError, LightmapReport, judge},
    },
    scene::world::World,
    transport::LightTransportSolution,
};
use std::path::{Path, PathBuf};

/// The job that holds a lightmap against the light, as the journal names it.
pub const JUDGING: &str = "Judging a lightmap";

/// A lightmap that is looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct LightmapFile {
    /// `.exr` or `.hdr` with irradiance in lx, or `.png`.
    pub path: PathBuf,
    /// Irradiance of white in a `.png`, or of 1 in the others, lx.
    pub white: f32,
    /// Paths a texel by which it is held against the path tracer too; 0 leaves that.
    pub paths: u32,
}

impl LightmapFile {
    /// A file as it is first looked at.
    pub fn new(path: PathBuf) -> Self {
        Self { path, white: 1.0, paths: 0 }
    }

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
pub const LIGHTMAPS: [&str; 4] = [
    "radiosity.lightmap",
    "radiosity.lightmap_difference",
    "radiosity.lightmap_error",
    "radiosity.lightmap_faults",
];

/// Paths a texel by which the window holds a lightmap against the path tracer.
pub const PATHS: u32 = 64;

/// Extensions of lightmaps.
pub const EXTENSIONS: [&str; 3] = ["exr", "hdr", "png"];

/// How far a lightmap, and our light on its texels, are from the path tracer.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// Paths a texel, at least.
    pub paths: u32,
    /// Median of its standard error over max(E, 5 % of the mean).
    pub noise: f64,
    /// Of the lightmap.
    pub of_map: ErrorStatistics,
    /// Of our light.
    pub of_ours: ErrorStatistics,
}

/// Seed of the paths.
const SEED: u64 = 1;

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
    /// The same against the path tracer, where that was asked for.
    pub traced: Option<Traced>,
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
        let mut report = match judge(world, &solution.radiosity, &map, &coordinates(world), progress) {
            Err(LightmapError::Cancelled(cancelled)) => return Err(cancelled.into()),
            judged => judged.with_context(|| file.path.display().to_string())?,
        };
        map.clear_invalid();
        let [found, ours]: [Vec<Vec3>; 2] = [|t: &JudgedTexel| t.found, |t: &JudgedTexel| t.ours]
            .map(|value| report.texels.iter().map(value).collect());
        let errors = relative_errors(&found, &ours)?;
        let traced = match file.paths {
            0 => None,
            paths => {
                let estimates = traced(&report, world, paths, SEED, progress)?;
                let light: Vec<Vec3> = estimates.iter().map(|e| e.mean).collect();
                let of_map = relative_errors(&found, &light)?;
                let of_ours = relative_errors(&ours, &light)?;
                report.traced = light;
                Some(Traced { paths, noise: noise(&estimates), of_map, of_ours })
            }
        };
        let faults = report.faults(&world.geometry);
        Ok(Self { file: file.clone(), map, report, errors, traced, faults })
    }

    /// Our light on its texels, lx; black on those that nothing covers.
    pub fn ours(&self) -> LinearImage {
        let mut ours = LinearImage::new(self.map.width, self.map.height);
        for texel in &self.report.texels {
            ours.pixels[self.place(texel.at)] = texel.ours;
        }
        ours
    }

    /// What the path tracer finds on its texels, lx; black where nothing covers one. `None` where it was not asked.
    pub fn reference(&self) -> Option<LinearImage> {
        self.traced.as_ref()?;
        let mut reference = LinearImage::new(self.map.width, self.map.height);
        for (texel, light) in self.report.texels.iter().zip(&self.report.traced) {
            reference.pixels[self.place(texel.at)] = *light;
        }
        Some(reference)
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
