//! What the views of radiosity say, against closed forms.

use glam::Vec3;
use lumenscope_core::{
    math::progress::Progress,
    radiosity::{
        RadiositySettings, RadiositySolution, inspect_elements, inspect_light, shared_edges::shared_edges,
    },
    scene::{Object, Scene, world::World},
};
use lumenscope_tests::{add, add_point_lamp, box_room, cuboid, diffuse, rectangle};

fn solve(world: &World, spacing: f32) -> RadiositySolution {
    let settings = RadiositySettings { element_spacing_m: Some(spacing), ..RadiositySettings::default() };
    RadiositySolution::solve(world, &settings, &Progress::silent()).expect("solves")
}

/// A floor of 4 m under a point lamp of 100 cd at a height of 1 m, of one material or of two side by side.
fn floor(parts: usize) -> Scene {
    let mut scene = Scene::default();
    for i in 0..parts {
        let width = 4.0 / parts as f32;
        let corner = Vec3::new(-2.0 + width * i as f32, 0.0, -2.0);
        let name = format!("floor {i}");
        let part = rectangle(corner, Vec3::Z * 4.0, Vec3::X * width);
        add(&mut scene, &name, part, diffuse(&name, Vec3::splat(0.5), Vec3::ZERO));
    }
    let others: Vec<_> = scene.objects.drain(1..).flat_map(|o| o.parts).collect();
    scene.objects[0].parts.extend(others);
    add_point_lamp(&mut scene, Vec3::new(0.0, 1.0, 0.0), Vec3::splat(100.0));
    scene
}

#[test]
fn the_gradient_is_that_of_the_closed_form() {
    let world = World::new(&floor(1));
    let mut solution = solve(&world, 0.1);
    // Elements hold the mean over their area from a few points; here the light at the node itself.
    let places: Vec<Vec3> = solution.elements().iter().map(|e| e.position).collect();
    for (direct, p) in solution.direct.iter_mut().zip(places) {
        *direct = Vec3::splat(100.0 / (1.0 + p.x * p.x + p.z * p.z).powf(1.5));
    }
    let shown = inspect_light::gradient(&solution, &world);
    assert_eq!(shown.legend.expect("a legend").unit, "lx/m");
    let mut judged = 0;
    for (position, value) in shown.meshes[0].positions.iter().zip(&shown.meshes[0].values) {
        let r = position.x.hypot(position.z);
        if r > 1.6 || position.x.abs().max(position.z.abs()) > 1.7 {
            continue;
        }
        // |dE/dr| of E = I / (1 + r²)^{3/2}.
        let exact = 300.0 * r / (1.0 + r * r).powf(2.5);
        judged += 1;
        // Central differences over 0.2 m are off by h²/6 of the third derivative, 2.5 lx/m where that is largest.
        assert!((value.x - exact).abs() < 2.5, "{} lx/m, not {exact}, at {position}", value.x);
    }
    assert!(judged > 300, "{judged} nodes");
}

#[test]
fn radiosity_is_reflectance_times_irradiance() {
    let world = World::new(&floor(1));
    let solution = solve(&world, 0.2);
    let shown = inspect_light::radiosity(&solution, &world);
    for (i, value) in shown.meshes[0].values.iter().take(solution.elements().len()).enumerate() {
        let wanted = 0.5 * (solution.direct[i] + solution.indirect[i]);
        assert!((*value - wanted).abs().max_element() <= 1e-5 * wanted.max_element(), "{value} {wanted}");
    }
}

#[test]
fn the_light_goes_on_across_the_edge_of_two_charts_and_a_lamps_own_edge_is_none() {
    let world = World::new(&floor(2));
    let solution = solve(&world, 0.1);
    let shown = inspect_light::seams(&solution, &world);
    // The two halves share one edge 4 m long, made of one side of a rectangle each.
    assert_eq!(shown.value_lines.len(), 1, "{:?}", shown.notes);
    // Nodes lie a fifth of the spacing inside the edge: what that moves the light by, E'/E 0.02 m at most 2.4 %.
    assert!(shown.value_lines[0].value < 4.0, "{} %", shown.value_lines[0].value);
    // One surface has none.
    let whole = World::new(&floor(1));
    assert!(inspect_light::seams(&solve(&whole, 0.2), &whole).value_lines.is_empty());
    assert_eq!(shared_edges(&whole.geometry).len(), 1, "the diagonal");
    // Nor has an edge beneath what stands there, or between things that touch.
    let mut covered = floor(2);
    let slab = cuboid(Vec3::new(-0.5, 0.001, -2.2), Vec3::new(0.5, 0.3, 2.2), false);
    add(&mut covered, "slab", slab, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    let mut apart = floor(2);
    let part = apart.objects[0].parts.pop().unwrap();
    let other = Object { parts: vec![part], ..apart.objects[0].clone() };
    apart.objects.push(other);
    for scene in [covered, apart] {
        let world = World::new(&scene);
        let shown = inspect_light::seams(&solve(&world, 0.1), &world);
        assert!(shown.value_lines.is_empty(), "{:?}", shown.notes);
    }
}

#[test]
fn chequers_cover_every_surface_once() {
    let world = World::new(&box_room(0.5, 0.5));
    let solution = solve(&world, 0.1);
    let shown = inspect_elements::elements(&solution, &world);
    let area: f32 = shown
        .meshes
        .iter()
        .flat_map(|m| m.triangles.iter().map(|t| t.map(|i| m.positions[i as usize])))
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
        .sum();
    let lit = |t: u32| {
        let sides = [2 * t as usize, 2 * t as usize + 1].map(|s| solution.sides()[s]);
        sides.into_iter().filter(|s| *s != lumenscope_core::radiosity::lookup::SideMap::NONE).count() as f32
    };
    let wanted: f32 =
        (0..world.geometry.len() as u32).map(|t| lit(t) * 0.5 * world.geometry.area_normal(t).length()).sum();
    // Single precision sums.
    assert!((area / wanted - 1.0).abs() < 1e-3, "{area} m² of {wanted} m²");
}
