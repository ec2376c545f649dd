//! Atlases and lightmaps: packing, and every fault found where it was put and nowhere else.

use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::{
        colour::luminance,
        image::LinearImage,
        part::Part,
        progress::{Cancelled, Progress},
        random::Rng,
    },
    measure::irradiance::relative_errors,
    radiosity::{
        RadiositySettings, RadiositySolution,
        atlas::{Atlas, bake, lookup},
        inspect_lightmap::{Shown, on_surfaces},
        lightmap::{LightmapReport, judge},
        texels::{self, Coverage},
    },
    scene::{Scene, accel::Ray, world::World},
};
use lumenscope_tests::{add, add_point_lamp, cuboid, diffuse, golden::shipped, rectangle};

#[test]
fn rectangles_are_packed_apart_and_densely() {
    for (count, padding) in [(1, 0), (40, 1), (200, 2)] {
        let sizes: Vec<UVec2> =
            (0..count).map(|i| (Rng::new(6, i).next_vec2() * 40.0).as_uvec2() + UVec2::ONE).collect();
        let atlas = Atlas::pack(&sizes, padding);
        let mut used = vec![false; (atlas.size.x * atlas.size.y) as usize];
        for (size, place) in sizes.iter().zip(&atlas.places) {
            for y in place.y - padding..place.y + size.y + padding {
                for x in place.x - padding..place.x + size.x + padding {
                    assert!(x < atlas.size.x && y < atlas.size.y);
                    let texel = &mut used[(y * atlas.size.x + x) as usize];
                    assert!(!std::mem::replace(texel, true), "({x}, {y}) is taken twice");
                }
            }
        }
        let share = used.iter().filter(|u| **u).count() as f32 / used.len() as f32;
        assert!(share > 0.7, "{count} rectangles fill {share} of the image");
    }
}

fn room() -> (World, RadiositySolution) {
    let mut scene = Scene::default();
    let wall = diffuse("wall", Vec3::splat(0.6), Vec3::ZERO);
    add(&mut scene, "room", cuboid(Vec3::ZERO, Vec3::new(2.0, 2.4, 3.0), true), wall);
    add_point_lamp(&mut scene, Vec3::new(1.0, 1.4, 1.5), Vec3::splat(100.0));
    let world = World::new(&scene);
    let settings = RadiositySettings { element_spacing_m: Some(0.1), ..RadiositySettings::default() };
    let solution = RadiositySolution::solve(&world, &settings, &Progress::silent()).expect("solves");
    (world, solution)
}

fn errors(report: &LightmapReport) -> f64 {
    let found: Vec<Vec3> = report.texels.iter().map(|t| t.found).collect();
    let ours: Vec<Vec3> = report.texels.iter().map(|t| t.ours).collect();
    relative_errors(&found, &ours).expect("texels").median
}

type Uvs = Vec<Option<[Vec2; 3]>>;

fn cover(world: &World, uvs: &Uvs, size: [u32; 2]) -> Coverage {
    Coverage::new(world, uvs, size).expect("texels")
}

