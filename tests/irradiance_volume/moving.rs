//! Dynamic objects: what they hide from themselves against closed forms, levels of detail, the reference.

use glam::{Affine3A, Vec2, Vec3};
use lumenscope_core::{
    irradiance_volume::{
        IrradianceVolume, VolumeSettings,
        dynamic_object::{Detail, DynamicObject, lattice_blend, lattice_len},
        self_occlusion,
        trust::SampleState,
    },
    math::{colour::luminance, part::Part, progress::Progress, random::Rng},
    radiosity::RadiositySettings,
    reference::irradiance::irradiance,
    scene::{Scene, Target, direct::Receiver, mesh::Mesh, world::World},
    superposition::moved::MovedLight,
    transport::{
        LightTransportSolution,
        live::{LiveTransport, SolveSettings},
    },
};
use lumenscope_tests::{add, cornell, diffuse, merged, rectangle};
use rayon::prelude::*;
use std::{f32::consts::PI, sync::Arc};

/// A rectangle cut into `nu` × `nv` quadrilaterals.
fn plate(corner: Vec3, u: Vec3, v: Vec3, [nu, nv]: [u32; 2]) -> Mesh {
    let (du, dv) = (u / nu as f32, v / nv as f32);
    let piece = |i: u32| rectangle(corner + du * (i % nu) as f32 + dv * (i / nu) as f32, du, dv);
    merged(&(0..nu * nv).map(piece).collect::<Vec<_>>())
}

/// Part of a sphere of radius 1 around the origin, from the south pole up to `share` of a half turn; its
/// front looks inwards or outwards.
fn bowl(share: f32, [around, up]: [u32; 2], inward: bool) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=up {
        for i in 0..=around {
            let (theta, phi) = (PI * share * j as f32 / up as f32, 2.0 * PI * i as f32 / around as f32);
            let p = Vec3::new(theta.sin() * phi.cos(), -theta.cos(), theta.sin() * phi.sin());
            mesh.positions.push(p);
            mesh.normals.push(if inward { -p } else { p });
            mesh.uvs.push(Vec2::ZERO);
        }
    }
    let row = around + 1;
    for j in 0..up {
        for i in 0..around {
            let [a, b, c, d] = [j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i];
            let mut sides = vec![[a, c, b], [a, d, c]];
            // At a pole one side of the quadrilateral has no length.
            if j == 0 {
                sides.remove(0);
            } else if share == 1.0 && j + 1 == up {
                sides.remove(1);
            }
            mesh.triangles.extend(sides.iter().map(|t| if inward { [t[0], t[2], t[1]] } else { *t }));
        }
    }
    mesh
}

fn alone(mesh: Mesh, spacing: Option<f32>) -> (World, DynamicObject) {
    let mut scene = Scene::default();
    let object = add(&mut scene, "thing", mesh, diffuse("grey", Vec3::splat(0.5), Vec3::ZERO));
    scene.objects[object].movable = true;
    let world = World::new(&scene);
    let mut known = DynamicObject::new(&scene, &world.geometry, object, spacing);
    known.occlude(&world, object, 1);
    (world, known)
}

fn positions(world: &World, known: &DynamicObject) -> Vec<Vec3> {
    let at = |&(t, Vec2 { x: u, y: v }): &(u32, Vec2)| {
        let [a, b, c] = world.geometry.positions[t as usize];
        a * (1.0 - u - v) + b * u + c * v
    };
    known.places.iter().map(at).collect()
}

