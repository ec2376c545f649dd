//! Scenes built in code that several test files share.

use glam::{Affine3A, Vec2, Vec3};
use lumenscope_core::{
    glossy::environment::{Environments, depth_of},
    irradiance_volume::{IrradianceVolume, VolumeSettings},
    math::progress::Progress,
    radiosity::{RadiositySettings, RadiositySolution},
    scene::{
        MeasuringPlane, Object, Part, Scene, Target,
        camera::Camera,
        lamp::{Lamp, LampKind},
        material::Material,
        mesh::Mesh,
        world::World,
    },
    transport::LightTransportSolution,
};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

pub mod command_line;
pub mod golden;

/// A rectangle with its front towards `edge_u × edge_v`.
pub fn rectangle(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> Mesh {
    Mesh::quad([corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v])
}

/// Several meshes as one.
pub fn merged(meshes: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for mesh in meshes {
        let first = all.positions.len() as u32;
        all.positions.extend_from_slice(&mesh.positions);
        all.normals.extend_from_slice(&mesh.normals);
        all.uvs.extend_from_slice(&mesh.uvs);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    all
}

/// An axis-aligned box, its fronts inside or outside: −x, +x, −y, +y, −z, +z, two triangles each.
pub fn cuboid(low: Vec3, high: Vec3, inward: bool) -> Mesh {
    let size = high - low;
    let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
    let face = |corner, u, v| if inward { rectangle(corner, u, v) } else { rectangle(corner, v, u) };
    merged(&[
        face(low, y, z),
        face(low + x, z, y),
        face(low, z, x),
        face(low + y, x, z),
        face(low, x, y),
        face(low + z, y, x),
    ])
}

/// A diffuse material, single-sided.
pub fn diffuse(name: &str, reflectance: Vec3, emission: Vec3) -> Material {
    Material { name: name.into(), reflectance, emission, ..Material::default() }
}

/// Adds an object of one mesh and one material; returns its index.
pub fn add(scene: &mut Scene, name: &str, mesh: Mesh, material: Material) -> usize {
    scene.meshes.push(Arc::new(mesh));
    scene.materials.push(material);
    scene.objects.push(Object {
        name: name.into(),
        parts: vec![Part { mesh: scene.meshes.len() - 1, material: scene.materials.len() - 1 }],
        world_from_object: Affine3A::IDENTITY,
        movable: false,
        dimmer: 1.0,
    });
    scene.objects.len() - 1
}

/// Adds a point lamp; returns its index.
pub fn add_point_lamp(scene: &mut Scene, position: Vec3, intensity: Vec3) -> usize {
    scene.lamps.push(Lamp {
        name: format!("lamp {}", scene.lamps.len()),
        kind: LampKind::Point { intensity },
        world_from_lamp: Affine3A::from_translation(position),
        dimmer: 1.0,
    });
    scene.lamps.len() - 1
}

/// A closed box of 2 m around the origin, grey, every wall emitting the same: a furnace. Radiance is
/// `emission / (1 − reflectance)` everywhere in it.
pub fn box_room(reflectance: f32, emission: f32) -> Scene {
    let mut scene = Scene { name: "box room".into(), ..Scene::default() };
    let material = diffuse("wall", Vec3::splat(reflectance), Vec3::splat(emission));
    add(&mut scene, "room", cuboid(Vec3::splat(-1.0), Vec3::ONE, true), material);
    scene.camera =
        Camera { eye: Vec3::new(0.3, 0.2, 0.7), target: Vec3::new(-0.2, -0.4, -1.0), ..Camera::default() };
    scene
}

/// A box like Cornell's: 2 m wide, floor at y = 0, open towards +z, red on the left, green on the right,
/// a panel of 0.6 m × 0.5 m under the ceiling that emits downwards 100 cd/m², a tall block standing
/// still and a short one that may move (object 5, "short block").
pub fn cornell() -> Scene {
    let mut scene = Scene { name: "cornell".into(), ..Scene::default() };
    let white = Vec3::new(0.73, 0.72, 0.68);
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let low = Vec3::new(-1.0, 0.0, -1.0);
    let shell = [rectangle(low, z, x), rectangle(low + y, x, z), rectangle(low, x, y)];
    add(&mut scene, "shell", merged(&shell), diffuse("white", white, Vec3::ZERO));
    let red = diffuse("red", Vec3::new(0.61, 0.06, 0.06), Vec3::ZERO);
    add(&mut scene, "left wall", rectangle(low, y, z), red);
    let green = diffuse("green", Vec3::new(0.12, 0.43, 0.12), Vec3::ZERO);
    add(&mut scene, "right wall", rectangle(low + x, z, y), green);
    let panel = rectangle(Vec3::new(-0.3, 1.98, -0.25), Vec3::X * 0.6, Vec3::Z * 0.5);
    add(&mut scene, "panel", panel, diffuse("panel", Vec3::ZERO, Vec3::new(100.0, 90.0, 70.0)));
    let block =
        |half: f32, height: f32| cuboid(Vec3::new(-half, 0.001, -half), Vec3::new(half, height, half), false);
    let tall = add(&mut scene, "tall block", block(0.3, 1.2), diffuse("tall", white, Vec3::ZERO));
    scene.objects[tall].world_from_object =
        Affine3A::from_translation(Vec3::new(-0.35, 0.0, -0.35)) * Affine3A::from_rotation_y(0.3);
    let short = add(&mut scene, "short block", block(0.3, 0.6), diffuse("short", white, Vec3::ZERO));
    scene.objects[short].world_from_object =
        Affine3A::from_translation(Vec3::new(0.4, 0.0, 0.35)) * Affine3A::from_rotation_y(-0.3);
    scene.objects[short].movable = true;
    scene.camera = Camera {
        eye: Vec3::new(0.0, 1.0, 4.6),
        target: Vec3::new(0.0, 1.0, 0.0),
        up: Vec3::Y,
        vertical_fov: 40f32.to_radians(),
    };
    scene.planes.push(MeasuringPlane {
        name: "floor".into(),
        corner: Vec3::new(-1.0, 0.01, -1.0),
        edge_u: z,
        edge_v: x,
    });
    scene
}

/// The light of a scene, solved coarsely: elements `spacing_m` apart, a volume of 4³ samples of 50 bins.
///
/// # Panics
/// If the scene has no solution.
pub fn solved(scene: Scene, spacing_m: f32) -> LightTransportSolution {
    let world = World::new(&scene);
    let settings = RadiositySettings {
        element_spacing_m: Some(spacing_m),
        gather_rays: 64,
        ..RadiositySettings::default()
    };
    let radiosity =
        RadiositySolution::solve(&world, &settings, &Progress::silent()).expect("the scene has a solution");
    let settings = VolumeSettings { samples: Some([4; 3]), bins_n: 5, ..VolumeSettings::default() };
    let volume = IrradianceVolume::build(&world, &radiosity, &settings, &Progress::silent())
        .expect("the scene has a volume");
    LightTransportSolution {
        environments: Arc::new(Environments::new(&world, &radiosity, depth_of(&scene.plan))),
        scene: Arc::new(scene),
        mirror_images: None,
        particles: None,
        world: Arc::new(world),
        radiosity: Arc::new(radiosity),
        volume: Some(Arc::new(volume)),
        moved_objects: Vec::new(),
        dynamic_objects: Default::default(),
        guests: Default::default(),
        detail: Default::default(),
        gloss: None,
        provenance: Default::default(),
    }
}

/// The same light with the short block moved and no new transport solved; and the block's number.
///
/// # Panics
/// If there is no short block.
pub fn with_moved_block(solution: &LightTransportSolution, by: Vec3) -> (LightTransportSolution, u32) {
    let mut scene = (*solution.scene).clone();
    let block = scene.objects.iter().position(|o| o.name == "short block").expect("a short block");
    let placement = Affine3A::from_translation(by) * scene.objects[block].world_from_object;
    scene.place(Target::Object(block), placement);
    let mut world = (*solution.world).clone();
    world.follow(&scene);
    let moved = LightTransportSolution {
        scene: Arc::new(scene),
        world: Arc::new(world),
        moved_objects: vec![block as u32],
        ..solution.clone()
    };
    (moved, block as u32)
}

/// A binary glTF file of its two chunks.
pub fn glb(json: &serde_json::Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let total = 12 + 8 + text.len() + 8 + binary.len();
    out.extend([2u32, total as u32, text.len() as u32].iter().flat_map(|v| v.to_le_bytes()));
    out.extend(b"JSON");
    out.extend(&text);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

/// A ball of so many rows and columns with the normals of a sphere.
pub fn ball(centre: Vec3, radius: f32, [rows, columns]: [u32; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let (theta, phi) = (row as f32 / rows as f32 * PI, column as f32 / columns as f32 * TAU);
            let normal = Vec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin());
            mesh.positions.push(centre + radius * normal);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::ZERO);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, c) = (a + columns + 1, a + columns + 2);
            mesh.triangles.extend([[a, b, c], [a, c, a + 1]].into_iter().filter(|t| {
                let [p, q, r] = t.map(|i| mesh.positions[i as usize]);
                (q - p).cross(r - p).length() > 1e-9
            }));
        }
    }
    mesh
}