#[test]
fn our_own_bake_has_no_fault_and_each_fault_is_found() {
    let (world, solution) = room();
    let (image, uvs) = bake(&world.geometry, &solution, Part::All, 2);
    assert!(uvs.iter().all(Option::is_some));
    // The baked texture gives what the solution does, on every triangle.
    for t in 0..world.geometry.len() as u32 {
        let [a, b, c] = uvs[t as usize].expect("coordinates");
        let at = lookup(&image, a * 0.3 + b * 0.5 + c * 0.2);
        let wanted = solution.irradiance(t, Vec2::new(0.5, 0.2), false, Part::All);
        assert!((at - wanted).abs().max_element() < 1e-3 * wanted.max_element(), "{t}: {at} for {wanted}");
    }
    let clean = judge(&world, &solution, &image, &uvs, &Progress::silent()).expect("a lightmap");
    assert!(clean.texels.len() > 2000 && errors(&clean) < 0.01, "{} {}", clean.texels.len(), errors(&clean));
    assert!(clean.overlapping.is_empty() && clean.stretched.is_empty() && clean.unmapped.is_empty());
    assert!(
        clean.seams.is_empty() && clean.dark.is_empty() && clean.leaks.is_empty() && clean.uneven.is_empty()
    );

    let with = |image: &LinearImage, change: &dyn Fn(&mut Uvs)| {
        let mut uvs = uvs.clone();
        change(&mut uvs);
        judge(&world, &solution, image, &uvs, &Progress::silent()).expect("a lightmap")
    };
    let overlapping = with(&image, &|uvs| uvs[2] = uvs[0]);
    assert!(overlapping.overlapping.len() > 50, "{}", overlapping.overlapping.len());
    let stretched = with(&image, &|uvs| {
        uvs[0] = uvs[0].map(|[a, b, c]| [a, a + (b - a) * 0.1, a + (b - a) * 0.1 + (c - b)]);
    });
    assert!(stretched.stretched.contains(&0) && stretched.stretched.len() == 1, "{:?}", stretched.stretched);
    let uneven = with(&image, &|uvs| uvs[0] = uvs[0].map(|[a, b, c]| [a, a.lerp(b, 0.3), a.lerp(c, 0.3)]));
    assert_eq!(uneven.uneven, [0]);
    let outside = with(&image, &|uvs| uvs[3] = uvs[3].map(|uvs| uvs.map(|uv| uv + 1.0)));
    assert_eq!(outside.unmapped, [3]);
    // One triangle of the first wall half as bright as the other: a seam along their common edge.
    let mut half = image.clone();
    for t in clean.texels.iter().filter(|t| t.triangle == 0) {
        half.pixels[(t.at[1] * half.width + t.at[0]) as usize] *= 0.5;
    }
    let seam = with(&half, &|uvs| {
        // Shifted by a texel along the wall, as when charts are cut apart and packed anew.
        let texel = Vec2::new(3.0 / half.width as f32, 0.0);
        uvs[1] = uvs[1].map(|uvs| uvs.map(|uv| uv + texel));
    });
    assert_eq!(seam.seams.len(), 1, "{:?}", seam.seams);
    let mut black = image.clone();
    let dark: Vec<[u32; 2]> = clean.texels.iter().filter(|t| t.triangle == 4).map(|t| t.at).collect();
    dark.iter().for_each(|at| black.pixels[(at[1] * black.width + at[0]) as usize] = Vec3::ZERO);
    assert_eq!(with(&black, &|_| {}).dark.len(), dark.len());
    // What is no number is named as such, and counts as black in the errors.
    dark.iter().for_each(|at| black.pixels[(at[1] * black.width + at[0]) as usize] = Vec3::NAN);
    let broken = with(&black, &|_| {});
    assert_eq!((broken.not_finite.len(), broken.dark.len()), (dark.len(), 0));
    assert!(broken.texels.iter().all(|t| t.found.is_finite()));
}

