//! `images`: mirrors shown from images-with-depth, against those shown from the geometry: the data of Bastos
//! 1999, Table 6.1, then error, holes and cost.

use super::{
    Common,
    glossy::flip,
    images_moved, parse_point, parse_size,
    render::{auto_display, write_png},
    solve,
};
use anyhow::bail;
use clap::Args;
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::{image::LinearImage, progress::Progress},
    measure::image,
    mirror::{
        images::{
            LayeredImage, MirrorImages, SampleSettings, Selection, Splat,
            inspect::HOLE,
            pass::{Frame, Layered, MirrorPicture, Nearest, diffuse},
        },
        reflectors::Reflectors,
    },
    scene::{Scene, geometry::Geometry, world::World},
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
};
use std::{fmt::Write as _, path::PathBuf, time::Instant};

/// Options of `images`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Folder for `samples.csv`, `images.csv`, `moved.csv` and the pictures.
    #[arg(long)]
    out: PathBuf,
    /// Picture size.
    #[arg(long, default_value = "720x486", value_parser = parse_size)]
    size: [u32; 2],
    /// Longest side of a reflector element, m. Without this and the next three each reflector is sampled as its size
    /// asks; with any of them all are alike, in elements of 1.5 m, 12 images of 128×128 from 1.6 m.
    #[arg(long)]
    element: Option<f32>,
    /// Images-with-depth a hemisphere.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000))]
    poses: Option<u32>,
    /// Radius of the hemispheres, m.
    #[arg(long)]
    radius: Option<f32>,
    /// Width and height of an image-with-depth, pixels: a power of two from 8 to 1024.
    #[arg(long)]
    resolution: Option<u32>,
    /// Images an element that are reprojected.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2, 4], value_parser = clap::value_parser!(u32).range(1..))]
    count: Vec<u32>,
    /// Choose images by distance instead of by angle.
    #[arg(long)]
    by_distance: bool,
    /// Movable objects by name, each moved alone: what keeping the images costs then, and what taking them anew.
    #[arg(long = "move", value_delimiter = ',')]
    moved: Vec<String>,
    /// How far they are moved, m.
    #[arg(long, default_value = "0.3,0,0", value_parser = parse_point, allow_hyphen_values = true)]
    by: Vec3,
}

/// Samples, shows, compares and prints.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    for (name, value) in [("element", options.element), ("radius", options.radius)] {
        if let Some(value) = value.filter(|v| !(0.01..=1000.0).contains(v)) {
            bail!("--{name} {value} must lie from 0.01 to 1000 m");
        }
    }
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let reflectors = Reflectors::new(&Geometry::new(&loaded.scene));
    if reflectors.is_empty() {
        bail!("{}: nothing flat is polished", options.scene.display());
    }
    // What does not fit is told before the light is solved.
    let began = Instant::now();
    let mut images = options.sample(&World::new(&loaded.scene))?;
    let seconds = began.elapsed().as_secs_f64();
    if !options.moved.is_empty() {
        let anew = |world: &World| options.sample(world);
        images_moved::run(&loaded.scene, &images, (&options.moved, options.by), &anew, &options.out)?;
    }
    let solution = solve::solve(&loaded, false)?;
    let (world, camera) = (&solution.world, &solution.scene.camera);
    let pass = PassSettings { direct: DirectQuality::Elements, seed: common.seed, ..PassSettings::default() };
    let shading = Shading::new(&solution, &pass);
    images.recolour(world, &diffuse(&shading));
    describe(options, &solution.scene, &reflectors, &images, seconds)?;
    let layering = Instant::now();
    let layered: Vec<(u32, Vec<LayeredImage>)> = images
        .sets
        .iter()
        .map(|set| (set.triangle, set.elements.iter().map(|e| LayeredImage::new(e)).collect()))
        .collect();
    let layering = layering.elapsed().as_secs_f64();
    let all = || layered.iter().flat_map(|(_, images)| images);
    println!(
        "layered: {} points of {}, {:.2} MB, {} layers at most, {layering:.2} s",
        all().map(|l| l.points.len()).sum::<usize>(),
        all().map(|l| l.merged_from).sum::<usize>(),
        1e-6 * all().map(LayeredImage::bytes).sum::<usize>() as f64,
        all().map(|l| l.layers).max().unwrap_or(0)
    );

    let size = UVec2::from(options.size);
    let buffer = GBuffer::new(world, camera, size, Vec2::splat(0.5));
    let frame = Frame::new(world, &reflectors, &buffer, camera);
    let began = Instant::now();
    let exact = frame.from_geometry(&shading);
    let rays = 1e3 * began.elapsed().as_secs_f64();
    if exact.mirrored == 0 {
        bail!("{}: the scene's camera sees no flat reflector", options.scene.display());
    }
    println!("{} of {} pixels show mirrors; a ray each: {rays:.1} ms", exact.mirrored, frame.of_pixels.len());
    println!(
        "{:<9}{:<10}{:>10}{:>10}{:>10}{:>9}{:>9}",
        "images", "splat", "points", "relMSE", "FLIP", "holes %", "ms"
    );
    let mut table = Table { options, of_pixels: &frame.of_pixels, exact: &exact, text: String::new() };
    table.text.push_str("images,splat,points,rel_mse,flip,holes_percent,milliseconds,holes\n");
    let selection = if options.by_distance { Selection::Distance } else { Selection::Angle };
    let timed = |show: &dyn Fn() -> MirrorPicture| {
        let began = Instant::now();
        let shown = show();
        (shown, 1e3 * began.elapsed().as_secs_f64())
    };
    let nearest = |count: u32| Nearest { images: &images, selection, count: count as usize };
    for splat in Splat::ALL {
        for &count in &options.count {
            let shown = timed(&|| frame.from_points(&nearest(count), splat));
            table.row(&count.to_string(), splat.name(), shown)?;
        }
    }
    for &count in &options.count {
        table.row(&count.to_string(), "ids", timed(&|| frame.from_ids(&nearest(count), &shading)))?;
    }
    for splat in [Splat::Box, Splat::Gaussian] {
        let shown = timed(&|| frame.from_points(&Layered(&layered), splat));
        table.row("layered", splat.name(), shown)?;
    }
    table.picture("geometry", &exact)?;
    solve::write(&options.out.join("images.csv"), &table.text)
}

