//! `images`: mirrors shown from images-with-depth, against those shown from the geometry: the data of Bastos
//! 1999, Table 6.1, then error, holes and cost.

use super::{
    Common,
    glossy::flip,
    parse_size,
    render::{auto_display, write_png},
    solve,
};
use anyhow::bail;
use clap::Args;
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::image::LinearImage,
    measure::image,
    mirror::{
        images::{
            LayeredImage, ReflectorImages, SampleSettings, Selection, Splat,
            inspect::HOLE,
            pass::{
                Layered, MirrorPicture, Nearest, diffuse, from_geometry, from_points, reflector_of_pixels,
            },
        },
        reflectors::{NO_REFLECTOR, Reflectors},
    },
    scene::geometry::Geometry,
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
};
use std::{fmt::Write as _, path::PathBuf, time::Instant};

/// Bytes of a pixel of an image-with-depth.
const BYTES_A_PIXEL: f32 = 28.0;

/// Memory that images may take, GB.
const MOST_GIGABYTES: f32 = 8.0;

/// Options of `images`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Folder for `samples.csv`, `images.csv` and the pictures.
    #[arg(long)]
    out: PathBuf,
    /// Picture size.
    #[arg(long, default_value = "720x486", value_parser = parse_size)]
    size: [u32; 2],
    /// Longest side of a reflector element, m.
    #[arg(long, default_value_t = 1.5)]
    element: f32,
    /// Images-with-depth a hemisphere.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=1000))]
    poses: u32,
    /// Radius of the hemispheres, m.
    #[arg(long, default_value_t = 1.6)]
    radius: f32,
    /// Width and height of an image-with-depth, pixels.
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(4..=1024))]
    resolution: u32,
    /// Images an element that are reprojected.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2, 4])]
    count: Vec<usize>,
    /// Choose images by distance instead of by angle.
    #[arg(long)]
    by_distance: bool,
}

/// Samples, shows, compares and prints.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    for (name, value) in [("element", options.element), ("radius", options.radius)] {
        if !(0.01..=1000.0).contains(&value) {
            bail!("--{name} {value} must lie from 0.01 to 1000 m");
        }
    }
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let reflectors = Reflectors::new(&Geometry::new(&loaded.scene));
    if reflectors.is_empty() {
        bail!("{}: nothing flat is polished", options.scene.display());
    }
    let [area, element, poses, side] = [
        reflectors.list.iter().map(|r| r.area).sum(),
        options.element,
        options.poses as f32,
        options.resolution as f32,
    ];
    let gigabytes = 1e-9 * BYTES_A_PIXEL * side * side * poses * (area / (element * element)).max(1.0);
    if gigabytes > MOST_GIGABYTES {
        bail!(
            "{area:.1} m² of mirrors in elements of {element} m with {poses} images of {side}×{side} take about \
             {gigabytes:.0} GB; at most {MOST_GIGABYTES} GB are taken: choose larger elements or fewer images"
        );
    }
    let solution = solve::solve(&loaded, false)?;
    let (world, camera) = (&solution.world, &solution.scene.camera);
    let pass = PassSettings { direct: DirectQuality::Elements, seed: common.seed, ..PassSettings::default() };
    let shading = Shading::new(&solution, &pass);
    let sets = sample(options, &shading, &reflectors)?;
    let layering = Instant::now();
    let layered: Vec<(u32, Vec<LayeredImage>)> = sets
        .iter()
        .map(|set| (set.reflector, set.elements.iter().map(|e| LayeredImage::new(e)).collect()))
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
    let of_pixels = reflector_of_pixels(&reflectors, &buffer, camera.eye);
    let began = Instant::now();
    let exact = from_geometry(&shading, &reflectors, &of_pixels, &buffer, camera);
    let rays = 1e3 * began.elapsed().as_secs_f64();
    if exact.mirrored == 0 {
        bail!("{}: the scene's camera sees no flat reflector", options.scene.display());
    }
    println!("{} of {} pixels show mirrors; a ray each: {rays:.1} ms", exact.mirrored, of_pixels.len());
    println!(
        "{:<9}{:<10}{:>10}{:>10}{:>10}{:>9}{:>9}",
        "images", "splat", "points", "relMSE", "FLIP", "holes %", "ms"
    );
    let mut table = Table { options, of_pixels: &of_pixels, exact: &exact, text: String::new() };
    table.text.push_str("images,splat,points,rel_mse,flip,holes_percent,milliseconds\n");
    let selection = if options.by_distance { Selection::Distance } else { Selection::Angle };
    let show = |points: &dyn Fn(Splat) -> MirrorPicture, splat| {
        let began = Instant::now();
        let shown = points(splat);
        (shown, 1e3 * began.elapsed().as_secs_f64())
    };
    let view = (camera, size);
    for splat in Splat::ALL {
        for &count in &options.count {
            let nearest = Nearest { sets: &sets, selection, count };
            let points = |splat| from_points(&nearest, &reflectors, &of_pixels, view, splat);
            table.row(&count.to_string(), splat, show(&points, splat))?;
        }
    }
    for splat in [Splat::Box, Splat::Gaussian] {
        let points = |splat| from_points(&Layered(&layered), &reflectors, &of_pixels, view, splat);
        table.row("layered", splat, show(&points, splat))?;
    }
    table.picture("geometry", &exact)?;
    solve::write(&options.out.join("images.csv"), &table.text)
}

