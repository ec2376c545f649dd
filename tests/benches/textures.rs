//! Radiosity as textures on few polygons against the same light at the vertices of a mesh cut into its elements:
//! the dissertation's Table 5.1, drawn by one renderer in one run. `cargo bench --bench textures`.
//!
//! Ours are not texture images: a polygon's light is a grid of elements in a buffer, looked up bilinearly or
//! bicubically. The mesh has a corner at each of these elements and their light, so both show the same.

use anyhow::Context;
use glam::{UVec2, Vec3};
use lumenscope_core::{
    gpu::{
        FrameSettings, GpuContext, GpuRenderer,
        clock::{Stage, StageClock},
    },
    math::progress::Progress,
    radiosity::{
        RadiositySettings, RadiositySolution,
        gather::Transport,
        lookup::{Lookup, SideMap},
        surface_map::{Chart, ElementLayout, SurfaceMap},
    },
    scene::{Object, Part, Scene, camera::Camera, import, mesh::Mesh, world::World},
    superposition::{composite::DirectQuality, layers::Layer},
    transport::{
        LightTransportSolution,
        live::{LiveTransport, SolveSettings},
    },
};
use lumenscope_scenes::grotto::{POLYGONS, grotto};
use std::{sync::Arc, time::Instant};

/// Polygons of the thesis's mesh.
const MESH_POLYGONS: usize = 93_640;
/// Its frames a second: textures bilinear and bicubic, and mesh.
const THESIS: [f64; 3] = [25.3, 13.3, 3.2];
/// Its bytes: model and textures, and mesh.
const THESIS_BYTES: [f64; 2] = [93e3 + 4e6, 16_282e3];
const SIZE: [u32; 2] = [720, 486];
const FRAMES: usize = 30;
const WARM_UP: usize = 4;

fn main() -> anyhow::Result<()> {
    // Runners of tests start every target; this one tests nothing.
    if std::env::args().any(|a| a == "--test" || a == "--list") {
        return Ok(());
    }
    let textures = solved(scene()?)?;
    let mesh = meshed(&textures)?;
    let mut bicubic = textures.clone();
    Arc::make_mut(&mut bicubic.scene).plan.lookup = Some(Lookup::Mitchell);
    let context = GpuContext::headless_with(StageClock::FEATURES)?;
    println!("{}, {}x{}, {FRAMES} frames each in turns", context.adapter, SIZE[0], SIZE[1]);

    let shown = [&textures, &bicubic, &mesh];
    // The first renderer that uses a shader may be several times slower on a processor: one is thrown away.
    for solution in shown {
        Drawing::new(&context, solution)?.draw(&context)?;
    }
    let mut drawings =
        shown.map(|s| Drawing::new(&context, s)).into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    for frame in 0..WARM_UP + FRAMES {
        for drawing in &mut drawings {
            let spent = drawing.draw(&context)?;
            if frame >= WARM_UP {
                drawing.spent.push(spent);
            }
        }
    }
    let layers = |d: &Drawing| d.renderer.read_layers(&context.device, &context.queue);
    let [a, b] = [layers(&drawings[0])?, layers(&drawings[2])?];
    let (a, b) = (a.get(Layer::Indirect), b.get(Layer::Indirect));
    let off = a.pixels.iter().zip(&b.pixels).fold(Vec3::ZERO, |sum, (a, b)| sum + (*a - *b).abs());
    let mean = b.pixels.iter().fold(Vec3::ZERO, |sum, b| sum + *b);
    println!("indirect light of both differs by {:.2} % of its mean", 100.0 * (off / mean).x);

    println!(
        "{:<26}{:>10}{:>11}{:>12}{:>12}{:>11}{:>11}{:>9}{:>8}",
        "", "polygons", "triangles", "visibility", "shading ms", "frame ms", "frames/s", "thesis", "MB"
    );
    let names = ["textures, bilinear", "textures, bicubic", "mesh, light at vertices"];
    for (i, drawing) in drawings.iter().enumerate() {
        let triangles = shown[i].world.geometry.len();
        let [visibility, shading, frame] = drawing.medians();
        println!(
            "{:<26}{:>10}{triangles:>11}{visibility:>12.2}{shading:>12.2}{frame:>11.2}{:>11.1}{:>9.1}{:>8.2}",
            names[i],
            triangles / 2,
            1e3 / frame,
            THESIS[i],
            drawing.bytes as f64 / 1e6
        );
    }
    let frame = |i: usize| drawings[i].medians()[2];
    let bytes = |i: usize| drawings[i].bytes as f64;
    println!(
        "textures over mesh: {:.2} times the frames a second (thesis {:.1}), bicubic {:.2} (thesis {:.1}); memory 1 to \
         {:.2} (thesis 1 to {:.1})",
        frame(2) / frame(0),
        THESIS[0] / THESIS[2],
        frame(2) / frame(1),
        THESIS[1] / THESIS[2],
        bytes(2) / bytes(0),
        THESIS_BYTES[1] / THESIS_BYTES[0]
    );
    Ok(())
}

