//! `fly`: a recorded walk on the GPU twin, and what flat reflectors cost it, as Bastos 1999, Fig. 6.20 asks.

use super::{Common, fly_path::Walk, fly_report, parse_glossy, parse_size, render::MirrorsName, solve};
use anyhow::{Context, bail};
use clap::Args;
use lumenscope_core::{
    glossy::{
        GlossyMethod,
        particles::light::{PARTICLES, ParticleLight},
    },
    gpu::{FrameSettings, GpuContext, GpuRenderer, Stage, StageClock},
    math::progress::Progress,
    mirror::{MirrorMethod, MirrorSettings, images::MirrorImages, reflectors::Reflectors},
    scene::Scene,
    superposition::composite::DirectQuality,
    transport::LightTransportSolution,
};
use std::{path::PathBuf, sync::Arc, time::Instant};

/// Options of `fly`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    pub(super) scene: PathBuf,
    /// Places on the walk: `seconds,eye_x,eye_y,eye_z,target_x,target_y,target_z`, m.
    #[arg(long)]
    path: PathBuf,
    /// Folder for `fly.csv`, `fly.json` and the chart.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Frames of the walk.
    #[arg(long, default_value_t = 944, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub(super) frames: u32,
    /// Picture size.
    #[arg(long, default_value = "720x486", value_parser = parse_size)]
    pub(super) size: [u32; 2],
    /// Numbers of reflectors that reflect, the largest first: `5`, `0,5` or `0..5`.
    #[arg(long, default_value = "0..5", value_parser = parse_counts)]
    reflectors: Counts,
    /// Convolve what glossy surfaces mirror, by this method: variant, variant_half, invariant (the default) or sharp; or
    /// make it of particles. Without it they mirror sharply.
    #[arg(long, value_parser = parse_glossy, num_args = 0..=1, default_missing_value = "invariant")]
    pub(super) glossy: Option<GlossyMethod>,
    /// Mirrors that light is followed through; the scene's plan by default.
    #[arg(long)]
    depth: Option<u32>,
    /// Where what mirrors show comes from; several are walked in turn.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [MirrorsName::Geometry])]
    mirrors: Vec<MirrorsName>,
    /// Images-with-depth an element; several are walked in turn.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2], value_parser = clap::value_parser!(u32).range(1..=64))]
    count: Vec<u32>,
}

impl Options {
    /// What is walked with: images-with-depth an element, or `None` for geometry.
    fn methods(&self) -> Vec<Option<u32>> {
        let of = |mirrors: &MirrorsName| match mirrors {
            MirrorsName::Geometry => vec![None],
            MirrorsName::Images => self.count.iter().copied().map(Some).collect(),
        };
        self.mirrors.iter().flat_map(of).collect()
    }
}

/// Numbers of reflectors that are walked with, at most.
const MOST_COUNTS: usize = 32;

/// Numbers of reflectors.
#[derive(Clone, Debug)]
struct Counts(Vec<usize>);

fn parse_counts(text: &str) -> Result<Counts, String> {
    let wrong = || format!("`{text}` is not a number, a list or a range of numbers of reflectors");
    let counts = match text.split_once("..") {
        Some((from, to)) => {
            let from: usize = from.parse().map_err(|_| wrong())?;
            (from..=to.parse().map_err(|_| wrong())?).take(MOST_COUNTS + 1).collect()
        }
        None => text
            .split(',')
            .map(|n| n.trim().parse().map_err(|_| wrong()))
            .collect::<Result<Vec<usize>, String>>()?,
    };
    if counts.is_empty() || counts.len() > MOST_COUNTS { Err(wrong()) } else { Ok(Counts(counts)) }
}

/// What one walk cost.
pub(super) struct Row {
    pub(super) reflectors: usize,
    /// Images-with-depth an element, or from the geometry.
    pub(super) images: Option<u32>,
    /// Mirrored views a frame, mean.
    pub(super) views: f64,
    /// Milliseconds of each frame.
    pub(super) milliseconds: Vec<f64>,
    /// Milliseconds of each stage, mean; `None` without timestamps.
    pub(super) stages: Option<[f64; 7]>,
}

impl Row {
    /// Where what its mirrors show comes from.
    pub(super) fn mirrors(&self) -> String {
        self.images
            .map_or("geometry".into(), |count| format!("{count} image{}", if count == 1 { "" } else { "s" }))
    }

    pub(super) fn percentile(&self, share: f64) -> f64 {
        let mut sorted = self.milliseconds.clone();
        sorted.sort_by(f64::total_cmp);
        sorted[((sorted.len() - 1) as f64 * share).round() as usize]
    }

