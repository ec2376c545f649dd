//! The texture of one grid of a solved scene, stage by stage, against the path tracer.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{colour::luminance, frame::uniform_direction, progress::Progress, random::Rng},
    measure::grid_texture::{Conversion, GridReference, GridTexture, Kind, Prefilter, Stage, StageSettings},
    radiosity::texture::{
        Border, RadiosityTexture,
        display::Filter,
        sphere::{direction_at, place_of},
    },
    scene::{import, material::Material, mesh::Mesh},
    transport::LightTransportSolution,
};
use lumenscope_tests::{add, ball, box_room, command_line::scene, cornell, diffuse, solved};
use std::{
    f32::consts::{PI, TAU},
    path::Path,
};

#[test]
fn a_furnace_is_as_bright_at_every_stage_as_the_path_tracer_says() {
    let solution = solved(box_room(0.5, 10.0), 0.5);
    let grid = GridTexture::of_element(&solution.radiosity, &solution.world, 0).expect("a wall has a grid");
    assert!((grid.size_m.x - 2.0).abs() < 1e-4 && (grid.size_m.y - 2.0).abs() < 1e-4, "{}", grid.size_m);
    // Radiance 20 cd/m² from everywhere: 20 π lx. Gathering stops within 1e-3, and 64 rays see half of it.
    let exact = 20.0 * PI;
    let mut reference = GridReference::new(&grid, 1);
    reference.more(&grid, &solution.world, &Progress::silent()).unwrap();
    let traced = reference.mean(&grid);
    let noise = reference.noise(&grid) as f32;
    assert!(noise > 0.0 && noise < 0.1, "{noise}");
    let count = traced.pixels.len() as f32;
    // Points are independent: four standard errors of their mean.
    let off = luminance(traced.mean()) / exact - 1.0;
    assert!(off.abs() < 4.0 * noise / count.sqrt(), "{off} with a noise of {noise} at {count} points");
    for stage in grid.stages(&StageSettings::default()) {
        let most =
            stage.picture([16; 2]).pixels.iter().map(|p| (p.x / exact - 1.0).abs()).fold(0.0, f32::max);
        assert!(most < 0.02, "{most}");
        let error = grid.judge(&stage, &traced).unwrap();
        // What differs is the noise of the reference alone.
        assert!(error.rel_mse < f64::from(4.0 * noise * noise), "{error:?}, noise {noise}");
    }
    let stopped = Progress::silent();
    stopped.cancel();
    assert!(reference.more(&grid, &solution.world, &stopped).is_err());
    assert_eq!(reference.paths(), GridReference::PATHS, "a pass that was stopped does not count");
}

#[test]
fn the_smooth_function_passes_through_what_is_stored() {
    let solution = solved(cornell(), 0.25);
    let elements = solution.radiosity.elements();
    let floor = (0..elements.len() as u32)
        .find(|&i| elements[i as usize].normal.y > 0.99 && elements[i as usize].position.y.abs() < 1e-3);
    let grid = GridTexture::of_element(&solution.radiosity, &solution.world, floor.expect("a floor"))
        .expect("a grid");
    let settings = StageSettings {
        stored: Filter::Nearest,
        factor: 1,
        prefilter: Prefilter::Gaussian(1),
        shown: Filter::Mitchell,
        ..StageSettings::default()
    };
    let [stored, smooth, shown] = grid.stages(&settings);
    assert_eq!(stored.texels(), (grid.nodes[0] * grid.nodes[1]) as usize);
    assert_eq!(stored.bytes(), 12 * stored.texels());
    for (a, b) in stored.texture.image.pixels.iter().zip(&smooth.texture.image.pixels) {
        // The same numbers through a cubic's weights.
        assert!((*a - *b).abs().max_element() <= 1e-5 * a.max_element().max(1.0), "{a} {b}");
    }
    assert_eq!(shown.texture, smooth.texture, "a Gaussian of one texel changes nothing");
    let [zero, first] = grid.orders().expect("a tree");
    for (conversion, wanted) in [(Conversion::ZeroOrder, zero), (Conversion::FirstOrder, first)] {
        assert_eq!(grid.stages(&StageSettings { conversion, ..settings })[0], wanted);
    }
    let fine = &grid.stages(&StageSettings { factor: 3, ..settings })[1];
    assert_eq!(fine.texture.image.width, 3 * (grid.nodes[0] - 1) + 1);
    assert!(fine.texture.image.pixels.iter().all(|p| p.cmpge(Vec3::ZERO).all()));
    // A point over the floor's edge is asked from inside: all of this grid is floor.
    assert!((0..(grid.points[0] * grid.points[1]) as usize).all(|i| grid.is_judged(i)));
}

