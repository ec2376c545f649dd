//! A session without a window, under commands nobody would think of.

use glam::{Affine3A, Quat, Vec3};
use lumenscope::{
    command::Command,
    copies::{Copies, CopyVolume},
    pipeline::can_follow,
    session::{Against, Compare, Document, Effect, Session, View},
    session_file,
};
use lumenscope_core::{
    irradiance_volume::VolumeSettings,
    math::progress::Progress,
    radiosity::RadiositySettings,
    scene::{Scene, Target},
    superposition::{PassSettings, composite::DirectQuality, render},
    transport::{
        LightTransportSolution,
        live::{LiveTransport, SolveSettings},
    },
};
use lumenscope_tests::{add_point_lamp, cornell};
use proptest::prelude::*;
use std::sync::{Arc, LazyLock};

/// Numbers as users and files give them: mostly sensible, sometimes not.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        12 => -3.0f32..3.0,
        1 => Just(0.0),
        1 => prop_oneof![
            Just(f32::NAN), Just(f32::INFINITY), Just(-1e30), Just(1e-30), Just(-0.0), Just(1e6)
        ],
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    (number(), number(), number()).prop_map(Vec3::from)
}

fn target() -> impl Strategy<Value = Target> {
    prop_oneof![
        4 => Just(Target::Object(5)),
        2 => Just(Target::Object(3)),
        4 => Just(Target::Lamp(0)),
        1 => (0usize..9).prop_map(Target::Object),
        1 => (0usize..3).prop_map(Target::Lamp),
    ]
}

fn placement() -> impl Strategy<Value = Affine3A> {
    (number(), -4.0f32..4.0, point()).prop_map(|(scale, turn, at)| {
        let scale = if (0.1..3.0).contains(&scale) { Vec3::ONE } else { Vec3::splat(scale) };
        Affine3A::from_scale_rotation_translation(scale, Quat::from_rotation_y(turn), at)
    })
}

fn view() -> impl Strategy<Value = View> {
    (point(), point(), prop::option::of((point(), point())), 0u32..70, prop::option::of(target()), number())
        .prop_map(|(eye, weights, probe, probe_bins_n, selected, ev100)| {
            let mut view = View { probe, probe_bins_n, selected, ..View::default() };
            view.camera.eye = eye;
            view.weights = [weights.x, weights.y, weights.z, weights.y, weights.x];
            view.display.ev100 = ev100;
            view.compare = if ev100 > 1.0 { Compare::Reference } else { Compare::Picture };
            view
        })
}

fn command() -> impl Strategy<Value = Command> {
    prop_oneof![
        6 => (target(), placement(), any::<bool>())
            .prop_map(|(target, placement, dragging)| Command::Place { target, placement, dragging }),
        4 => (target(), number(), any::<bool>())
            .prop_map(|(target, dimmer, dragging)| Command::Dim { target, dimmer, dragging }),
        2 => Just(Command::EndDrag),
        3 => Just(Command::Undo),
        2 => Just(Command::Redo),
        2 => view().prop_map(|v| Command::View(Box::new(v))),
        1 => Just(Command::StartReference),
        1 => Just(Command::Cancel),
        1 => Just(Command::SaveSession("nowhere.lumenscope".into())),
    ]
}

static SCENE: LazyLock<Arc<Scene>> = LazyLock::new(|| {
    let mut scene = cornell();
    add_point_lamp(&mut scene, Vec3::new(0.5, 1.5, 0.5), Vec3::new(20.0, 18.0, 15.0));
    Arc::new(scene)
});

/// Coarse: what is tested is that numbers stay numbers, not how near they are.
static SOLVED: LazyLock<LightTransportSolution> = LazyLock::new(|| solve(&SCENE).current().clone());

fn solve(scene: &Arc<Scene>) -> LiveTransport {
    let radiosity = RadiositySettings {
        element_spacing_m: Some(1.0),
        gather_rays: 16,
        shadow_rays: 1,
        tolerance: 0.1,
        ..RadiositySettings::default()
    };
    let volume = VolumeSettings { samples: Some([2, 2, 2]), bins_n: 3, ..VolumeSettings::default() };
    let settings = SolveSettings { radiosity, volume: Some(volume), preview: false };
    LiveTransport::solve(Arc::clone(scene), settings, &Progress::silent(), &mut |_| {})
        .expect("the room has a solution")
}

fn session() -> Session {
    let mut session = Session::default();
    session.open(Document::default(), Arc::clone(&SCENE), None, true);
    session
}

/// What a session looks like from outside: edits and the scene they make, to the bit.
fn state(session: &Session) -> String {
    let scene = session.scene.as_ref().expect("there is one");
    let objects: Vec<_> = scene.objects.iter().map(|o| (o.world_from_object, o.dimmer)).collect();
    format!("{:?} {objects:?} {:?}", session.document.edits, scene.lamps)
}

