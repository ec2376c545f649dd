//! The window that tests drive, and the room in it.

use egui_kittest::{Harness, kittest::Queryable};
use glam::Vec3;
use lumenscope::{
    LumenscopeApp,
    app::Config,
    command::Command,
    panels::status::Badge,
    session::{Document, View},
};
use lumenscope_core::{
    math::{colour::luminance, part::Part},
    scene::{Scene, accel::Ray},
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
pub const PATIENCE: Duration = Duration::from_secs(100);

/// A room of 4 × 3 × 4 m with a movable block and a point lamp.
pub const ROOM: &str = r#"(
    models: [(file: "room.obj")],
    lamps: [Point(name: "bulb", at: (0.0, 2.5, 0.0), intensity: (300.0, 280.0, 240.0))],
    movable: ["block"],
    camera: Some((eye: (0.0, 1.5, 1.95), target: (0.0, 1.2, -2.0), up: (0.0, 1.0, 0.0), vertical_fov: 1.2)),
    plan: (element_spacing_m: Some(0.5), gather_rays: Some(64), volume_samples: Some((4, 4, 4)), volume_bins_n: Some(5)),
)"#;

pub fn cuboid(obj: &mut String, first: usize, low: [f32; 3], high: [f32; 3], inward: bool) {
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
pub fn room(folder: &Path) -> PathBuf {
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

/// The program's window.
pub struct Window<'a> {
    pub harness: Harness<'a, LumenscopeApp>,
    pub folder: tempfile::TempDir,
}

impl Window<'_> {
    pub fn empty() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let config = Config { folder: Some(folder.path().join("config")) };
        let harness = Harness::builder()
            .with_size([1280.0, 800.0])
            .wgpu()
            .build_eframe(|cc| LumenscopeApp::with_config(cc, Document::default(), &config).unwrap());
        Self { harness, folder }
    }

    /// The window with the room in it, lit.
    pub fn on_room() -> Self {
        let mut window = Self::empty();
        let scene = room(window.folder.path());
        window.run(Command::Open(scene));
        window.wait_lit();
        window
    }

    pub fn app(&self) -> &LumenscopeApp {
        self.harness.state()
    }

    pub fn view(&self) -> View {
        self.app().session().document.view.clone()
    }

    pub fn run(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.harness.state_mut().run(&ctx, command);
        self.harness.step();
    }

    pub fn wait(&mut self, what: &str, done: impl Fn(&LumenscopeApp) -> bool) {
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

    /// Waits until a widget with a label is there.
    pub fn wait_for_label(&mut self, label: &str) {
        let began = Instant::now();
        while self.harness.query_by_label(label).is_none() {
            assert!(began.elapsed() < PATIENCE, "waited in vain for {label}");
            self.harness.step();
            sleep(Duration::from_millis(20));
        }
    }

    pub fn wait_lit(&mut self) {
        self.wait("settled light", |app| app.badge() == Badge::Settled);
    }

    /// Waits until nothing is at work and the viewport shows a picture.
    pub fn wait_picture(&mut self) {
        self.wait("a picture", |app| !app.is_busy() && app.has_picture());
    }

    /// Waits until the viewport shows another picture.
    pub fn wait_other_picture(&mut self, than: &[u8]) {
        let began = Instant::now();
        while self.picture() == than {
            assert!(began.elapsed() < PATIENCE, "the picture never changes");
            self.harness.step();
            sleep(Duration::from_millis(20));
        }
    }

    /// What the viewport shows.
    pub fn picture(&mut self) -> Vec<u8> {
        let rect = self.harness.get_by_label("viewport").rect();
        let image = self.harness.render().unwrap();
        let (x, y) = (rect.left() as u32, rect.top() as u32);
        let (w, h) = (rect.width() as u32, rect.height() as u32);
        image::imageops::crop_imm(&image, x, y, w, h).to_image().into_raw()
    }

    pub fn scene(&self) -> Arc<Scene> {
        self.app().session().scene.clone().unwrap()
    }

    pub fn edits_bytes(&self) -> Vec<u8> {
        format!("{:?}", self.app().session().document.edits).into_bytes()
    }

    /// Illuminance on the floor below the middle of the room, lx.
    pub fn floor_irradiance(&self) -> f32 {
        let solution = self.app().session().solution.clone().unwrap();
        let ray = Ray::new(Vec3::new(0.1, 1.0, 0.1), Vec3::NEG_Y);
        let hit = solution.world.accel.trace(&ray).unwrap();
        luminance(solution.radiosity.irradiance(hit.triangle, hit.barycentric, false, Part::All))
    }

    pub fn press(&mut self, key: egui::Key) {
        self.harness.key_press(key);
        self.harness.run_steps(2);
    }

    /// Clicks the widget with a label, in view or scrolled out of it.
    pub fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click_accesskit();
        self.harness.step();
        self.harness.step();
    }

    /// Clicks a point of the window.
    pub fn click_at(&mut self, at: egui::Pos2) {
        self.harness.hover_at(at);
        self.harness.step();
        self.harness.drag_at(at);
        self.harness.step();
        self.harness.drop_at(at);
        self.harness.run_steps(2);
    }

    /// Keeps what is on screen where the environment asks for it.
    pub fn keep(&mut self, name: &str) {
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
