//! Rays of a point: through mirrors, and aimed at what is bright.

use super::*;
use lumenscope_core::irradiance_volume::rays::{NO_ELEMENT, Patch, Source, Targets, trace_point};
use lumenscope_core::scene::fresnel;

/// A room of 3 × 2.5 × 4 m whose faces named in `mirrors` reflect `reflectance` like mirrors.
fn mirrored_room(mirrors: &[usize], reflectance: f32, emission: [Vec3; 6]) -> Scene {
    let mut scene = room(emission);
    for &face in mirrors {
        let material = &mut scene.materials[face];
        (material.metallic, material.roughness) = (1.0, 0.0);
        material.reflectance = Vec3::splat(reflectance);
    }
    scene
}

/// How often a ray from `p` along `d` crosses the planes x = 3 k before it leaves 0 < y < 2.5, 0 < z < 4,
/// in the unfolded room, and which of those walls stops it.
fn unfolded(p: Vec3, d: Vec3) -> u32 {
    let to = |p: f32, d: f32, size: f32| match d {
        _ if d > 0.0 => (size - p) / d,
        _ if d < 0.0 => -p / d,
        _ => f32::INFINITY,
    };
    let t = to(p.y, d.y, 2.5).min(to(p.z, d.z, 4.0));
    let x = p.x + t * d.x;
    (x / 3.0).floor().abs() as u32
}

#[test]
fn a_chain_between_two_mirrors_is_the_power_of_their_reflectance() {
    let (reflectance, radiance, cutoff) = (0.8f32, 5.0, 0.5);
    let scene = mirrored_room(&[0, 1], reflectance, [Vec3::ZERO; 6]);
    let world = World::new(&scene);
    let light = PerTriangle(vec![Vec3::splat(PI * radiance); 12]);
    let settings = VolumeSettings { specular_cutoff: cutoff, ..VolumeSettings::default() };
    // Off the middle, so that no ray meets an edge exactly.
    let p = Vec3::new(1.31, 1.17, 1.93);
    let probe = Probe::with(&world, &light, p, &settings, &Targets::default(), 0);
    let (mut longest, mut given_up) = (0, 0);
    for (bin, seen) in probe.radiance.iter().enumerate() {
        let reflections = unfolded(p, probe.bins.centre(bin));
        let cos_theta = probe.bins.centre(bin).x.abs();
        let left = fresnel::reflectance(reflectance, cos_theta).powi(reflections as i32);
        let expected = if left >= cutoff { left * radiance } else { 0.0 };
        given_up += u32::from(left < cutoff);
        longest = longest.max(if left >= cutoff { reflections } else { 0 });
        // Sums of rounding over three reflections.
        assert!((seen.x - expected).abs() < 1e-4 * radiance, "bin {bin}: {} for {expected}", seen.x);
    }
    // At normal incidence 0.8³ = 0.51 is followed, 0.8⁴ = 0.41 is not; near grazing more are.
    assert!(longest >= 3 && given_up > 0, "{longest} {given_up}");
}

#[test]
fn an_emitter_in_a_mirror_is_light_that_has_bounced() {
    let mut emission = [Vec3::ZERO; 6];
    emission[1] = Vec3::splat(50.0);
    let mut scene = mirrored_room(&[0], 0.5, emission);
    scene.materials[1..].iter_mut().for_each(|m| m.reflectance = Vec3::ZERO);
    let world = World::new(&scene);
    let p = Vec3::new(1.31, 1.17, 1.93);
    let light = PerTriangle(vec![Vec3::ZERO; 12]);
    let probe = Probe::with(&world, &light, p, &VolumeSettings::default(), &Targets::default(), 0);
    let mut seen = 0;
    for (bin, l) in probe.reflected_radiance.iter().enumerate() {
        let d = probe.bins.centre(bin);
        // By way of the wall x = 0 to x = 3, that is −3 in the unfolded room.
        let in_mirror = d.x < 0.0 && unfolded(p, d) >= 2;
        seen += u32::from(in_mirror);
        let wanted = if in_mirror { 50.0 * fresnel::reflectance(0.5, d.x.abs()) } else { 0.0 };
        assert!((l.x - wanted).abs() < 2e-4, "bin {bin}: {}", l.x);
    }
    assert!(seen > 10, "{seen}");
    let volume = build(&scene, &light, &small([3, 3, 3]));
    let [built, traced] = [volume.clone(), volume.of_reference(&world, 16, &Progress::silent()).unwrap()]
        .map(|v| v.irradiance(p, Vec3::NEG_X, Part::Indirect).x);
    // Rays through bin centres and through random points of bins part at the mirror image's edges: a row of
    // bins in seventeen a hemisphere.
    assert!(built > 1.0 && (traced / built - 1.0).abs() < 0.05, "{traced} for {built}");
}

