//! The program as its user meets it: the real window, without a screen.

use egui_kittest::{Harness, kittest::Queryable};
use glam::{Affine3A, Vec3};
use lumenscope::{
    LumenscopeApp,
    app::Config,
    command::Command,
    examples::Example,
    panels::status::Badge,
    placement::{PLACEMENT, Placement, Site},
    session::{Compare, Document, View},
};
use lumenscope_core::{
    irradiance_volume::placement::requirement::preset,
    math::{colour::luminance, part::Part},
    scene::{Scene, Target, accel::Ray},
};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
    thread::sleep,
    time::{Duration, Instant},
};

/// Longest wait for the worker: many times what the room takes on two busy cores, so that only a hang
/// reaches it.
const PATIENCE: Duration = Duration::from_secs(100);

/// A room of 4 × 3 × 4 m with a movable block and a point lamp.
const ROOM: &str = r#"(
    models: [(file: "room.obj")],
    lamps: [Point(name: "bulb", at: (0.0, 2.5, 0.0), intensity: (300.0, 280.0, 240.0))],
    movable: ["block"],
    camera: Some((eye: (0.0, 1.5, 1.95), target: (0.0, 1.2, -2.0), up: (0.0, 1.0, 0.0), vertical_fov: 1.2)),
    plan: (element_spacing_m: Some(0.5), gather_rays: Some(64), volume_samples: Some((4, 4, 4)), volume_bins_n: Some(5)),
)"#;

fn cuboid(obj: &mut String, first: usize, low: [f32; 3], high: [f32; 3], inward: bool) {
    for i in 0..8 {
        let pick = |axis: usize| if i >> axis & 1 == 1 { high[axis] } else { low[axis] };
        obj.push_str(&format!("v {} {} {}\n", pick(0), pick(1), pick(2)));
    }
    for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        let mut corners = face.map(|c| c + first);
        if inward {
            corners.reverse();
        }
        obj.push_str(&format!("f {} {} {} {}\n", corners[0], corners[1], corners[2], corners[3]));
    }
}

/// Writes the room into a folder and returns its scene file.
fn room(folder: &Path) -> PathBuf {
    let mut obj = String::from("mtllib room.mtl\no walls\nusemtl white\n");
    cuboid(&mut obj, 1, [-2.0, 0.0, -2.0], [2.0, 3.0, 2.0], true);
    obj.push_str("o block\nusemtl red\n");
    cuboid(&mut obj, 9, [-1.2, 0.01, -1.4], [-0.4, 1.1, -0.6], false);
    fs::write(folder.join("room.obj"), obj).unwrap();
    fs::write(folder.join("room.mtl"), "newmtl white\nKd 0.7 0.7 0.7\nnewmtl red\nKd 0.7 0.1 0.1\n").unwrap();
    let scene = folder.join("room.ron");
    fs::write(&scene, ROOM).unwrap();
    scene
}

struct Window<'a> {
    harness: Harness<'a, LumenscopeApp>,
    folder: tempfile::TempDir,
}

