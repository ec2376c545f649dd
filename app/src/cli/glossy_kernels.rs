//! `glossy --kernels`: what one kernel over a picture costs, by its radius and by the way of summing.

use super::{Common, glossy::Options, solve};
use anyhow::bail;
use glam::{Vec2, Vec3};
use lumenscope_core::{
    glossy::{
        convolution::{Convention, Masked, Way},
        inspect_point::KernelPoint,
        invariant::{Kernel, SplitKernel, convolve},
        kernel::{GlossyPoint, Lens},
        lobes::LobeEntry,
        pyramid::{MOST_LEVELS, Pyramid},
    },
    math::random::hash2,
    mirror::{pass::MirrorImage, reflectors::Reflectors, views::Eye},
    scene::{brdf::Lobe, world::World},
};
use std::{fmt::Write as _, time::Instant};

/// Radii, pixels.
const RADII: [u32; 10] = [1, 2, 3, 5, 8, 12, 20, 32, 48, 80];

/// What is expected to take longer is not timed.
const MOST_MILLISECONDS: f64 = 1500.0;

/// Times both ways and the coarser level for every radius and every roughness of the options (NaN where that is too slow to be tried), as if the whole picture
/// showed the scene's largest glossy reflector.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let loaded = solve::load(&options.scene, common)?;
    let (world, camera) = (World::new(&loaded.scene), &loaded.scene.camera);
    let reflectors = Reflectors::new(&world.geometry);
    let Some(point) = KernelPoint::near(&world.geometry, &reflectors, camera.eye, None) else {
        bail!("{}: no flat glossy reflector faces the camera", options.scene.display());
    };
    let [width, height] = options.size;
    let size = Vec2::new(width as f32, height as f32);
    let lens = Lens { eye: Eye::new(camera, size.x / size.y), size, subpixel: Vec2::splat(0.5) };
    let from_eye = point.position - camera.eye;
    let far = 0.5 / from_eye.length();
    let glossy = |alpha| {
        let lobe = Lobe::new(point.lobe.shape(), alpha);
        GlossyPoint { from_eye, normal: point.normal, lobe }
    };
    let picture = random_picture(options.size);
    println!(
        "one kernel over {width}x{height} pixels, what it mirrors as far behind the surface as the eye is before it, {} threads",
        rayon::current_num_threads()
    );
    println!(
        "{:<16}{:>8}{:>12}{:>12}{:>11}{:>9}{:>12}{:>12}{:>12}{:>7}{:>11}",
        "kernel",
        "radius",
        "direct ms",
        "Fourier ms",
        "expected",
        "chosen",
        "apart",
        "white",
        "forward",
        "level",
        "level ms"
    );
    let mut table = String::from(
        "kernel,radius,direct_milliseconds,fourier_milliseconds,chosen,apart,white_error,forward_difference,level,level_milliseconds\n",
    );
    let of_radius = RADII.iter().map(|&radius| (format!("radius {radius}"), glossy(0.04), radius));
    let of_roughness = options.roughness.iter().map(|&roughness| {
        let glossy = glossy(roughness * roughness);
        let support = LobeEntry::new(glossy.lobe, glossy.cos_theta()).support;
        let radius = Kernel::wanted_radius(&lens, &glossy, far, support);
        (format!("roughness {roughness}"), glossy, radius)
    });
    for (name, glossy, radius) in of_radius.chain(of_roughness) {
        let kernel = Kernel::on_level(&lens, &glossy, far, 0, radius);
        let [direct, fourier] = Way::ALL.map(|way| {
            let expected = way.milliseconds(picture.size, radius);
            (expected < MOST_MILLISECONDS)
                .then(|| timed(|| picture.convolved(&kernel, Convention::Backward, way)))
        });
        let apart = match (&direct, &fourier) {
            (Some(direct), Some(fourier)) => largest(&direct.0, &fourier.0),
            _ => f32::NAN,
        };
        let [direct, fourier] = [direct, fourier].map(|way| way.map_or(f64::NAN, |w| w.1));
        let white = Masked { radiance: vec![Vec3::ONE; picture.radiance.len()], ..picture.clone() };
        let chosen = Way::cheaper(picture.size, radius);
        let [backward, forward] = Convention::ALL.map(|c| white.convolved(&kernel, c, chosen));
        let white = largest(&backward, &white.radiance).max(largest(&forward, &white.radiance));
        let [backward, forward] = Convention::ALL.map(|c| picture.convolved(&kernel, c, chosen));
        let turned = largest(&backward, &forward);
        let expected = chosen.milliseconds(picture.size, radius);
        let (level, on_level) = by_level(&picture, &lens, &glossy, far, radius);
        println!(
            "{name:<16}{radius:>8}{:>12.2}{:>12.2}{expected:>11.2}{:>9}{apart:>12.1e}{white:>12.1e}{turned:>12.1e}{level:>7}{on_level:>11.2}",
            direct,
            fourier,
            chosen.name()
        );
        let _ = writeln!(
            table,
            "{name},{radius},{},{},{},{apart},{white},{turned},{level},{on_level}",
            direct,
            fourier,
            chosen.name()
        );
    }
    match &options.out {
        Some(out) => {
            solve::output_folder(out)?;
            solve::write(&out.join("kernels.csv"), &table)
        }
        None => Ok(()),
    }
}

/// Noise all over.
fn random_picture(size: [u32; 2]) -> Masked {
    let count = size[0] * size[1];
    let radiance = (0..count).map(|i| Vec3::splat((hash2(i, 7) & 255) as f32 / 255.0)).collect();
    Masked { size, radiance, mask: vec![1.0; count as usize] }
}

/// Largest difference of two pictures.
fn largest(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

/// What work gives, and its milliseconds: the least of three, of one where that is long.
fn timed<T>(work: impl Fn() -> T) -> (T, f64) {
    let once = || {
        let start = Instant::now();
        let out = work();
        (out, 1e3 * start.elapsed().as_secs_f64())
    };
    let first = once();
    let again = if first.1 < 200.0 { 2 } else { 0 };
    let least = (0..again).map(|_| once().1).fold(first.1, f64::min);
    (first.0, least)
}

/// The level that holds the peak of the same kernel split, and the milliseconds of summing there, the halving included.
fn by_level(picture: &Masked, lens: &Lens, point: &GlossyPoint, nearness: f32, radius: u32) -> (usize, f64) {
    let [width, height] = picture.size;
    let count = picture.radiance.len();
    let image = MirrorImage {
        width,
        height,
        reflector: vec![0; count],
        radiance: picture.radiance.clone(),
        distance: vec![1.0; count],
        views: 1,
        holes: 0,
    };
    let eye_distance = vec![1.0; count];
    let kernel = SplitKernel::for_radius(lens, point, nearness, radius, MOST_LEVELS);
    let (_, milliseconds) = timed(|| convolve(&Pyramid::new(&image, &eye_distance, |_| true), 0, &kernel));
    (kernel.peak.level, milliseconds)
}
