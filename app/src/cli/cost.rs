//! `cost`: what an object lit from the volume costs a frame while it moves, as Greger's Fig. 5.8 counts it.

use super::{Common, parse_size, solve};
use anyhow::Context;
use clap::{Args, ValueEnum};
use glam::{Affine3A, Vec2, Vec3};
use lumenscope_core::{
    irradiance_volume::dynamic_object::{Detail, DynamicObject},
    scene::{Object, Part, Scene, Target, import, material::Material, mesh::Mesh, world::World},
    superposition::{
        composite::DirectQuality,
        moved::MovedLight,
        pass::{PassSettings, render, render_lit},
    },
    transport::LightTransportSolution,
};
use std::{
    f32::consts::{PI, TAU},
    fmt::Write as _,
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant},
};

/// Options of `cost`.
#[derive(Args)]
pub struct Options {
    /// Scene file; the light is solved without the object.
    scene: PathBuf,
    /// Models that move, one row each; without any, balls of the polygon counts of Fig. 5.8.
    #[arg(long)]
    model: Vec<PathBuf>,
    /// Frames of a run across the room.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// How finely the object asks the volume.
    #[arg(long, value_enum, default_value_t = DetailOption::Vertices)]
    detail: DetailOption,
    /// Picture size.
    #[arg(long, default_value = "320x180", value_parser = parse_size)]
    size: [u32; 2],
    /// CSV to write.
    #[arg(long)]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum DetailOption {
    /// At a few of the vertices.
    Coarse,
    /// At every vertex, as in the thesis.
    Vertices,
    /// At every node, inside large triangles too.
    Fine,
    /// At every pixel.
    Pixels,
}

impl From<DetailOption> for Detail {
    fn from(option: DetailOption) -> Self {
        match option {
            DetailOption::Coarse => Self::Coarse,
            DetailOption::Vertices => Self::Vertices,
            DetailOption::Fine => Self::Fine,
            DetailOption::Pixels => Self::Pixels,
        }
    }
}

/// Polygons of the thesis's rabbits.
const RABBITS: [u32; 5] = [1162, 1921, 3145, 4639, 6598];
/// Size of a moving object, as a share of the scene's diagonal.
const SIZE: f32 = 0.06;

/// Moves each object across the room and prints the table.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let loaded = solve::load(&options.scene, common)?;
    let solution = solve::solve(&loaded, true)?;
    solution.volume.as_ref().context("the plan built no volume")?;
    let mut table = String::from(
        "object,polygons,total_polygons,queries,seconds,model_percent,object_percent,query_percent,\
         follow_percent,frames_per_second,occlusion_seconds\n",
    );
    println!(
        "{} frames of {}x{} on {} threads",
        options.frames,
        options.size[0],
        options.size[1],
        rayon::current_num_threads()
    );
    println!(
        "{:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>7}",
        "object",
        "polygons",
        "total",
        "queries",
        "seconds",
        "model %",
        "object %",
        "query %",
        "follow %",
        "fps"
    );
    for (name, scene) in objects(options, &loaded.scene)? {
        let cost = measure(&solution, scene, options)?;
        let total = cost.frame.as_secs_f64() + cost.query.as_secs_f64() + cost.follow.as_secs_f64();
        let share = |d: Duration| 100.0 * d.as_secs_f64() / total;
        let object = cost.frame.saturating_sub(cost.model);
        let shares =
            [share(cost.model.min(cost.frame)), share(object), share(cost.query), share(cost.follow)];
        let fps = f64::from(options.frames) / total;
        println!(
            "{name:<22}{:>9}{:>9}{:>9}{total:>9.2}{:>9.1}{:>9.1}{:>9.1}{:>9.1}{fps:>7.1}",
            cost.polygons, cost.total, cost.queries, shares[0], shares[1], shares[2], shares[3]
        );
        let _ = writeln!(
            table,
            "{name},{},{},{},{total},{},{},{},{},{fps},{}",
            cost.polygons,
            cost.total,
            cost.queries,
            shares[0],
            shares[1],
            shares[2],
            shares[3],
            cost.occlusion.as_secs_f64()
        );
    }
    if let Some(out) = &options.out {
        solve::write(out, &table)?;
    }
    Ok(())
}

/// The scene with each object added last.
fn objects(options: &Options, scene: &Scene) -> anyhow::Result<Vec<(String, Scene)>> {
    let mut found = Vec::new();
    for path in &options.model {
        let mut with = scene.clone();
        let added = import::add_model(&mut with, path)?;
        // All of a model moves as one.
        let parts = with.objects.drain(added).flat_map(|o| o.parts).collect();
        with.objects.push(object(parts));
        let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        found.push((name, with));
    }
    if options.model.is_empty() {
        for polygons in RABBITS {
            let mut with = scene.clone();
            with.meshes.push(Arc::new(ball(polygons)));
            with.materials.push(Material {
                name: "ball".into(),
                reflectance: Vec3::splat(0.6),
                ..Material::default()
            });
            let part = Part { mesh: with.meshes.len() - 1, material: with.materials.len() - 1 };
            with.objects.push(object(vec![part]));
            found.push((format!("ball of {polygons}"), with));
        }
    }
    Ok(found)
}

