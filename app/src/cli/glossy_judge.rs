//! What `glossy` holds its methods to: the lobe by rays under the same light, and the path tracer.

use super::{
    glossy::{Options, flip_map},
    solve,
};
use anyhow::bail;
use glam::Vec3;
use lumenscope_core::{
    glossy::{
        by_rays::pass::lobes_by_rays,
        pass::{GlossyFrame, Lobes, lobes},
    },
    math::{image::LinearImage, progress::Cancelled},
    measure::image,
    mirror::{pass::mirror_image, reflectors::Reflectors},
    reference::picture::ReferencePicture,
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
    transport::LightTransportSolution,
};

/// A layer that others are held to.
pub struct Reference {
    /// The layer, cd/m².
    pub picture: LinearImage,
    /// Variance of each pixel's mean, (cd/m²)².
    pub variance: LinearImage,
}

/// Where a method may fail: parts of the glossy pixels, which may overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    /// All that is glossy.
    All,
    /// What is mirrored stands within 5 cm of the surface.
    Contact,
    /// Within 40 cm.
    Near,
    /// Farther away.
    Far,
    /// Seen at more than 75° from the normal.
    Grazing,
    /// More than a tenth of the lobe falls on what the mirror image does not show.
    Hidden,
}

impl Area {
    /// Every area, in the order of the table.
    pub const ALL: [Self; 6] = [Self::All, Self::Contact, Self::Near, Self::Far, Self::Grazing, Self::Hidden];

    /// Name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Contact => "contact",
            Self::Near => "near",
            Self::Far => "far",
            Self::Grazing => "grazing",
            Self::Hidden => "hidden",
        }
    }
}

/// Distances from the surface up to which what is mirrored is in contact and near, m.
const REACHES: [f32; 2] = [0.05, 0.4];
/// Cosine of the angle to the normal below which a pixel is grazing.
const GRAZING: f32 = 0.25;
/// Share of the lobe from which on a pixel counts as hidden.
const HIDDEN: f32 = 0.1;

/// What is known of one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    /// Frames that show something glossy there.
    frames: u32,
    /// Sums over them.
    distance: f32,
    cos_theta: f32,
    hidden: f32,
}

/// References of one solution.
pub struct Judge {
    /// The lobe by rays, in the light that the methods have.
    pub by_rays: Reference,
    /// The path tracer.
    pub by_paths: Option<Reference>,
    known: Vec<Known>,
    frames: u32,
}

impl Judge {
    /// Casts the rays and follows the paths.
    ///
    /// # Errors
    /// One line where nothing glossy is seen, so that nothing would be compared.
    pub fn new(solution: &LightTransportSolution, options: &Options, seed: u64) -> anyhow::Result<Self> {
        let frames = options.frames;
        let (by_rays, known) = by_rays(solution, options, seed)?;
        if !known.iter().any(|k| k.frames == frames) {
            bail!("{}: the scene's camera sees no flat glossy reflector", options.scene.display());
        }
        if by_rays.picture.pixels.iter().all(|p| *p == Vec3::ZERO) {
            bail!("{}: no light is reflected glossily, nothing can be compared", options.scene.display());
        }
        let by_paths = if options.paths > 0 { Some(by_paths(solution, options, seed)?) } else { None };
        Ok(Self { by_rays, by_paths, known, frames })
    }

    /// Whether a pixel is glossy in every frame and lies in an area.
    pub fn holds(&self, area: Area, pixel: usize) -> bool {
        let known = self.known[pixel];
        if known.frames < self.frames {
            return false;
        }
        let mean = |sum: f32| sum / self.frames as f32;
        let distance = mean(known.distance);
        match area {
            Area::All => true,
            Area::Contact => distance < REACHES[0],
            Area::Near => (REACHES[0]..REACHES[1]).contains(&distance),
            Area::Far => distance >= REACHES[1],
            Area::Grazing => mean(known.cos_theta) < GRAZING,
            Area::Hidden => mean(known.hidden) > HIDDEN,
        }
    }

    /// Share of the glossy pixels that lie in each area.
    pub fn shares(&self) -> [f64; 6] {
        let count = |area| (0..self.known.len()).filter(|&i| self.holds(area, i)).count() as f64;
        Area::ALL.map(|area| count(area) / count(Area::All))
    }