    pub(super) fn mean(&self) -> f64 {
        self.milliseconds.iter().sum::<f64>() / self.milliseconds.len() as f64
    }

    /// Shares of a frame in percent: mirrored views, convolution, modulation, shading.
    fn shares(&self, without: &Self, sharp: Option<&Self>) -> [f64; 4] {
        let share = |milliseconds: f64| 100.0 * milliseconds / self.mean();
        match self.stages {
            Some(stages) => {
                let of = |list: &[Stage]| share(list.iter().map(|s| stages[*s as usize]).sum());
                [
                    of(&[Stage::MirroredVisibility, Stage::MirroredShading]),
                    of(&[Stage::Convolution]),
                    of(&[Stage::Modulation]),
                    of(&[Stage::Shading]),
                ]
            }
            // By differences; modulation and shading cannot be told apart.
            None => {
                let convolution = sharp.map_or(0.0, |s| (self.mean() - s.mean()).max(0.0));
                let views = (self.mean() - convolution - without.mean()).max(0.0);
                [share(views), share(convolution), f64::NAN, f64::NAN]
            }
        }
    }
}

/// Walks once a number of reflectors and prints the table.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let walk = Walk::read(&options.path)?;
    let loaded = solve::load(&options.scene, common)?;
    let solution = solve::solve(&loaded, false)?;
    let found = Reflectors::new(&solution.world.geometry).list.len();
    if let Some(too_many) = options.reflectors.0.iter().find(|n| **n > found) {
        bail!("{}: {too_many} reflectors asked for, {found} found", options.scene.display());
    }
    let solution = match options.mirrors.contains(&MirrorsName::Images) {
        true => {
            let images = MirrorImages::automatic(&solution.world, &Progress::silent())?;
            LightTransportSolution { mirror_images: Some(Arc::new(images)), ..solution }
        }
        false => solution,
    };
    let solution = match options.glossy {
        Some(GlossyMethod::Particles) => {
            let count = solution.scene.plan.glossy_particles.unwrap_or(PARTICLES);
            let sent = ParticleLight::new(&solution.world, count, common.seed, &Progress::silent())?;
            LightTransportSolution { particles: Some(Arc::new(sent)), ..solution }
        }
        _ => solution,
    };
    let context = GpuContext::headless_with(StageClock::FEATURES)?;
    let timed = StageClock::new(&context.device, &context.queue).is_some();
    let (plain, wanted) = (GlossyMethod::Sharp, options.glossy.unwrap_or(GlossyMethod::Sharp));
    let [width, height] = options.size;
    println!(
        "{}: {} triangles, {} frames of {width}x{height} on {}, mirrors to depth {}, glossy {}, {}",
        options.scene.display(),
        solution.world.geometry.len(),
        options.frames,
        context.adapter,
        with_reflectors(&solution, found, options).1,
        wanted.name(),
        if timed { "stages by timestamps" } else { "stages by differences" }
    );
    println!(
        "{:>10}{:>10}{:>9}{:>11}{:>9}{:>10}{:>10}{:>11}{:>12}{:>11}",
        "reflectors",
        "mirrors",
        "views",
        "median ms",
        "95 % ms",
        "frames/s",
        "views %",
        "convol. %",
        "modulation %",
        "shading %"
    );
    let measure = |count: usize, images: Option<u32>, glossy: GlossyMethod| -> anyhow::Result<Row> {
        let (mut solution, _) = with_reflectors(&solution, count, options);
        let plan = &mut Arc::make_mut(&mut solution.scene).plan;
        plan.glossy = Some(glossy);
        plan.mirrors = Some(if images.is_some() { MirrorMethod::Images } else { MirrorMethod::Geometry });
        plan.mirror_images = images;
        Ok(Row { images, ..walk_once(&context, &solution, &walk, count, options)? })
    };
    // Without reflectors twice, before and after: what differs is noise.
    let before = measure(0, None, plain)?;
    let mut rows = Vec::new();
    for &count in &options.reflectors.0 {
        for images in options.methods() {
            let sharp = (wanted != plain && !timed).then(|| measure(count, images, plain)).transpose()?;
            let row = measure(count, images, wanted)?;
            let shares = row.shares(&before, sharp.as_ref());
            print_row(&row, shares);
            rows.push((row, shares));
        }
    }
    let after = measure(0, None, plain)?;
    println!(
        "without reflectors: {:.1} ms before, {:.1} ms after",
        before.percentile(0.5),
        after.percentile(0.5)
    );
    if let Some(out) = &options.out {
        fly_report::write(out, options, &context.adapter, &rows, [&before, &after])?;
    }
    Ok(())
}

