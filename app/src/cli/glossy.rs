//! `glossy`: ways of glossy reflection, in the picture and in object space, judged by roughness.

use super::{
    Common,
    glossy_judge::{Area, Judge, Reference, settings},
    glossy_kernels,
    glossy_particles::{self, Wanted},
    glossy_sheet::Sheet,
    parse_size,
    render::{auto_display, write_png},
    solve,
};
use anyhow::{Context, bail};
use clap::Args;
use lumenscope_core::{
    glossy::{
        GlossyMethod,
        particles::splat::SplatSettings,
        pass::{GlossyFrame, Lobes, lobes},
    },
    math::{image::LinearImage, progress::Cancelled},
    measure::image,
    mirror::{pass::mirror_image, reflectors::Reflectors},
    scene::{Scene, geometry::Geometry, world::World},
    superposition::{
        PassSettings,
        composite::{self, DirectQuality},
        gbuffer::GBuffer,
        layers::Layer,
        mean_of_frames,
        pass::Shading,
        plan::Plan,
    },
    transport::LightTransportSolution,
};
use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    sync::Arc,
    time::Instant,
};

/// Options of `glossy`.
#[derive(Args)]
pub struct Options {
    /// Scene file; its glossy materials are given each roughness in turn.
    pub scene: PathBuf,
    /// Folder for the table and the pictures; `--kernels` prints without one.
    #[arg(long, required_unless_present = "kernels")]
    pub out: Option<PathBuf>,
    /// Print what one kernel over a picture of this size costs by its radius, directly and by Fourier transforms, and
    /// which is chosen; nothing else.
    #[arg(long)]
    kernels: bool,
    /// Values of roughness, from 0.05 to below 0.5.
    #[arg(long, value_delimiter = ',', default_values_t = [0.05, 0.1, 0.2, 0.4])]
    pub roughness: Vec<f32>,
    /// Rays a pixel of the reference that has the methods' own light, at least two a frame.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub spp: u32,
    /// Paths a pixel of the path tracer; 0 leaves it out.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub paths: u32,
    /// Frames averaged of each method.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub frames: u32,
    /// Particles of the object-space rows; each number goes on from the one before. A hit takes 40 bytes, one on
    /// what is glossy 100 more.
    #[arg(long, value_delimiter = ',', default_values_t = [1_000_000, 8_000_000])]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    particles: Vec<u32>,
    /// C of h = C √(A / n), the radius of a particle's Gaussian.
    #[arg(long, default_value_t = SplatSettings::default().scale)]
    splat_scale: f32,
    /// Picture size.
    #[arg(long, default_value = "480x270", value_parser = parse_size)]
    pub size: [u32; 2],
}