    /// relMSE without the reference's noise, and mean FLIP, by area; NaN where an area has no pixel.
    ///
    /// # Errors
    /// Where sizes differ.
    pub fn errors(&self, picture: &LinearImage, reference: &Reference) -> anyhow::Result<[[f64; 2]; 6]> {
        let flip = flip_map(picture, &reference.picture)?;
        let mut out = [[f64::NAN; 2]; 6];
        for (found, area) in out.iter_mut().zip(Area::ALL) {
            let counts = |i: usize| self.holds(area, i);
            let inside = (0..flip.len()).filter(|&i| counts(i)).map(|i| f64::from(flip[i]));
            let (count, sum) = inside.fold((0u32, 0.0), |(count, sum), flip| (count + 1, sum + flip));
            if count > 0 {
                let (truth, variance) = (&reference.picture, &reference.variance);
                let rel_mse = image::rel_mse_without_noise(picture, truth, variance, counts)?;
                *found = [rel_mse, sum / f64::from(count)];
            }
        }
        Ok(out)
    }
}

fn by_rays(
    solution: &LightTransportSolution,
    options: &Options,
    seed: u64,
) -> Result<(Reference, Vec<Known>), Cancelled> {
    let ([width, height], frames) = (options.size, options.frames);
    let camera = &solution.scene.camera;
    let world = &solution.world;
    let reflectors = Reflectors::new(&world.geometry);
    let lobes = lobes(world, &reflectors, &Lobes::new());
    let mut picture = LinearImage::new(width, height);
    let mut variance = picture.clone();
    let mut known = vec![Known::default(); picture.pixels.len()];
    let share = 1.0 / frames as f32;
    solve::watched(|progress| {
        progress.begin("lobes by rays");
        for frame in 0..frames {
            progress.report(frame as f32 * share)?;
            let settings = settings(frame, frames, seed);
            let shading = Shading::new(solution, &settings);
            let buffer = GBuffer::new(world, camera, options.size.into(), settings.subpixel());
            let Some(image) = mirror_image(&shading, &reflectors, &buffer, camera, &settings) else { break };
            let frame = GlossyFrame::new(world, &reflectors, &lobes, &image, &buffer, camera, &settings);
            let rays = options.spp.div_ceil(frames);
            let found = lobes_by_rays(&frame, &shading, camera, &settings, rays);
            for (i, pixel) in found.into_iter().enumerate() {
                let Some(pixel) = pixel else { continue };
                picture.pixels[i] += share * pixel.radiance;
                variance.pixels[i] += share * share * pixel.variance;
                let known = &mut known[i];
                known.frames += 1;
                known.distance += image.distance[i];
                known.cos_theta += frame.point(i).map_or(0.0, |(point, _)| point.cos_theta());
                known.hidden += pixel.hidden;
            }
        }
        progress.report(1.0)
    })?;
    Ok((Reference { picture, variance }, known))
}

/// Settings of one of the frames that a method's mean is of.
pub fn settings(frame: u32, frames: u32, seed: u64) -> PassSettings {
    PassSettings { direct: DirectQuality::PerPixel(4), frame, jitter: frames > 1, seed }
}

/// The glossy layer of the path tracer, twice: half of what differs is the noise of the mean.
fn by_paths(solution: &LightTransportSolution, options: &Options, seed: u64) -> Result<Reference, Cancelled> {
    let [width, height] = options.size;
    let half = |seed: u64| {
        let mut picture =
            ReferencePicture::new(solution.world.clone(), solution.scene.camera, width, height, seed);
        solve::watched(|progress| picture.add_samples(options.paths.div_ceil(2), progress))?;
        let [.., glossy] = picture.layers();
        Ok(glossy)
    };
    let (a, b) = (half(seed)?, half(seed.wrapping_add(0x9e37))?);
    let both = |f: &dyn Fn(Vec3, Vec3) -> Vec3| LinearImage {
        width,
        height,
        pixels: a.pixels.iter().zip(&b.pixels).map(|(a, b)| f(*a, *b)).collect(),
    };
    let variance = both(&|a, b| 0.25 * (a - b) * (a - b));
    Ok(Reference { picture: both(&|a, b| 0.5 * (a + b)), variance })
}
