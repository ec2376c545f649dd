//! Live updates: what follows a drag ends where a fresh solve would, and is right at once where it claims to be.

use glam::{Affine3A, Vec2, Vec3};
use lumenscope_core::{
    irradiance_volume::VolumeSettings,
    math::{colour::luminance, part::Part, progress::Progress},
    radiosity::{RadiositySettings, surface_map::SurfaceMap},
    scene::{Scene, Target, direct::Receiver, direct::total_irradiance, world::World},
    superposition::plan::{Component, Plan},
    transport::{
        live::{LiveTransport, SolveSettings},
        solution::State,
    },
};
use lumenscope_tests::{add_point_lamp, cornell};
use std::sync::Arc;

/// The movable block of the test box.
const BLOCK: Target = Target::Object(5);

fn settings() -> SolveSettings {
    let radiosity =
        RadiositySettings { gather_rays: 64, element_spacing_m: Some(0.1), ..RadiositySettings::default() };
    let volume = VolumeSettings { samples: Some([4, 4, 4]), bins_n: 5, ..VolumeSettings::default() };
    SolveSettings { radiosity, volume: Some(volume), preview: false }
}

fn solve(scene: &Scene) -> LiveTransport {
    solve_with(scene, settings())
}

fn solve_with(scene: &Scene, settings: SolveSettings) -> LiveTransport {
    LiveTransport::solve(Arc::new(scene.clone()), settings, &Progress::silent(), &mut |_| {})
        .expect("the box has a solution")
}

fn settle(live: &mut LiveTransport) {
    while live.refine(&Progress::silent()).expect("the box has a solution").is_some() {}
}

fn moved(scene: &Scene, target: Target, by: Vec3) -> Scene {
    let mut scene = scene.clone();
    scene.place(target, Affine3A::from_translation(by) * scene.placement(target));
    scene
}

/// Mean difference of two element tables, as a share of the mean of the second.
fn difference(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    let sum = |f: &dyn Fn(usize) -> f32| (0..b.len()).map(f).sum::<f32>();
    sum(&|i| (luminance(a[i]) - luminance(b[i])).abs()) / sum(&|i| luminance(b[i]))
}

/// Sweeps stop when the area-weighted mean error is below 2e-4 of the mean; two runs may err on either
/// side, and small elements, which count here as much as large ones, by more.
const SWEEP_BOUND: f32 = 1e-3;

#[test]
fn a_dragged_lamp_settles_to_a_fresh_solve() {
    let mut scene = cornell();
    let lamp = Target::Lamp(add_point_lamp(&mut scene, Vec3::new(0.4, 1.2, 0.3), Vec3::splat(30.0)));
    let mut live = solve(&scene);
    let scene = moved(&scene, lamp, Vec3::new(-0.5, 0.1, 0.2));
    assert_eq!(live.follow(Arc::new(scene.clone())).provenance.state, State::Refining);
    settle(&mut live);
    let fresh = solve(&scene);
    let (live, fresh) = (live.current(), fresh.current());
    assert_eq!(live.provenance.state, State::Settled);
    assert_eq!(live.radiosity.direct, fresh.radiosity.direct, "direct light has no memory");
    let off = difference(&live.radiosity.indirect, &fresh.radiosity.indirect);
    assert!(off < SWEEP_BOUND, "indirect light differs by {off} of its mean");
}

#[test]
fn a_dragged_lamp_is_right_at_once() {
    let mut scene = cornell();
    let lamp = Target::Lamp(add_point_lamp(&mut scene, Vec3::new(0.4, 1.2, 0.3), Vec3::splat(300.0)));
    let mut live = solve(&scene);
    let scene = moved(&scene, lamp, Vec3::new(-0.5, 0.1, 0.2));
    let first = live.follow(Arc::new(scene.clone())).clone();
    settle(&mut live);
    let mean = |e: &[Vec3]| e.iter().map(|e| luminance(*e)).sum::<f32>() / e.len() as f32;
    let (first, settled) = (mean(&first.radiosity.indirect), mean(&live.current().radiosity.indirect));
    // Reflectances below 0.75 shrink what three sweeps leave out to a few per cent of the change.
    assert!((first - settled).abs() < 0.05 * settled, "first {first} lx, settled {settled} lx");
}

