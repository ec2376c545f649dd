//! The command line: one binary, one subcommand a job, one clear line when something is wrong.

/// As the standard one, except that a reader who closes the pipe, such as `head`, does not end the job.
macro_rules! println {
    ($($what:tt)*) => {{
        use std::io::Write as _;
        if let Err(error) = writeln!(std::io::stdout(), $($what)*)
            && error.kind() != std::io::ErrorKind::BrokenPipe
        {
            panic!("standard output cannot be written: {error}");
        }
    }};
}

mod bake;
mod chart;
mod compare;
mod compare_volumes;
mod copies;
mod cost;
mod element_options;
mod fly;
mod fly_path;
mod fly_report;
mod framed;
mod glossy;
mod glossy_judge;
mod glossy_kernels;
mod glossy_particles;
mod glossy_sheet;
mod headless;
mod images;
mod images_moved;
mod irradiance;
mod kernel;
mod leaks;
mod lightmap;
mod page;
pub mod panorama;
pub mod placement;
mod placement_map;
mod plot;
mod probe;
mod radial_svg;
mod reference;
mod reflectance;
mod render;
mod replay;
mod report;
mod screenshots;
mod small_png;
mod solve;
mod surface_texture;
mod table;
mod textures;
mod tour;
mod tour_volumes;
mod view;
mod volume;
mod volume_options;
mod volume_table;
pub mod wall;

use anyhow::Context;
use clap::{Args, Parser, Subcommand};
use lumenscope_core::glossy::GlossyMethod;
use std::{ffi::OsString, path::PathBuf};

/// See where light flows in a scene, where it came from, and how well a method has captured it.
#[derive(Parser)]
#[command(name = "lumenscope", version, after_help = "Example: lumenscope scenes/office/office.ron")]
struct Cli {
    /// Scene (.ron, .gltf, .glb, .obj) or session (.lumenscope) to open in the window.
    file: Option<PathBuf>,
    #[command(subcommand)]
    command: Option<Job>,
    #[command(flatten)]
    common: Common,
}

/// What every subcommand takes.
#[derive(Args, Clone)]
pub struct Common {
    /// Seed of every random number.
    #[arg(long, default_value_t = 1, global = true)]
    pub seed: u64,
    /// Threads; 0 takes one a core. The result does not depend on it.
    #[arg(long, default_value_t = 0, global = true)]
    pub threads: usize,
    /// Relative error wanted of surface irradiance; settings the scene file leaves open follow from it.
    #[arg(long, default_value_t = 0.04, global = true)]
    pub tolerance: f32,
    /// Layout of radiosity's elements.
    #[command(flatten)]
    pub elements: element_options::ElementOptions,
}

#[derive(Subcommand)]
enum Job {
    /// Render a picture, its layers and a report.
    #[command(after_help = "Example: lumenscope render scenes/office/office.ron --out out --size 1280x720")]
    Render(render::Options),
    /// Irradiance at points listed in a CSV file.
    #[command(
        after_help = "Example: lumenscope irradiance scenes/cornell/cornell.ron --points in.csv --method radiosity --out out.csv"
    )]
    Irradiance(irradiance::Options),
    /// Radiance and irradiance spheres at one point.
    #[command(
        after_help = "Example: lumenscope probe scenes/office/office.ron --at 1.0,1.2,0.5 --out out --bins 1682"
    )]
    Probe(probe::Options),
    /// Build and save the irradiance volume.
    #[command(after_help = "Example: lumenscope volume scenes/office/office.ron --out office.volume")]
    Volume(volume::Options),
    /// Illuminance on a plane or an object's top: numbers, map, and what a task still lacks.
    #[command(
        after_help = "Example: lumenscope placement scenes/office/office.ron --plane Desk --task \"Writing, reading, screens\" --out out"
    )]
    Placement(placement::Options),
    /// A cinder-block wall of 612,000 polygons streamed by and lit from the volume.
    #[command(after_help = "Example: lumenscope wall scenes/office/office.ron --out out")]
    Wall(wall::Options),
    /// One object twice, side by side, lit by two volumes at once.
    #[command(
        after_help = "Example: lumenscope copies scenes/office/office.ron --object Mug --left 5:all --right 17:all --out out"
    )]
    Copies(copies::Options),
    /// What an object lit from the volume costs a frame while it moves.
    #[command(after_help = "Example: lumenscope cost scenes/office/office.ron --model bunny.obj")]
    Cost(cost::Options),
    /// A recorded walk on the graphics device: frames a second with more and more flat reflectors.
    #[command(
        after_help = "Example: lumenscope fly scenes/house/house.ron --path scenes/house/path.csv --frames 120"
    )]
    Fly(fly::Options),
    /// A latitude-longitude picture of everything around a point, in cd/m².
    #[command(
        after_help = "Example: lumenscope panorama scenes/office/office.ron --at 0,1.2,0.5 --out p.exr"
    )]
    Panorama(panorama::Options),
    /// Make an irradiance volume of panoramas taken at known places.
    #[command(after_help = "Example: lumenscope panoramas nodes.ron --out pictures.volume")]
    Panoramas(panorama::VolumeOptions),
    /// Path-traced picture with the variance of every pixel.
    #[command(
        after_help = "Example: lumenscope reference scenes/cornell/cornell.ron --out ref.exr --spp 256"
    )]
    Reference(reference::Options),
    /// Difference of two EXR pictures or irradiance volumes in numbers and images.
    #[command(after_help = "Example: lumenscope compare out/layers.exr ref.exr --out difference")]
    Compare(compare::Options),
    /// Seconds against error: every method at many settings, held to the path tracer.
    #[command(after_help = "Example: lumenscope chart scenes/office/office.ron --out out")]
    Chart(chart::Options),
    /// Replay a recorded drag, timing every step.
    #[command(
        after_help = "Example: lumenscope replay scenes/office/office.ron --script scenes/office/drag.ron --out out"
    )]
    Replay(replay::Options),
    /// A lightmap baked elsewhere against our light: errors, seams, overlaps, leaks.
    #[command(after_help = "Example: lumenscope lightmap room.glb --map baked.exr --out out")]
    Lightmap(lightmap::Options),
    /// Our light as a lightmap over a scene's texture coordinates, or over coordinates packed here.
    #[command(after_help = "Example: lumenscope bake room.glb --out light.exr --size 1024x1024")]
    Bake(bake::Options),
    /// Ways of reconstructing radiosity from few samples, judged on a bright spot whose light is known, or the stages
    /// of one surface of a scene against the path tracer.
    #[command(after_help = "Example: lumenscope textures --out out --samples 5")]
    Textures(textures::Options),
    /// Ways of convolving what glossy surfaces mirror, judged against the path tracer by roughness.
    #[command(after_help = "Example: lumenscope glossy scenes/glossy/teapot.ron --out out")]
    Glossy(glossy::Options),
    /// The kernel of one glossy point: footprint, image, lobe, spectrum and the sampling it needs.
    #[command(after_help = "Example: lumenscope kernel scenes/glossy/teapot.ron --out out")]
    Kernel(kernel::Options),
    /// Mirrors shown from images-with-depth against those shown from the geometry.
    #[command(after_help = "Example: lumenscope images scenes/house/house.ron --out out")]
    Images(images::Options),
    /// How polished materials reflect by angle: maps, graphs, and what that makes of a mirror image.
    #[command(
        after_help = "Example: lumenscope reflectance scenes/mirror/pyramid.ron --metal 0.63,0.56,0.37 --out out"
    )]
    Reflectance(reflectance::Options),
    /// What the window's views show, as pictures with their legends and as numbers.
    #[command(
        after_help = "Example: lumenscope view scenes/office/office.ron --view radiosity.irradiance --percentiles 2,98 --out out"
    )]
    View(view::Options),
    /// Everything in a scene that would make light wrong.
    #[command(after_help = "Example: lumenscope check model.glb")]
    Check {
        /// Scene file.
        scene: PathBuf,
    },
    /// Rewrite `screenshots/`: pictures of every scene, layer and view, made by the program.
    #[command(after_help = "Example: lumenscope screenshots --out screenshots")]
    Screenshots(screenshots::Options),
}

