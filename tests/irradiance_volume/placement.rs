//! Placement: illuminance on planes and tops against closed forms, contours on known fields, warnings.

use glam::{Affine3A, Vec3};
use lumenscope_core::{
    irradiance_volume::{
        IrradianceVolume, VolumeSettings,
        placement::{
            MeasureSettings, Measurement,
            contours::{Lattice, contours},
            grid::{MeasuringGrid, standard_spacing_m},
            inspect::{Field, levels, scene as view},
            measure,
            requirement::{PRESETS, Requirement, Shortfall, preset},
        },
    },
    math::progress::Progress,
    radiosity::{RadiositySettings, RadiositySolution},
    scene::{MeasuringPlane, Scene, geometry::Geometry, world::World},
};
use lumenscope_tests::{add, add_point_lamp, box_room, cuboid, diffuse, rectangle};

fn plane(corner: Vec3, edge_u: Vec3, edge_v: Vec3) -> MeasuringPlane {
    MeasuringPlane { name: "plane".into(), corner, edge_u, edge_v }
}

fn solved(scene: &Scene) -> (World, RadiositySolution) {
    let world = World::new(scene);
    let settings =
        RadiositySettings { element_spacing_m: Some(0.25), gather_rays: 128, ..RadiositySettings::default() };
    let light = RadiositySolution::solve(&world, &settings, &Progress::silent()).unwrap();
    (world, light)
}

fn measured(scene: &Scene, grid: MeasuringGrid, settings: &MeasureSettings) -> Measurement {
    let (world, light) = solved(scene);
    measure(&world, &light, None, "plane", grid, settings)
}

/// A black floor of 4 m × 4 m, and 100 cd one metre above its middle.
fn lamp_over_floor() -> Scene {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-2.0, 0.0, 2.0), Vec3::X * 4.0, Vec3::Z * -4.0);
    add(&mut scene, "floor", floor, diffuse("black", Vec3::ZERO, Vec3::ZERO));
    add_point_lamp(&mut scene, Vec3::Y, Vec3::splat(100.0));
    scene
}

#[test]
fn a_point_lamp_over_a_plane_is_its_closed_form() {
    let scene = lamp_over_floor();
    let plane = plane(Vec3::new(-1.0, 0.01, 0.5), Vec3::X * 2.0, Vec3::Z * -1.0);
    let grid = MeasuringGrid::on_plane(&plane, 3);
    let found = measured(&scene, grid.clone(), &MeasureSettings::default());
    // I cos θ / d² = I h / (h² + r²)^(3/2) with h = 0.99 m.
    let closed = |p: Vec3| 100.0 * 0.99 / (0.99f32.powi(2) + p.x * p.x + p.z * p.z).powf(1.5);
    let wanted: Vec<f32> = grid.points.iter().flatten().map(|p| closed(*p)).collect();
    for (found, wanted) in found.values.iter().zip(&wanted) {
        // Rounding alone: the three channels are equal and their weights sum to 1.
        assert!((found.unwrap() / wanted - 1.0).abs() < 1e-5, "{found:?} for {wanted}");
    }
    let s = found.statistics().unwrap();
    let mean = wanted.iter().sum::<f32>() / wanted.len() as f32;
    let low = wanted.iter().copied().fold(f32::INFINITY, f32::min);
    let high = wanted.iter().copied().fold(0.0, f32::max);
    for (found, wanted) in [
        (s.mean_lx, mean),
        (s.min_lx, low),
        (s.max_lx, high),
        (s.uniformity, low / mean),
        (s.diversity, low / high),
    ] {
        assert!((found / wanted - 1.0).abs() < 1e-4, "{found} for {wanted}");
    }
    assert_eq!(s.points, (grid.nx * grid.ny) as usize);
    assert!(s.darkest.x.abs() > 0.8 && s.brightest.x.abs() < 0.1);
    let aged = MeasureSettings { maintenance_factor: 0.8, ..MeasureSettings::default() };
    let aged = measured(&scene, grid, &aged).statistics().unwrap();
    assert!((aged.mean_lx / s.mean_lx - 0.8).abs() < 1e-5 && (aged.uniformity - s.uniformity).abs() < 1e-5);
}