#[test]
fn a_groove_hides_what_its_closed_form_says() {
    for degrees in [60.0f32, 90.0, 140.0] {
        let alpha = degrees.to_radians();
        let long = Vec3::Z * 40.0;
        let other = Vec3::new(alpha.cos(), alpha.sin(), 0.0);
        let groove =
            merged(&[plate(-0.5 * long, long, Vec3::X, [41, 2]), plate(-0.5 * long, other, long, [2, 41])]);
        let (world, known) = alone(groove, Some(0.5));
        // 600,000 rays over the nodes: four standard errors of as many random rays for each node, and
        // their mean to 0.3 %.
        let rays = 600_000 / known.places.len();
        let (mut checked, mut sum) = (0, 0.0);
        for (p, open) in positions(&world, &known).iter().zip(&known.open) {
            // The ends of the plates are far from the middle: what they lack is below 0.1 %.
            if p.z.abs() > 0.5 {
                continue;
            }
            // Strip to infinitely long plate of width 1 at angle α, distance x from the edge they share:
            // F = ½ (1 + (cos α − x) / √(x² + 1 − 2 x cos α)).
            let x = p.truncate().length();
            let c = alpha.cos();
            let hidden = 0.5 * (1.0 + (c - x) / (x * x + 1.0 - 2.0 * x * c).sqrt());
            let error = open[0] - (1.0 - hidden);
            let bound = 4.0 * (hidden * (1.0 - hidden) / rays as f32).sqrt() + 1e-3;
            assert!(error.abs() < bound, "{degrees}° at {x}: {} open, {} wanted", open[0], 1.0 - hidden);
            (checked, sum) = (checked + 1, sum + error);
        }
        assert!(checked > 20, "{checked} nodes");
        assert!((sum / checked as f32).abs() < 3e-3, "{degrees}°: {} on average", sum / checked as f32);
    }
}

#[test]
fn a_bowl_hides_half_and_a_ball_nothing() {
    // Inside a sphere a point sees any part of it in proportion to its area: half of it for half a sphere.
    let (_, inside) = alone(bowl(0.5, [48, 24], true), None);
    let off = inside.open.iter().map(|o| (o[0] - 0.5).abs()).fold(0.0, f32::max);
    // Rays as above, and facets of 7.5° whose planes lie up to that much off the sphere's.
    assert!(off < 0.04, "off by {off}");
    let (_, ball) = alone(bowl(1.0, [24, 12], false), None);
    assert!(ball.open.iter().all(|o| o[0] == 1.0), "a convex thing hides nothing from itself");
}

#[test]
fn lattices_reproduce_linear_functions_and_vertices_are_shared() {
    let mut rng = Rng::new(5, 0);
    for steps in [1, 2, 3, 7, 24] {
        assert_eq!(lattice_len(steps), (0..=steps).map(|j| steps - j + 1).sum::<u32>());
        let mut values = Vec::new();
        for j in 0..=steps {
            for i in 0..=steps - j {
                values.push(Vec2::new(i as f32, j as f32) / steps as f32);
            }
        }
        let on_edges = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::splat(0.5), Vec2::new(0.5, 0.0)];
        let inside = (0..200).map(|_| {
            let p = rng.next_vec2();
            if p.x + p.y > 1.0 { Vec2::ONE - p } else { p }
        });
        for at in on_edges.into_iter().chain(inside) {
            let (entries, weights) = lattice_blend(steps, at);
            let found: Vec2 = (0..3).map(|i| values[entries[i] as usize] * weights[i]).sum();
            assert!((found - at).length() < 1e-5 && weights.iter().all(|w| *w > -1e-4), "{steps}: {at}");
        }
    }
    let (_, ball) = alone(bowl(1.0, [24, 12], false), None);
    // One node a vertex that a triangle uses; the 24 of the south pole are one.
    assert_eq!(ball.vertices, 25 * 13 - 2 - 23);
    assert_eq!(ball.places.len(), ball.vertices);
}

fn settings() -> SolveSettings {
    let radiosity =
        RadiositySettings { gather_rays: 128, element_spacing_m: Some(0.1), ..RadiositySettings::default() };
    let volume = VolumeSettings { samples: Some([6, 6, 6]), bins_n: 9, ..VolumeSettings::default() };
    SolveSettings { radiosity, volume: Some(volume), preview: false }
}

