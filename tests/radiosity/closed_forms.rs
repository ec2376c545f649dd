//! Furnaces, spheres and a lamp whose light is known in closed form.

use super::{settings, solve, solved, total};
use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::part::Part,
    radiosity::RadiositySettings,
    scene::{
        Scene,
        direct::{Receiver, polygon_irradiance, total_irradiance},
        mesh::Mesh,
        world::World,
    },
};
use lumenscope_tests::{add, add_point_lamp, box_room, cuboid, diffuse, rectangle};
use std::f32::consts::PI;

/// A unit sphere seen from inside: an icosahedron split `levels` times, with smooth normals.
fn sphere_inwards(levels: u32) -> Mesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut mesh = Mesh::default();
    let corner = |mesh: &mut Mesh, p: Vec3| {
        mesh.positions.push(p.normalize());
        mesh.normals.push(-p.normalize());
        mesh.uvs.push(Vec2::ZERO);
        mesh.positions.len() as u32 - 1
    };
    let points = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    for p in points {
        corner(&mut mesh, Vec3::from(p));
    }
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..levels {
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let at = |mesh: &Mesh, i: u32| mesh.positions[i as usize];
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[i, j]| {
                let middle = at(&mesh, i) + at(&mesh, j);
                corner(&mut mesh, middle)
            });
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
    }
    mesh.triangles = faces.into_iter().map(|[a, b, c]| [a, c, b]).collect();
    mesh
}

#[test]
fn furnace_boxes_reach_e_over_one_minus_rho() {
    // Every wall emits L, so each point receives πL directly and πL / (1 − ρ) in all. 1 %: sweeps
    // stop at an error bound of 0.1 %, direct light is a closed form, and no ray escapes.
    let emission = Vec3::new(1.0, 2.0, 0.5);
    for rho in [0.5, 0.9, 0.99, 0.999] {
        let mut scene = Scene::default();
        let walls = cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 1.5), true);
        add(&mut scene, "furnace", walls, diffuse("wall", Vec3::splat(rho), emission));
        let (_, solution) = solve(&scene, &settings(0.25));
        let sweeps = solution.convergence().sweeps;
        let expected = emission * (PI / (1.0 - rho));
        let off = |i: usize| ((total(&solution, i) - expected) / expected).abs().max_element();
        let worst = solved(&solution).map(off).fold(0.0, f32::max);
        println!("ρ {rho}: {sweeps} sweeps, {:.3} % off at worst", 100.0 * worst);
        assert!(sweeps <= 20 && worst < 0.01, "ρ {rho}: {worst} after {sweeps} sweeps");
    }
}

#[test]
fn closed_sphere_with_a_lamp_at_its_centre_shows_radiance_one() {
    // E_d = I/r² = π, E = E_d / (1 − ρ), L = ρE/π = 1 at ρ = 0.5. 1 %: facets of 0.15 m on a unit
    // sphere stand up to 0.4 % inside it, and 1/r² doubles that.
    let mut scene = Scene::default();
    add(&mut scene, "sphere", sphere_inwards(3), diffuse("wall", Vec3::splat(0.5), Vec3::ZERO));
    add_point_lamp(&mut scene, Vec3::ZERO, Vec3::splat(PI));
    let (world, solution) = solve(&scene, &RadiositySettings::default());
    for i in solved(&solution) {
        let radiance = solution.radiosity()[i] / PI;
        assert!((radiance - 1.0).abs().max_element() < 0.01, "element {i}: {radiance}");
    }
    for t in (0..world.geometry.len() as u32).step_by(7) {
        let inwards = world.geometry.surface(t, Vec2::new(0.2, 0.3), -world.geometry.area_normal(t));
        let radiance = solution.radiance(&world, &inwards, Part::All);
        assert!((radiance - 1.0).abs().max_element() < 0.01, "triangle {t}: {radiance}");
        let outside = world.geometry.surface(t, Vec2::new(0.2, 0.3), world.geometry.area_normal(t));
        assert_eq!(solution.radiance(&world, &outside, Part::All), Vec3::ZERO, "the back is black");
    }
}