#[test]
fn gathered_light_in_a_furnace_is_pi_l() {
    // Every wall emits and reflects the same: indirect irradiance is π ρ L / (1 − ρ), direct π L.
    let (reflectance, emission) = (0.5, 10.0);
    let scene = box_room(reflectance, emission);
    let grid = MeasuringGrid::on_plane(&plane(Vec3::new(-0.5, -0.2, 0.5), Vec3::X, Vec3::Z * -1.0), 1);
    let settings = MeasureSettings { shadow_rays: 64, ..MeasureSettings::default() };
    let found = measured(&scene, grid.clone(), &settings);
    let wanted = std::f32::consts::PI * emission / (1.0 - reflectance);
    for value in found.values.iter().flatten() {
        // Gathered rays all meet the same radiosity, up to the sweeps' tolerance; twelve emissive
        // triangles in closed form are all seen.
        assert!((value / wanted - 1.0).abs() < 5e-3, "{value} for {wanted}");
    }
    let (world, light) = solved(&scene);
    let small = VolumeSettings { samples: Some([3; 3]), bins_n: 9, ..VolumeSettings::default() };
    let volume = IrradianceVolume::build(&world, &light, &small, &Progress::silent()).unwrap();
    // Rays drawn over a lamp all around often fall below the horizon: as many as at rest.
    let moving = MeasureSettings { shadow_rays: 64, ..settings.moving() };
    let live = measure(&world, &light, Some(&volume), "plane", grid, &moving);
    assert_eq!(live.gather_rays, 0);
    for value in live.values.iter().flatten() {
        // Constant radiance reads πL exactly from any bin.
        assert!((value / wanted - 1.0).abs() < 5e-3, "{value} for {wanted} from the volume");
    }
}