/// The Cornell box with a movable thing, solved with it outside, then moved to `to`.
fn moved_in(mesh: Mesh, reflectance: f32, to: Affine3A) -> (LightTransportSolution, u32) {
    let mut scene = cornell();
    let thing = add(&mut scene, "thing", mesh, diffuse("grey", Vec3::splat(reflectance), Vec3::ZERO));
    scene.objects[thing].movable = true;
    // Behind the camera, where it neither shadows nor stretches the grid much.
    scene.objects[thing].world_from_object =
        Affine3A::from_translation(Vec3::new(0.0, 0.9, 1.1)) * Affine3A::from_scale(Vec3::splat(1e-3));
    let mut live =
        LiveTransport::solve(Arc::new(scene.clone()), settings(), &Progress::silent(), &mut |_| {}).unwrap();
    scene.place(Target::Object(thing), to);
    (live.follow(Arc::new(scene)).clone(), thing as u32)
}

/// Mean relative difference of the light on random points of an object from a query at the point itself.
fn against_pixels(solution: &LightTransportSolution, object: u32) -> f32 {
    let light = MovedLight::new(solution, false);
    let (geometry, volume) = (&solution.world.geometry, solution.volume.as_ref().unwrap());
    let range = geometry.object_triangles[object as usize].clone();
    let mut rng = Rng::new(11, 0);
    let (mut off, count) = (0.0, 2000);
    for _ in 0..count {
        let t = range.start + (rng.next_f32() * range.len() as f32) as u32;
        let p = rng.next_vec2();
        let at = if p.x + p.y > 1.0 { Vec2::ONE - p } else { p };
        let surface = geometry.surface(t, at, -geometry.area_normal(t));
        let found = light.irradiance(solution, t, at, false, Part::Indirect).unwrap();
        let wanted = volume.irradiance(surface.position, surface.normal, Part::Indirect);
        off += (luminance(found) - luminance(wanted)).abs() / luminance(wanted);
    }
    off / count as f32
}

#[test]
fn large_triangles_show_what_happens_inside_them() {
    let table = rectangle(Vec3::new(-0.8, 0.0, 0.6), Vec3::X * 1.6, Vec3::Z * -1.2);
    let (mut solution, table) = moved_in(table, 0.5, Affine3A::from_translation(Vec3::Y * 1.4));
    // Built a thousandth of its size, its lattices are anew for where it stands.
    let (scene, world) = (solution.scene.clone(), solution.world.clone());
    let known = DynamicObject::new(&scene, &world.geometry, table as usize, Some(0.08));
    assert!(known.queries(Detail::Fine) > 50 * known.queries(Detail::Vertices));
    solution.dynamic_objects = Arc::new([(table, known)].into());
    let error = |detail| against_pixels(&LightTransportSolution { detail, ..solution.clone() }, table);
    let (fine, corners) = (error(Detail::Fine), error(Detail::Vertices));
    println!("mean difference from a query a pixel: {fine:.4} with lattices, {corners:.4} at corners");
    // Half a cell between nodes: what bends inside a cell is a product of two linear functions.
    assert!(fine < 0.01 && corners > 5.0 * fine, "{fine} with lattices, {corners} at corners");
}

#[test]
fn the_coarse_level_asks_less_and_stays_near() {
    let place =
        Affine3A::from_translation(Vec3::new(0.1, 1.35, 0.2)) * Affine3A::from_scale(Vec3::splat(0.3));
    let (mut solution, ball) = moved_in(bowl(1.0, [96, 48], false), 0.5, place);
    let (scene, world) = (solution.scene.clone(), solution.world.clone());
    let known = DynamicObject::new(&scene, &world.geometry, ball as usize, None);
    let [coarse, vertices] = [Detail::Coarse, Detail::Vertices].map(|d| known.queries(d));
    assert!(5 * coarse < vertices, "{coarse} queries of {vertices}");
    assert_eq!(known.within(10), Detail::Coarse);
    assert_eq!(known.within(usize::MAX), Detail::Fine);
    let light = |detail| {
        let volume = solution.volume.as_ref().unwrap();
        known.irradiance(volume, &world.geometry, ball as usize, [false, true], 1.0, detail)
    };
    let (a, b) = (light(Detail::Coarse), light(Detail::Vertices));
    let mut off: Vec<f32> =
        a.iter().zip(&b).map(|(a, b)| (luminance(a[1]) / luminance(b[1]) - 1.0).abs()).collect();
    off.sort_by(f32::total_cmp);
    let (median, worst) = (off[off.len() / 2], off[off.len() - 1]);
    println!("coarse: {coarse} of {vertices} queries, median {median:.4} off, worst {worst:.4}");
    // An eighteenth of the ball's diagonal is 0.19 rad of its normal; irradiance changes by about its own
    // size over one radian, in places somewhat faster.
    assert!(median < 0.03 && worst < 0.25, "median {median}, worst {worst}");
    solution.detail = Detail::Coarse;
    assert_eq!(MovedLight::new(&solution, true).first[&ball], 0);
}