/// Samples every reflector and prints Table 6.1.
fn sample(
    options: &Options,
    shading: &Shading,
    reflectors: &Reflectors,
) -> anyhow::Result<Vec<ReflectorImages>> {
    let settings = SampleSettings {
        element_m: options.element,
        poses: options.poses,
        radius_m: options.radius,
        resolution: options.resolution,
    };
    let (scene, world) = (&shading.solution.scene, &shading.solution.world);
    let radiance = diffuse(shading);
    println!(
        "{:<24}{:>12}{:>12}{:>12}{:>10}{:>10}",
        "reflector", "hemispheres", "images each", "resolution", "MB", "build s"
    );
    let mut text =
        String::from("reflector,hemispheres,images_per_hemisphere,resolution,bytes,build_seconds\n");
    let mut sets = Vec::new();
    for (number, reflector) in reflectors.list.iter().enumerate() {
        let began = Instant::now();
        let set = ReflectorImages::new((world, &radiance), number as u32, reflector, &settings);
        let seconds = began.elapsed().as_secs_f64();
        let name = &scene.objects[reflector.object as usize].name;
        println!(
            "{name:<24}{:>12}{:>12}{:>12}{:>10.2}{seconds:>10.2}",
            set.elements.len(),
            options.poses,
            format!("{0}x{0}", options.resolution),
            1e-6 * set.bytes() as f64
        );
        let _ = writeln!(
            text,
            "{name},{},{},{},{},{seconds}",
            set.elements.len(),
            options.poses,
            options.resolution,
            set.bytes()
        );
        sets.push(set);
    }
    solve::write(&options.out.join("samples.csv"), &text)?;
    Ok(sets)
}

struct Table<'a> {
    options: &'a Options,
    of_pixels: &'a [u32],
    exact: &'a MirrorPicture,
    text: String,
}

impl Table<'_> {
    /// Prints how a picture differs, and writes it.
    fn row(&mut self, name: &str, splat: Splat, (shown, ms): (MirrorPicture, f64)) -> anyhow::Result<()> {
        let rel_mse = image::rel_mse(&self.mirrors(&shown), &self.mirrors(self.exact))?;
        let flip = flip(&self.whole(&shown, Vec3::ZERO), &self.whole(self.exact, Vec3::ZERO))?;
        let holes = 100.0 * shown.hole_share();
        println!(
            "{name:<9}{:<10}{:>10}{rel_mse:>10.4}{flip:>10.4}{holes:>9.2}{ms:>9.1}",
            splat.name(),
            shown.points
        );
        let _ = writeln!(self.text, "{name},{},{},{rel_mse},{flip},{holes},{ms}", splat.name(), shown.points);
        self.picture(&format!("{name}_{}", splat.name()), &shown)
    }

    /// The pixels of the mirrors alone, as an image of one row.
    fn mirrors(&self, picture: &MirrorPicture) -> LinearImage {
        let seen = picture.radiance.iter().zip(self.of_pixels).filter(|(_, r)| **r != NO_REFLECTOR);
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
