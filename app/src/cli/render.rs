//! `render`: picture, layers, report.

use super::{Common, parse_glossy, parse_size, report, solve, volume_options::VolumeOptions};
use anyhow::bail;
use clap::{Args, ValueEnum};
use glam::Vec3;
use lumenscope_core::{
    glossy::{GlossyMethod, environment::MOST_GLOSSY_DEPTH, particles::light},
    gpu,
    io::exr,
    irradiance_volume::{
        dynamic_object::{Detail, Gloss},
        moments::Order,
    },
    math::image::LinearImage,
    mirror::MirrorMethod,
    radiosity::lookup::Lookup,
    reference::expression::Expression,
    scene::{lookup::Reconstruction, world::World},
    superposition::{
        composite::{self, DirectQuality, Display},
        layers::{COUNT, Layer, Layers},
        mean_of_frames,
        pass::PassSettings,
        plan::Plan,
    },
    transport::LightTransportSolution,
};
use std::{path::PathBuf, sync::Arc, time::Instant};

/// Options of `render`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Folder for `picture.png`, `layers.exr` and `report.json`.
    #[arg(long)]
    out: PathBuf,
    /// Picture size.
    #[arg(long, default_value = "1280x720", value_parser = parse_size)]
    size: [u32; 2],
    /// Where the picture is computed; `auto` takes a GPU that is not emulated, else the CPU.
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// Frames averaged, each with its own sub-pixel offset and two shadow rays an area emitter; as many
    /// as the plan's shadow rays ask for by default.
    #[arg(long)]
    frames: Option<u32>,
    /// Shade objects that may be moved from the irradiance volume by the moment of this order (1 to 10000, or
    /// inf), towards the mirrored view vector above order 1.
    #[arg(long)]
    moment: Option<Order>,
    /// How finely these objects ask it: coarse, vertices, fine, or pixels, by the processor.
    #[arg(long, value_parser = parse_detail, default_value = "fine")]
    detail: Detail,
    /// How light stored on surfaces is looked up between its nodes; as the plan has it by default.
    #[arg(long, value_enum)]
    lookup: Option<LookupName>,
    /// How glossy flat surfaces blur what they mirror: variant (a kernel a pixel), variant_half (a kernel every second
    /// pixel of every second row), invariant (one a reflector) or sharp (not at all); or particles of light on whatever
    /// is glossy. As the plan has it by default.
    #[arg(long, value_parser = parse_glossy)]
    glossy: Option<GlossyMethod>,
    /// Glossy reflections, one seen in the other, that what is glossy shows in mirrors and curved things show; as the
    /// plan has it by default.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_GLOSSY_DEPTH)))]
    glossy_depth: Option<u32>,
    /// Particles sent by all emitters for `--glossy particles`; as the plan has it by default.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=i64::from(light::MOST_PARTICLES)))]
    particles: Option<u32>,
    /// Where what flat mirrors show comes from; as the plan has it by default.
    #[arg(long, value_enum)]
    mirrors: Option<MirrorsName>,
    /// What becomes of that light before: nothing, the smooth function through the nodes at twice as many of them, or
    /// that low-passed; as the plan has it by default.
    #[arg(long, value_enum)]
    reconstruction: Option<ReconstructionName>,
    /// Only the light of these paths, from the light L to the eye E by diffuse D and specular S reflections; where
    /// nothing is specular any, else what is a sum of layers: LDE, "LD{2}E", "L(D|S)*SE".
    #[arg(long)]
    paths: Option<Expression>,
    #[command(flatten)]
    volume: VolumeOptions,
}

/// Where pictures are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// A GPU that is not emulated, else the CPU.
    Auto,
    /// The CPU: the specification.
    Cpu,
    /// The GPU, emulated or not.
    Gpu,
}

/// [`Lookup`] by its name on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LookupName {
    /// Bilinear between four nodes.
    Bilinear,
    /// Mitchell and Netravali's bicubic over 4 × 4 nodes.
    Mitchell,
}