impl Window<'_> {
    fn empty() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let config = Config { folder: Some(folder.path().join("config")) };
        let harness = Harness::builder()
            .with_size([1280.0, 800.0])
            .wgpu()
            .build_eframe(|cc| LumenscopeApp::with_config(cc, Document::default(), &config).unwrap());
        Self { harness, folder }
    }

    /// The window with the room in it, lit.
    fn on_room() -> Self {
        let mut window = Self::empty();
        let scene = room(window.folder.path());
        window.run(Command::Open(scene));
        window.wait_lit();
        window
    }

    fn app(&self) -> &LumenscopeApp {
        self.harness.state()
    }

    fn view(&self) -> View {
        self.app().session().document.view.clone()
    }

    fn run(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.harness.state_mut().run(&ctx, command);
        self.harness.step();
    }

    fn wait(&mut self, what: &str, done: impl Fn(&LumenscopeApp) -> bool) {
        let began = Instant::now();
        loop {
            self.harness.step();
            if done(self.app()) {
                return;
            }
            assert!(began.elapsed() < PATIENCE, "waited in vain for {what}: {:?}", self.app().notice());
            sleep(Duration::from_millis(10));
        }
    }

    fn wait_lit(&mut self) {
        self.wait("settled light", |app| app.badge() == Badge::Settled);
    }

    /// Waits until nothing is at work and the viewport shows a picture.
    fn wait_picture(&mut self) {
        self.wait("a picture", |app| !app.is_busy() && app.has_picture());
    }

    /// Waits until the viewport shows another picture.
    fn wait_other_picture(&mut self, than: &[u8]) {
        let began = Instant::now();
        while self.picture() == than {
            assert!(began.elapsed() < PATIENCE, "the picture never changes");
            self.harness.step();
            sleep(Duration::from_millis(20));
        }
    }

    /// What the viewport shows.
    fn picture(&mut self) -> Vec<u8> {
        let rect = self.harness.get_by_label("viewport").rect();
        let image = self.harness.render().unwrap();
        let (x, y) = (rect.left() as u32, rect.top() as u32);
        let (w, h) = (rect.width() as u32, rect.height() as u32);
        image::imageops::crop_imm(&image, x, y, w, h).to_image().into_raw()
    }

    fn scene(&self) -> Arc<Scene> {
        self.app().session().scene.clone().unwrap()
    }

    fn edits_bytes(&self) -> Vec<u8> {
        format!("{:?}", self.app().session().document.edits).into_bytes()
    }

    /// Illuminance on the floor below the middle of the room, lx.
    fn floor_irradiance(&self) -> f32 {
        let solution = self.app().session().solution.clone().unwrap();
        let ray = Ray::new(Vec3::new(0.1, 1.0, 0.1), Vec3::NEG_Y);
        let hit = solution.world.accel.trace(&ray).unwrap();
        luminance(solution.radiosity.irradiance(hit.triangle, hit.barycentric, false, Part::All))
    }

    fn press(&mut self, key: egui::Key) {
        self.harness.key_press(key);
        self.harness.run_steps(2);
    }

    /// Clicks the widget with a label, in view or scrolled out of it.
    fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click_accesskit();
        self.harness.step();
        self.harness.step();
    }

    /// Keeps what is on screen where the environment asks for it.
    fn keep(&mut self, name: &str) {
        if let Ok(folder) = std::env::var("LUMENSCOPE_SHOTS") {
            let began = Instant::now();
            while began.elapsed() < Duration::from_secs(4) && !self.app().is_picture_settled() {
                self.harness.step();
                sleep(Duration::from_millis(20));
            }
            let image = self.harness.render().unwrap();
            image.save(Path::new(&folder).join(format!("{name}.png"))).unwrap();
        }
    }
}

#[test]
fn the_empty_window_invites() {
    let mut window = Window::empty();
    window.keep("empty");
    for label in ["Open a scene…", "Open example: Office", "Open example: Cornell box"] {
        window.harness.get_by_label(label);
    }
    window.press(egui::Key::F1);
    window.harness.run_steps(3);
    window.keep("help");
    window.harness.get_by_label("Keys and mouse");
}

#[test]
fn layers_and_views_follow_their_keys() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.keep("room");
    assert_eq!(window.app().session().scene.as_ref().unwrap().name, "room");
    let whole = window.picture();
    for (key, solo) in [
        (egui::Key::Num1, [1.0, 0.0, 0.0]),
        (egui::Key::Num2, [0.0, 1.0, 0.0]),
        (egui::Key::Num3, [0.0, 0.0, 1.0]),
    ] {
        window.press(key);
        assert_eq!(window.view().weights, solo);
        window.wait_other_picture(&whole);
        window.press(key);
        assert_eq!(window.view().weights, [1.0; 3]);
    }
    window.press(egui::Key::V);
    assert!(window.view().volume.shown);
    window.wait("volume spheres", |app| {
        app.session().inspection.as_ref().is_some_and(|i| !i.spheres.is_empty())
    });
    window.wait_picture();
    window.click("Views");
    window.keep("volume");
    for row in lumenscope_core::registry::VIEWS.iter().filter(|r| r.id != "irradiance_volume.spheres") {
        window.click(row.title);
        assert_eq!(window.view().views, [row.id]);
        window.wait("the view", |app| !app.is_busy());
        window.keep(row.id);
        window.click(row.title);
        assert!(window.view().views.is_empty());
    }
    window.press(egui::Key::V);
    assert!(window.app().session().inspection.is_none());
    for compare in [Compare::Reference, Compare::Difference, Compare::Picture] {
        window.press(egui::Key::R);
        assert_eq!(window.view().compare, compare);
        if compare == Compare::Reference {
            window
                .wait("a reference", |app| app.session().reference.as_ref().is_some_and(|r| r.samples >= 2));
        }
    }
}

