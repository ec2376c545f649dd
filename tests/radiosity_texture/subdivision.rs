//! Quadtrees in the solver: what they keep, and what they gain over uniform grids.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{colour::luminance, part::Part, progress::Progress, random::Rng},
    radiosity::{
        RadiositySettings, RadiositySolution, inspect_elements, inspect_exchange, subdivide::Subdivision,
        surface_map::UNSOLVED,
    },
    reference::{irradiance::irradiance_with, path::PathTracer},
    scene::{Scene, direct::Receiver, world::World},
};
use lumenscope_tests::{add, add_point_lamp, cuboid, diffuse};
use rayon::prelude::*;
use std::f32::consts::PI;

fn settings(spacing: f32, levels: u8, tolerance: f32) -> RadiositySettings {
    RadiositySettings {
        element_spacing_m: Some(spacing),
        subdivision: (levels > 0).then_some(Subdivision { levels, tolerance, restricted: false }),
        ..RadiositySettings::default()
    }
}

fn solve(world: &World, settings: &RadiositySettings) -> RadiositySolution {
    let solution = RadiositySolution::solve(world, settings, &Progress::silent()).expect("solves");
    let values = solution.direct.iter().chain(&solution.indirect);
    assert!(values.clone().all(|e| e.is_finite() && e.min_element() >= 0.0));
    solution
}

fn solved(solution: &RadiositySolution) -> usize {
    solution.elements().iter().filter(|e| e.flags & UNSOLVED == 0).count()
}

/// A hall with a lamp and a cupboard 10 cm from its wall: open walls, and a gap where light bends.
fn hall() -> Scene {
    let mut scene = Scene::default();
    let wall = diffuse("wall", Vec3::splat(0.6), Vec3::ZERO);
    add(&mut scene, "hall", cuboid(Vec3::ZERO, Vec3::new(5.0, 3.0, 4.0), true), wall.clone());
    let cupboard = cuboid(Vec3::new(2.0, 0.0, 0.1), Vec3::new(3.0, 1.5, 0.6), false);
    add(&mut scene, "cupboard", cupboard, wall);
    add_point_lamp(&mut scene, Vec3::new(1.5, 2.5, 2.5), Vec3::splat(100.0));
    scene
}

#[test]
fn a_furnace_stays_one_on_trees() {
    // Every wall emits L: πL / (1 − ρ) everywhere, at solved nodes and between them. 1 %, as on uniform grids.
    let mut scene = Scene::default();
    let walls = cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 1.5), true);
    add(&mut scene, "furnace", walls, diffuse("wall", Vec3::splat(0.5), Vec3::ONE));
    let solution = solve(&World::new(&scene), &settings(0.5, 2, 1e-3));
    for (d, i) in solution.direct.iter().zip(&solution.indirect) {
        assert!(((*d + *i) / (2.0 * PI) - 1.0).abs().max_element() < 0.01, "{d} {i}");
    }
}