/// Walls of radiance 1 and one small bright square on the wall x = 0; elements are quads.
struct Bright {
    radiosity: Vec<Vec3>,
    corner: Vec3,
    edge: f32,
}

impl Bright {
    fn new(radiance: f32, edge: f32) -> (Scene, Self) {
        let mut scene = room([Vec3::ZERO; 6]);
        let corner = Vec3::new(0.01, 1.4, 2.3);
        let square =
            [(0.0, 0.0), (edge, 0.0), (edge, edge), (0.0, edge)].map(|(y, z)| corner + Vec3::new(0.0, y, z));
        add(&mut scene, "square", Mesh::quad(square), Material::default());
        let mut radiosity = vec![Vec3::splat(PI); 7];
        radiosity[6] = Vec3::splat(PI * radiance);
        (scene, Self { radiosity, corner, edge })
    }
}

impl SurfaceLight for Bright {
    fn element_at(&self, triangle: u32, _: Vec2, back: bool) -> u32 {
        if back { NO_ELEMENT } else { triangle / 2 }
    }

    fn radiosity(&self) -> &[Vec3] {
        &self.radiosity
    }

    fn patch(&self, element: u32) -> Option<Patch> {
        let edges = [Vec3::Y * self.edge, Vec3::Z * self.edge];
        let bright = Patch { centre: self.corner + 0.5 * (edges[0] + edges[1]), edges, normal: Vec3::X };
        // The walls as one far patch each, so that the mean radiosity is theirs.
        let wall = Patch { edges: [Vec3::Y * 3.0, Vec3::Z * 3.0], ..bright };
        Some(if element == 6 { bright } else { wall })
    }
}

#[test]
fn aimed_rays_keep_the_mean_and_lower_the_variance() {
    let (radiance, edge) = (400.0, 0.1);
    let (scene, light) = Bright::new(radiance, edge);
    let world = World::new(&scene);
    let targets = Targets::new(&light);
    assert_eq!(targets.len(), 1);
    let p = Vec3::new(1.7, 1.1, 1.6);
    let towards = (light.corner + 0.5 * edge * Vec3::new(0.0, 1.0, 1.0) - p).normalize();
    // Radiance 1 everywhere, and what the square is above that; one exact bin holds the normal.
    let factor =
        |n: Vec3| -> f64 { (12..14).map(|t| polygon_irradiance(p, n, &world.geometry.positions[t])).sum() };
    let runs = 48;
    let of = |informed: u32, supersample: u32| -> (f64, f64) {
        let values: Vec<f64> = (0..runs)
            .map(|seed| {
                let settings = VolumeSettings {
                    seed,
                    informed_rays: informed,
                    supersample,
                    ..VolumeSettings::default()
                };
                let probe = Probe::with(&world, &light, p, &settings, &targets, seed as u32 * 977);
                f64::from(probe.indirect[probe.bins.bin(towards)].x)
            })
            .collect();
        let mean = values.iter().sum::<f64>() / runs as f64;
        (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (runs - 1) as f64)
    };
    let bin = DirectionBins::new(17);
    let normal = bin.centre(bin.bin(towards));
    let exact = f64::from(PI) + f64::from(radiance - 1.0) * factor(normal);
    let (plain, plain_variance) = of(0, 4);
    let (aimed, aimed_variance) = of(64, 4);
    eprintln!("exact {exact}, plain {plain} ± {plain_variance}, aimed {aimed} ± {aimed_variance}");
    for (mean, variance) in [(plain, plain_variance), (aimed, aimed_variance)] {
        // Four standard errors of the runs, and 0.5 % for cosines taken at the centres of bins.
        let tolerance = 4.0 * (variance / runs as f64).sqrt() + 0.005 * exact;
        assert!((mean - exact).abs() < tolerance, "{mean} for {exact}");
    }
    // The square covers 0.003 sr, a seventh of a bin: some 0.6 of its four rays meet it. Of 64 aimed
    // ones all do; what remains is the walls' share.
    assert!(aimed_variance < 0.05 * plain_variance, "{aimed_variance} {plain_variance}");
    // With one ray through the centre of each bin, aimed rays mend what the centre misses.
    let settings = VolumeSettings { informed_rays: 64, ..VolumeSettings::default() };
    let probe = Probe::with(&world, &light, p, &settings, &targets, 1);
    let one = f64::from(probe.indirect[probe.bins.bin(towards)].x);
    assert!((one / exact - 1.0).abs() < 0.05, "{one} for {exact}");
}