#[test]
fn a_wall_is_shown_as_one_sees_it_who_stands_before_it() {
    let solution = solved(cornell(), 0.25);
    let elements = solution.radiosity.elements();
    let at = |p: Vec3, n: Vec3| {
        let facing = |i: &u32| elements[*i as usize].geometric_normal.dot(n) > 0.99;
        let wall = (0..elements.len() as u32).filter(facing);
        wall.min_by(|&a, &b| {
            let far = |i: u32| elements[i as usize].position.distance(p);
            far(a).total_cmp(&far(b))
        })
    };
    // Behind the block that stands to the left, the back wall is darker on its left and, away from the panel
    // under the ceiling, below.
    let back = at(Vec3::new(0.0, 1.0, -1.0), Vec3::Z).expect("a back wall");
    let grid = GridTexture::of_element(&solution.radiosity, &solution.world, back).expect("a grid");
    let picture = grid.stages(&StageSettings::default())[0].picture([16; 2]);
    let mean = |inside: &dyn Fn(u32, u32) -> bool| {
        let pixels: Vec<f32> = (0..256u32)
            .filter(|i| inside(i % 16, i / 16))
            .map(|i| luminance(picture.pixels[i as usize]))
            .collect();
        pixels.iter().sum::<f32>() / pixels.len() as f32
    };
    let (left, right) = (mean(&|x, y| x < 8 && y > 7), mean(&|x, y| x > 7 && y > 7));
    assert!(left < 0.9 * right, "left {left} lx, right {right} lx");
    let (top, bottom) = (mean(&|_, y| y < 6), mean(&|_, y| y > 9));
    assert!(bottom < top, "top {top} lx, bottom {bottom} lx");
}

#[test]
fn orders_are_means_of_corners_and_of_the_leaves_that_meet() {
    let solution = solved(box_room(0.5, 10.0), 0.25);
    let grid = GridTexture::of_element(&solution.radiosity, &solution.world, 0).expect("a wall has a grid");
    let [nx, ny] = grid.nodes;
    assert!(nx == ny && (nx - 1).is_power_of_two(), "{nx} x {ny}: a full tree's vertices");
    let cells = nx - 1;
    let node = |x: u32, y: u32| grid.stages(&StageSettings::default())[0].texture.image.at(x, y);
    let [zero, first] = grid.orders().expect("a tree");
    let mean = |x: u32, y: u32| (node(x, y) + node(x + 1, y) + node(x, y + 1) + node(x + 1, y + 1)) / 4.0;
    for (x, y) in [(0, 0), (3, 1), (cells - 1, cells - 1)] {
        // Program 5.7: one texel a leaf. Single precision, in another order.
        let texel = zero.texture.image.at(x, y);
        assert!((texel - mean(x, y)).abs().max_element() < 1e-3, "{texel} {}", mean(x, y));
    }
    // Programs 5.10 and 5.11: the mean of four leaves inside, of one at a corner.
    let inside = (mean(2, 2) + mean(3, 2) + mean(2, 3) + mean(3, 3)) / 4.0;
    assert!((first.texture.image.at(3, 3) - inside).abs().max_element() < 1e-3);
    assert!((first.texture.image.at(0, 0) - mean(0, 0)).abs().max_element() < 1e-3);
    assert_eq!([zero.texels(), first.texels()], [cells * cells, nx * nx].map(|n| n as usize));
}

