//! Images-with-depth against the geometry they were taken of.

use crate::planar::floor_and_mirror;
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    mirror::{
        images::{
            ImageWithDepth, LayeredImage, Point, ReflectorImages, SampleSettings, Selection, Splat,
            pass::{
                Layered, MirrorPicture, Nearest, Points, diffuse, from_geometry, from_points,
                reflector_of_pixels,
            },
            reproject,
        },
        reflectors::Reflectors,
        views::Eye,
    },
    scene::camera::Camera,
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
    transport::LightTransportSolution,
};
use lumenscope_tests::solved;

const SIZE: UVec2 = UVec2::new(120, 90);
const SETTINGS: SampleSettings = SampleSettings { element_m: 2.0, poses: 7, radius_m: 1.5, resolution: 96 };

fn shading(solution: &LightTransportSolution) -> Shading<'_> {
    Shading::new(solution, &PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() })
}

/// The mirror's samples.
fn samples(solution: &LightTransportSolution) -> (Reflectors, ReflectorImages) {
    let reflectors = Reflectors::new(&solution.world.geometry);
    let set = ReflectorImages::new(
        (&solution.world, &diffuse(&shading(solution))),
        0,
        &reflectors.list[0],
        &SETTINGS,
    );
    (reflectors, set)
}

/// The eye of a sample that looks straight through its element, its picture the element.
fn own_eye(image: &ImageWithDepth) -> Eye {
    let (u, v) = (image.edge_u.length(), image.edge_v.length());
    let out = image.middle() - image.eye;
    Eye {
        position: image.eye,
        right: image.edge_u / u,
        up: -image.edge_v / v,
        forward: out.normalize(),
        half_size: 0.5 * Vec2::new(u, v) / out.length(),
    }
}

#[test]
fn a_sample_seen_from_its_own_pose_is_itself() {
    let solution = solved(floor_and_mirror(), 0.3);
    let (_, set) = samples(&solution);
    for element in &set.elements {
        let image = &element[0];
        let points: Vec<_> = image.points().collect();
        let size = UVec2::splat(image.resolution);
        let mask = vec![true; image.triangle.len()];
        for splat in [Splat::Pixel, Splat::Box] {
            let shown = reproject(&points, &own_eye(image), size, &mask, splat);
            assert_eq!(shown.radiance, image.colour, "{}", splat.name());
            let nothing = image.depth.iter().filter(|d| d.is_infinite()).count();
            assert_eq!(shown.holes, nothing);
        }
    }
    assert!(set.elements.len() >= 4);
}

fn picture(
    solution: &LightTransportSolution,
    points: &impl Points,
    reflectors: &Reflectors,
    camera: &Camera,
    splat: Splat,
) -> (MirrorPicture, MirrorPicture) {
    let buffer = GBuffer::new(&solution.world, camera, SIZE, Vec2::splat(0.5));
    let of_pixels = reflector_of_pixels(reflectors, &buffer, camera.eye);
    let exact = from_geometry(&shading(solution), reflectors, &of_pixels, &buffer, camera);
    (from_points(points, reflectors, &of_pixels, (camera, SIZE), splat), exact)
}