#[test]
fn weights_of_rays_are_those_of_the_balance_heuristic() {
    let (scene, light) = Bright::new(400.0, 0.5);
    let world = World::new(&scene);
    let targets = Targets::new(&light);
    let p = Vec3::new(1.2, 1.1, 1.6);
    let settings = VolumeSettings { informed_rays: 32, supersample: 2, ..VolumeSettings::default() };
    let bins = DirectionBins::new(17);
    let hits = trace_point(&world, &light, bins, &settings, &targets, p, 3);
    assert!(hits.extras.iter().all(|e| e.source == Source::Element(6)));
    // Aimed rays count between nothing and a whole ray; what bins give up is negative, at most a ray's half.
    let (given, taken): (Vec<f32>, Vec<f32>) = hits.extras.iter().map(|e| e.factor.x).partition(|f| *f > 0.0);
    assert_eq!(given.len(), 32);
    assert!(given.iter().all(|f| *f < 0.5) && taken.iter().all(|f| (-0.5..0.0).contains(f)));
    assert_eq!(taken.len(), hits.elements.iter().filter(|e| **e == 6).count());
}

#[test]
fn the_distance_of_two_spheres_is_the_mean_relative_error() {
    use lumenscope_core::irradiance_volume::adaptive::sphere_distance;
    // |1.1 − 1| / 1, |2 − 4| / 4, and 0.3 over the floor of 1.
    let distance = sphere_distance(&[1.1, 2.0, 0.5], &[1.0, 4.0, 0.2], 1.0);
    assert!((distance - (0.1 + 0.5 + 0.3) / 3.0).abs() < 1e-6, "{distance}");
    assert_eq!(sphere_distance(&[3.0], &[3.0], 1.0), 0.0);
}