/// Parses arguments, the program's name first, and does what they ask. Prints and leaves the process
/// where they ask for help or cannot be parsed.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> anyhow::Result<()> {
    let cli = Cli::parse_from(arguments);
    if cli.common.threads > 0 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(cli.common.threads);
        pool.build_global().context("cannot start threads")?;
    }
    let common = &cli.common;
    match cli.command {
        None => headless::window_or_files(cli.file, common),
        Some(Job::Render(options)) => render::run(&options, common),
        Some(Job::Irradiance(options)) => irradiance::run(&options, common),
        Some(Job::Probe(options)) => probe::run(&options, common),
        Some(Job::Volume(options)) => volume::run(&options, common),
        Some(Job::Placement(options)) => placement::run(&options, common),
        Some(Job::Wall(options)) => wall::run(&options, common),
        Some(Job::Copies(options)) => copies::run(&options, common),
        Some(Job::Cost(options)) => cost::run(&options, common),
        Some(Job::Fly(options)) => fly::run(&options, common),
        Some(Job::Panorama(options)) => panorama::run(&options, common),
        Some(Job::Panoramas(options)) => panorama::volume(&options),
        Some(Job::Reference(options)) => reference::run(&options, common),
        Some(Job::Compare(options)) => compare::run(&options),
        Some(Job::Chart(options)) => chart::run(&options, common),
        Some(Job::Replay(options)) => replay::run(&options, common),
        Some(Job::Lightmap(options)) => lightmap::run(&options, common),
        Some(Job::Bake(options)) => bake::run(&options, common),
        Some(Job::Textures(options)) => textures::run(&options, common),
        Some(Job::Glossy(options)) => glossy::run(&options, common),
        Some(Job::Kernel(options)) => kernel::run(&options, common),
        Some(Job::Images(options)) => images::run(&options, common),
        Some(Job::Reflectance(options)) => reflectance::run(&options, common),
        Some(Job::View(options)) => view::run(&options, common),
        Some(Job::Check { scene }) => solve::check(&scene),
        Some(Job::Screenshots(options)) => screenshots::run(&options, common),
    }
}

/// `WIDTHxHEIGHT`.
fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    match parsed {
        Some([w, h]) if (1..=16384).contains(&w) && (1..=16384).contains(&h) => Ok([w, h]),
        _ => Err(format!("`{text}` is not WIDTHxHEIGHT with both from 1 to 16384")),
    }
}

/// A method of glossy reflection by its name.
fn parse_glossy(text: &str) -> Result<GlossyMethod, String> {
    let names = || GlossyMethod::ALL.map(GlossyMethod::name).join(", ");
    let found = GlossyMethod::ALL.into_iter().find(|m| m.name() == text);
    found.ok_or_else(|| format!("`{text}` is not one of {}", names()))
}

/// `X,Y,Z` in metres.
fn parse_point(text: &str) -> Result<glam::Vec3, String> {
    let numbers: Vec<f32> =
        text.split(',').filter_map(|n| n.trim().parse().ok()).filter(|n: &f32| n.is_finite()).collect();
    match numbers[..] {
        [x, y, z] if text.split(',').count() == 3 => Ok(glam::Vec3::new(x, y, z)),
        _ => Err(format!("`{text}` is not X,Y,Z in metres")),
    }
}