/// [`MirrorMethod`] by its name on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MirrorsName {
    /// The geometry seen from mirrored eyes.
    Geometry,
    /// Images-with-depth taken beforehand.
    Images,
}

/// [`Reconstruction`] by its name on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ReconstructionName {
    /// The nodes as they are.
    Stored,
    /// The smooth function through them.
    Hermite,
    /// That, low-passed.
    Filtered,
}

/// Renders.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    solve::output_folder(&options.out)?;
    let start = Instant::now();
    let mut loaded = solve::load(&options.scene, common)?;
    if let Some(lookup) = options.lookup {
        Arc::make_mut(&mut loaded.scene).plan.lookup = Some(match lookup {
            LookupName::Bilinear => Lookup::Bilinear,
            LookupName::Mitchell => Lookup::Mitchell,
        });
    }
    let asked = [options.particles, options.glossy_depth].into_iter().any(|n| n.is_some());
    if asked || options.glossy.is_some() || options.mirrors.is_some() {
        let scene = Arc::make_mut(&mut loaded.scene);
        scene.plan.glossy = options.glossy.or(scene.plan.glossy);
        scene.plan.glossy_particles = options.particles.or(scene.plan.glossy_particles);
        scene.plan.glossy_depth = options.glossy_depth.or(scene.plan.glossy_depth);
        let mirrors = options.mirrors.map(|name| match name {
            MirrorsName::Geometry => MirrorMethod::Geometry,
            MirrorsName::Images => MirrorMethod::Images,
        });
        scene.plan.mirrors = mirrors.or(scene.plan.mirrors);
        loaded.plan = Plan::new(scene, &World::new(scene), common.tolerance, common.seed);
    }
    if let Some(reconstruction) = options.reconstruction {
        Arc::make_mut(&mut loaded.scene).plan.reconstruction = Some(match reconstruction {
            ReconstructionName::Stored => Reconstruction::Stored,
            ReconstructionName::Hermite => Reconstruction::Hermite,
            ReconstructionName::Filtered => Reconstruction::Filtered,
        });
    }
    if let Some(settings) = &mut loaded.plan.solve.volume {
        options.volume.apply(settings);
    }
    if let Some(order) = options.moment {
        let settings = loaded.plan.volume_settings();
        options.volume.apply(settings);
        settings.moments.push(order);
    }
    let load_seconds = start.elapsed().as_secs_f64();
    let eye = loaded.scene.camera.eye;
    let gloss = options.moment.map(|order| Gloss { order, eye });
    let solution = solve::solve(&loaded, false)?.with_gloss(gloss).with_detail(Some(options.detail));
    let (solution, terms) = match &options.paths {
        Some(paths) => of_paths(&solution, paths)?,
        None => (solution, [true; COUNT]),
    };
    let frames = options.frames.unwrap_or((loaded.plan.direct_samples / 2).max(4));
    let start_picture = Instant::now();
    let (mut layers, backend) = picture(&solution, options.size, frames, options.backend, common.seed)?;
    let picture_seconds = start_picture.elapsed().as_secs_f64();
    let total_seconds = start.elapsed().as_secs_f64();

    for (layer, _) in layers.images.iter_mut().zip(terms).filter(|(_, counts)| !counts) {
        layer.pixels.fill(Vec3::ZERO);
    }
    let sum = layers.total();
    let display = auto_display(&sum);
    write_png(&options.out.join("picture.png"), &sum, &display)?;
    write_layers(&options.out.join("layers.exr"), &layers)?;
    let mut stages = vec![("load".to_owned(), load_seconds)];
    stages.extend(solution.provenance.stage_seconds.clone());
    stages.push(("picture".to_owned(), picture_seconds));
    let report = serde_json::json!({
        "scene": options.scene,
        "size": options.size,
        "backend": backend,
        "threads": rayon::current_num_threads(),
        "seed": common.seed,
        "plan": loaded.plan.lines,
        "stage_seconds": stages.iter().map(|(k, v)| (k.clone(), serde_json::json!(v))).collect::<serde_json::Map<_, _>>(),
        "total_seconds": total_seconds,
        "triangles": solution.world.geometry.len(),
        "emitters": solution.world.emitters.len(),
        "elements": solution.radiosity.direct.len(),
        "radiosity": report::radiosity(&solution.radiosity, &solution.world),
        "mirror_images_bytes": solution.mirror_images.as_ref().map(|images| images.bytes()),
        "volume": solution.volume.as_ref().map(|v| report::volume(v)),
        "peak_bytes": peak_bytes(),
        "ev100": display.ev100,
    });
    solve::write(&options.out.join("report.json"), &serde_json::to_string_pretty(&report)?)?;
    eprintln!(
        "{}: {}x{} by {backend} in {total_seconds:.2} s",
        options.out.display(),
        options.size[0],
        options.size[1]
    );
    Ok(())
}

