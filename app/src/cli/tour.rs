//! The tour: the real window, driven without a screen, photographed as a user would see it.

use super::small_png;
use crate::{
    LumenscopeApp,
    app::Config,
    command::{Command, Window as WindowCommand},
    examples::Example,
    lightmaps::{LIGHTMAPS, LightmapFile, coordinates},
    pipeline::KERNEL,
    placement::{PLACEMENT, Placement, Site},
    session::{Compare, Document, View, VolumeView},
};
use anyhow::{Context, anyhow, bail};
use egui_kittest::{Harness, kittest::Queryable};
use glam::{Affine3A, Vec3};
use lumenscope_core::{
    io::exr,
    irradiance_volume::inspect::ColourBy,
    math::{false_colour::FalseColour, part::Part, progress::Progress},
    measure::grid_texture::GridReference,
    radiosity::{
        texels::{self, Coverage},
        texture::display::Filter,
    },
    scene::Target,
};
use std::{
    path::{Path, PathBuf},
    thread::sleep,
    time::{Duration, Instant},
};

/// Size of the window, points.
const WINDOW: [f32; 2] = [1280.0, 800.0];
/// Taller, for panels that show much at once.
const TALL: [f32; 2] = [1280.0, 1180.0];
/// Longest wait for light to settle.
const PATIENCE: Duration = Duration::from_secs(300);
/// Longest wait for the picture to lose its grain; it is photographed then as it is.
pub(super) const GRAIN: Duration = Duration::from_secs(20);

/// Slice through the office, m along z.
const SLICE: (u8, f32) = (2, 0.4);

/// Photographs the window in the states a user meets first, or what belongs to one example alone.
///
/// # Errors
/// One line saying what could not be shown or written.
pub fn write(folder: &Path, only: Option<Example>) -> anyhow::Result<()> {
    super::solve::output_folder(folder)?;
    let mut tour = Tour::start(folder)?;
    if only.is_none() {
        tour.empty()?;
    }
    let parts: [(Example, Scenes); 7] = [
        (Example::Office, Tour::office),
        (Example::Cornell, Tour::cornell),
        (Example::Quadtrees, Tour::quadtrees),
        (Example::Ball, Tour::ball),
        (Example::Teapot, Tour::teapot),
        (Example::Phong, Tour::phong),
        (Example::House, Tour::house),
    ];
    for (_, part) in parts.into_iter().filter(|(example, _)| only.is_none_or(|only| only == *example)) {
        part(&mut tour)?;
    }
    Ok(())
}

/// What is photographed of one example.
type Scenes = fn(&mut Tour) -> anyhow::Result<()>;

pub(super) struct Tour {
    harness: Harness<'static, LumenscopeApp>,
    folder: PathBuf,
    /// For what is deleted at the end.
    pub(super) scratch: PathBuf,
}

impl Drop for Tour {
    fn drop(&mut self) {
        if let Err(error) = std::fs::remove_dir_all(&self.scratch) {
            log::warn!("cannot remove {}: {error}", self.scratch.display());
        }
    }
}