#[test]
fn every_triangle_has_a_chart_of_its_own_with_the_light_of_its_corners() {
    for name in ["office/office.ron", "cornell/ball.ron"] {
        let world = shipped(name);
        let settings = RadiositySettings {
            gather_rays: 4,
            shadow_rays: 1,
            element_spacing_m: (name == "cornell/ball.ron").then_some(0.02),
            ..RadiositySettings::default()
        };
        let solution = RadiositySolution::solve(&world, &settings, &Progress::silent()).expect("solves");
        let (image, uvs) = bake(&world.geometry, &solution, Part::All, 1);
        let coverage = cover(&world, &uvs, [image.width, image.height]);
        assert_eq!((coverage.unmapped.len(), coverage.overlapping.len()), (0, 0), "{name}");
        let mut worst = (0.0, 0);
        for (t, uvs) in uvs.iter().enumerate() {
            let uvs = uvs.unwrap_or_else(|| panic!("{name}: triangle {t} has no coordinates"));
            let corners = [Vec2::ZERO, Vec2::X, Vec2::Y];
            let wanted = corners.map(|at| solution.irradiance(t as u32, at, false, Part::All));
            // Coordinates of single precision are off by 1e-4 texels on a map of two thousand.
            let scale = wanted.iter().fold(f32::MIN_POSITIVE, |most, e| most.max(e.max_element()));
            for (uv, wanted) in uvs.iter().zip(wanted) {
                let off = (lookup(&image, *uv) - wanted).abs().max_element() / scale;
                worst = if off > worst.0 { (off, t) } else { worst };
            }
        }
        println!("{name}: {} x {} texels, corners off by {worst:?}", image.width, image.height);
        assert!(worst.0 < 1e-3, "{name}: {worst:?}");
    }
}

#[test]
fn our_light_baked_onto_coordinates_of_a_file_has_no_fault() {
    let (world, solution) = room();
    let (_, uvs) = bake(&world.geometry, &solution, Part::All, 2);
    let silent = Progress::silent();
    let size = [160, 160];
    let map = texels::bake(&world, &solution, &cover(&world, &uvs, size), 2, &silent).expect("bakes");
    let report = judge(&world, &solution, &map, &uvs, &silent).expect("a lightmap");
    assert!(errors(&report) == 0.0 && report.seams.is_empty() && report.dark.is_empty());
    // Padding repeats the light of the chart: bilinear lookup at its corners meets no black.
    for (t, uvs) in uvs.iter().enumerate() {
        let at = lookup(&map, uvs.expect("coordinates")[0]);
        let wanted = solution.irradiance(t as u32, Vec2::ZERO, false, Part::All);
        assert!(luminance(at) > 0.7 * luminance(wanted), "{t}: {at} for {wanted}");
    }
    // On the surfaces: the light there, and no difference to ours.
    let mut world = world;
    world.geometry.lightmap_uvs = uvs.iter().map(|uvs| uvs.expect("coordinates")).collect();
    for (shown, wanted) in [(Shown::Light, 1.0), (Shown::Difference, 0.0)] {
        let view = on_surfaces(&report, &world, 0.1, shown);
        let mesh = &view.meshes[0];
        assert!(mesh.triangles.len() > 1000);
        for t in mesh.triangles.iter().step_by(97) {
            let middle = t.iter().map(|i| mesh.positions[*i as usize]).sum::<Vec3>() / 3.0;
            let found = t.iter().map(|i| luminance(mesh.values[*i as usize])).sum::<f32>() / 3.0;
            let towards = Vec3::new(1.0, 1.2, 1.5) - middle;
            let hit =
                world.accel.trace(&Ray::new(middle + towards * 0.1, -towards.normalize())).expect("a wall");
            let ours = luminance(solution.irradiance(hit.triangle, hit.barycentric, false, Part::All));
            assert!((found - wanted * ours).abs() < 0.3 * ours, "{middle}: {found} for {ours}");
        }
    }
}