#[test]
fn dimming_to_nothing_removes_the_lamp() {
    let mut scene = cornell();
    let without = solve(&scene);
    let lamp = add_point_lamp(&mut scene, Vec3::new(0.4, 1.2, 0.3), Vec3::splat(30.0));
    let mut live = solve(&scene);
    scene.lamps[lamp].dimmer = 0.0;
    live.follow(Arc::new(scene));
    settle(&mut live);
    assert_eq!(live.current().radiosity.direct, without.current().radiosity.direct);
    let off = difference(&live.current().radiosity.indirect, &without.current().radiosity.indirect);
    assert!(off < SWEEP_BOUND, "indirect light differs by {off} of its mean");
}

#[test]
fn light_is_linear_in_the_lamps() {
    // Transport is; the smoothing after it weighs differences against noise and is not.
    let mut scene = cornell();
    let first = add_point_lamp(&mut scene, Vec3::new(0.4, 1.2, 0.3), Vec3::splat(30.0));
    let second = add_point_lamp(&mut scene, Vec3::new(-0.3, 0.8, 0.5), Vec3::new(10.0, 20.0, 40.0));
    for object in &mut scene.objects {
        object.dimmer = 0.0;
    }
    let with = |a: f32, b: f32| {
        let mut scene = scene.clone();
        scene.lamps[first].dimmer = a;
        scene.lamps[second].dimmer = b;
        let mut settings = settings();
        settings.radiosity.smoothing = 0.0;
        solve_with(&scene, settings).current().radiosity.indirect.clone()
    };
    let sum: Vec<Vec3> = with(1.0, 0.0).iter().zip(with(0.0, 1.0)).map(|(a, b)| *a + b).collect();
    let off = difference(&sum, &with(1.0, 1.0));
    assert!(off < SWEEP_BOUND, "the sum of two lamps differs from both together by {off} of its mean");
}

#[test]
fn a_moved_object_shadows_at_once_and_is_solved_at_rest() {
    let scene = cornell();
    let mut live = solve(&scene);
    let block = scene.placement(BLOCK).translation;
    let away = Vec3::new(-0.25 - block.x, 0.0, 0.0);
    let scene = moved(&scene, BLOCK, away);
    let first = live.follow(Arc::new(scene.clone())).clone();
    assert_eq!(first.moved_objects, [5]);
    let hit = first
        .world
        .accel
        .trace(&lumenscope_core::scene::accel::Ray::new(Vec3::new(0.0, 1.5, 0.0), Vec3::NEG_Y));
    assert!(hit.is_some());
    settle(&mut live);
    let settled = live.current();
    assert!(settled.moved_objects.is_empty());
    let fresh = solve(&scene);
    assert_eq!(settled.radiosity.direct, fresh.current().radiosity.direct);
    assert_eq!(settled.radiosity.indirect, fresh.current().radiosity.indirect);
    let at = (Vec3::new(0.1, 0.9, 0.1), Vec3::Y);
    let volume = |s: &lumenscope_core::transport::LightTransportSolution| {
        s.volume.as_ref().map(|v| v.irradiance(at.0, at.1, Part::All))
    };
    assert_eq!(volume(settled), volume(fresh.current()));
    // The world itself moved at once: direct light on the floor under the block's new place is gone.
    let under = Receiver::new(Vec3::from(block) + away + Vec3::new(0.0, 1e-4 - block.y, 0.0), Vec3::Y);
    assert_eq!(
        total_irradiance(&first.world, &under, 64, 1),
        total_irradiance(&fresh.current().world, &under, 64, 1)
    );
}

#[test]
fn a_cancelled_refinement_keeps_what_is_shown() {
    let scene = cornell();
    let mut live = solve(&scene);
    live.follow(Arc::new(moved(&scene, BLOCK, Vec3::X * 0.1)));
    live.refine(&Progress::silent()).expect("relighting needs no new transport");
    let before = live.current().radiosity.indirect.clone();
    let progress = Progress::default();
    progress.cancel();
    assert!(live.refine(&progress).is_err_and(|e| e.is_cancelled()));
    assert_eq!(live.current().radiosity.indirect, before);
    assert_eq!(live.current().moved_objects, [5]);
}