#[test]
fn a_dragged_lamp_changes_the_light_and_undo_brings_it_back() {
    let mut window = Window::on_room();
    window.wait_picture();
    let bulb = Target::Lamp(0);
    let (scene, edits) = (window.scene(), window.edits_bytes());
    let (floor, picture) = (window.floor_irradiance(), window.picture());
    for step in 1..=5 {
        let at = Vec3::new(0.25 * step as f32, 2.5, 0.0);
        let placement = Affine3A::from_translation(at);
        window.run(Command::Place { target: bulb, placement, dragging: true });
        window.wait("light that follows", |app| app.session().is_lit_as_edited());
    }
    window.run(Command::EndDrag);
    window.wait_lit();
    window.wait_other_picture(&picture);
    window.keep("dragged");
    assert!(
        (window.floor_irradiance() - floor).abs() > 0.02 * floor,
        "the floor's irradiance follows the lamp"
    );
    assert_eq!(window.app().session().history.depth(), 1, "one drag is one step");
    let dragged = window.edits_bytes();

    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.harness.step();
    assert_eq!(window.edits_bytes(), edits);
    assert_eq!(window.scene().placement(bulb), scene.placement(bulb));
    window.wait_lit();
    let back = window.floor_irradiance();
    // Sweeps from another start stop within the radiosity's own tolerance, 1e-3 of the mean.
    assert!((back - floor).abs() < 5e-3 * floor, "{back} lx against {floor} lx before");
    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Y);
    window.harness.step();
    assert_eq!(window.edits_bytes(), dragged);
}

#[test]
fn a_dimmed_lamp_dims_the_room() {
    let mut window = Window::on_room();
    let floor = window.floor_irradiance();
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.5, dragging: false });
    window.wait_lit();
    let dimmed = window.floor_irradiance();
    // Light is linear in its only lamp; the sweeps stop within 1e-3 of the mean.
    assert!((dimmed - 0.5 * floor).abs() < 5e-3 * floor, "{dimmed} lx is not half of {floor} lx");
}

#[test]
fn a_clicked_point_is_read_out_and_its_spheres_open() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.harness.get_by_label("viewport").click();
    window.harness.step();
    window.wait("the spheres", |app| app.session().probe.is_some());
    window.wait_picture();
    window.keep("picked");
    let pick = window.app().pick().unwrap().clone();
    assert_eq!(pick.object, "walls");
    let irradiance = pick.irradiance_direct + pick.irradiance_indirect;
    assert!(irradiance.min_element() > 0.0);
    let weights: f32 = pick.volume_samples.iter().map(|s| s.weight).sum();
    assert!((weights - 1.0).abs() < 1e-4, "weights of the samples sum to {weights}");
    let probe = window.app().session().probe.clone().unwrap();
    assert_eq!(Some(probe.position), window.view().probe.map(|p| p.0));
    assert!(probe.position.distance(pick.position) < 0.2, "the spheres stand by the point");
    window.harness.get_by_label("Irradiance");
}

#[test]
fn a_session_is_saved_and_reopened_and_pictures_are_exported() {
    let mut window = Window::on_room();
    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 0.25, dragging: false });
    let file = window.folder.path().join("kept.lumenscope");
    window.run(Command::SaveSession(file.clone()));
    assert!(!window.app().session().is_dirty());
    assert!(fs::read_to_string(&file).unwrap().contains("\"room.ron\""), "the scene's path is relative");
    let edits = window.edits_bytes();
    window.wait_lit();
    let (png, exr) = (window.folder.path().join("out.png"), window.folder.path().join("out.exr"));
    window.run(Command::ExportPicture(png.clone()));
    window.run(Command::ExportLayers(exr.clone()));
    window.wait("the exports", |app| !app.is_busy());
    assert!(image::open(&png).unwrap().width() > 500);
    let layers = lumenscope_core::io::exr::read_layers(&exr).unwrap();
    assert_eq!(layers.iter().map(|l| l.0.as_str()).collect::<Vec<_>>(), ["emitted", "direct", "indirect"]);

    window.run(Command::Dim { target: Target::Lamp(0), dimmer: 1.0, dragging: false });
    assert_ne!(window.edits_bytes(), edits);
    window.run(Command::Open(file.clone()));
    window.wait("the session", |app| !app.session().history.can_undo());
    window.wait_lit();
    assert_eq!(window.edits_bytes(), edits);
    assert_eq!(window.scene().lamps[0].dimmer, 0.25);
    assert_eq!(window.app().recent()[0], file);
}