#[test]
fn self_occlusion_brings_a_moved_bowl_nearer_to_the_reference() {
    let place =
        Affine3A::from_translation(Vec3::new(0.1, 1.2, 0.3)) * Affine3A::from_scale(Vec3::splat(0.25));
    // Black, so that it sends nothing to itself: what is left is what it hides.
    let (solution, object) = moved_in(bowl(0.6, [24, 12], true), 0.0, place);
    let (world, volume) = (&solution.world, solution.volume.as_ref().unwrap());
    // Anew at its size here: where it was solved it is a millimetre wide.
    let mut known = DynamicObject::new(&solution.scene, &world.geometry, object as usize, None);
    known.occlude(world, object as usize, 1);
    let known = &known;
    let light =
        known.irradiance(volume, &world.geometry, object as usize, [false, true], 1.0, Detail::Vertices);
    let points = positions_in(world, known, object);
    let chosen: Vec<usize> = (30..known.vertices).step_by(7).collect();
    let reference: Vec<f32> = chosen
        .par_iter()
        .map(|&i| {
            let (p, n) = points[i];
            let receiver = Receiver::new(p + n * 1e-3, n);
            luminance(irradiance(world, &receiver, Part::Indirect, 512, i as u64).mean)
        })
        .collect();
    let error = |of: &dyn Fn(usize) -> f32| {
        chosen.iter().zip(&reference).map(|(&i, r)| (of(i) - r) / r).sum::<f32>() / chosen.len() as f32
    };
    let with = error(&|i| luminance(light[i][1]));
    let without = error(&|i| luminance(light[i][1]) / known.open[i][0]);
    println!("mean error against the reference: {:+.3} with self-occlusion, {:+.3} without", with, without);
    assert!(with.abs() < 0.5 * without.abs(), "{with} with, {without} without");
}

fn positions_in(world: &World, known: &DynamicObject, object: u32) -> Vec<(Vec3, Vec3)> {
    let first = world.geometry.object_triangles[object as usize].start;
    let at = |&(t, Vec2 { x: u, y: v }): &(u32, Vec2)| {
        let mix = |[a, b, c]: [Vec3; 3]| a * (1.0 - u - v) + b * u + c * v;
        let t = (first + t) as usize;
        (mix(world.geometry.positions[t]), mix(world.geometry.normals[t]).normalize())
    };
    known.places.iter().map(at).collect()
}

#[test]
fn at_pixels_a_moved_thing_is_lit_by_a_query_at_each_point() {
    let place =
        Affine3A::from_translation(Vec3::new(0.1, 1.2, 0.3)) * Affine3A::from_scale(Vec3::splat(0.25));
    let (mut solution, object) = moved_in(bowl(0.6, [24, 12], true), 0.5, place);
    solution.detail = Detail::Pixels;
    let light = MovedLight::new(&solution, false);
    let (geometry, volume) = (&solution.world.geometry, solution.volume.as_ref().unwrap());
    let range = geometry.object_triangles[object as usize].clone();
    let known = &solution.dynamic_objects[&object];
    let mut rng = Rng::new(2, 0);
    for _ in 0..200 {
        let t = range.start + (rng.next_f32() * range.len() as f32) as u32;
        let p = rng.next_vec2();
        let at = if p.x + p.y > 1.0 { Vec2::ONE - p } else { p };
        let surface = geometry.surface(t, at, -geometry.area_normal(t));
        let open = known.open_at(t - range.start, at, false);
        let found = light.irradiance(&solution, t, at, false, Part::Indirect).unwrap();
        let wanted = volume.irradiance(surface.position, surface.normal, Part::Indirect) * open;
        assert!((found - wanted).length() < 1e-4 * wanted.length() + 1e-6, "{found} {wanted}");
    }
    assert_eq!(solution.with_detail(Some(Detail::Coarse)).detail, Detail::Coarse);
    assert_eq!(solution.with_detail(None).detail, Detail::Pixels);
    // The processor makes such a picture; one of nodes a graphics device may make.
    assert!(solution.is_asked_at_pixels() && !solution.with_detail(Some(Detail::Fine)).is_asked_at_pixels());
}