#[test]
fn surfaces_seen_from_elsewhere_lie_within_a_footprint_of_where_they_are() {
    let mut scene = floor_and_mirror();
    // The floor alone: what is seen of it is a plane.
    scene.objects.retain(|o| o.name == "floor" || o.name == "mirror" || o.name == "lamp");
    let solution = solved(scene, 0.5);
    let (reflectors, mut set) = samples(&solution);
    // Colours that say where on the floor a point lies, x and z, and how large it is; nothing else is compared.
    for image in set.elements.iter_mut().flatten() {
        for pixel in 0..image.triangle.len() as u32 {
            if let Some(Point { position, sides, .. }) = image.point(pixel) {
                let size = if position.y.abs() < 1e-4 { sides[0].length() + sides[1].length() } else { -1.0 };
                image.colour[pixel as usize] = Vec3::new(position.x, size, position.z);
            }
        }
    }
    let camera = solution.scene.camera;
    let lens = Eye::new(&camera, SIZE.x as f32 / SIZE.y as f32);
    let nearest = Nearest { sets: &[set], selection: Selection::Angle, count: 2 };
    let (found, _) = picture(&solution, &nearest, &reflectors, &camera, Splat::Box);
    let (mut compared, mut worst) = (0, 0.0f32);
    for (i, found_at) in found.radiance.iter().enumerate() {
        if found.hole[i] || found_at.y <= 0.0 {
            continue;
        }
        // Where the pixel's ray mirrored at x = 0 meets the floor.
        let uv =
            Vec2::new((i as u32 % SIZE.x) as f32 + 0.5, (i as u32 / SIZE.x) as f32 + 0.5) / SIZE.as_vec2();
        let direction = lens.forward
            + lens.right * ((2.0 * uv.x - 1.0) * lens.half_size.x)
            + lens.up * ((1.0 - 2.0 * uv.y) * lens.half_size.y);
        let meets = camera.eye - direction * (camera.eye.y / direction.y);
        let off = Vec2::new(-meets.x - found_at.x, meets.z - found_at.z).length();
        // The ray crosses the point's square, which stands upright, and goes on to the floor: as far again as
        // it is flat. A point smaller than a pixel is seen in the one that it falls into. A thousandth for rounding.
        let flat = Vec2::new(direction.x, direction.z).length() / direction.y.abs();
        let pixel = camera.eye.y / direction.y.abs() * (2.0 * lens.half_size / SIZE.as_vec2()).element_sum();
        let bound = 1.001 * (found_at.y + pixel) * (1.0 + flat);
        assert!(off <= bound, "pixel {i}: off by {off} m, footprint {bound} m");
        worst = worst.max(off / bound);
        compared += 1;
    }
    println!("{compared} pixels of the floor, at worst {worst:.2} footprints off");
    assert!(compared > 300, "{compared}");
}

#[test]
fn more_samples_leave_fewer_holes_and_layers_keep_surfaces_once() {
    let solution = solved(floor_and_mirror(), 0.3);
    let (reflectors, set) = samples(&solution);
    let layered: Vec<LayeredImage> = set.elements.iter().map(|e| LayeredImage::new(e)).collect();
    let (points, merged_from): (usize, usize) =
        layered.iter().fold((0, 0), |(a, b), l| (a + l.points.len(), b + l.merged_from));
    let sets = [set];
    let camera = solution.scene.camera;
    let share = |count| {
        let nearest = Nearest { sets: &sets, selection: Selection::Angle, count };
        picture(&solution, &nearest, &reflectors, &camera, Splat::Box).0.hole_share()
    };
    let (one, four, all) = (share(1), share(4), share(7));
    let layered = [(0, layered)];
    let (shown, exact) = picture(&solution, &Layered(&layered), &reflectors, &camera, Splat::Box);
    println!(
        "holes: {:.2} % of one, {:.2} % of four, {:.2} % of all, {:.2} % layered; {points} points of {merged_from}",
        100.0 * one,
        100.0 * four,
        100.0 * all,
        100.0 * shown.hole_share()
    );
    assert!(one > 0.0 && four <= one && all <= four, "{one} {four} {all}");
    assert!(shown.hole_share() <= one && 2 * points < merged_from);
    assert!(exact.mirrored > 1_000 && exact.hole_share() == 0.0);
}

#[test]
fn colours_read_by_id_after_a_lamp_has_changed_are_those_of_a_fresh_build() {
    let scene = floor_and_mirror();
    let before = solved(scene.clone(), 0.4);
    let (_, mut set) = samples(&before);
    let old = set.clone();
    let mut changed = scene;
    let lamp = changed.materials.iter_mut().find(|m| m.name == "lamp").unwrap();
    lamp.emission *= Vec3::new(0.3, 0.5, 1.5);
    lumenscope_tests::add_point_lamp(&mut changed, Vec3::new(1.5, 2.0, -1.0), Vec3::splat(40.0));
    let after = solved(changed, 0.4);
    set.recolour(&after.world, &diffuse(&shading(&after)));
    let (_, fresh) = samples(&after);
    assert!(set == fresh, "colours read anew differ from a fresh build's");
    assert!(set != old);
}

#[test]
fn the_nearest_samples_are_those_that_look_alike() {
    let solution = solved(floor_and_mirror(), 0.5);
    let (_, set) = samples(&solution);
    for selection in [Selection::Angle, Selection::Distance] {
        for image in set.images() {
            // A sample is the nearest to its own centre of projection.
            let nearest = selection.nearest(&set, image.eye, 1);
            assert!(nearest.iter().any(|n| n.eye == image.eye && n.corner == image.corner), "{selection:?}");
        }
        assert_eq!(selection.nearest(&set, Vec3::new(-2.0, 1.0, 0.0), 3).len(), 3 * set.elements.len());
    }
}