/// Renders, compares and prints the table.
///
/// # Errors
/// One line naming the file and the cause; also where there is nothing glossy to compare.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    if let Some(wrong) = options.roughness.iter().find(|r| !(0.05..0.5).contains(*r)) {
        bail!("--roughness {wrong} must lie from 0.05 to below 0.5");
    }
    if !options.particles.is_sorted() || !(0.1..=100.0).contains(&options.splat_scale) {
        bail!("--particles must ascend and --splat-scale lie from 0.1 to 100");
    }
    if options.kernels {
        return glossy_kernels::run(options, common);
    }
    let out = options.out.as_deref().context("--out is missing")?;
    solve::output_folder(out)?;
    let loaded = solve::load(&options.scene, common)?;
    let mut table = Table { out, text: String::from("roughness,method") };
    for area in Area::ALL {
        let _ = write!(table.text, ",rel_mse_{0},flip_{0}", area.name());
    }
    table.text += ",rel_mse_paths,flip_paths,milliseconds,build_seconds\n";
    for &roughness in &options.roughness {
        let scene = with_roughness(&loaded.scene, roughness);
        if !Reflectors::new(&Geometry::new(&scene))
            .list
            .iter()
            .any(|r| scene.materials[r.material as usize].is_glossy())
        {
            bail!("{}: nothing flat is glossy", options.scene.display());
        }
        let plan = Plan::new(&scene, &World::new(&scene), common.tolerance, common.seed);
        let solution = solve::solve(&solve::Loaded { scene: Arc::new(scene), plan }, false)?;
        let judge = Judge::new(&solution, options, common.seed)?;
        table.begin(roughness, &judge)?;
        let mut sheet = Sheet::new(&judge, roughness);
        for method in GlossyMethod::OF_IMAGE {
            let picture = picture(&solution, method, options, common.seed)?;
            let milliseconds = cost(&solution, method, options.size, common.seed);
            table.row(roughness, method.name(), &picture, &judge, [milliseconds, 0.0])?;
            sheet.add(method.name(), &picture, &judge);
        }
        let (picture, milliseconds) = in_full(&solution, options, common.seed)?;
        table.row(roughness, "invariant in full", &picture, &judge, [milliseconds, 0.0])?;
        let wanted = Wanted {
            counts: &options.particles,
            scale: options.splat_scale,
            size: options.size,
            frames: options.frames,
            seed: common.seed,
        };
        for row in glossy_particles::rows(&solution.world, &solution.scene.camera, &wanted)? {
            table.row(roughness, &row.name, &row.picture, &judge, [row.milliseconds, row.build_seconds])?;
        }
        sheet.write(&out.join(format!("sheet_{roughness}.png")))?;
    }
    solve::write(&out.join("glossy.csv"), &table.text)
}

struct Table<'a> {
    out: &'a Path,
    text: String,
}

impl Table<'_> {
    /// Prints the head of one roughness and writes the references.
    fn begin(&self, roughness: f32, judge: &Judge) -> anyhow::Result<()> {
        let shares = judge.shares().map(|s| format!("{:>15.1}%", 100.0 * s)).join("");
        println!(
            "roughness {roughness}: relMSE / FLIP against the lobe by rays, the reference's own variance taken off"
        );
        let names = Area::ALL.map(|a| format!("{:>16}", a.name())).join("");
        println!("{:<18}{names}{:>16}{:>11}{:>9}", "method", "by paths", "ms a frame", "s before");
        println!("{:<18}{shares}", "share of pixels");
        self.picture("rays", roughness, &judge.by_rays.picture, &judge.by_rays)?;
        match &judge.by_paths {
            Some(paths) => self.picture("reference", roughness, &paths.picture, &judge.by_rays),
            None => Ok(()),
        }
    }

    /// Prints a method's row and writes its picture.
    fn row(
        &mut self,
        roughness: f32,
        name: &str,
        picture: &LinearImage,
        judge: &Judge,
        [milliseconds, build_seconds]: [f64; 2],
    ) -> anyhow::Result<()> {
        self.picture(&name.replace(' ', "_"), roughness, picture, &judge.by_rays)?;
        let errors = judge.errors(picture, &judge.by_rays)?;
        let [by_paths, ..] = match &judge.by_paths {
            Some(paths) => judge.errors(picture, paths)?,
            None => [[f64::NAN; 2]; 6],
        };
        let shown =
            errors.iter().chain([&by_paths]).map(|[rel_mse, flip]| format!("{rel_mse:>9.5} /{flip:>5.3}"));
        println!("{name:<18}{}{milliseconds:>11.1}{build_seconds:>9.2}", shown.collect::<String>());
        let figures = errors.iter().chain([&by_paths]).flatten().chain([&milliseconds, &build_seconds]);
        let figures = figures.map(|figure| format!(",{figure}")).collect::<String>();
        let _ = writeln!(self.text, "{roughness},{name}{figures}");
        Ok(())
    }

    /// Writes a picture, exposed for a reference.
    fn picture(
        &self,
        name: &str,
        roughness: f32,
        picture: &LinearImage,
        exposed_for: &Reference,
    ) -> anyhow::Result<()> {
        let path = self.out.join(format!("{name}_{roughness}.png"));
        write_png(&path, picture, &auto_display(&exposed_for.picture))
    }
}