#[test]
fn what_cannot_be_opened_is_said_and_nothing_is_lost() {
    let mut window = Window::on_room();
    let scene = window.scene();
    for (name, bytes) in [
        ("broken.glb", b"glTF\x02\0\0\0garbage".as_slice()),
        ("broken.obj", b"v 0 0\nf 1 2 9\n"),
        ("broken.ron", b"(models: ["),
        ("broken.lumenscope", b"(scene: Some(\"nowhere.ron\"))"),
    ] {
        let path = window.folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        window.run(Command::Open(path));
        window.wait("a notice", |app| app.notice().is_some());
        let notice = window.app().notice().unwrap().clone();
        assert!(notice.text.contains("broken") || notice.text.contains("nowhere"), "{notice:?}");
        assert!(Arc::ptr_eq(&scene, &window.scene()), "{name}: the open scene stays");
        window.harness.run_steps(3);

        window.click("Dismiss");
        assert!(window.app().notice().is_none());
    }
    window.run(Command::SaveSession("/proc/nowhere/x.lumenscope".into()));
    assert!(window.app().notice().is_some());
}

#[test]
fn long_work_is_cancelled_and_taken_up_again() {
    let mut window = Window::empty();
    let scene = room(window.folder.path());
    let fine = ROOM.replace("gather_rays: Some(64)", "gather_rays: Some(4096)");
    let fine = fine.replace("element_spacing_m: Some(0.5)", "element_spacing_m: Some(0.03)");
    fs::write(&scene, fine).unwrap();
    window.run(Command::Open(scene.clone()));
    window.wait("the first light", |app| app.badge() == Badge::Solving);
    window.run(Command::Cancel);
    window.wait("the end of the work", |app| !app.is_busy());
    window.harness.run_steps(2);
    assert_eq!(window.app().badge(), Badge::Unlit);
    fs::write(&scene, ROOM).unwrap();
    window.run(Command::Open(scene));
    window.wait_lit();
    let floor = window.floor_irradiance();
    assert!(floor > 0.0);
    window.run(Command::Solve);
    window.wait_lit();
    assert_eq!(window.floor_irradiance(), floor, "solved again, nothing changes");
}

#[test]
fn a_dropped_model_is_added_as_a_movable_object() {
    let mut window = Window::on_room();
    let before = window.scene().objects.len();
    let path = window.folder.path().join("stool.obj");
    let mut obj = String::from("o stool\n");
    cuboid(&mut obj, 1, [0.4, 0.0, -0.2], [0.8, 0.5, 0.2], false);
    fs::write(&path, obj).unwrap();
    let ctx = window.harness.ctx.clone();
    window.harness.state_mut().drop_file(&ctx, &path);
    window.harness.run_steps(3);
    window.click("Add to scene");
    window.wait("the stool", |app| app.session().scene.as_ref().is_some_and(|s| s.objects.len() > before));
    window.wait_lit();
    window.keep("added");
    assert!(window.scene().objects[before..].iter().all(|o| o.movable));
    assert_eq!(window.app().session().document.added.len(), 1);
}

#[test]
fn panels_hide_and_the_light_theme_holds() {
    let mut window = Window::on_room();
    window.wait_picture();
    let bulb = window.harness.get_all_by_label_contains("bulb").next().unwrap();
    bulb.click();
    window.harness.run_steps(2);
    assert_eq!(window.view().selected, Some(Target::Lamp(0)));
    window.keep("selected");
    window.run(Command::Window(lumenscope::command::Window::Theme));
    window.harness.run_steps(2);
    window.keep("light");
    window.press(egui::Key::Escape);
    assert_eq!(window.view().selected, None);
    assert!(window.harness.query_by_label("Read-out").is_some());
    window.press(egui::Key::Tab);
    assert!(window.harness.query_by_label("Read-out").is_none());
}