impl Options {
    fn sample(&self, world: &World) -> anyhow::Result<MirrorImages> {
        let chosen = self.element.is_some() || self.poses.is_some() || self.radius.is_some();
        if !chosen && self.resolution.is_none() {
            return Ok(MirrorImages::automatic(world, &Progress::silent())?);
        }
        let usual = SampleSettings::default();
        let settings = SampleSettings {
            element_m: self.element.unwrap_or(usual.element_m),
            poses: self.poses.unwrap_or(usual.poses),
            radius_m: self.radius.unwrap_or(usual.radius_m),
            resolution: self.resolution.unwrap_or(usual.resolution),
        };
        Ok(MirrorImages::new(world, &settings, &Progress::silent())?)
    }
}

/// Prints Bastos 1999, Table 6.1, and writes it.
fn describe(
    options: &Options,
    scene: &Scene,
    reflectors: &Reflectors,
    images: &MirrorImages,
    seconds: f64,
) -> anyhow::Result<()> {
    println!("{:<24}{:>12}{:>12}{:>12}{:>10}", "reflector", "hemispheres", "images each", "resolution", "MB");
    let mut text = String::from("reflector,side,hemispheres,images_per_hemisphere,resolution,bytes\n");
    for set in &images.sets {
        let reflector = reflectors.list.iter().find(|r| r.triangles[0] == set.triangle);
        let name = reflector.map_or("", |r| &scene.objects[r.object as usize].name);
        let side = if set.back { "back" } else { "front" };
        let (poses, resolution) = (set.settings.poses, set.settings.resolution);
        println!(
            "{:<24}{:>12}{poses:>12}{:>12}{:>10.2}",
            if set.back { format!("{name}, back") } else { name.to_owned() },
            set.elements.len(),
            format!("{resolution}x{resolution}"),
            1e-6 * set.bytes() as f64
        );
        let _ = writeln!(text, "{name},{side},{},{poses},{resolution},{}", set.elements.len(), set.bytes());
    }
    println!("{:.2} MB with colours, taken in {seconds:.2} s", 1e-6 * images.bytes() as f64);
    solve::write(&options.out.join("samples.csv"), &text)
}

struct Table<'a> {
    options: &'a Options,
    of_pixels: &'a [u32],
    exact: &'a MirrorPicture,
    text: String,
}

impl Table<'_> {
    /// Prints how a picture differs, and writes it.
    fn row(&mut self, name: &str, splat: &str, (shown, ms): (MirrorPicture, f64)) -> anyhow::Result<()> {
        let rel_mse = image::rel_mse(&self.mirrors(&shown), &self.mirrors(self.exact))?;
        let flip = flip(&self.whole(&shown, Vec3::ZERO), &self.whole(self.exact, Vec3::ZERO))?;
        let holes = 100.0 * shown.hole_share();
        println!(
            "{name:<9}{:<10}{:>10}{rel_mse:>10.4}{flip:>10.4}{holes:>9.2}{ms:>9.1}",
            splat, shown.points
        );
        let counts = (shown.points, shown.holes());
        let _ = writeln!(self.text, "{name},{splat},{},{rel_mse},{flip},{holes},{ms},{}", counts.0, counts.1);
        self.picture(&format!("{name}_{splat}"), &shown)
    }

    /// The pixels of the mirrors alone, as an image of one row.
    fn mirrors(&self, picture: &MirrorPicture) -> LinearImage {
        let seen = picture.radiance.iter().zip(self.of_pixels).filter(|(_, view)| **view != 0);
        let pixels: Vec<Vec3> = seen.map(|(radiance, _)| *radiance).collect();
        LinearImage { width: pixels.len() as u32, height: 1, pixels }
    }

    /// The whole picture, holes in a colour.
    fn whole(&self, picture: &MirrorPicture, hole: Vec3) -> LinearImage {
        let [width, height] = self.options.size;
        let pixels = picture.radiance.iter().zip(&picture.hole);
        let pixels = pixels.map(|(radiance, is_hole)| if *is_hole { hole } else { *radiance }).collect();
        LinearImage { width, height, pixels }
    }

    fn picture(&self, name: &str, picture: &MirrorPicture) -> anyhow::Result<()> {
        let display = auto_display(&self.whole(self.exact, Vec3::ZERO));
        let shown = self.whole(picture, HOLE * 4000.0);
        write_png(&self.options.out.join(format!("{name}.png")), &shown, &display)
    }
}