#[test]
fn cells_are_divided_where_light_changes() {
    use lumenscope_core::irradiance_volume::{adaptive::cell_errors, grid::NONE};
    // Constant light: nothing to divide, however small the tolerance.
    let constant = PerTriangle(vec![Vec3::splat(10.0); 12]);
    let settings = VolumeSettings { refine_tolerance: Some(0.01), ..small([4, 4, 5]) };
    let volume = build(&room([Vec3::ZERO; 6]), &constant, &settings);
    assert_eq!(volume.grid().second_level_grids(), 0);
    // A lamp: cells around it, fewer the larger the tolerance, worst first within the target.
    let mut scene = room([Vec3::ZERO; 6]);
    let lamp = Vec3::new(0.7, 1.6, 0.9);
    scene.lamps.push(point_lamp(lamp, 40.0));
    let world = World::new(&scene);
    let light = PerTriangle(vec![Vec3::splat(PI * 5.0); 12]);
    let grid = settings.grid(&world).unwrap();
    let errors = cell_errors(&world, &light, &settings, &grid, &Progress::silent()).unwrap();
    let divided = |tolerance: f32, target_samples: u32| {
        let settings =
            VolumeSettings { refine_tolerance: Some(tolerance), target_samples, ..small([4, 4, 5]) };
        build(&scene, &light, &settings)
    };
    for tolerance in [0.05, 0.2] {
        let volume = divided(tolerance, 2_287);
        let expected = errors.iter().filter(|e| **e > tolerance).count();
        assert!(volume.grid().second_level_grids() == expected && expected > 0, "{expected}");
    }
    let few = divided(0.05, 140);
    assert!(few.samples().len() <= 140 && few.grid().second_level_grids() > 0);
    // The cell that holds the lamp is among the few.
    let (low, _) = few.grid().bounds();
    let at = ((lamp - low) / few.grid().cell_size()).as_uvec3();
    let size = few.grid().size();
    assert_ne!(few.grid().second()[((at.z * size.y + at.y) * size.x + at.x) as usize], NONE);
    // What is bought with the samples is accuracy: half-way between samples of the coarse grid.
    let coarse = build(&scene, &light, &VolumeSettings { refine_tolerance: Some(10.0), ..small([4, 4, 5]) });
    let error = |volume: &IrradianceVolume| -> f32 {
        (0..400)
            .map(|i| {
                let mut rng = Rng::new(12, i);
                let p = Vec3::new(rng.next_f32() * 3.0, rng.next_f32() * 2.5, rng.next_f32() * 4.0);
                let n = uniform_direction(rng.next_vec2());
                let to = lamp - p;
                let direct = 40.0 * n.dot(to.normalize()).max(0.0) / to.length_squared();
                (volume.irradiance(p, n, Part::All).x - direct - 5.0 * PI).abs() / (direct + 5.0 * PI)
            })
            .sum()
    };
    let (coarse, fine) = (error(&coarse), error(&divided(0.05, 2_287)));
    assert!(fine < 0.7 * coarse, "{fine} {coarse}");
}

#[test]
fn at_the_default_setting_aimed_rays_leave_the_mean_over_places_as_it_is() {
    // One ray through the middle of each bin, and 256 aimed ones: at one place the middles decide whether the
    // bins see the square, over places they do as often as its share of them says.
    let (radiance, edge) = (400.0, 0.1);
    let (scene, light) = Bright::new(radiance, edge);
    let world = World::new(&scene);
    let targets = Targets::new(&light);
    let count = 1500;
    let of = |settings: &VolumeSettings| {
        let errors: Vec<f64> = (0..count)
            .map(|i| {
                let mut rng = Rng::new(31, i);
                let p = Vec3::new(1.0, 0.4, 0.4)
                    + Vec3::new(1.8, 1.7, 3.2) * Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
                let settings = VolumeSettings { seed: i, ..settings.clone() };
                let probe = Probe::with(&world, &light, p, &settings, &targets, i as u32);
                let to = light.corner + 0.5 * edge * Vec3::new(0.0, 1.0, 1.0) - p;
                let bin = probe.bins.bin(to.normalize());
                let normal = probe.bins.centre(bin);
                let square: f64 =
                    (12..14).map(|t| polygon_irradiance(p, normal, &world.geometry.positions[t])).sum();
                let exact = f64::from(PI) + f64::from(radiance - 1.0) * square;
                f64::from(probe.indirect[bin].x) / exact - 1.0
            })
            .collect();
        let mean = errors.iter().sum::<f64>() / count as f64;
        let variance = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (count - 1) as f64;
        (mean, (variance / count as f64).sqrt(), variance.sqrt())
    };
    let aimed = VolumeSettings::default();
    assert_eq!((aimed.supersample, aimed.informed_rays), (1, 256));
    let (mean, error, spread) = of(&aimed);
    let (plain, plain_error, plain_spread) = of(&VolumeSettings { informed_rays: 0, ..aimed });
    eprintln!(
        "aimed {mean:+.4} ± {error:.4}, spread {spread:.3}; not aimed {plain:+.4} ± {plain_error:.4}, {plain_spread:.3}"
    );
    // Four standard errors, and what cosines at the middles of bins are off by where the square lies anywhere
    // in the bin that is asked: 1 − cos of half a bin (4°) at most.
    assert!(mean.abs() < 4.0 * error + 0.0025, "{mean} ± {error}");
    assert!(spread < 0.3 * plain_spread, "{spread} {plain_spread}");
}