#[test]
fn a_ball_is_one_texture_by_longitude_and_latitude() {
    // In a furnace every stage says the 20 π lx of the walls, also on a ball that reflects all of it.
    let mut scene = box_room(0.5, 10.0);
    add(&mut scene, "ball", ball(Vec3::ZERO, 0.4, [24, 48]), diffuse("white", Vec3::ONE, Vec3::ZERO));
    let solution = solved(scene, 0.2);
    let of = |solution: &LightTransportSolution, object: u32| {
        let elements = solution.radiosity.elements();
        let element = elements.iter().position(|e| e.object == object).expect("its elements") as u32;
        GridTexture::of_element(&solution.radiosity, &solution.world, element)
    };
    let furnace = of(&solution, solution.scene.objects.len() as u32 - 1).expect("a ball");
    assert!(
        furnace.kind() == Kind::Ball && (furnace.size_m.x / (0.8 * PI) - 1.0).abs() < 1e-3,
        "{}",
        furnace.size_m
    );
    for stage in furnace.stages(&StageSettings::default()) {
        // Facets of 7.5° hide a part of what the ball's normals face, 1 % found on average, 2.4 % at worst.
        let off: Vec<f32> = stage.picture([32, 16]).pixels.iter().map(|p| p.x / (20.0 * PI) - 1.0).collect();
        let worst = off.iter().fold(0.0f32, |worst, o| worst.max(o.abs()));
        println!("furnace: {worst:.4} off at worst");
        assert!(worst < 0.03, "{worst}");
    }
    // Lit from one side: the Cornell box with a ball in it, against the path tracer, without a seam.
    let mut scene = cornell();
    add(
        &mut scene,
        "ball",
        ball(Vec3::new(0.09, 0.3, -0.2), 0.08, [24, 48]),
        diffuse("white", Vec3::splat(0.7), Vec3::ZERO),
    );
    let solution = solved(scene, 0.02);
    let grid = of(&solution, solution.scene.objects.len() as u32 - 1).expect("a ball");
    let mut reference = GridReference::new(&grid, 1);
    (0..4).for_each(|_| reference.more(&grid, &solution.world, &Progress::silent()).unwrap());
    let (traced, noise) = (reference.mean(&grid), reference.noise(&grid));
    // Trees that are fine where light bends.
    let [taken, full] = grid.samples().expect("six trees");
    println!("{taken} samples of {full}");
    assert!(4 * taken < 3 * full, "{taken} of {full}");
    let stages = grid.stages(&StageSettings::default());
    // Range of the light within 10° of a direction, lx; a hundredth of the whole range where it is even.
    let light = |stage: &Stage, d: Vec3| luminance(stage.texture.sample(place_of(d), stage.filter));
    let range = |values: &mut dyn Iterator<Item = f32>| {
        let (low, high) = values.fold((f32::INFINITY, 0f32), |(l, h), v| (l.min(v), h.max(v)));
        high - low
    };
    let around = |i: u64| uniform_direction(Rng::new(2, i).next_vec2());
    let whole = range(&mut (0..2000).map(|i| light(&stages[1], around(i))));
    let local = |about: Vec3| {
        let near = |i: u64| (about + 0.176 * around(i)).normalize();
        range(&mut (0..400).map(|i| light(&stages[1], near(i)))).max(0.01 * whole)
    };
    // Largest jump over the seam, and spread about a pole, a hundredth of a texel away.
    let seam_and_poles = |texture: &RadiosityTexture, filter: Filter| {
        let step = 0.01 * texture.step;
        let at = |u: f32, v: f32| luminance(texture.sample(Vec2::new(u, v), filter));
        let seam = (1..60)
            .map(|i| i as f32 / 60.0)
            .map(|v| (at(1.0 - step.x, v) - at(step.x, v)).abs() / local(direction_at(Vec2::new(0.0, v))));
        let poles = [(step.y, Vec3::Y), (1.0 - step.y, Vec3::NEG_Y)]
            .map(|(v, pole)| range(&mut (0..64).map(|i| at(i as f32 / 64.0, v))) / local(pole));
        [seam.fold(0.0, f32::max), poles[0].max(poles[1])]
    };
    for (number, stage) in stages.iter().enumerate() {
        let error = grid.judge(stage, &traced).unwrap();
        let [seam, poles] = seam_and_poles(&stage.texture, stage.filter);
        println!("stage {}: {error:?}, seam {seam:.5}, poles {poles:.5}, noise {noise:.4}", number + 1);
        // Found 0.017 with elements of 2 cm on a ball of 8 cm, with the reference's 5 % of noise in it.
        assert!(error.rel_mse < 0.025, "{error:?}");
        assert!(seam < 0.01 && poles < 0.01, "{seam} {poles}");
        // So that the test can fail: without padding the seam is open.
        let open = RadiosityTexture { border: Border::Clamp, ..stage.texture.clone() };
        assert!(seam_and_poles(&open, stage.filter)[0] > 0.01);
    }
    // An even prefilter, which can be chosen for any surface, is the next narrower one on what goes round.
    let with = |width| {
        let prefilter = Prefilter::Gaussian(width);
        grid.stages(&StageSettings { prefilter, ..StageSettings::default() })[2].clone()
    };
    assert_eq!((with(2), with(6)), (with(1), with(5)));
    let [zero, first] = grid.orders().expect("six trees");
    let errors = [&zero, &first].map(|stage| grid.judge(stage, &traced).unwrap().rel_mse);
    println!("zero and first order of leaves: relMSE {errors:?}");
    // Means of leaves blur; of zero order they jump too.
    assert!(errors[1] < errors[0] && errors[0] < 0.1, "{errors:?}");
    // Nor is a cylinder as high as it is wide, whose corners are all as far from its middle.
    let rims: Vec<Vec3> = (0..96)
        .map(|i| (PI * (i / 2) as f32 / 24.0, 0.2 * (2 * (i % 2)) as f32 - 0.2))
        .map(|(angle, y)| Vec3::new(0.2 * angle.cos(), y, -0.2 * angle.sin()))
        .collect();
    let around = (0..48).flat_map(|i| {
        let [a, b, c, d] = [2 * i, 2 * i + 1, (2 * i + 2) % 96, (2 * i + 3) % 96];
        [[a, c, b], [c, d, b]]
    });
    let caps = (1..47).flat_map(|i| [[0, 2 * i + 2, 2 * i], [1, 2 * i + 1, 2 * i + 3]]);
    let normals = rims.iter().map(|p| p.normalize()).collect();
    let triangles = around.chain(caps).collect();
    let cylinder =
        Mesh { uvs: vec![Vec2::ZERO; rims.len()], positions: rims, normals, triangles, ..Mesh::default() };
    let mut scene = box_room(0.5, 10.0);
    add(&mut scene, "cylinder", cylinder, diffuse("white", Vec3::ONE, Vec3::ZERO));
    let solution = solved(scene, 0.2);
    assert!(of(&solution, 1).is_none_or(|g| g.kind() != Kind::Ball));
    // A wall is none.
    assert!(of(&solution, 0).is_some_and(|g| g.kind() == Kind::Grid));
}

