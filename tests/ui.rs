//! The program as its user meets it: the real window, without a screen.

use egui_kittest::{Harness, kittest::Queryable};
use lumenscope::{
    LumenscopeApp,
    app::Config,
    session::{Document, View},
};
use std::{
    fs,
    path::{Path, PathBuf},
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
    cuboid(&mut obj, 9, [-1.2, 0.0, -1.4], [-0.4, 1.1, -0.6], false);
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
        window.run(lumenscope::command::Command::Open(scene));
        window.wait_lit();
        window
    }

    fn app(&self) -> &LumenscopeApp {
        self.harness.state()
    }

    fn view(&self) -> View {
        self.app().session().document.view.clone()
    }

    fn run(&mut self, command: lumenscope::command::Command) {
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
        self.wait("settled light", |app| app.badge() == lumenscope::panels::status::Badge::Settled);
    }

    /// Clicks the widget with a label.
    fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.harness.step();
        self.harness.step();
    }

    /// Keeps what is on screen where the environment asks for it.
    fn keep(&mut self, name: &str) {
        if let Ok(folder) = std::env::var("LUMENSCOPE_SHOTS") {
            self.harness.step();
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
    window.harness.key_press(egui::Key::F1);
    window.harness.step();
    window.harness.step();
    window.keep("help");
    window.harness.get_by_label("Keys and mouse");
}

#[test]
fn a_room_opens_and_is_lit() {
    let mut window = Window::on_room();
    window.keep("room");
    assert_eq!(window.app().session().scene.as_ref().unwrap().name, "room");
    assert!(window.view().display.ev100.is_finite());
    let bulb = window.harness.get_all_by_label_contains("bulb").next().unwrap();
    bulb.click();
    window.harness.step();
    window.harness.step();
    window.keep("selected");
    assert_eq!(window.view().selected, Some(lumenscope_core::scene::Target::Lamp(0)));
    let ctx = window.harness.ctx.clone();
    ctx.set_theme(egui::Theme::Light);
    window.harness.step();
    window.keep("light");
}