#[test]
fn geometry_and_tolerance_divide_cells_together() {
    use lumenscope_core::irradiance_volume::grid::NONE;
    let (scene, light) = furnished();
    let by = |refine_tolerance, refine_geometry, target_samples| {
        let settings = VolumeSettings {
            refine_tolerance,
            refine_geometry,
            target_samples,
            bins_n: 5,
            ..small([5, 4, 6])
        };
        let volume = build(&scene, &light, &settings);
        let divided: Vec<bool> = volume.grid().second().iter().map(|s| *s != NONE).collect();
        (divided, volume.samples().len())
    };
    let (geometry, _) = by(None, false, 2_287);
    let (error, _) = by(Some(0.05), false, 2_287);
    let (both, samples) = by(Some(0.05), true, 2_287);
    let union: Vec<bool> = geometry.iter().zip(&error).map(|(a, b)| *a || *b).collect();
    assert_eq!(both, union);
    assert!(geometry != error && samples <= 2_287);
    // With little room geometry comes first.
    let (few, samples) = by(Some(0.0), true, 400);
    assert!(samples <= 400 || few == geometry, "{samples}");
    assert!(geometry.iter().zip(&few).all(|(g, f)| !g || *f));
}

#[test]
fn the_rays_of_a_point_and_the_errors_of_cells_are_drawn() {
    use lumenscope_core::irradiance_volume::inspect_sampling::{cell_error_scene, rays};
    let scene = mirrored_room(&[0, 1], 0.9, [Vec3::ZERO; 6]);
    let (world, light) = (World::new(&scene), PerTriangle(vec![Vec3::splat(10.0); 12]));
    let p = Vec3::new(1.31, 1.17, 1.93);
    let settings = VolumeSettings { bins_n: 9, specular_cutoff: 0.5, ..small([4, 3, 4]) };
    let drawn = rays(&world, &light, &settings, p);
    // One segment a bin, and one more for each mirror on the way.
    let bins = DirectionBins::new(9);
    let reflections: usize = (0..bins.len())
        .map(|b| {
            let n = unfolded(p, bins.centre(b)) as usize;
            let kept = |n: usize| {
                fresnel::reflectance(0.9, bins.centre(b).x.abs()).powi(n as i32) >= settings.specular_cutoff
            };
            (0..=n).take_while(|k| *k == 0 || kept(*k)).count()
        })
        .sum();
    assert_eq!(drawn.lines.len(), reflections);
    assert!(drawn.lines.iter().all(|l| l.ends.iter().all(|e| e.is_finite())));
    let (bright, light) = Bright::new(400.0, 0.1);
    let aimed = rays(&World::new(&bright), &light, &VolumeSettings { bins_n: 3, ..settings.clone() }, p);
    let onto =
        |e: Vec3| (e.x - 0.01).abs() < 1e-5 && (1.4..=1.5).contains(&e.y) && (2.3..=2.4).contains(&e.z);
    assert_eq!(aimed.lines.iter().filter(|l| onto(l.ends[1])).count(), 64);
    let mut lit = room([Vec3::ZERO; 6]);
    lit.lamps.push(point_lamp(Vec3::new(0.7, 1.6, 0.9), 40.0));
    let light = PerTriangle(vec![Vec3::splat(PI * 5.0); 12]);
    let errors = cell_error_scene(&World::new(&lit), &light, &settings).unwrap();
    assert_eq!(errors.meshes[0].positions.len(), 8 * 3 * 2 * 3);
    assert!(errors.legend.unwrap().range[1] > 5.0 && errors.notes[0].starts_with("18 cells"));
}