#[test]
fn trees_are_split_where_surfaces_meet_and_their_light_is_continuous() {
    let world = World::new(&hall());
    let solution = solve(&world, &settings(0.4, 2, 0.05));
    let map = &solution.transport().map;
    let mut levels = [0usize; 3];
    for tree in map.trees.iter().flatten() {
        tree.leaves.iter().for_each(|leaf| levels[leaf.level as usize] += 1);
        let cells: u32 = tree.leaves.iter().map(|l| tree.span(l.level).iter().product::<u32>()).sum();
        assert_eq!(cells, (tree.nodes[0] - 1) * (tree.nodes[1] - 1), "leaves cover the grid once");
    }
    println!("leaves by level {levels:?}, {} solved of {}", solved(&solution), map.elements.len());
    assert!(levels.iter().all(|n| *n > 50), "{levels:?}");
    assert!(2 * solved(&solution) < map.elements.len());
    // The area of the hall and the cupboard is divided among the solved elements, none is lost.
    let area: f32 = map.elements.iter().map(|e| e.area).sum();
    let wanted: f32 =
        (0..world.geometry.len() as u32).map(|t| 0.5 * world.geometry.area_normal(t).length()).sum();
    assert!((area / wanted - 1.0).abs() < 1e-4, "{area} m² for {wanted}");
    for e in map.elements.iter().filter(|e| e.flags & UNSOLVED != 0) {
        assert_eq!(e.area, 0.0);
    }
    assert!(
        solution
            .transport()
            .hits
            .iter()
            .all(|&h| { map.elements.get(h as usize).is_none_or(|e| e.flags & UNSOLVED == 0) })
    );
    // 96 rays for the 10 cm × 10 cm of a finest leaf, as many more as the root of the area says, in steps of 8; a leaf
    // that was split since keeps what it has. Nodes at borders stand for less, so walls have less than whole cells.
    for (i, e) in map.elements.iter().enumerate().filter(|(_, e)| e.flags & UNSOLVED == 0) {
        let chart = &map.charts[e.chart as usize];
        let extent = chart.step_u.length() * chart.step_v.length() * ((chart.nx - 1) * (chart.ny - 1)) as f32;
        let nodes = ((chart.nx - 1) / 4 + 1) * ((chart.ny - 1) / 4 + 1);
        let root = 96.0 * (extent / nodes as f32 / 0.01).sqrt();
        let wanted = root / f32::from(1u8 << map.levels[i]);
        let rays = solution.transport().row(i as u32).len() as f32;
        assert!(rays >= wanted.max(24.0) - 4.0 && rays <= root + 4.0, "{rays} rays of {wanted} to {root}");
    }
    // Four edges a leaf, coloured by its level; two strokes a T-vertex.
    let view = inspect_elements::edges(&solution, &world);
    let leaves: Vec<_> = map.trees.iter().flatten().flat_map(|t| &t.leaves).collect();
    let at_level = |level: f32| view.value_lines.iter().filter(|l| l.value == level).count();
    let of_level = |level: u8| leaves.iter().filter(|l| l.level == level).count();
    assert!(of_level(1) > 100 && of_level(2) > 0);
    assert!(at_level(2.0) <= 4 * of_level(2) && at_level(2.0) > 3 * of_level(2), "{:?}", view.notes);
    let noted = view.notes.iter().find_map(|n| n.strip_suffix(" T-vertices")?.parse().ok());
    assert_eq!(noted, Some(view.lines.len() / 2));
    // Chequers cover what the leaves cover.
    let shown = inspect_elements::elements(&solution, &world);
    assert!(shown.meshes.iter().all(|m| m.transparency > 0.0 && m.triangles.len() > 100));
    // The links of an element carry the light it takes from others.
    let picked = |i: &u32| map.elements[*i as usize].position.distance(Vec3::new(2.5, 0.0, 2.0)) < 0.3;
    let picked = (0..map.elements.len() as u32).find(picked).expect("an element");
    let links = inspect_exchange::links(&solution, picked).expect("an element");
    assert!(
        !links.value_lines.is_empty() && links.notes[0].contains(" lx from other elements"),
        "{:?}",
        links.notes
    );
    // The balance closes as it does on uniform grids: 1 % of noise.
    let energy = solution.energy(&world);
    assert!((energy.absorbed_flux / energy.direct_flux - 1.0).abs() < 0.015, "{energy:?}");
}