/// The texture of the element of an object that is nearest to a point.
fn texture_at(solution: &LightTransportSolution, object: &str, p: Vec3) -> GridTexture {
    let object = solution.scene.objects.iter().position(|o| o.name == object).expect("an object") as u32;
    let elements = solution.radiosity.elements();
    let own = (0..elements.len() as u32).filter(|&i| elements[i as usize].object == object);
    let away = |i: u32| elements[i as usize].position.distance(p);
    let element = own.min_by(|&a, &b| away(a).total_cmp(&away(b))).expect("its elements");
    GridTexture::of_element(&solution.radiosity, &solution.world, element).expect("a texture")
}

/// Relative mean squared errors of the three stages and of both conversions, and the reference's noise.
fn errors(grid: &GridTexture, solution: &LightTransportSolution) -> ([f64; 5], f64) {
    let mut reference = GridReference::new(grid, 1);
    (0..8).for_each(|_| reference.more(grid, &solution.world, &Progress::silent()).unwrap());
    let traced = reference.mean(grid);
    let orders = grid.orders().expect("a tree");
    let stages = grid.stages(&StageSettings::default());
    let all: Vec<f64> =
        stages.iter().chain(&orders).map(|s| grid.judge(s, &traced).unwrap().rel_mse).collect();
    (all.try_into().expect("five"), reference.noise(grid))
}