#[test]
fn points_inside_a_solid_are_left_out() {
    let mut scene = lamp_over_floor();
    let block = cuboid(Vec3::new(-0.4, 0.001, -0.4), Vec3::new(0.4, 0.3, 0.4), false);
    add(&mut scene, "block", block, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    let grid = MeasuringGrid::on_plane(&plane(Vec3::new(-1.0, 0.1, 1.0), Vec3::X * 2.0, Vec3::Z * -2.0), 1);
    let found = measured(&scene, grid.clone(), &MeasureSettings::default());
    for (point, value) in grid.points.iter().zip(&found.values) {
        let p = point.unwrap();
        assert_eq!(value.is_none(), p.x.abs() < 0.4 && p.z.abs() < 0.4, "{p}");
    }
    assert_eq!(found.inside, found.values.iter().filter(|v| v.is_none()).count());
    assert!(found.inside >= 4 && found.statistics().unwrap().points == grid.points.len() - found.inside);
}

#[test]
fn the_top_of_an_object_is_its_largest_level_surface_and_turns_with_it() {
    let mut scene = lamp_over_floor();
    // A seat of 0.4 m × 0.4 m at 0.45 m with a narrow back rest to 0.9 m.
    let mut chair = cuboid(Vec3::new(-0.2, 0.4, -0.2), Vec3::new(0.2, 0.45, 0.2), false);
    chair = lumenscope_tests::merged(&[
        chair,
        cuboid(Vec3::new(-0.2, 0.46, 0.17), Vec3::new(0.2, 0.9, 0.2), false),
    ]);
    let chair = add(&mut scene, "chair", chair, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    scene.objects[chair].world_from_object =
        Affine3A::from_translation(Vec3::new(0.5, 0.1, -0.3)) * Affine3A::from_rotation_y(0.5);
    let grid = MeasuringGrid::on_top(&Geometry::new(&scene), chair, 2).unwrap();
    let [u, v] = [grid.edge_u, grid.edge_v];
    assert!((u.length() - 0.4).abs() < 1e-4 && (v.length() - 0.4).abs() < 1e-4, "{u} {v}");
    assert!((u.normalize().dot(Vec3::new(0.5f32.cos(), 0.0, -0.5f32.sin())) - 1.0).abs() < 1e-4, "{u}");
    assert!((grid.normal - u.cross(v).normalize()).length() < 1e-5);
    for point in &grid.points {
        assert!((point.unwrap().y - 0.55).abs() < 1e-4);
    }
    assert!(MeasuringGrid::on_top(&Geometry::new(&scene), 99, 1).is_none());
    // A triangle covers half of its rectangle.
    let mut half = rectangle(Vec3::new(0.0, 0.5, 0.0), Vec3::X, Vec3::Z * -1.0);
    half.triangles.truncate(1);
    let half = add(&mut scene, "half", half, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    let grid = MeasuringGrid::on_top(&Geometry::new(&scene), half, 4).unwrap();
    let covered = grid.points.iter().flatten().count() as f32 / grid.points.len() as f32;
    // Half of the cells, and half of those on the diagonal.
    assert!((covered - 0.5).abs() <= 0.5 / grid.nx as f32 + 1e-4, "{covered}");
}

#[test]
fn the_grid_is_as_fine_as_the_standard_asks() {
    // The standard's own table of examples.
    for (longer, spacing) in [(0.4, 0.15), (1.0, 0.2), (2.0, 0.3), (5.0, 0.6), (10.0, 1.0), (100.0, 5.0)] {
        // It rounds to one digit.
        assert!((standard_spacing_m(longer) / spacing - 1.0).abs() < 0.3, "{longer} m");
    }
    assert_eq!(standard_spacing_m(1e4), 10.0);
    let grid = MeasuringGrid::on_plane(&plane(Vec3::ZERO, Vec3::Z * 10.0, Vec3::X * 5.0), 1);
    assert_eq!((grid.nx, grid.ny), (10, 5));
    let middle = grid.points[0].unwrap();
    assert!((middle - Vec3::new(0.5, 0.0, 0.5)).length() < 1e-5, "{middle}");
}

#[test]
fn contours_of_a_cone_are_circles_and_of_a_plane_lines() {
    let (width, height) = (41usize, 31usize);
    let of = |f: &dyn Fn(f32, f32) -> Option<f32>| -> Vec<Option<f32>> {
        (0..width * height).map(|i| f((i % width) as f32, (i / width) as f32)).collect()
    };
    let lines = |values: &[Option<f32>], level| contours(&Lattice { width, height, values }, level);
    let cone = of(&|x, y| Some((x - 20.0).hypot(y - 15.0)));
    let circles = lines(&cone, 9.5);
    assert_eq!(circles.len(), 1);
    assert!(circles[0].closed && circles[0].points.len() > 40);
    for [x, y] in &circles[0].points {
        // Curvature within a cell: 1 / (8 r).
        assert!(((x - 20.0).hypot(y - 15.0) - 9.5).abs() < 1.0 / 76.0, "{x} {y}");
    }
    // Beyond the lower and upper edges a circle is cut into two open lines.
    let cut = lines(&cone, 17.5);
    assert_eq!(cut.len(), 2);
    assert!(cut.iter().all(|c| !c.closed));
    let slope = of(&|x, y| Some(2.0 * x + y));
    let line = lines(&slope, 33.3);
    assert_eq!(line.len(), 1);
    for [x, y] in &line[0].points {
        // Linear along every edge: exact up to rounding.
        assert!((2.0 * x + y - 33.3).abs() < 1e-4);
    }
    // A saddle at the middle of a cell: two lines that do not cross.
    let saddle = of(&|x, y| Some((x - 20.5) * (y - 15.5)));
    let two = lines(&saddle, 0.1);
    assert_eq!(two.len(), 2);
    let side = |c: &lumenscope_core::irradiance_volume::placement::contours::Contour| {
        c.points.iter().map(|p| (p[0] - 20.5).signum()).sum::<f32>().abs() == c.points.len() as f32
    };
    assert!(two.iter().all(side), "each stays on its side");
    // No line runs where there is no value.
    let holed = of(&|x, y| (x < 20.0).then_some(2.0 * x + y));
    assert!(lines(&holed, 33.3).iter().flat_map(|c| &c.points).all(|p| p[0] < 20.0));
    assert!(lines(&slope, 1e9).is_empty());
}

#[test]
fn warnings_name_what_falls_short() {
    let scene = lamp_over_floor();
    let grid = MeasuringGrid::on_plane(&plane(Vec3::new(-1.0, 0.0, 1.0), Vec3::X * 2.0, Vec3::Z * -2.0), 2);
    let found = measured(&scene, grid, &MeasureSettings::default());
    let s = found.statistics().unwrap();
    let writing = preset("writing, reading, screens").unwrap().requirement();
    let short = writing.shortfalls(Some(&s));
    assert_eq!(short.len(), 2, "{short:?}");
    assert!(matches!(short[0], Shortfall::Mean { wanted_lx: 500.0, .. }));
    assert!(matches!(short[1], Shortfall::Uneven { wanted: 0.6, .. }));
    assert!(short[0].to_string().contains("of 500 lx"));
    let paper = preset("Exhibit: works on paper, textiles").unwrap().requirement();
    assert!(matches!(paper.shortfalls(Some(&s))[..], [Shortfall::Bright { wanted_lx: 50.0, .. }]));
    let modest = Requirement { min_lx: Some(s.min_lx), mean_lx: Some(s.mean_lx), ..Requirement::default() };
    assert!(modest.shortfalls(Some(&s)).is_empty(), "what is just met is met");
    assert!(Requirement::default().shortfalls(None).is_empty());
    assert!(matches!(modest.shortfalls(None)[..], [Shortfall::Nothing]));
    for preset in PRESETS {
        assert!(!preset.requirement().is_empty() && preset.source.contains("20"), "{}", preset.task);
    }

    let wanted = Requirement { mean_lx: Some(50.0), ..Requirement::default() };
    let lines = levels(&found, &wanted);
    assert!(lines.contains(&50.0) && lines.windows(2).all(|w| w[0] < w[1]), "{lines:?}");
    let shown = view(&found, &wanted);
    assert_eq!(shown.legend.as_ref().unwrap().unit, "lx");
    assert!(shown.lines.len() > 50 && shown.labels.iter().any(|l| l.text == "50 lx"));
    // Lines lie where the closed form has their value; the field is linear between points.
    let field = Field::new(&found);
    let (mut off, mut count) = (0.0f32, 0);
    for contour in field.contours(50.0) {
        for point in &contour.points {
            let p = field.position(*point);
            let closed = 100.0 / (1.0 + p.x * p.x + p.z * p.z).powf(1.5);
            off = off.max((closed / 50.0 - 1.0).abs());
            count += 1;
        }
    }
    // E'' p² / 8 with p = 0.17 m and |E''| up to 3 I: a few per cent.
    assert!(count > 20 && off < 0.03, "{count} points, off by {off}");
}

#[test]
fn threads_do_not_change_a_measurement() {
    let scene = box_room(0.5, 10.0);
    let (world, light) = solved(&scene);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let grid = MeasuringGrid::on_plane(&plane(Vec3::new(-0.5, -0.2, 0.5), Vec3::X, Vec3::Z * -1.0), 2);
        pool.install(|| measure(&world, &light, None, "plane", grid, &MeasureSettings::default()))
    };
    assert_eq!(run(1), run(2));
}

/// A mug without a lid: a tube of 16 sides and a bottom, of one double-sided shell.
fn mug(centre: Vec3, radius: f32, height: f32) -> lumenscope_core::scene::mesh::Mesh {
    let at = |i: u32, y: f32| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / 16.0).sin_cos();
        centre + Vec3::new(radius * cos, y, radius * sin)
    };
    let side = |i| {
        lumenscope_core::scene::mesh::Mesh::quad([
            at(i + 1, 0.0),
            at(i, 0.0),
            at(i, height),
            at(i + 1, height),
        ])
    };
    let mut parts: Vec<_> = (0..16).map(side).collect();
    let bottom = rectangle(
        centre - Vec3::new(0.7, 0.0, -0.7) * radius,
        Vec3::X * 1.4 * radius,
        Vec3::Z * -1.4 * radius,
    );
    parts.push(bottom);
    lumenscope_tests::merged(&parts)
}