#[test]
fn texels_are_lit_at_their_middles() {
    // A point lamp of 100 cd 1 m above a floor of 2 × 2 m: E = I h / d³.
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-1.0, 0.0, 1.0), Vec3::X * 2.0, Vec3::Z * -2.0);
    add(&mut scene, "floor", floor, diffuse("floor", Vec3::splat(0.5), Vec3::ZERO));
    add_point_lamp(&mut scene, Vec3::new(0.3, 1.0, -0.4), Vec3::splat(100.0));
    let world = World::new(&scene);
    let settings = RadiositySettings { element_spacing_m: Some(0.2), ..RadiositySettings::default() };
    let solution = RadiositySolution::solve(&world, &settings, &Progress::silent()).expect("solves");
    let uvs: Vec<_> = world.geometry.lightmap_uvs.iter().map(|uvs| Some(*uvs)).collect();
    const SIDE: u32 = 12;
    let map = texels::bake(&world, &solution, &cover(&world, &uvs, [SIDE; 2]), 0, &Progress::silent())
        .expect("bakes");
    for y in 0..SIDE {
        for x in 0..SIDE {
            // u runs along x and v, downwards, along z.
            let p = (Vec2::new(x as f32, y as f32) + 0.5) * (2.0 / SIDE as f32) - 1.0;
            let exact = 100.0 * (1.0 + p.distance_squared(Vec2::new(0.3, -0.4))).powf(-1.5);
            let found = map.at(x, y).x;
            assert!((found - exact).abs() < 1e-4 * exact, "{x}, {y}: {found} for {exact}");
        }
    }
}

#[test]
fn coordinates_that_repeat_or_cover_nothing_are_refused() {
    let (world, solution) = room();
    let over = |uvs: [Vec2; 3]| {
        let uvs = vec![Some(uvs); world.geometry.len()];
        Coverage::new(&world, &uvs, [64; 2]).map_err(|e| e.to_string())
    };
    // Twelve triangles over half the map each: six times.
    let half = [Vec2::ZERO, Vec2::X, Vec2::Y];
    assert!(over(half).is_ok());
    let many = |times: usize| {
        let mut scene = Scene::default();
        let wall = diffuse("wall", Vec3::splat(0.6), Vec3::ZERO);
        for i in 0..times {
            let low = Vec3::X * 3.0 * i as f32;
            add(&mut scene, "room", cuboid(low, low + Vec3::ONE, true), wall.clone());
        }
        let world = World::new(&scene);
        Coverage::new(&world, &vec![Some(half); world.geometry.len()], [64, 64]).map_err(|e| e.to_string())
    };
    let refused = many(2).expect_err("twelve times over");
    assert!(refused.contains("12 times"), "{refused}");
    assert!(over([Vec2::ZERO; 3]).is_err_and(|e| e.contains("no texel")));
    let cancelled = Progress::default();
    cancelled.cancel();
    let (_, uvs) = bake(&world.geometry, &solution, Part::All, 2);
    let stopped = texels::bake(&world, &solution, &cover(&world, &uvs, [64; 2]), 0, &cancelled);
    assert_eq!(stopped, Err(Cancelled));
}

#[test]
fn light_where_there_is_none_is_a_leak() {
    // Two rooms, one dark: a lightmap that is bright in both leaks in the second only.
    let mut scene = Scene::default();
    let wall = diffuse("wall", Vec3::splat(0.5), Vec3::ZERO);
    add(&mut scene, "lit", cuboid(Vec3::ZERO, Vec3::splat(2.0), true), wall.clone());
    let far = cuboid(Vec3::new(3.0, 0.0, 0.0), Vec3::new(5.0, 2.0, 2.0), true);
    add(&mut scene, "dark", far, wall);
    add_point_lamp(&mut scene, Vec3::ONE, Vec3::splat(100.0));
    let world = World::new(&scene);
    let settings = RadiositySettings { element_spacing_m: Some(0.2), ..RadiositySettings::default() };
    let solution = RadiositySolution::solve(&world, &settings, &Progress::silent()).expect("solves");
    let (image, uvs) = bake(&world.geometry, &solution, Part::All, 1);
    let bright = LinearImage::from_fn(image.width, image.height, |_, _| Vec3::splat(150.0));
    let report = judge(&world, &solution, &bright, &uvs, &Progress::silent()).expect("a lightmap");
    let in_dark = |i: &usize| report.texels[*i].position.x > 2.5;
    assert!(!report.leaks.is_empty() && report.leaks.iter().all(in_dark));
    assert_eq!(report.leaks.len(), (0..report.texels.len()).filter(in_dark).count());
}