#[test]
fn threads_do_not_change_a_byte() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| {
            let scene = cornell();
            let mut live = solve(&scene);
            live.follow(Arc::new(moved(&scene, BLOCK, Vec3::X * 0.1)));
            settle(&mut live);
            let current = live.current();
            let e = current.radiosity.irradiance(0, Vec2::splat(0.3), false, Part::All);
            let v =
                current.volume.as_ref().map(|v| v.irradiance(Vec3::new(0.1, 0.9, 0.1), Vec3::Y, Part::All));
            (
                e.to_array().map(f32::to_bits),
                v.map(|v| v.to_array().map(f32::to_bits)),
                current.radiosity.indirect.clone(),
            )
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn other_settings_solve_what_they_change_and_end_where_a_fresh_solve_would() {
    let scene = Arc::new(cornell());
    let live = solve(&scene);
    let before = live.current();
    let with = |settings: SolveSettings| {
        live.with_settings(scene.clone(), settings, &Progress::silent(), &mut |_| {})
            .expect("it can be solved")
    };
    let volume = VolumeSettings { samples: Some([3, 3, 3]), bins_n: 4, ..VolumeSettings::default() };
    let finer = with(SolveSettings { volume: Some(volume.clone()), ..settings() });
    assert!(Arc::ptr_eq(&finer.current().radiosity, &before.radiosity), "light on surfaces stays");
    let built = finer.current().volume.as_ref().expect("there is a volume");
    // Every cell of so small a room holds geometry: 2·2 + 1 samples an axis over both levels.
    assert_eq!((built.samples().len(), built.bins().n()), (125, 4));
    let none = with(SolveSettings { volume: None, ..settings() });
    assert!(none.current().volume.is_none() && Arc::ptr_eq(&none.current().radiosity, &before.radiosity));

    // Shadow rays leave the transport; spacing does not.
    let shadows = RadiositySettings { shadow_rays: 4, ..settings().radiosity };
    let relit = with(SolveSettings { radiosity: shadows, volume: None, ..settings() });
    assert!(Arc::ptr_eq(relit.current().radiosity.transport(), before.radiosity.transport()));
    let coarse = RadiositySettings { element_spacing_m: Some(0.3), ..settings().radiosity };
    let coarse = SolveSettings { radiosity: coarse, volume: Some(volume), ..settings() };
    let again = with(coarse.clone());
    let fresh = LiveTransport::solve(scene.clone(), coarse, &Progress::silent(), &mut |_| {})
        .expect("the box has a solution");
    assert_eq!(again.current().radiosity.indirect, fresh.current().radiosity.indirect);
    assert_eq!(again.current().provenance.state, State::Settled);
}

#[test]
fn the_plan_says_what_is_built() {
    for spacing in [None, Some(0.25)] {
        let mut scene = cornell();
        scene.plan.element_spacing_m = spacing;
        let world = World::new(&scene);
        let plan = Plan::new(&scene, &world, 0.04, 1);
        let line = |c: Component| plan.lines.iter().find(|l| l.component == c).expect("every line is there");
        let map = SurfaceMap::new(&world.geometry, plan.solve.radiosity.element_spacing_m)
            .expect("it has a layout");
        let radiosity = line(Component::Radiosity);
        let said = format!("every {:.4} m", map.spacing_m);
        assert!(
            radiosity.settings.contains(said.trim_end_matches(" m").trim_end_matches('0')),
            "{radiosity:?}, {said}"
        );
        assert_eq!(radiosity.overridden, spacing.is_some());
        let volume = plan.solve.volume.as_ref().expect("the block can be moved");
        let grid = volume.grid(&world).expect("it has a grid");
        let samples = format!("{} samples of 578 bins", grid.places().len());
        assert!(line(Component::IrradianceVolume).settings.starts_with(&samples), "{:?}", plan.lines);
        assert!(Component::Radiosity.freed(&scene.plan) == Default::default());
    }
}