fn object(parts: Vec<Part>) -> Object {
    Object { name: "object".into(), parts, world_from_object: Affine3A::IDENTITY, movable: true, dimmer: 1.0 }
}

/// A ball of about so many triangles, vertices shared.
fn ball(polygons: u32) -> Mesh {
    let up = ((polygons as f32 / 4.0).sqrt().round() as u32).max(2);
    let around = (polygons / (2 * (up - 1))).max(3);
    let mut mesh = Mesh::default();
    for j in 0..=up {
        for i in 0..=around {
            let (theta, phi) = (PI * j as f32 / up as f32, TAU * i as f32 / around as f32);
            let p = Vec3::new(theta.sin() * phi.cos(), -theta.cos(), theta.sin() * phi.sin());
            mesh.positions.push(p);
            mesh.normals.push(p);
            mesh.uvs.push(Vec2::ZERO);
        }
    }
    let row = around + 1;
    for j in 0..up {
        for i in 0..around {
            let [a, b, c, d] = [j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i];
            if j > 0 {
                mesh.triangles.push([a, c, b]);
            }
            if j + 1 < up {
                mesh.triangles.push([a, d, c]);
            }
        }
    }
    mesh
}

struct Cost {
    polygons: usize,
    total: usize,
    /// Queries of the volume in each frame, counted as they are made: every node, both parts, both sides where both are lit.
    queries: usize,
    model: Duration,
    frame: Duration,
    query: Duration,
    follow: Duration,
    occlusion: Duration,
}

fn measure(solved: &LightTransportSolution, mut scene: Scene, options: &Options) -> anyhow::Result<Cost> {
    let object = scene.objects.len() - 1;
    let mut world = World::new(&scene);
    let range = world.geometry.object_triangles[object].clone();
    let corners = || world.geometry.positions[range.start as usize..range.end as usize].iter().flatten();
    let (low, high) =
        corners().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (room_low, room_high) = solved.world.geometry.bounds();
    let scale = SIZE * (room_high - room_low).length() / (high - low).length();
    let place = |share: f32| {
        // Along the room's longer side at half its height, off the middle.
        let size = room_high - room_low;
        let along = if size.x >= size.z { Vec3::X * size.x } else { Vec3::Z * size.z };
        let at = room_low + 0.5 * size + along * (0.7 * (share - 0.5));
        Affine3A::from_translation(at)
            * Affine3A::from_scale(Vec3::splat(scale))
            * Affine3A::from_translation(-0.5 * (low + high))
    };
    scene.objects[object].world_from_object = place(0.0);
    world.follow(&scene);
    let cell =
        solved.volume.as_ref().map_or(1.0, |v| v.grid().cell_size().min_element() / v.grid().inner() as f32);
    let mut known = DynamicObject::new(&scene, &world.geometry, object, Some(0.5 * cell));
    let start = Instant::now();
    known.occlude(&world, object, 1);
    let occlusion = start.elapsed();
    let detail = Detail::from(options.detail);
    let mut solution = LightTransportSolution {
        scene: Arc::new(scene.clone()),
        world: Arc::new(world.clone()),
        moved_objects: vec![object as u32],
        dynamic_objects: Arc::new([(object as u32, known)].into()),
        detail,
        ..solved.clone()
    };
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let [width, height] = options.size;
    let camera = solved.scene.camera;
    let mut cost = Cost {
        polygons: range.len(),
        total: world.geometry.len(),
        queries: 0,
        model: Duration::ZERO,
        frame: Duration::ZERO,
        query: Duration::ZERO,
        follow: Duration::ZERO,
        occlusion,
    };
    for frame in 0..options.frames {
        let placement = place((frame as f32 + 0.5) / options.frames as f32);
        let start = Instant::now();
        scene.place(Target::Object(object), placement);
        world.follow(&scene);
        cost.follow += start.elapsed();
        solution.world = Arc::new(world.clone());
        let start = Instant::now();
        let light = MovedLight::new(&solution, true);
        cost.query += start.elapsed();
        cost.queries = light.queries;
        anyhow::ensure!(!light.entries.is_empty(), "the object has no triangles");
        let start = Instant::now();
        render_lit(&solution, &light, &camera, width, height, &settings);
        cost.frame += start.elapsed();
        let start = Instant::now();
        render(solved, &camera, width, height, &settings);
        cost.model += start.elapsed();
    }
    Ok(cost)
}