impl Tour {
    fn start(folder: &Path) -> anyhow::Result<Self> {
        let make = |cc: &mut eframe::CreationContext<'_>| match LumenscopeApp::with_config(
            cc,
            Document::default(),
            &Config::default(),
        ) {
            Ok(app) => app,
            Err(error) => panic!("the window did not start: {error}"),
        };
        let build = || Harness::builder().with_size(WINDOW).wgpu().build_eframe(make);
        // The harness panics where there is no adapter, not even a software one.
        let harness = std::panic::catch_unwind(build)
            .map_err(|_| anyhow!("there is no graphics adapter to draw the window with"))?;
        let scratch = std::env::temp_dir().join(format!("lumenscope-tour-{}", std::process::id()));
        super::solve::output_folder(&scratch)?;
        Ok(Self { harness, folder: folder.to_path_buf(), scratch })
    }

    pub(super) fn run(&mut self, command: Command) {
        let ctx = self.harness.ctx.clone();
        self.harness.state_mut().run(&ctx, command);
        self.harness.run_steps(2);
    }

    pub(super) fn view(&mut self, change: impl FnOnce(&mut View)) {
        let mut view = self.harness.state().session().document.view.clone();
        change(&mut view);
        self.run(Command::View(Box::new(view)));
    }

    fn open(&mut self, example: Example) -> anyhow::Result<()> {
        let before = self.harness.state().session().base.clone();
        self.run(Command::OpenExample(example));
        if self.harness.state().asked().is_some() {
            self.harness.run_steps(2);
            self.click("Discard");
        }
        self.wait("the scene", |app| match (&before, &app.session().base) {
            (Some(before), Some(now)) => !std::sync::Arc::ptr_eq(before, now),
            (_, now) => now.is_some(),
        })?;
        self.settled()
    }

    /// Waits for light to settle.
    pub(super) fn settled(&mut self) -> anyhow::Result<()> {
        self.wait("light", |app| app.badge() == crate::panels::status::Badge::Settled && !app.is_busy())
    }

    /// The window before anything is open.
    fn empty(&mut self) -> anyhow::Result<()> {
        self.photograph("empty", Duration::ZERO)?;
        self.run(Command::Window(WindowCommand::Help));
        self.photograph("help", Duration::ZERO)?;
        self.run(Command::Window(WindowCommand::Help));
        Ok(())
    }

    /// Most views, in the office.
    fn office(&mut self) -> anyhow::Result<()> {
        self.open(Example::Office)?;
        self.photograph("office", GRAIN)?;
        self.click_at([0.36, 0.58]);
        self.wait("the spheres", |app| app.session().probe.is_some())?;
        self.tall(true);
        self.photograph("probe", GRAIN)?;
        self.click("Unfolded");
        self.photograph("unfolded", GRAIN)?;
        self.view(|view| view.probe_bins_n = 29);
        self.click("Smooth");
        self.click("3-D lobe");
        self.click("E");
        self.wait("the spheres", |app| !app.is_busy())?;
        self.photograph("lobe", GRAIN)?;
        self.click("Resolutions");
        self.wait("every resolution", |app| !app.session().resolutions.is_empty() && !app.is_busy())?;
        self.photograph("resolutions", GRAIN)?;
        self.click("Smooth");
        self.click("Moments");
        self.wait("the moments", |app| app.session().moments.is_some() && !app.is_busy())?;
        self.photograph("moments", GRAIN)?;
        self.click("Radial plots");
        self.tall(false);
        let camera = self.harness.state().session().document.view.camera;
        for (id, away) in [("irradiance_volume.lighting", 1.1), ("irradiance_volume.rays", 3.0)] {
            self.view(|view| {
                view.views = vec![id.to_owned()];
                view.camera.target = view.probe.map_or(camera.target, |(point, _)| point);
                view.camera.eye =
                    view.camera.target + (camera.eye - camera.target).normalize_or_zero() * away;
            });
            self.wait("the view", |app| app.session().inspection.is_some() && !app.is_busy())?;
            self.photograph(&id.replace('.', "_"), GRAIN)?;
        }
        self.view(|view| *view = View { camera, ..View::default() });
        self.click("Plan");
        self.click("radiosity: automatic");
        self.photograph("plan", GRAIN)?;
        self.harness.key_press(egui::Key::Escape);
        self.harness.run_steps(2);
        self.click("Layers");

        self.view(|view| (view.volume.shown, view.volume.size) = (true, 0.06));
        self.wait("the volume", |app| app.session().inspection.is_some() && !app.is_busy())?;
        self.photograph("volume", GRAIN)?;
        self.view(|view| {
            view.volume.part = Part::Indirect;
            view.volume.slice = Some(SLICE);
            view.volume.size = 0.3;
        });
        self.wait("the slice", |app| !app.is_busy())?;
        self.photograph("volume_slice", GRAIN)?;
        self.view(|view| *view = View { camera: view.camera, ..View::default() });

        self.view(|view| {
            view.volume = VolumeView {
                shown: true,
                colour_by: ColourBy::Validity,
                size: 0.12,
                ..VolumeView::default()
            };
        });
        self.click("Views");
        self.wait("what the samples are worth", |app| app.session().inspection.is_some() && !app.is_busy())?;
        self.photograph("volume_validity", GRAIN)?;
        self.view(|view| *view = View { camera: view.camera, ..View::default() });

        let with_slice = Some(SLICE);
        for (id, slice) in [
            ("radiosity.elements", None),
            ("radiosity.edges", None),
            ("radiosity.irradiance", None),
            ("radiosity.gradient", None),
            ("irradiance_volume.grid", with_slice),
            ("irradiance_volume.slice", with_slice),
            ("irradiance_volume.cell_errors", None),
            ("irradiance_volume.self_occlusion", None),
        ] {
            self.view(|view| (view.views, view.volume.slice) = (vec![id.to_owned()], slice));
            self.wait("the view", |app| app.session().inspection.is_some() && !app.is_busy())?;
            self.photograph(&id.replace('.', "_"), GRAIN)?;
        }
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        self.click("Layers");
        self.compare_volumes("Ceiling panel")?;
        self.view(|view| view.views.clear());
        self.view(|view| view.weights = [0.0, 0.0, 1.0, 0.0, 0.0]);
        self.photograph("indirect", GRAIN)?;
        self.view(|view| view.weights = View::default().weights);
        let colours = FalseColour { palette: Default::default(), low: 1.0, high: 300.0, logarithmic: true };
        self.view(|view| view.display.false_colour = Some(colours));
        self.photograph("false_colour", GRAIN)?;
        self.view(|view| view.display.false_colour = None);

        let writing = lumenscope_core::irradiance_volume::placement::requirement::PRESETS
            .iter()
            .find(|p| p.mean_lx == Some(500.0))
            .map(|p| p.requirement())
            .unwrap_or_default();
        let placement =
            Placement { site: Some(Site::Plane(0)), requirement: writing, ..Placement::default() };
        self.run(Command::Measure { placement: Box::new(placement), dragging: false });
        self.view(|view| view.views = vec![PLACEMENT.to_owned()]);
        self.click("Placement");
        self.wait("the measurement", |app| app.session().measurement.is_some() && !app.is_busy())?;
        self.photograph("placement", GRAIN)?;
        self.view(|view| view.views.clear());
        self.click("Spheres");

        self.drag("Desk lamp", Vec3::new(-0.55, 0.0, 0.1))?;
        self.photograph("dragged", GRAIN)?;
        self.run(Command::Window(WindowCommand::Theme));
        self.photograph("light_theme", GRAIN)?;
        self.run(Command::Window(WindowCommand::Theme));
        Ok(())
    }

    /// Textures, lightmaps and the reference, in the Cornell box.
    fn cornell(&mut self) -> anyhow::Result<()> {
        self.open(Example::Cornell)?;
        self.texture_at([0.56, 0.3], "texture")?;
        self.view(|view| view.compare = Compare::Reference);
        self.run(Command::StartReference);
        self.wait("the reference", |app| app.session().reference.as_ref().is_some_and(|r| r.samples >= 512))?;
        self.run(Command::Cancel);
        self.photograph("reference", Duration::ZERO)?;
        self.view(|view| view.compare = Compare::Difference);
        self.photograph("difference", GRAIN)?;
        self.view(|view| view.compare = Compare::Flip);
        self.photograph("flip", GRAIN)?;
        self.lightmap()?;
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        self.view(|view| "LD{2}E".clone_into(&mut view.paths));
        self.photograph("bounce", GRAIN)?;
        self.view(|view| view.paths.clear());
        self.volumes()
    }

    /// Radiosity on quadtrees, split where light bends.
    fn quadtrees(&mut self) -> anyhow::Result<()> {
        self.open(Example::Quadtrees)?;
        self.view(|view| view.views = vec!["radiosity.edges".to_owned()]);
        self.wait("the quadtrees", |app| app.session().inspection.is_some() && !app.is_busy())?;
        self.photograph("radiosity_quadtrees", GRAIN)?;
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        Ok(())
    }

    /// What is glossy.
    fn teapot(&mut self) -> anyhow::Result<()> {
        self.open(Example::Teapot)?;
        self.view(|view| "L(D|S)*SE".clone_into(&mut view.paths));
        self.photograph("specular", GRAIN)?;
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        self.kernel("kernel")
    }

    /// The same of Phong's lobe.
    fn phong(&mut self) -> anyhow::Result<()> {
        self.open(Example::Phong)?;
        self.kernel("kernel_phong")
    }

    /// The kernel of a point of the table.
    fn kernel(&mut self, name: &str) -> anyhow::Result<()> {
        self.view(|view| view.show(KERNEL, true));
        let viewport = self.harness.get_by_label("viewport").rect();
        self.harness.hover_at(viewport.lerp_inside(egui::vec2(0.35, 0.75)));
        self.wait("the kernel", |app| !app.is_busy())?;
        self.photograph(name, GRAIN)?;
        self.view(|view| view.show(KERNEL, false));
        Ok(())
    }

    /// The house with its mirrors, and where they are sampled.
    fn house(&mut self) -> anyhow::Result<()> {
        self.open(Example::House)?;
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        self.photograph("house", GRAIN)?;
        self.view(|view| view.views = vec!["mirror.images".to_owned()]);
        self.wait("the samples", |app| app.session().inspection.is_some() && !app.is_busy())?;
        self.photograph("mirror_images", GRAIN)
    }

    /// Clicks the widget with a label.
    pub(super) fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.harness.run_steps(2);
    }

    /// What comes to the air straight from an object, as spheres and as a slice.
    fn compare_volumes(&mut self, name: &str) -> anyhow::Result<()> {
        let scene = self.harness.state().session().scene.clone().context("no scene is open")?;
        let object = scene.objects.iter().position(|o| o.name == name);
        let target = Target::Object(object.with_context(|| format!("no object is called {name}"))?);
        self.view(|view| {
            view.volume.ignored.insert(target);
            view.volume.slice = Some(SLICE);
            view.volume.part = Part::All;
            view.views = vec!["irradiance_volume.difference_slice".to_owned()];
        });
        self.click("Views");
        self.wait("the difference", |app| !app.is_busy())?;
        self.tall(true);
        self.photograph("volume_difference", GRAIN)?;
        self.tall(false);
        self.click("Layers");
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        Ok(())
    }

    /// A ball's texture by longitude and latitude.
    fn ball(&mut self) -> anyhow::Result<()> {
        self.open(Example::Ball)?;
        self.texture_at([0.6, 0.55], "ball_texture")
    }

    /// The texture of a surface at its three stages, against the path tracer.
    fn texture_at(&mut self, at: [f32; 2], name: &str) -> anyhow::Result<()> {
        self.click("Texture");
        self.click_at(at);
        self.view(|view| view.stages.stored = Filter::Nearest);
        self.view(|view| view.traced_texture = true);
        self.wait("the path tracer", |app| {
            let reference = app.session().texture.as_ref().and_then(|t| t.reference.as_ref());
            reference.is_some_and(|r| r.paths >= GridReference::PATHS * GridReference::ENOUGH)
        })?;
        self.tall(true);
        self.photograph(name, GRAIN)?;
        self.tall(false);
        self.click("Spheres");
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        Ok(())
    }

    /// A lightmap baked before the tall block was moved.
    fn lightmap(&mut self) -> anyhow::Result<()> {
        const TEXELS: u32 = 256;
        self.view(|view| view.compare = Compare::default());
        let solution = self.harness.state().session().solution.clone().context("there is no light")?;
        let (world, progress) = (&solution.world, Progress::silent());
        let coverage = Coverage::new(world, &coordinates(world), [TEXELS; 2])?;
        let map = texels::bake(world, &solution.radiosity, &coverage, 2, &progress)?;
        let path = self.scratch.join("cornell lightmap.exr");
        exr::write_layers(&path, &[("", &map)], "irradiance, lx")?;
        self.drag("Tall block", Vec3::new(0.07, 0.0, 0.0))?;
        self.run(Command::Lightmap(LightmapFile::new(path.clone())));
        self.click("Lightmap");
        self.view(|view| view.views = vec![LIGHTMAPS[1].to_owned()]);
        self.wait("the lightmap", |app| app.session().lightmap.is_some() && !app.is_busy())?;
        self.tall(true);
        self.photograph("lightmap", GRAIN)?;
        self.view(|view| view.views = vec![LIGHTMAPS[3].to_owned()]);
        self.wait("its faults", |app| app.session().inspection.is_some() && !app.is_busy())?;
        self.photograph("lightmap_faults", GRAIN)?;
        self.tall(false);
        self.click("Spheres");
        self.view(|view| view.views.clear());
        Ok(())
    }

    /// Makes the window tall, or as it was.
    pub(super) fn tall(&mut self, tall: bool) {
        self.harness.set_size(if tall { TALL } else { WINDOW }.into());
        self.harness.run_steps(3);
    }

    /// Clicks the viewport at a share of its width and height.
    fn click_at(&mut self, [x, y]: [f32; 2]) {
        let rect = self.harness.get_by_label("viewport").rect();
        let at = rect.lerp_inside(egui::vec2(x, y));
        self.harness.hover_at(at);
        self.harness.step();
        self.harness.drag_at(at);
        self.harness.step();
        self.harness.drop_at(at);
        self.harness.run_steps(2);
    }

    pub(super) fn drag(&mut self, name: &str, by: Vec3) -> anyhow::Result<()> {
        let scene = self.harness.state().session().scene.clone().context("no scene is open")?;
        let object = scene.objects.iter().position(|o| o.name == name);
        let target = Target::Object(object.with_context(|| format!("no object is called {name}"))?);
        self.view(|view| view.selected = Some(target));
        for step in 1..=4 {
            let placement = Affine3A::from_translation(by * (step as f32 / 4.0)) * scene.placement(target);
            self.run(Command::Place { target, placement, dragging: true });
        }
        self.run(Command::EndDrag);
        self.settled()
    }

    pub(super) fn wait(&mut self, what: &str, done: impl Fn(&LumenscopeApp) -> bool) -> anyhow::Result<()> {
        let began = Instant::now();
        loop {
            self.harness.step();
            if done(self.harness.state()) {
                return Ok(());
            }
            if let Some(notice) = self.harness.state().notice() {
                bail!("waiting for {what}: {notice:?}");
            }
            if began.elapsed() > PATIENCE {
                bail!("waited {} s in vain for {what}", PATIENCE.as_secs());
            }
            sleep(Duration::from_millis(10));
        }
    }

    /// Waits for the picture to settle, at most `patience`, and writes the window.
    pub(super) fn photograph(&mut self, name: &str, patience: Duration) -> anyhow::Result<()> {
        let began = Instant::now();
        self.harness.run_steps(3);
        while began.elapsed() < patience && !self.harness.state().is_picture_settled() {
            self.harness.step();
            sleep(Duration::from_millis(10));
        }
        let image = self.harness.render().map_err(|error| anyhow!("the window cannot be drawn: {error}"))?;
        let path = self.folder.join(format!("{name}.png"));
        let pixels: Vec<[u8; 4]> = image.pixels().map(|p| p.0).collect();
        small_png::write(&path, image.width(), image.height(), &pixels)?;
        eprintln!("{}", path.display());
        Ok(())
    }
}