fn scene() -> anyhow::Result<Scene> {
    let path = std::env::temp_dir().join(format!("lumenscope-grotto-{}.glb", std::process::id()));
    std::fs::write(&path, grotto(7).bytes())?;
    let scene = import::load(&path);
    std::fs::remove_file(&path)?;
    let mut scene = scene?;
    scene.camera = Camera {
        eye: Vec3::new(0.6, 2.6, 8.4),
        target: Vec3::new(6.5, 0.8, 4.0),
        up: Vec3::Y,
        vertical_fov: 1.0,
    };
    Ok(scene)
}

/// Solved so finely that its grids have as many cells as the thesis's mesh has polygons.
fn solved(scene: Scene) -> anyhow::Result<LightTransportSolution> {
    let geometry = World::new(&scene).geometry;
    anyhow::ensure!(geometry.len() == 2 * POLYGONS, "{} triangles for {POLYGONS} polygons", geometry.len());
    let mut spacing = 0.2;
    while ElementLayout::new(&geometry, Some(spacing)).grid_nodes < MESH_POLYGONS + MESH_POLYGONS / 20 {
        spacing *= 0.99;
    }
    let radiosity = RadiositySettings { element_spacing_m: Some(spacing), ..RadiositySettings::default() };
    let settings = SolveSettings { radiosity, volume: None, preview: false };
    let live = LiveTransport::solve(Arc::new(scene), settings, &Progress::silent(), &mut |_| {})?;
    Ok(live.current().clone())
}

/// The same light on a mesh with a corner at every element.
fn meshed(textures: &LightTransportSolution) -> anyhow::Result<LightTransportSolution> {
    let map = &textures.radiosity.transport().map;
    let mut scene = Scene { meshes: Vec::new(), objects: Vec::new(), ..(*textures.scene).clone() };
    let mut sides = Vec::new();
    for (number, object) in textures.scene.objects.iter().enumerate() {
        let mut mesh = Mesh::default();
        for chart in
            map.charts.iter().filter(|c| map.elements[c.first_element as usize].object == number as u32)
        {
            add_grid(&mut mesh, &mut sides, chart, map.elements[chart.first_element as usize].normal);
        }
        scene.objects.push(Object {
            parts: vec![Part { mesh: scene.meshes.len(), material: object.parts[0].material }],
            world_from_object: glam::Affine3A::IDENTITY,
            ..object.clone()
        });
        scene.meshes.push(Arc::new(mesh));
    }
    let world = World::new(&scene);
    anyhow::ensure!(sides.len() == 2 * world.geometry.len(), "a triangle was dropped");
    let map = SurfaceMap { sides, trees: map.charts.iter().map(|_| None).collect(), ..map.clone() };
    let settings = RadiositySettings {
        gather_rays: 1,
        shadow_rays: 1,
        max_sweeps: 1000,
        ..*textures.radiosity.settings()
    };
    let transport = Arc::new(Transport::new(&world, map, 1, 1, &Progress::silent())?);
    let mut radiosity = RadiositySolution::light(&world, transport, &settings, &Progress::silent())?;
    radiosity.direct.clone_from(&textures.radiosity.direct);
    radiosity.indirect.clone_from(&textures.radiosity.indirect);
    Ok(LightTransportSolution {
        scene: Arc::new(scene),
        world: Arc::new(world),
        radiosity: Arc::new(radiosity),
        ..textures.clone()
    })
}