/// Pictures of the examples for the eye, where the environment asks for them.
#[test]
fn examples_open() {
    for example in Example::ALL {
        assert!(example.path().unwrap().exists());
        if std::env::var("LUMENSCOPE_SHOTS").is_ok() {
            let mut window = Window::empty();
            window.run(Command::OpenExample(example));
            window.wait_lit();
            window.harness.get_by_label("viewport").click();
            window.wait("the spheres", |app| app.session().probe.is_some());
            window.wait_picture();
            window.keep(example.title());
            window.press(egui::Key::V);
            window.click("Views");
            window.wait_picture();
            window.click("Plan");
            window.keep(&format!("{} volume", example.title()));
        }
    }
}

#[test]
fn illuminance_is_measured_where_asked_and_follows_the_lamp() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.click("Placement");
    assert!(window.app().session().measurement.is_none());
    // Under the bulb, 0.75 m above the floor.
    let requirement = preset("Technical drawing").unwrap().requirement();
    let mut placement = Placement { site: Some(Site::Own), requirement, ..Placement::default() };
    let measure =
        |placement: &Placement| Command::Measure { placement: Box::new(placement.clone()), dragging: false };
    window.run(measure(&placement));
    window.wait("a measurement", |app| app.session().measurement.is_some() && !app.is_busy());
    let mean = |app: &LumenscopeApp| {
        app.session().measurement.as_ref().and_then(|m| m.statistics()).map_or(0.0, |s| s.mean_lx)
    };
    let bright = mean(window.app());
    // I / d² of about 280 cd at 1.75 m is 92 lx; the grey room adds less than that again.
    assert!((60.0..250.0).contains(&bright), "{bright} lx");
    window.harness.get_by_label("illuminance map");
    window.harness.get_by_label_contains("too little light");
    window.click("Show in the picture");
    assert_eq!(window.view().views, [PLACEMENT]);
    window.wait("lines of equal illuminance", |app| {
        app.session().inspection.as_ref().is_some_and(|i| !i.lines.is_empty() && !i.labels.is_empty())
    });
    window.keep("placement");

    // The bulb is carried off: the desk darkens while it moves.
    let light = window.app().session().solution.as_ref().map(|s| s.provenance.revision);
    for step in 1..=3 {
        let at = Affine3A::from_translation(Vec3::new(0.5 * step as f32, 2.5, 0.0));
        window.run(Command::Place { target: Target::Lamp(0), placement: at, dragging: true });
        window.wait("a darker desk", |app| mean(app) < bright - 2.0 * step as f32);
    }
    assert_ne!(window.app().session().solution.as_ref().map(|s| s.provenance.revision), light);
    window.run(Command::EndDrag);
    window.wait_lit();

    // The choice is an edit: one step, undone and redone without new light, kept in a session.
    placement.requirement = Default::default();
    placement.site = Some(Site::Top(1));
    window.run(measure(&placement));
    window.wait("the block's top", |app| {
        app.session().measurement.as_ref().is_some_and(|m| m.name == "Top of block")
    });
    window.run(Command::Undo);
    window.wait("the desk again", |app| {
        app.session().measurement.as_ref().is_some_and(|m| m.name == "Own plane")
    });
    assert_eq!(window.app().badge(), Badge::Settled, "a measurement needs no new light");
    let file = window.folder.path().join("measured.lumenscope");
    window.run(Command::SaveSession(file.clone()));
    window.run(Command::Open(file));
    window.wait("the session", |app| app.session().measurement.is_some() && !app.is_busy());
    assert_eq!(window.app().session().document.edits.placement.site, Some(Site::Own));
    window.run(measure(&Placement { site: Some(Site::Plane(7)), ..Placement::default() }));
    assert_eq!(
        window.app().session().document.edits.placement.site,
        Some(Site::Own),
        "there is no such plane"
    );
}