#[test]
fn points_inside_a_mug_on_a_table_are_left_out() {
    let mut scene = lamp_over_floor();
    let table = scene.objects.iter().position(|o| o.name == "floor").unwrap();
    let shell = lumenscope_core::scene::material::Material {
        double_sided: true,
        ..diffuse("clay", Vec3::splat(0.5), Vec3::ZERO)
    };
    let at = Vec3::new(0.6, 0.001, 0.4);
    add(&mut scene, "mug", mug(at, 0.1, 0.12), shell);
    let world = World::new(&scene);
    let grid = MeasuringGrid::on_top(&world.geometry, table, 12).unwrap();
    let found =
        measured(&scene, grid.clone(), &MeasureSettings { gather_rays: 16, ..MeasureSettings::default() });
    let (mut inside, mut beside) = (0, 0);
    for (point, value) in grid.points.iter().zip(&found.values) {
        let d = (point.unwrap() - at).with_y(0.0).length();
        if d < 0.09 {
            assert!(value.is_none(), "{d} m from the mug's axis");
            inside += 1;
        } else if d > 0.11 {
            assert!(value.is_some(), "{d} m from the mug's axis");
            beside += 1;
        }
    }
    assert!(inside > 2 && beside > 100, "{inside} {beside}");
    // The mug's own top is its bottom, which it does stand around: that is measured.
    let own = scene.objects.len() - 1;
    let top = MeasuringGrid::on_top(&world.geometry, own, 3).unwrap();
    assert!(measured(&scene, top, &MeasureSettings::default()).values.iter().any(Option::is_some));
}