fn print_row(row: &Row, shares: [f64; 4]) {
    let shares = shares.map(|s| if s.is_finite() { format!("{s:.1}") } else { "-".into() });
    println!(
        "{:>10}{:>10}{:>9.2}{:>11.1}{:>9.1}{:>10.2}{:>10}{:>11}{:>12}{:>11}",
        row.reflectors,
        row.mirrors(),
        row.views,
        row.percentile(0.5),
        row.percentile(0.95),
        1000.0 / row.mean(),
        shares[0],
        shares[1],
        shares[2],
        shares[3]
    );
}

/// The solution with only the `count` largest reflectors polished, and how deep mirrors are followed.
///
/// What is made dull keeps the light it was solved with: what is shown of it is not right, what it costs is.
fn with_reflectors(
    solution: &LightTransportSolution,
    count: usize,
    options: &Options,
) -> (LightTransportSolution, u32) {
    let reflectors = Reflectors::new(&solution.world.geometry);
    let kept: Vec<u32> = reflectors.list.iter().take(count).map(|r| r.material).collect();
    let mut scene: Scene = (*solution.scene).clone();
    scene.plan.mirror_depth = options.depth.or(scene.plan.mirror_depth);
    let mut world = (*solution.world).clone();
    for (i, material) in world.geometry.materials.iter_mut().enumerate() {
        if !kept.contains(&(i as u32)) {
            (material.roughness, material.metallic, material.transmission) = (1.0, 0.0, 0.0);
        }
    }
    world.glass = world.geometry.has_glass();
    let depth = MirrorSettings::of(&scene.plan).depth;
    let polished = Reflectors::new(&world.geometry).list.len();
    if polished != count {
        log::warn!("{polished} reflectors where {count} are meant: some share a material");
    }
    (LightTransportSolution { scene: Arc::new(scene), world: Arc::new(world), ..solution.clone() }, depth)
}

fn walk_once(
    context: &GpuContext,
    solution: &LightTransportSolution,
    walk: &Walk,
    reflectors: usize,
    options: &Options,
) -> anyhow::Result<Row> {
    let (device, queue) = (&context.device, &context.queue);
    let renderer = || -> anyhow::Result<GpuRenderer> {
        let mut renderer = GpuRenderer::new(device, wgpu::TextureFormat::Rgba8Unorm)?;
        renderer.upload(device, queue, solution)?;
        renderer.set_clock(StageClock::new(device, queue));
        Ok(renderer)
    };
    let draw = |renderer: &mut GpuRenderer, share: f32| -> anyhow::Result<(f64, usize, Option<[f64; 7]>)> {
        let settings = FrameSettings {
            camera: walk.camera(share, &solution.scene.camera),
            size: options.size,
            direct: DirectQuality::Elements,
            ..FrameSettings::default()
        };
        let began = Instant::now();
        let mut encoder = device.create_command_encoder(&Default::default());
        renderer.render(device, queue, &mut encoder, &settings);
        queue.submit([encoder.finish()]);
        device.poll(wgpu::PollType::wait_indefinitely()).context("the device was lost")?;
        let milliseconds = 1e3 * began.elapsed().as_secs_f64();
        let stages = renderer.clock().map(|c| c.read(device, queue)).transpose()?;
        Ok((milliseconds, renderer.mirrored_views(), stages))
    };
    // Pipelines are compiled when first used, and llvmpipe runs what it has just compiled several times slower
    // than what it has from its cache: so one renderer that is thrown away, then the one that is timed. The cache
    // is written in its own time, so only a second run of the command is sure to have all from it.
    draw(&mut renderer()?, 0.0)?;
    let mut renderer = renderer()?;
    for share in [0.0, 0.4] {
        draw(&mut renderer, share)?;
    }
    let (mut milliseconds, mut views, mut sum) = (Vec::new(), 0, None);
    for frame in 0..options.frames {
        let (spent, seen, stages) = draw(&mut renderer, frame as f32 / (options.frames - 1) as f32)?;
        milliseconds.push(spent);
        views += seen;
        if let Some(stages) = stages {
            let sum = sum.get_or_insert([0.0; 7]);
            sum.iter_mut().zip(stages).for_each(|(s, v): (&mut f64, f64)| *s += v);
        }
    }
    let each = |total: f64| total / f64::from(options.frames);
    Ok(Row {
        reflectors,
        images: None,
        views: each(views as f64),
        milliseconds,
        stages: sum.map(|s| s.map(each)),
    })
}