/// The scene with every glossy material's roughness replaced.
fn with_roughness(scene: &Scene, roughness: f32) -> Scene {
    let mut scene = scene.clone();
    for material in scene.materials.iter_mut().filter(|m| m.is_glossy()) {
        material.roughness = roughness;
    }
    scene
}

/// The glossy layer by a method.
fn picture(
    solution: &LightTransportSolution,
    method: GlossyMethod,
    options: &Options,
    seed: u64,
) -> Result<LinearImage, Cancelled> {
    let mut scene = (*solution.scene).clone();
    scene.plan.glossy = Some(method);
    let solution = LightTransportSolution { scene: Arc::new(scene), ..solution.clone() };
    let camera = &solution.scene.camera;
    let (size, frames) = (options.size, options.frames);
    let settings = settings(0, frames, seed);
    let layers = solve::watched(|p| mean_of_frames(&solution, camera, size, frames, &settings, p))?;
    Ok(layers.get(Layer::Glossy).clone())
}

/// Mean FLIP of two pictures as the display shows them, exposed for the second.
pub fn flip(picture: &LinearImage, reference: &LinearImage) -> anyhow::Result<f64> {
    let map = flip_map(picture, reference)?;
    Ok(map.iter().copied().map(f64::from).sum::<f64>() / map.len().max(1) as f64)
}

/// FLIP of each pixel of two pictures as the display shows them, exposed for the second.
pub fn flip_map(picture: &LinearImage, reference: &LinearImage) -> anyhow::Result<Vec<f32>> {
    let display = auto_display(reference);
    let [a, b] = [picture, reference].map(|p| composite::display(p, &display));
    Ok(image::flip_displayed(&a, &b, picture.width, image::PIXELS_PER_DEGREE)?.map)
}

/// Runs over a frame's glossy pixels, if it has any.
fn with_frame<T>(
    solution: &LightTransportSolution,
    size: [u32; 2],
    settings: &PassSettings,
    work: impl FnOnce(&GlossyFrame) -> T,
) -> Option<T> {
    let (world, camera) = (&solution.world, &solution.scene.camera);
    let shading = Shading::new(solution, settings);
    let reflectors = Reflectors::new(&world.geometry);
    let lobes = lobes(world, &reflectors, &Lobes::new());
    let buffer = GBuffer::new(world, camera, size.into(), settings.subpixel());
    let image = mirror_image(&shading, &reflectors, &buffer, camera, settings)?;
    Some(work(&GlossyFrame::new(world, &reflectors, &lobes, &image, &buffer, camera, settings)))
}

/// Milliseconds that the convolution of one frame takes.
fn cost(solution: &LightTransportSolution, method: GlossyMethod, size: [u32; 2], seed: u64) -> f64 {
    let settings = PassSettings { direct: DirectQuality::Elements, seed, ..PassSettings::default() };
    let seconds = with_frame(solution, size, &settings, |frame| {
        let start = Instant::now();
        std::hint::black_box(frame.scattered(method));
        start.elapsed().as_secs_f64()
    });
    1e3 * seconds.unwrap_or(0.0)
}

/// One kernel a reflector over the picture's own pixels: the mean of the frames, and milliseconds of one convolution.
fn in_full(
    solution: &LightTransportSolution,
    options: &Options,
    seed: u64,
) -> Result<(LinearImage, f64), Cancelled> {
    let [width, height] = options.size;
    let mut sum = LinearImage::new(width, height);
    let mut seconds = 0.0;
    solve::watched(|progress| {
        progress.begin("convolution in full");
        for number in 0..options.frames {
            progress.report(number as f32 / options.frames as f32)?;
            with_frame(solution, options.size, &settings(number, options.frames, seed), |frame| {
                let start = Instant::now();
                let scattered = frame.invariant_in_full();
                seconds += start.elapsed().as_secs_f64();
                for (pixel, out) in sum.pixels.iter_mut().enumerate() {
                    *out += frame.reflected(pixel, scattered[pixel]) / options.frames as f32;
                }
            });
        }
        progress.report(1.0)
    })?;
    Ok((sum, 1e3 * seconds / f64::from(options.frames)))
}