#[test]
fn fewer_elements_on_trees_come_nearer_than_more_on_uniform_grids() {
    // Held to a uniform grid of 7 cm with four times the rays: the same solver, laid out without trees.
    let world = World::new(&hall());
    let rays = |rays: u32, s: RadiositySettings| RadiositySettings { gather_rays: rays, ..s };
    let truth = solve(&world, &rays(512, settings(0.07, 0, 0.0)));
    let points: Vec<(u32, Vec2)> = (0..4000)
        .map(|i| {
            let mut rng = Rng::new(5, i);
            // As many on each triangle: the cupboard's count as much as the walls'.
            let triangle = (rng.next_f32() * world.geometry.len() as f32) as u32;
            let p = rng.next_vec2();
            (triangle, if p.element_sum() > 1.0 { Vec2::ONE - p } else { p })
        })
        .collect();
    let at =
        |s: &RadiositySolution, (t, b): (u32, Vec2)| luminance(s.irradiance(t, b, false, Part::Indirect));
    let mean = points.iter().map(|p| at(&truth, *p)).sum::<f32>() / points.len() as f32;
    let error = |s: &RadiositySolution| {
        let off = points.iter().map(|p| (at(s, *p) - at(&truth, *p)).abs() / at(&truth, *p).max(0.05 * mean));
        off.sum::<f32>() / points.len() as f32
    };
    // And to the path tracer, whose noise is in both.
    let tracer = PathTracer::new(&world);
    let traced: Vec<(f32, f32)> = points[..400]
        .par_iter()
        .enumerate()
        .map(|(i, (t, b))| {
            let surface = world.geometry.surface(*t, *b, -world.geometry.area_normal(*t));
            let found = irradiance_with(&tracer, &Receiver::of(&surface), Part::Indirect, 8192, i as u64);
            (luminance(found.mean), luminance(found.standard_error))
        })
        .collect();
    let of_traced = |off: &dyn Fn((u32, Vec2), (f32, f32)) -> f32| {
        let off = points.iter().zip(&traced).map(|(p, t)| off(*p, *t) / t.0.max(0.05 * mean));
        off.sum::<f32>() / traced.len() as f32
    };
    let from_paths = |s: &RadiositySolution| of_traced(&|p, (wanted, _)| (at(s, p) - wanted).abs());
    println!("paths: noise {:.4}, the fine grid {:.4}", of_traced(&|_, (_, e)| e), from_paths(&truth));
    let [uniform, trees] = [settings(0.1, 0, 0.0), settings(0.2, 2, 0.1)].map(|settings| {
        let solution = solve(&world, &rays(128, settings));
        let (count, error, from_paths) = (solved(&solution), error(&solution), from_paths(&solution));
        println!("{count:6} elements, mean error {error:.4}, from paths {from_paths:.4}");
        (count as f32, error, from_paths)
    });
    // Found: 0.48 of the elements, 0.90 of the error, from paths 0.61.
    assert!(
        trees.0 < 0.6 * uniform.0 && trees.1 < uniform.1 && trees.2 < uniform.2,
        "{trees:?} for {uniform:?}"
    );
}

#[test]
fn trees_are_the_same_at_any_thread_count() {
    let world = World::new(&hall());
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| solve(&world, &settings(0.4, 2, 0.2)))
    };
    let (one, two) = (with(1), with(2));
    assert_eq!(one.transport().hits, two.transport().hits);
    assert_eq!(one.indirect, two.indirect);
}

#[test]
fn restricted_trees_step_by_one_level_across_edges() {
    let world = World::new(&hall());
    let mut settings = settings(0.8, 4, 0.02);
    let steepest = |settings: &RadiositySettings| {
        let solution = solve(&world, settings);
        let trees = solution.transport().map.trees.iter().flatten();
        let of_tree = trees.flat_map(|tree| {
            let [w, h] = tree.nodes.map(|n| n as usize - 1);
            let levels = tree.levels_of_cells();
            let beside =
                |i: usize| [(i % w + 1 < w).then_some((i, i + 1)), (i / w + 1 < h).then_some((i, i + w))];
            (0..w * h)
                .flat_map(beside)
                .flatten()
                .map(move |(i, j)| levels[i].abs_diff(levels[j]))
                .collect::<Vec<_>>()
        });
        of_tree.max()
    };
    assert!(steepest(&settings) > Some(1), "without the restriction some differ by more");
    settings.subdivision = settings.subdivision.map(|s| Subdivision { restricted: true, ..s });
    assert_eq!(steepest(&settings), Some(1));
}