fn assert_no_fault(solution: &LightTransportSolution) {
    let settings = PassSettings { direct: DirectQuality::PerPixel(1), ..PassSettings::default() };
    let (_, layers) = render(solution, &solution.scene.camera, 16, 12, &settings);
    for image in &layers.images {
        assert!(image.pixels.iter().all(|p| p.is_finite()), "a layer holds what is no number");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_command_breaks_a_session(commands in prop::collection::vec(command(), 1..24)) {
        let mut session = session();
        let first = state(&session);
        let mut live: Option<LiveTransport> = None;
        for command in commands {
            let follows = session.apply(command).iter().any(|e| matches!(e, Effect::Follow { .. }));
            if follows {
                let scene = session.scene.clone().unwrap();
                let live = live.get_or_insert_with(|| solve(&SCENE));
                prop_assert!(can_follow(&live.current().scene, &scene));
                assert_no_fault(live.follow(scene));
            }
            prop_assert!(session.document.view.is_finite());
        }
        let last = state(&session);
        let mut steps = 0;
        while session.history.can_undo() {
            session.apply(Command::Undo);
            steps += 1;
        }
        prop_assert_eq!(state(&session), first);
        for _ in 0..steps {
            session.apply(Command::Redo);
        }
        prop_assert_eq!(state(&session), last);
    }

    #[test]
    fn sessions_come_back_from_their_files(commands in prop::collection::vec(command(), 1..12)) {
        let folder = tempfile::tempdir().unwrap();
        let mut session = session();
        for command in commands {
            session.apply(command);
        }
        session.document.scene = Some(folder.path().join("scene.ron"));
        std::fs::write(folder.path().join("scene.ron"), "()").unwrap();
        let file = folder.path().join("kept.lumenscope");
        session_file::write(&file, &session.document).unwrap();
        let read = session_file::read(&file).unwrap();
        prop_assert_eq!(format!("{:?}", read.edits), format!("{:?}", session.document.edits));
        prop_assert_eq!(read.view, session.document.view.clone());
        prop_assert_eq!(read.scene.unwrap().canonicalize().unwrap(), folder.path().join("scene.ron").canonicalize().unwrap());
    }
}

#[test]
fn the_coarse_light_of_the_property_test_is_light() {
    let settings = PassSettings::default();
    let (_, layers) = render(&SOLVED, &SOLVED.scene.camera, 16, 12, &settings);
    assert!(layers.images[..3].iter().all(|i| i.mean().min_element() > 0.0), "every layer has light to lose");
}

#[test]
fn one_drag_is_one_step_and_another_thing_is_another() {
    let mut session = session();
    let first = state(&session);
    for (target, x) in [(Target::Object(5), 0.1), (Target::Object(5), 0.2), (Target::Lamp(0), 0.3)] {
        let placement = Affine3A::from_translation(Vec3::X * x);
        session.apply(Command::Place { target, placement, dragging: true });
    }
    assert_eq!(session.history.depth(), 2);
    session.apply(Command::EndDrag);
    let placement = Affine3A::from_translation(Vec3::X * 0.4);
    session.apply(Command::Place { target: Target::Lamp(0), placement, dragging: true });
    assert_eq!(session.history.depth(), 3);
    for _ in 0..3 {
        session.apply(Command::Undo);
    }
    assert_eq!(state(&session), first);
    assert!(session.apply(Command::Undo).is_empty(), "nothing is left to undo");
}

#[test]
fn what_cannot_be_placed_is_said_and_left() {
    let mut session = session();
    let first = state(&session);
    let bad = [
        (Target::Object(0), Affine3A::from_translation(Vec3::X)),
        (Target::Object(99), Affine3A::IDENTITY),
        (Target::Object(5), Affine3A::from_translation(Vec3::NAN)),
        (Target::Object(5), Affine3A::from_scale(Vec3::ZERO)),
        (Target::Lamp(0), Affine3A::from_translation(Vec3::X * 1e9)),
    ];
    for (i, (target, placement)) in bad.into_iter().enumerate() {
        assert!(session.apply(Command::Place { target, placement, dragging: false }).is_empty());
        assert_eq!(session.log.lines().len(), i + 1);
    }
    for dimmer in [f32::NAN, -1.0, 1e3] {
        session.apply(Command::Dim { target: Target::Lamp(0), dimmer, dragging: false });
    }
    assert_eq!(state(&session), first);
    assert!(!session.history.can_undo());
}

/// Two copies of an object, the right one lit by a kept volume.
fn copies(session: &Session, object: usize, kept: usize) -> Copies {
    let mut copies = Copies::of(session.scene.as_ref().unwrap(), object);
    copies.lights[1].volume = CopyVolume::Kept(kept);
    copies
}

#[test]
fn a_forgotten_volume_leaves_the_others_where_they_were() {
    let mut session = session();
    let volume = || SOLVED.volume.clone().expect("the room has a volume");
    (0..3).for_each(|_| session.keep(volume(), "radiosity"));
    let mut view = session.document.view.clone();
    view.volume.against = Against::Kept(2);
    view.copies = Some(copies(&session, 5, 2));
    session.apply(Command::View(Box::new(view)));
    let lights = |session: &Session| session.document.view.copies.unwrap().lights.map(|l| l.volume);

    let (name, meant) = (session.kept[2].name.clone(), session.kept[2].volume.clone());
    let effects = session.apply(Command::ForgetVolume(0));
    assert_eq!(effects, [Effect::Inspect, Effect::Copies]);
    assert_eq!(lights(&session), [CopyVolume::Present, CopyVolume::Kept(1)]);
    assert_eq!(session.document.view.volume.against, Against::Kept(1));
    assert!(session.kept[1].name == name && Arc::ptr_eq(&session.kept[1].volume, &meant));

    session.keep(volume(), "radiosity");
    let mut names: Vec<_> = session.kept.iter().map(|k| &k.name).collect();
    names.dedup();
    assert_eq!(names.len(), 3, "no two are called the same: {names:?}");

    session.apply(Command::ForgetVolume(1));
    assert_eq!(lights(&session)[1], CopyVolume::Present, "its own volume is gone");
    assert!(session.apply(Command::ForgetVolume(9)).is_empty());
}

#[test]
fn copies_of_a_model_go_with_it() {
    let mut session = session();
    let mut with = Scene::clone(&SCENE);
    with.objects.push(with.objects[5].clone());
    let added = with.objects.len() - 1;
    session.reopen(vec!["stool.obj".into()], Arc::new(with));
    let copies = Some(copies(&session, added, 0));
    session.apply(Command::View(Box::new(View { copies, ..session.document.view.clone() })));
    assert!(session.document.view.copies.is_some());
    let effects = session.apply(Command::Undo);
    assert!(session.document.view.copies.is_none(), "what is gone cannot be copied");
    assert!(effects.contains(&Effect::Copies), "{effects:?}");
    session.apply(Command::Redo);
    assert!(session.document.view.copies.is_none(), "a look is not undone");
}

#[test]
fn weights_and_light_paths_agree() {
    let mut session = session();
    let look = |session: &mut Session, change: &dyn Fn(&mut View)| {
        let mut view = session.document.view.clone();
        change(&mut view);
        session.apply(Command::View(Box::new(view)))
    };
    let indirect = [0.0, 0.0, 1.0, 0.0, 0.0];
    look(&mut session, &|v| v.paths = "L(D|S)+DE".into());
    assert_eq!(session.document.view.weights, indirect);
    look(&mut session, &|v| v.compare = Compare::Difference);
    assert_eq!(session.document.view.compare, Compare::Difference);

    // Half typed, nothing is traced and nothing shown is thrown away.
    let effects = look(&mut session, &|v| v.paths = "L(D|S)+D".into());
    assert!(effects.is_empty(), "{effects:?}");
    assert_eq!(
        (session.document.view.weights, session.document.view.compare),
        (indirect, Compare::Difference)
    );
    assert_eq!(look(&mut session, &|v| v.camera.eye.y += 0.1), [Effect::DropReference]);
    assert!(session.apply(Command::StartReference).is_empty());

    // Where nothing is polished radiosity tells single bounces apart.
    assert_eq!(look(&mut session, &|v| v.paths = "LDE|LD{3}E".into()), [Effect::Reference]);
    assert_eq!(
        (session.document.view.weights, session.document.view.compare),
        ([0.0, 1.0, 1.0, 0.0, 0.0], Compare::Difference)
    );
    assert!(session.light_paths.single_bounces().is_some());

    // Else no weights show two of them: there is nothing that the reference could be compared with.
    let mut polished = (**SCENE).clone();
    polished.materials[0].roughness = 0.1;
    let view = session.document.view.clone();
    session.open(Document { view, ..Document::default() }, Arc::new(polished), None, false);
    assert_eq!(look(&mut session, &|v| v.paths = "LD{2}E".into()), [Effect::Reference]);
    assert!(session.light_paths.single_bounces().is_none());
    assert_eq!(session.document.view.compare, Compare::Reference);
    look(&mut session, &|v| v.compare = Compare::Difference);
    assert_eq!(session.document.view.compare, Compare::Reference);

    // Weights set by hand are no expression's.
    assert_eq!(look(&mut session, &|v| v.weights[0] = 0.5), [Effect::Reference]);
    assert_eq!(session.document.view.paths, "");
    look(&mut session, &|v| v.compare = Compare::Difference);
    assert_eq!(session.document.view.compare, Compare::Difference);

    // A file in which they disagree is read as its expression says.
    let view = View { paths: "LDE".into(), weights: indirect, ..session.document.view.clone() };
    session.open(Document { view, ..Document::default() }, Arc::clone(&SCENE), None, false);
    assert_eq!(session.document.view.weights, [0.0, 1.0, 0.0, 0.0, 0.0]);
}