/// The cells of a grid as two triangles each, and where their corners' light is.
fn add_grid(mesh: &mut Mesh, sides: &mut Vec<SideMap>, chart: &Chart, normal: Vec3) {
    let first = mesh.positions.len() as u32;
    for node in 0..chart.nx * chart.ny {
        let (x, y) = ((node % chart.nx) as f32, (node / chart.nx) as f32);
        mesh.positions.push(chart.origin + chart.step_u * x + chart.step_v * y);
        mesh.normals.push(normal);
        mesh.uvs.push(glam::Vec2::ZERO);
    }
    let facing = chart.step_u.cross(chart.step_v).dot(normal) > 0.0;
    for cell in 0..(chart.nx - 1) * (chart.ny - 1) {
        let at = UVec2::new(cell % (chart.nx - 1), cell / (chart.nx - 1));
        let node = |dx: u32, dy: u32| (at.y + dy) * chart.nx + at.x + dx;
        for [a, b, c] in [[node(0, 0), node(1, 0), node(1, 1)], [node(0, 0), node(1, 1), node(0, 1)]] {
            let triangle = if facing { [a, b, c] } else { [a, c, b] };
            mesh.triangles.push(triangle.map(|n| first + n));
            sides.extend([SideMap::vertices(triangle.map(|n| chart.first_element + n)), SideMap::NONE]);
        }
    }
}

/// A solution on the device, and what its frames took: visibility, shading and all, ms.
struct Drawing {
    renderer: GpuRenderer,
    camera: Camera,
    bytes: u64,
    spent: Vec<[f64; 3]>,
}

impl Drawing {
    fn new(context: &GpuContext, solution: &LightTransportSolution) -> anyhow::Result<Self> {
        let (device, queue) = (&context.device, &context.queue);
        let mut renderer = GpuRenderer::new(device, wgpu::TextureFormat::Rgba8Unorm)?;
        renderer.upload(device, queue, solution)?;
        renderer.set_clock(StageClock::new(device, queue));
        let bytes = renderer.shown_bytes();
        Ok(Self { renderer, camera: solution.scene.camera, bytes, spent: Vec::new() })
    }

    fn draw(&mut self, context: &GpuContext) -> anyhow::Result<[f64; 3]> {
        let (device, queue) = (&context.device, &context.queue);
        let settings = FrameSettings {
            camera: self.camera,
            size: SIZE,
            direct: DirectQuality::Elements,
            ..FrameSettings::default()
        };
        let start = Instant::now();
        let mut encoder = device.create_command_encoder(&Default::default());
        self.renderer.render(device, queue, &mut encoder, &settings);
        queue.submit([encoder.finish()]);
        device.poll(wgpu::PollType::wait_indefinitely()).context("the device was lost")?;
        let frame = 1e3 * start.elapsed().as_secs_f64();
        let stages = self.renderer.clock().map(|c| c.read(device, queue)).transpose()?.unwrap_or_default();
        Ok([stages[Stage::Visibility as usize], stages[Stage::Shading as usize], frame])
    }

    fn medians(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let mut values: Vec<f64> = self.spent.iter().map(|s| s[k]).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        })
    }
}
