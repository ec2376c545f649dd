//! Speed of everything the user waits for, on the office: `cargo bench`. Prints the goals beside the figures.

use criterion::{Criterion, Throughput};
use glam::{Affine3A, Vec2, Vec3};
use lumenscope_core::{
    irradiance_volume::{Basis, IrradianceVolume, VolumeSettings},
    math::{frame::uniform_direction, part::Part, progress::Progress, random::Rng},
    radiosity::{RadiositySettings, RadiositySolution},
    scene::{Object, Scene, Target, accel::Ray, emitters::Emitter, import, world::World},
    superposition::{
        composite::DirectQuality,
        pass::{PassSettings, render},
        plan::Plan,
    },
    transport::live::{LiveTransport, SolveSettings},
};
use std::{hint::black_box, path::Path, sync::Arc, time::Duration};

/// Rays and queries in one iteration.
const BATCH: u64 = 100_000;

fn main() {
    let mut criterion =
        Criterion::default().configure_from_args().sample_size(10).measurement_time(Duration::from_secs(5));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/office/office.ron");
    let scene = match import::load(&path) {
        Ok(scene) => Arc::new(scene),
        Err(error) => return eprintln!("{error}"),
    };
    let world = World::new(&scene);
    let plan = Plan::new(&scene, &world, 0.04, 1);
    rays(&mut criterion, &world);
    solving(&mut criterion, &path, &scene, &plan);
    drags(&mut criterion, &scene, &plan);
    criterion.final_summary();
}

fn rays(criterion: &mut Criterion, world: &World) {
    let (low, high) = world.geometry.bounds();
    let rays: Vec<Ray> = (0..BATCH)
        .map(|i| {
            let mut rng = Rng::new(7, i);
            let at = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            Ray::new(low + (high - low) * at, uniform_direction(rng.next_vec2()))
        })
        .collect();
    let mut group = criterion.benchmark_group("rays, one thread");
    group.throughput(Throughput::Elements(BATCH));
    group.bench_function("nearest hit, incoherent", |b| {
        b.iter(|| rays.iter().filter(|r| world.accel.trace(r).is_some()).count())
    });
    group.bench_function("any hit, incoherent", |b| {
        b.iter(|| rays.iter().filter(|r| world.accel.occluded(r)).count())
    });
    group.finish();
}

fn solving(criterion: &mut Criterion, path: &Path, scene: &Scene, plan: &Plan) {
    let world = &World::new(scene);
    let silent = Progress::silent();
    let solve = |settings: &RadiositySettings| RadiositySolution::solve(world, settings, &Progress::silent());
    let Ok(radiosity) = solve(&plan.solve.radiosity) else { return eprintln!("radiosity failed") };
    let thesis =
        VolumeSettings { bins_n: 17, target_samples: 2_287, ..plan.solve.volume.clone().unwrap_or_default() };
    let Ok(volume) = IrradianceVolume::build(world, &radiosity, &thesis, &silent) else {
        return eprintln!("volume failed");
    };
    eprintln!("elements {}, volume samples {}", radiosity.direct.len(), volume.samples().len());

    let mut group = criterion.benchmark_group("office");
    group
        .bench_function("file to first lit picture 640x360 (goal 4 s)", |b| b.iter(|| first_lit(path, plan)));
    group.bench_function("file to settled light", |b| {
        b.iter(|| {
            let scene = Arc::new(import::load(path).unwrap_or_default());
            let live = LiveTransport::solve(scene, plan.solve.clone(), &silent, &mut |_| {});
            black_box(live.is_ok())
        });
    });
    group.bench_function("radiosity", |b| b.iter(|| solve(&plan.solve.radiosity)));
    group.bench_function("volume, 578 bins (goal 1 s)", |b| {
        b.iter(|| IrradianceVolume::build(world, &radiosity, &thesis, &silent))
    });
    group.throughput(Throughput::Elements(BATCH));
    let queries = [("anywhere", anywhere(world)), ("vertices of balls", balls(world))];
    let mut answers = vec![Vec3::ZERO; BATCH as usize];
    for lamp in world.emitters.list.iter().map(Emitter::target) {
        let Target::Object(object) = lamp else { continue };
        let Object { name, movable: true, .. } = &scene.objects[object] else { continue };
        let shifted = shifted(scene, lamp);
        let radiosities = [world, &shifted].map(|w| radiosity.relight(w, &[lamp], 16, 100));
        let (mut relit, mut step) = (volume.clone(), 0);
        for (state, moving) in [("while it moves", &[lamp][..]), ("at rest", &[])] {
            group.bench_function(
                format!("volume relit from cached hits, {name} {state} (goal 30 ms)"),
                |b| {
                    b.iter(|| {
                        step += 1;
                        let world = [world, &shifted][step % 2];
                        relit = relit.relight_moving(world, &radiosities[step % 2], &[lamp], moving);
                    });
                },
            );
        }
    }
    let unguarded = volume.with_guard(None);
    let guarded = [("guarded, ", &volume, Basis::Bins)];
    let plain = [Basis::Harmonics, Basis::NearestBin, Basis::Bins].map(|basis| ("", &unguarded, basis));
    for (guard, volume, basis) in guarded.into_iter().chain(plain) {
        let volume = volume.with_basis(basis);
        for (place, queries) in &queries {
            let name = format!("volume queries, {guard}{}, {place}, one thread (goal 20 M/s)", basis.name());
            group.bench_function(name, |b| {
                b.iter(|| volume.irradiance_batch(queries, Part::Indirect, &mut answers));
            });
        }
    }
    group.finish();
}

