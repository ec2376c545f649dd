//! `glossy`: ways of glossy reflection, in the picture and in object space, judged against the path tracer by roughness.

use super::{
    Common,
    glossy_particles::{self, Wanted},
    parse_size,
    render::{auto_display, write_png},
    solve,
};
use anyhow::bail;
use clap::Args;
use glam::Vec3;
use lumenscope_core::{
    glossy::{
        GlossyMethod,
        particles::splat::SplatSettings,
        pass::{GlossyFrame, lobes},
    },
    math::{image::LinearImage, progress::Cancelled},
    measure::image,
    mirror::{pass::mirror_image, reflectors::Reflectors},
    reference::picture::ReferencePicture,
    scene::Scene,
    superposition::{
        PassSettings,
        composite::{self, DirectQuality},
        layers::Layer,
        mean_of_frames,
        pass::{Shading, render},
    },
    transport::LightTransportSolution,
};
use std::{fmt::Write as _, path::PathBuf, sync::Arc, time::Instant};

/// Options of `glossy`.
#[derive(Args)]
pub struct Options {
    /// Scene file; its glossy materials are given each roughness in turn.
    scene: PathBuf,
    /// Folder for the table and the pictures.
    #[arg(long)]
    out: PathBuf,
    /// Values of roughness, from 0.05 to below 0.5.
    #[arg(long, value_delimiter = ',', default_values_t = [0.05, 0.1, 0.2, 0.4])]
    roughness: Vec<f32>,
    /// Paths a pixel of the reference.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    spp: u32,
    /// Frames averaged of each method.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
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
    size: [u32; 2],
}

/// Distances from the surface to what it mirrors, m: where each band ends, and its name.
const BANDS: [(f32, &str); 3] = [(0.05, "contact"), (0.4, "near"), (f32::INFINITY, "far")];

/// Renders, compares and prints the table.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    if let Some(wrong) = options.roughness.iter().find(|r| !(0.05..0.5).contains(*r)) {
        bail!("--roughness {wrong} must lie from 0.05 to below 0.5");
    }
    if !options.particles.is_sorted() || !(0.1..=100.0).contains(&options.splat_scale) {
        bail!("--particles must ascend and --splat-scale lie from 0.1 to 100");
    }
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let mut table = String::from(
        "roughness,method,rel_mse,flip,rel_mse_contact,rel_mse_near,rel_mse_far,milliseconds,build_seconds\n",
    );
    println!(
        "roughness  method             relMSE    FLIP      contact   near      far       ms a frame  s before"
    );
    for &roughness in &options.roughness {
        let scene = with_roughness(&loaded.scene, roughness);
        if Reflectors::new(&lumenscope_core::scene::geometry::Geometry::new(&scene)).is_empty() {
            bail!("{}: nothing flat is polished", options.scene.display());
        }
        let plan = lumenscope_core::superposition::plan::Plan::new(
            &scene,
            &lumenscope_core::scene::world::World::new(&scene),
            common.tolerance,
            common.seed,
        );
        let solution = solve::solve(&solve::Loaded { scene: Arc::new(scene), plan }, false)?;
        let reference = reference(&solution, options, common)?;
        let write = |name: &str, picture: &LinearImage| {
            let path = options.out.join(format!("{name}_{roughness}.png"));
            write_png(&path, picture, &auto_display(&reference))
        };
        write("reference", &reference)?;
        let distance = distances(&solution, options.size, common.seed);
        let mut judge = |name: &str, picture: &LinearImage, milliseconds: f64, build_seconds: f64| {
            write(&name.replace(' ', "_"), picture)?;
            let rel_mse = image::rel_mse(picture, &reference)?;
            let flip = flip(picture, &reference)?;
            let bands = bands(picture, &reference, &distance)?;
            let row = bands.map(|b| format!("{b:.5}")).join("   ");
            println!(
                "{roughness:<9}  {name:<17}  {rel_mse:.5}   {flip:.5}   {row}   {milliseconds:<10.1}  {build_seconds:.2}"
            );
            let bands = bands.map(|b| b.to_string()).join(",");
            let _ =
                writeln!(table, "{roughness},{name},{rel_mse},{flip},{bands},{milliseconds},{build_seconds}");
            anyhow::Ok(())
        };
        for method in GlossyMethod::ALL {
            let picture = picture(&solution, method, options, common.seed)?;
            let milliseconds = cost(&solution, method, options.size, common.seed);
            judge(method.name(), &picture, milliseconds, 0.0)?;
        }
        let wanted = Wanted {
            counts: &options.particles,
            scale: options.splat_scale,
            size: options.size,
            frames: options.frames,
            seed: common.seed,
        };
        for row in glossy_particles::rows(&solution.world, &solution.scene.camera, &wanted)? {
            judge(&row.name, &row.picture, row.milliseconds, row.build_seconds)?;
        }
    }
    solve::write(&options.out.join("glossy.csv"), &table)
}