/// The layers of a solution seen by its scene's camera, and the name of what computed them.
///
/// # Errors
/// When a GPU is asked for and none answers.
pub fn picture(
    solution: &LightTransportSolution,
    size: [u32; 2],
    frames: u32,
    backend: Backend,
    seed: u64,
) -> anyhow::Result<(Layers, String)> {
    let solution = &solution.reconstructed();
    if backend == Backend::Gpu || (backend == Backend::Auto && !solution.is_asked_at_pixels()) {
        match gpu::offline::render(
            solution,
            &solution.scene.camera,
            size,
            frames,
            seed,
            backend == Backend::Gpu,
        ) {
            Ok(done) => return Ok(done),
            Err(error) if backend == Backend::Gpu => return Err(error.into()),
            Err(_) => {}
        }
    }
    let settings = PassSettings { direct: DirectQuality::PerPixel(2), seed, ..PassSettings::default() };
    let camera = &solution.scene.camera;
    let layers = solve::watched(|p| mean_of_frames(solution, camera, size, frames, &settings, p))?;
    Ok((layers, "cpu".into()))
}

/// A level of detail by its name.
fn parse_detail(text: &str) -> Result<Detail, String> {
    let found = Detail::ALL.into_iter().find(|d| d.name() == text);
    found.ok_or_else(|| format!("`{text}` is not coarse, vertices, fine or pixels"))
}

/// The display a picture is written with: filmic, exposed by its log-average luminance.
pub fn auto_display(picture: &LinearImage) -> Display {
    let standard = Display::default();
    Display { ev100: composite::auto_exposure(picture).unwrap_or(standard.ev100), ..standard }
}

/// Writes a picture as the display shows it.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write_png(path: &std::path::Path, picture: &LinearImage, display: &Display) -> anyhow::Result<()> {
    let pixels = composite::display(picture, display);
    Ok(lumenscope_core::io::png::write_png(path, picture.width, picture.height, &pixels)?)
}

/// Writes the layers and their sum as one EXR.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write_layers(path: &std::path::Path, layers: &Layers) -> anyhow::Result<()> {
    let sum = layers.total();
    let mut named: Vec<(&str, &LinearImage)> = vec![("", &sum)];
    named.extend(Layer::ALL.map(|l| (l.name(), layers.get(l))));
    Ok(exr::write_layers(path, &named, "cd/m2, linear Rec. 709")?)
}

/// Largest resident size of this process so far, bytes; `None` where the system does not tell.
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

/// The light of some paths, and which layers show it.
fn of_paths(
    solution: &LightTransportSolution,
    paths: &Expression,
) -> anyhow::Result<(LightTransportSolution, [bool; COUNT])> {
    let Some((solution, terms)) = solution.with_paths(paths) else {
        bail!(
            "light paths {paths}: where something is specular no layers are this light; use `reference --paths`"
        );
    };
    let [emitted, direct, indirect, specular] = terms;
    Ok((solution, [emitted, direct, indirect, specular, specular]))
}