#[test]
fn what_a_thing_hides_from_itself_is_drawn_on_it() {
    let (_, object) = alone(bowl(0.5, [48, 24], true), None);
    let (world, _) = alone(bowl(0.5, [48, 24], true), None);
    let scene = self_occlusion::scene(&[(0, object.clone())].into(), &world.geometry);
    let triangles: usize = object.lattices.iter().map(|(_, steps)| (steps * steps) as usize).sum();
    assert_eq!(scene.meshes[0].triangles.len(), triangles);
    // Half a sphere hides half of every point's hemisphere, to the rays' noise and facets as above.
    assert!(scene.meshes[0].values.iter().all(|v| (v.x - 50.0).abs() < 4.0));
    assert_eq!(scene.legend.unwrap().unit, "%");
}

#[test]
fn vertices_that_differ_in_texture_alone_ask_once() {
    let mut square = rectangle(Vec3::ZERO, Vec3::X, Vec3::NEG_Z);
    let (_, joined) = alone(square.clone(), None);
    // Cut along the diagonal: six vertices where four places are.
    square.positions = square.triangles.iter().flatten().map(|&i| square.positions[i as usize]).collect();
    square.normals = vec![square.normals[0]; 6];
    square.uvs = (0..6).map(|i| Vec2::splat(i as f32)).collect();
    square.triangles = vec![[0, 1, 2], [3, 4, 5]];
    let (_, cut) = alone(square, None);
    assert_eq!((joined.vertices, cut.vertices), (4, 4));
}

#[test]
fn the_volume_follows_furniture_at_once_and_stands_around_it_at_rest() {
    let mut scene = cornell();
    let block = scene.objects.iter().position(|o| o.name == "short block").unwrap();
    let mut live =
        LiveTransport::solve(Arc::new(scene.clone()), settings(), &Progress::silent(), &mut |_| {}).unwrap();
    let before = live.current().volume.clone().unwrap();
    // Up in the air under the lamp: it shadows what is below, and samples come to lie in it.
    let to = Vec3::new(-0.05, 1.1, 0.0);
    scene.place(Target::Object(block), Affine3A::from_translation(to));
    let dragged = live.follow(Arc::new(scene)).volume.clone().unwrap();
    let below = to + Vec3::new(0.0, -0.3, 0.0);
    let direct = |v: &IrradianceVolume| luminance(v.irradiance(below, Vec3::Y, Part::Direct));
    let (was, is) = (direct(&before), direct(&dragged));
    assert!(is < 0.7 * was, "{is} lx below it, {was} lx before");
    assert!((0..dragged.samples().len()).any(|s| dragged.age(s) > 0));
    while live.refine(&Progress::silent()).unwrap().is_some() {}
    let rested = live.current().volume.clone().unwrap();
    assert!((0..rested.samples().len()).all(|s| rested.age(s) == 0), "its rays are new");
    let inside = |v: &IrradianceVolume| {
        let block = |s: &&lumenscope_core::irradiance_volume::Sample| {
            (s.position - to).abs().with_y(0.0).max_element() < 0.29 && (1.11..1.69).contains(&s.position.y)
        };
        v.samples().iter().filter(block).filter(|s| s.state == SampleState::Free).count()
    };
    assert!(inside(&before) > 0 && inside(&rested) == 0, "{} {}", inside(&before), inside(&rested));
    assert!(direct(&rested) < 0.7 * was, "{} lx", direct(&rested));
}