/// The scene with every glossy material's roughness replaced.
fn with_roughness(scene: &Scene, roughness: f32) -> Scene {
    let mut scene = scene.clone();
    for material in scene.materials.iter_mut().filter(|m| m.alpha().is_some_and(|a| a > 0.0)) {
        material.roughness = roughness;
    }
    scene
}

/// The glossy layer of the path tracer.
fn reference(
    solution: &LightTransportSolution,
    options: &Options,
    common: &Common,
) -> anyhow::Result<LinearImage> {
    let [width, height] = options.size;
    let mut picture =
        ReferencePicture::new(solution.world.clone(), solution.scene.camera, width, height, common.seed);
    solve::watched(|progress| picture.add_samples(options.spp, progress))?;
    let [.., glossy] = picture.layers();
    Ok(glossy)
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
    let settings = PassSettings { direct: DirectQuality::PerPixel(4), seed, ..PassSettings::default() };
    let (size, frames) = (options.size, options.frames);
    let layers = solve::watched(|p| mean_of_frames(&solution, camera, size, frames, &settings, p))?;
    Ok(layers.get(Layer::Glossy).clone())
}

/// Distance from the surface to what each pixel mirrors, m; NaN where it is not glossy.
fn distances(solution: &LightTransportSolution, [width, height]: [u32; 2], seed: u64) -> Vec<f32> {
    let settings = PassSettings { direct: DirectQuality::Elements, seed, ..PassSettings::default() };
    let camera = &solution.scene.camera;
    let (buffer, layers) = render(solution, camera, width, height, &settings);
    let shading = Shading::new(solution, &settings);
    let reflectors = Reflectors::new(&solution.world.geometry);
    let image = mirror_image(&shading, &reflectors, &buffer, camera, &settings);
    let glossy = |i: usize| layers.get(Layer::Glossy).pixels[i] != Vec3::ZERO;
    match image {
        Some(image) => {
            (0..image.distance.len()).map(|i| if glossy(i) { image.distance[i] } else { f32::NAN }).collect()
        }
        None => vec![f32::NAN; (width * height) as usize],
    }
}

/// Relative error by distance of what is mirrored; 0 for a band without pixels.
fn bands(picture: &LinearImage, reference: &LinearImage, distance: &[f32]) -> anyhow::Result<[f64; 3]> {
    let mut from = 0.0;
    let mut out = [0.0; 3];
    for (found, (to, _)) in out.iter_mut().zip(BANDS) {
        let inside: Vec<usize> =
            (0..distance.len()).filter(|&i| (from..=to).contains(&distance[i])).collect();
        let part = |image: &LinearImage| LinearImage {
            width: inside.len() as u32,
            height: 1,
            pixels: inside.iter().map(|&i| image.pixels[i]).collect(),
        };
        if !inside.is_empty() {
            *found = image::rel_mse(&part(picture), &part(reference))?;
        }
        from = to.next_up();
    }
    Ok(out)
}

/// Mean FLIP of two pictures as the display shows them, exposed for the second.
pub fn flip(picture: &LinearImage, reference: &LinearImage) -> anyhow::Result<f64> {
    let display = auto_display(reference);
    let [a, b] = [picture, reference].map(|p| composite::display(p, &display));
    Ok(image::flip_displayed(&a, &b, picture.width, image::PIXELS_PER_DEGREE)?.mean)
}

/// Milliseconds that the convolution of one frame takes.
fn cost(
    solution: &LightTransportSolution,
    method: GlossyMethod,
    [width, height]: [u32; 2],
    seed: u64,
) -> f64 {
    let settings = PassSettings { direct: DirectQuality::Elements, seed, ..PassSettings::default() };
    let camera = &solution.scene.camera;
    let (buffer, _) = render(solution, camera, width, height, &settings);
    let shading = Shading::new(solution, &settings);
    let world = &solution.world;
    let reflectors = Reflectors::new(&world.geometry);
    let lobes = lobes(world, &reflectors);
    let Some(image) = mirror_image(&shading, &reflectors, &buffer, camera, &settings) else { return 0.0 };
    let frame = GlossyFrame::new(world, &reflectors, &lobes, &image, &buffer, camera, &settings);
    let start = Instant::now();
    let scattered = frame.scattered(method);
    let seconds = start.elapsed().as_secs_f64();
    if scattered.is_empty() { 0.0 } else { 1e3 * seconds }
}