#[test]
fn indirect_light_in_a_sphere_is_uniform_wherever_the_lamps_are() {
    // Every point of a sphere sees every other with the same form factor, so the indirect irradiance
    // is ρ/(1 − ρ) Φ/4πr² = π everywhere. 1 % on the mean: facets of 0.15 m have 0.5 % less area than
    // the sphere. 4 % an
    // element: the direct light varies fourfold over the wall and 1024 rays sample it.
    let mut scene = Scene::default();
    add(&mut scene, "sphere", sphere_inwards(3), diffuse("wall", Vec3::splat(0.5), Vec3::ZERO));
    for p in [[0.3, 0.3, 0.3], [-0.3, -0.3, 0.3], [-0.3, 0.3, -0.3], [0.3, -0.3, -0.3]] {
        add_point_lamp(&mut scene, Vec3::from(p), Vec3::splat(PI / 4.0));
    }
    let (_, solution) =
        solve(&scene, &RadiositySettings { gather_rays: 1024, ..RadiositySettings::default() });
    let (mut sum, mut area) = (0.0, 0.0);
    for i in solved(&solution) {
        let e = solution.indirect[i].x / PI;
        assert!((e - 1.0).abs() < 0.04, "element {i}: {e}");
        sum += e * solution.elements()[i].area;
        area += solution.elements()[i].area;
    }
    assert!((sum / area - 1.0).abs() < 0.01, "mean {}", sum / area);
}

#[test]
fn emissive_sphere_reflects_what_it_emits() {
    // E_d = πL; at ρ = 0.5 the reflected radiance ρE/π = L ρ/(1 − ρ) = L. The integrand over the
    // sphere is constant, so sampling many triangles adds nothing but the facets' error: 1 %.
    let mut scene = Scene::default();
    add(&mut scene, "sphere", sphere_inwards(3), diffuse("wall", Vec3::splat(0.5), Vec3::ONE));
    let (_, solution) = solve(&scene, &RadiositySettings::default());
    let areas = solution.elements().iter().map(|e| e.area);
    let mean = solution.radiosity().iter().zip(areas.clone()).map(|(b, a)| b.x / PI * a).sum::<f32>();
    assert!((mean / areas.sum::<f32>() - 1.0).abs() < 0.01, "{mean}");
    // A point sampled on the next facet, close by, can weigh too much or too little.
    let near = |b: &&Vec3| (b.x / PI - 1.0).abs() < 0.05;
    let within = solution.radiosity().iter().filter(near).count();
    assert!(within * 100 > solution.radiosity().len() * 95, "{within} of {}", solution.radiosity().len());
}

#[test]
fn a_block_changes_nothing_in_a_furnace() {
    // Everything emits 0.5 and reflects half: E = π wherever one looks, half of it direct. Walls light each
    // other from close by and the block hides parts of them, the worst case for the visible share of an
    // emitter: with 8 rays at each of 8 points it errs by under 2 %.
    let mut scene = Scene::default();
    let wall = diffuse("wall", Vec3::splat(0.5), Vec3::splat(0.5));
    add(&mut scene, "room", cuboid(Vec3::ZERO, Vec3::new(2.0, 2.4, 3.0), true), wall.clone());
    add(&mut scene, "block", cuboid(Vec3::new(0.5, 0.7, 0.5), Vec3::new(0.9, 1.3, 0.9), false), wall);
    let (_, solution) = solve(&scene, &RadiositySettings { shadow_rays: 64, ..settings(0.1) });
    let area = solution.elements().iter().map(|e| e.area).sum::<f32>();
    let mean = |values: &[Vec3]| {
        solution.elements().iter().zip(values).map(|(e, v)| e.area * v.x).sum::<f32>() / area / PI
    };
    let (direct, indirect) = (mean(&solution.direct), mean(&solution.indirect));
    println!("direct {direct}, indirect {indirect} of 0.5");
    assert!((direct / 0.5 - 1.0).abs() < 0.02 && (indirect / 0.5 - 1.0).abs() < 0.02, "{direct}, {indirect}");
}