/// Points and directions without order.
fn anywhere(world: &World) -> Vec<(Vec3, Vec3)> {
    let (low, high) = world.geometry.bounds();
    (0..BATCH)
        .map(|i| {
            let mut rng = Rng::new(9, i);
            let at = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            (low + (high - low) * at, uniform_direction(rng.next_vec2()))
        })
        .collect()
}

/// A ball of 1,000 vertices at a hundred places, as an object that moves is asked for.
fn balls(world: &World) -> Vec<(Vec3, Vec3)> {
    const RADIUS: f32 = 0.25;
    let (low, high) = world.geometry.bounds();
    (0..BATCH)
        .map(|i| {
            let (ball, vertex) = (i / 1_000, (i % 1_000) as f32);
            let mut rng = Rng::new(10, ball);
            let at = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            let normal = uniform_direction(Vec2::new((vertex + 0.5) / 1_000.0, (vertex / 40.0).fract()));
            (low + (high - low) * at + RADIUS * normal, normal)
        })
        .collect()
}

/// The world with a lamp 5 cm from where it is.
fn shifted(scene: &Scene, lamp: Target) -> World {
    let mut moved = scene.clone();
    moved.place(lamp, Affine3A::from_translation(0.05 * Vec3::X) * scene.placement(lamp));
    World::new(&moved)
}

/// Loads the scene, solves it until the first solution is shown, pictures that and stops.
fn first_lit(path: &Path, plan: &Plan) -> usize {
    let scene = Arc::new(import::load(path).unwrap_or_default());
    let settings = SolveSettings { preview: true, ..plan.solve.clone() };
    let (progress, mut pixels) = (Progress::default(), 0);
    let camera = scene.camera;
    let stopped = LiveTransport::solve(scene, settings, &progress, &mut |light| {
        let settings = PassSettings { direct: DirectQuality::PerPixel(1), ..PassSettings::default() };
        pixels = render(light, &camera, 640, 360, &settings).1.images[0].pixels.len();
        progress.cancel();
    });
    black_box(stopped.is_err());
    pixels
}

fn drags(criterion: &mut Criterion, scene: &Arc<Scene>, plan: &Plan) {
    let Ok(mut live) =
        LiveTransport::solve(scene.clone(), plan.solve.clone(), &Progress::silent(), &mut |_| {})
    else {
        return eprintln!("the office was not solved");
    };
    let lamp = scene.objects.iter().position(|o| o.movable && o.name.contains("Desk lamp"));
    let Some(lamp) = lamp.map(Target::Object) else { return eprintln!("no desk lamp") };
    let mut step = 0;
    let mut next = |scene: &Scene| {
        step += 1;
        let mut moved = scene.clone();
        let shift = Vec3::X * (0.01 * (step % 20) as f32);
        moved.place(lamp, Affine3A::from_translation(shift) * scene.placement(lamp));
        Arc::new(moved)
    };
    let mut group = criterion.benchmark_group("lamp drag");
    group.bench_function("first correct update (goal 100 ms)", |b| {
        b.iter(|| black_box(live.follow(next(scene)).provenance.revision))
    });
    group.bench_function("full-quality direct light (goal 1 s)", |b| {
        b.iter(|| {
            live.follow(next(scene));
            black_box(live.refine(&Progress::silent()).is_ok())
        });
    });
    group.finish();
}