#[test]
fn a_triangle_and_the_side_of_a_column_are_textures_too() {
    let scene = import::load(Path::new(&scene("cornell/patches.ron"))).expect("a shipped scene");
    let solution = solved(scene, 0.02);
    let sail = texture_at(&solution, "Sail", Vec3::new(-0.16, 0.06, -0.09));
    let column = texture_at(&solution, "Column", Vec3::new(0.09, 0.25, -0.119));
    assert_eq!((sail.kind(), column.kind()), (Kind::Triangle, Kind::Tube));
    assert!((column.size_m - Vec2::new(0.1 * PI, 0.18)).abs().max_element() < 1e-3, "{}", column.size_m);
    // The cap is no part of the side.
    assert_eq!(texture_at(&solution, "Column", Vec3::new(0.09, 0.36, -0.169)).kind(), Kind::Grid);
    for (name, grid) in [("sail", &sail), ("column", &column)] {
        let ([stored, smooth, shown, zero, first], noise) = errors(grid, &solution);
        let [taken, full] = grid.samples().expect("a tree");
        println!(
            "{name}: {taken} samples of {full}; {stored:.4} {smooth:.4} {shown:.4}, orders {zero:.4} {first:.4}, noise {noise:.4}"
        );
        assert!(taken < full, "{taken} of {full}");
        // Found 0.022 and 0.011, with 10.8 and 4.6 % of the reference's noise in it; the ball's bound.
        assert!(stored.max(smooth).max(shown) < 0.025 && first < zero, "{name}");
    }
    // Half of the sail's square is no sail, and is not judged.
    let judged = (0..(sail.points[0] * sail.points[1]) as usize).filter(|&i| sail.is_judged(i)).count();
    assert!(2 * judged <= (sail.points[0] * sail.points[1]) as usize && judged > 0);
    assert!(
        sail.covers(Vec2::splat(0.4)) && !sail.covers(Vec2::splat(0.6)) && column.covers(Vec2::splat(0.6))
    );
    // The column's texture goes round: a thousandth of a texel to both sides of where it closes.
    for stage in column.stages(&StageSettings::default()) {
        let seam = |texture: &RadiosityTexture| {
            let at = |u: f32, v: f32| luminance(texture.sample(Vec2::new(u, v), stage.filter));
            let step = 1e-3 * texture.step.x;
            let jump = (0..=40).map(|i| i as f32 / 40.0).map(|v| {
                // Within 10° of it, as the whole texture has it.
                let near = (-10..=10).map(|k| (k as f32 / 360.0).rem_euclid(1.0));
                let near = near.map(|u| luminance(stage.texture.sample(Vec2::new(u, v), stage.filter)));
                let (low, high) = near.fold((f32::INFINITY, 0f32), |(l, h), e| (l.min(e), h.max(e)));
                (at(1.0 - step, v) - at(step, v)).abs() / (high - low).max(0.01 * high)
            });
            jump.fold(0.0, f32::max)
        };
        let open = RadiosityTexture { border: Border::Clamp, ..stage.texture.clone() };
        let (closed, open) = (seam(&stage.texture), seam(&open));
        println!("column: seam {closed:.5} of the local range, {open:.3} without going round");
        assert!(closed < 0.01 && open > 0.1, "{closed} {open}");
    }
}

#[test]
fn a_tube_in_a_furnace_is_as_bright_outside_as_inside() {
    let mut scene = box_room(0.5, 10.0);
    let mut mesh = Mesh::default();
    let (rows, columns) = (8u32, 48u32);
    for (row, column) in (0..=rows).flat_map(|row| (0..=columns).map(move |column| (row, column))) {
        let angle = column as f32 / columns as f32 * TAU;
        // Lying, so that the axis is not the vertical.
        let normal = Vec3::new(0.0, angle.cos(), angle.sin());
        mesh.positions.push(Vec3::X * (row as f32 / rows as f32 - 0.5) * 0.8 + 0.3 * normal);
        mesh.normals.push(normal);
        mesh.uvs.push(Vec2::ZERO);
    }
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let a = row * (columns + 1) + column;
        let b = a + columns + 1;
        mesh.triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
    }
    let white = Material { double_sided: true, ..diffuse("white", Vec3::ONE, Vec3::ZERO) };
    let tube = add(&mut scene, "tube", mesh, white) as u32;
    let solution = solved(scene, 0.1);
    let elements = solution.radiosity.elements();
    let radial = |i: &usize| elements[*i].normal.dot(elements[*i].position.reject_from(Vec3::X));
    for sign in [1.0, -1.0] {
        let side = (0..elements.len()).filter(|&i| elements[i].object == tube);
        let element = side.into_iter().find(|i| sign * radial(i) > 0.0).expect("an element") as u32;
        let grid = GridTexture::of_element(&solution.radiosity, &solution.world, element).expect("a tube");
        assert_eq!(grid.kind(), Kind::Tube);
        assert!(grid.points[0] * grid.points[1] == (0..1152).filter(|&i| grid.is_judged(i)).count() as u32);
        for stage in grid.stages(&StageSettings::default()) {
            let off: Vec<f32> =
                stage.picture([32, 16]).pixels.iter().map(|p| p.x / (20.0 * PI) - 1.0).collect();
            let worst = off.iter().fold(0.0f32, |worst, o| worst.max(o.abs()));
            let mean = off.iter().sum::<f32>() / off.len() as f32;
            println!("side {sign}: {worst:.4} off at worst, {mean:+.4} in the mean");
            // As the ball's: facets of 7.5° hide a part of what normals face. Inside, the walls that emit are partly
            // hidden, so single elements are noisy: 18 % found at worst, 0.3 % in the mean.
            assert!(mean.abs() < 0.02 && (sign < 0.0 || worst < 0.03), "{mean}, {worst}");
        }
    }
}