/// Irradiance under the corner of a parallel rectangle of unit radiance, `a` × `b` at distance 1:
/// ½ (a/√(1+a²) atan(b/√(1+a²)) + b/√(1+b²) atan(a/√(1+b²))) (Howell C-1 times π).
fn corner_irradiance(a: f32, b: f32) -> f32 {
    let half = |a: f32, b: f32| {
        let r = (1.0 + a * a).sqrt();
        a / r * (b / r).atan()
    };
    0.5 * (half(a, b) + half(b, a))
}

#[test]
fn rectangular_lamp_gives_the_closed_form() {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    add(&mut scene, "floor", floor, diffuse("floor", Vec3::splat(0.5), Vec3::ZERO));
    let panel = rectangle(Vec3::new(-0.3, 1.0, -0.2), Vec3::X * 0.6, Vec3::Z * 0.4);
    add(&mut scene, "panel", panel, diffuse("panel", Vec3::ZERO, Vec3::splat(500.0)));
    let (world, solution) = solve(&scene, &settings(0.02));
    // 0.5 %: the mean over an element's footprint and bilinear interpolation, h²/6 + h²/8 times a relative
    // curvature below 8 a m² for h = 0.02 m.
    for (u, v) in [(0.1, 0.2), (0.3, 0.3), (0.5, 0.25), (0.6, 0.1), (0.25, 0.6)] {
        let surface = world.geometry.surface(0, Vec2::new(u, v), Vec3::NEG_Y);
        let (x, z) = (surface.position.x, surface.position.z);
        let signed = |x: f32, z: f32| x.signum() * z.signum() * corner_irradiance(x.abs(), z.abs());
        let expected = 500.0
            * (signed(0.3 - x, 0.2 - z) - signed(-0.3 - x, 0.2 - z) - signed(0.3 - x, -0.2 - z)
                + signed(-0.3 - x, -0.2 - z));
        let elements = solution.irradiance(0, Vec2::new(u, v), false, Part::Direct).x;
        assert!((elements / expected - 1.0).abs() < 0.005, "{elements} for {expected} at ({x}, {z})");
        let exact = solution.irradiance_exact_direct(&world, &surface, Part::Direct, 16, 1).x;
        assert!((exact / expected - 1.0).abs() < 1e-3, "{exact} for {expected} at ({x}, {z})");
    }
}

#[test]
fn a_point_on_what_faces_away_says_nothing_of_the_rest() {
    // Half of the walls lie behind a receiver: one ray must find those before it, whose light is 10 π.
    let world = World::new(&box_room(0.5, 10.0));
    let receiver = Receiver::new(Vec3::new(0.2, -0.3, 0.1), Vec3::new(2.0, 3.0, 6.0) / 7.0);
    for scramble in 0..1000 {
        let found = total_irradiance(&world, &receiver, 1, scramble).x;
        // Single precision.
        assert!((found / (10.0 * PI) - 1.0).abs() < 1e-4, "{found} lx of scramble {scramble}");
    }
}

#[test]
fn of_a_lamp_almost_below_the_horizon_the_rest_is_found() {
    // A square of 10 m faces a receiver 1 m before it that sees no more than its last 10 cm over the horizon.
    let mut scene = Scene::default();
    let panel = rectangle(Vec3::new(-5.0, -5.0, 0.0), Vec3::X * 10.0, Vec3::Y * 10.0);
    add(&mut scene, "panel", panel, diffuse("panel", Vec3::ZERO, Vec3::splat(10.0)));
    let world = World::new(&scene);
    let receiver = Receiver::new(Vec3::Z, Vec3::new(1.0, 0.0, 4.9).normalize());
    let corners = &world.geometry.positions;
    let exact = 10.0 * corners.iter().map(|c| polygon_irradiance(Vec3::Z, receiver.normal, c)).sum::<f64>();
    for scramble in 0..200 {
        let found = total_irradiance(&world, &receiver, 1, scramble).x;
        // Single precision.
        assert!(
            (f64::from(found) / exact - 1.0).abs() < 1e-4,
            "{found} lx for {exact} of scramble {scramble}"
        );
    }
}
