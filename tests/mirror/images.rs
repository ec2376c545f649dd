//! Images-with-depth against the geometry they were taken of.

use crate::planar::floor_and_mirror;
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::progress::Progress,
    mirror::{
        culling::Portal,
        images::{
            ImageWithDepth, ImagesError, LayeredImage, MirrorImages, NOTHING, Point, SampleSettings,
            Selection, Splat,
            pass::{Frame, Layered, MirrorPicture, Nearest, Points, diffuse},
            reproject,
            reproject::footprint,
            sample::place,
            visible::{Run, Sight},
        },
        reflectors::Reflectors,
        views::{Eye, MirroredView, mirrored_views},
    },
    scene::{Scene, camera::Camera, material::Material, world::World},
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
    transport::LightTransportSolution,
};
use lumenscope_tests::{add, cuboid, rectangle, solved};
use std::sync::Arc;

const SIZE: UVec2 = UVec2::new(120, 90);
const SETTINGS: SampleSettings = SampleSettings { element_m: 2.0, poses: 7, radius_m: 1.5, resolution: 128 };

fn shading(solution: &LightTransportSolution) -> Shading<'_> {
    Shading::new(solution, &PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() })
}

/// The samples of a scene's mirrors.
fn samples(solution: &LightTransportSolution) -> (Reflectors, MirrorImages) {
    let world = &solution.world;
    let mut images = MirrorImages::new(world, &SETTINGS, &Progress::silent()).unwrap();
    images.recolour(world, &diffuse(&shading(solution)));
    (Reflectors::new(&world.geometry), images)
}

/// Colours row by row, as a picture has them.
fn rows(image: &ImageWithDepth) -> Vec<Vec3> {
    let mut picture = vec![Vec3::ZERO; image.colour.len()];
    for (pixel, colour) in (0..).zip(&image.colour) {
        let at = place(pixel);
        picture[(at.y * image.resolution + at.x) as usize] = *colour;
    }
    picture
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
fn a_sample_seen_from_its_own_pose_is_itself_and_where_it_sees_nothing_is_no_hole() {
    let solution = solved(floor_and_mirror(), 0.3);
    let (_, images) = samples(&solution);
    let mut nothing = 0;
    for element in &images.sets[0].elements {
        let image = &element[0];
        let points: Vec<_> = image.points().collect();
        let size = UVec2::splat(image.resolution);
        let mask = vec![true; image.triangle.len()];
        for splat in [Splat::Pixel, Splat::Box] {
            let shown = reproject(&points, &own_eye(image), (size, Vec2::splat(0.5)), &mask, splat);
            assert_eq!(shown.radiance, rows(image), "{}", splat.name());
            assert_eq!(shown.holes, 0);
        }
        nothing += image.triangle.iter().filter(|t| **t == NOTHING).count();
    }
    assert!(images.sets[0].elements.len() >= 4 && nothing > 1_000, "there are no walls: {nothing}");
}

fn picture(
    solution: &LightTransportSolution,
    points: &impl Points,
    reflectors: &Reflectors,
    splat: Splat,
) -> (MirrorPicture, MirrorPicture) {
    let camera = &solution.scene.camera;
    let buffer = GBuffer::new(&solution.world, camera, SIZE, Vec2::splat(0.5));
    let frame = Frame::new(&solution.world, reflectors, &buffer, camera);
    (frame.from_points(points, splat), frame.from_geometry(&shading(solution)))
}

#[test]
fn surfaces_seen_from_elsewhere_lie_within_a_footprint_of_where_they_are() {
    let mut scene = floor_and_mirror();
    // The floor alone: what is seen of it is a plane.
    scene.objects.retain(|o| o.name == "floor" || o.name == "mirror" || o.name == "lamp");
    let solution = solved(scene, 0.5);
    let (reflectors, mut images) = samples(&solution);
    // Colours that say where on the floor a point lies, x and z, and how large it is; nothing else is compared.
    for image in images.sets[0].elements.iter_mut().flatten().map(Arc::make_mut) {
        for pixel in 0..image.triangle.len() as u32 {
            let Point { position, sides, .. } = image.point(pixel);
            let size = if position.y.abs() < 1e-4 { sides[0].length() + sides[1].length() } else { -1.0 };
            image.colour[pixel as usize] = Vec3::new(position.x, size, position.z);
        }
    }
    let camera = solution.scene.camera;
    let lens = Eye::new(&camera, SIZE.x as f32 / SIZE.y as f32);
    let nearest = Nearest { images: &images, selection: Selection::Angle, count: 2 };
    let (found, _) = picture(&solution, &nearest, &reflectors, Splat::Box);
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
    let (reflectors, images) = samples(&solution);
    let set = &images.sets[0];
    let layered: Vec<LayeredImage> = set.elements.iter().map(|e| LayeredImage::new(e)).collect();
    let (points, merged_from): (usize, usize) = layered.iter().fold((0, 0), |(a, b), l| {
        let surfaces = l.points.iter().filter(|p| p.triangle != NOTHING).count();
        (a + surfaces, b + l.merged_from)
    });
    let share = |count| {
        let nearest = Nearest { images: &images, selection: Selection::Angle, count };
        picture(&solution, &nearest, &reflectors, Splat::Box).0.hole_share()
    };
    let (one, four, all) = (share(1), share(4), share(7));
    let layered = [(set.triangle, layered)];
    let (shown, exact) = picture(&solution, &Layered(&layered), &reflectors, Splat::Box);
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
    let (_, mut images) = samples(&before);
    let old = images.clone();
    let mut changed = scene;
    let lamp = changed.materials.iter_mut().find(|m| m.name == "lamp").unwrap();
    lamp.emission *= Vec3::new(0.3, 0.5, 1.5);
    lumenscope_tests::add_point_lamp(&mut changed, Vec3::new(1.5, 2.0, -1.0), Vec3::splat(40.0));
    let after = solved(changed, 0.4);
    images.recolour(&after.world, &diffuse(&shading(&after)));
    let (_, fresh) = samples(&after);
    assert!(images == fresh, "colours read anew differ from a fresh build's");
    assert!(images != old);
}

#[test]
fn the_nearest_samples_are_those_that_look_alike() {
    let solution = solved(floor_and_mirror(), 0.5);
    let (_, images) = samples(&solution);
    let set = &images.sets[0];
    for selection in [Selection::Angle, Selection::Distance] {
        for (number, image) in set.images().enumerate() {
            // A sample is the nearest to its own centre of projection.
            assert!(selection.nearest(set, image.eye, 1).contains(&number), "{selection:?}");
            assert!(std::ptr::eq(set.image(number), image));
        }
        assert_eq!(selection.nearest(set, Vec3::new(-2.0, 1.0, 0.0), 3).len(), 3 * set.elements.len());
    }
}

/// Runs of points, each with its points.
type Runs = Vec<(Run, Vec<Point>)>;

/// What a camera's only view may show of the samples' points, by image.
fn runs<'a>(
    solution: &LightTransportSolution,
    images: &'a MirrorImages,
    camera: &Camera,
    size: UVec2,
) -> (MirroredView, Runs, &'a [Vec<Arc<ImageWithDepth>>]) {
    let geometry = &solution.world.geometry;
    let eye = Eye::new(camera, size.x as f32 / size.y as f32);
    let view = mirrored_views(geometry, &Reflectors::new(geometry), eye, 1)[0];
    let portal = Portal::of_view(&view, Portal::margin(size.to_array()));
    let sight = Sight { eye: &view.eye, portal: &portal, size };
    let of = |image| sight.runs(image).into_iter().map(move |run| (run, run.points(image).collect()));
    (view, images.sets[0].images().flat_map(of).collect(), &images.sets[0].elements)
}

#[test]
fn culling_points_changes_no_pixel() {
    let solution = solved(floor_and_mirror(), 0.4);
    let (_, images) = samples(&solution);
    let camera =
        Camera { eye: Vec3::new(0.8, 0.9, 0.5), target: Vec3::new(0.0, 0.6, 0.2), ..solution.scene.camera };
    // So large that no point is finer than a pixel.
    let size = UVec2::new(480, 360);
    let (view, chosen, elements) = runs(&solution, &images, &camera, size);
    let points: Vec<Point> = chosen.iter().flat_map(|(_, points)| points.iter().copied()).collect();
    let all: Vec<Point> = elements.iter().flatten().flat_map(|image| image.points()).collect();
    let mask = vec![true; (size.x * size.y) as usize];
    let shown = |points: &[Point]| reproject(points, &view.eye, (size, Vec2::splat(0.5)), &mask, Splat::Box);
    let (some, whole) = (shown(&points), shown(&all));
    // Only in the view's rectangle something has to be right.
    let [low, high] = [view.rectangle.low, view.rectangle.high]
        .map(|p| (0.5 * Vec2::new(p.x + 1.0, 1.0 - p.y) * size.as_vec2()).as_uvec2());
    for (y, x) in (high.y..low.y).flat_map(|y| (low.x..high.x).map(move |x| (y, x))) {
        let i = (y * size.x + x) as usize;
        assert_eq!((some.depth[i], some.radiance[i]), (whole.depth[i], whole.radiance[i]), "{x}, {y}");
    }
    println!("{} of {} points, {} runs", points.len(), all.len(), chosen.len());
    assert!(2 * points.len() < all.len() && chosen.iter().all(|(run, _)| run.level == 0));
    assert!((high.y..low.y).len() * (low.x..high.x).len() > 10_000);
}

#[test]
fn points_finer_than_pixels_are_skipped_and_those_left_are_no_wider_than_a_pixel() {
    // Within walls: a square of pixels that see something and nothing is as large as far away.
    let mut scene = floor_and_mirror();
    let walls = cuboid(Vec3::new(-0.5, -0.5, -3.0), Vec3::new(6.0, 4.0, 3.0), true);
    add(&mut scene, "walls", walls, Material::default());
    let solution = solved(scene, 0.5);
    let (_, images) = samples(&solution);
    let size = UVec2::new(40, 30);
    let camera = Camera { eye: Vec3::new(5.5, 2.0, 2.0), target: Vec3::ZERO, ..solution.scene.camera };
    let (view, chosen, _) = runs(&solution, &images, &camera, size);
    let count = |runs: &[(Run, Vec<Point>)]| runs.iter().map(|(_, points)| points.len()).sum::<usize>();
    let drawn = count(&chosen);
    let all = count(&runs(&solution, &images, &camera, 16 * size).1);
    let skipping = chosen.iter().filter(|(run, _)| run.level > 0).flat_map(|(_, points)| points);
    let width =
        |p: &Point| footprint(&view.eye, size, p).map_or(0.0, |(_, half, _)| 2.0 * half.max_element());
    let widest = skipping.map(width).fold(0.0, f32::max);
    println!("{drawn} of {all} points, those that stand for several at most {widest:.2} pixels wide");
    // Both sides of a square widen its box: √2, where it is turned by 45°.
    assert!(3 * drawn < all && widest > 0.25 && widest <= 1.415, "{drawn} of {all}, {widest}");
}

#[test]
fn images_that_do_not_fit_are_refused_in_one_line_and_those_chosen_always_fit() {
    let mut scene = Scene::default();
    let mirror = Material { metallic: 1.0, roughness: 0.0, double_sided: true, ..Material::default() };
    let hall = rectangle(Vec3::ZERO, Vec3::Z * 900.0, Vec3::X * 700.0);
    add(&mut scene, "floor", hall, mirror);
    let world = World::new(&scene);
    let silent = Progress::silent();
    let fine = SampleSettings { element_m: 0.01, resolution: 1024, ..SETTINGS };
    let error = MirrorImages::new(&world, &fine, &silent).unwrap_err();
    assert!(matches!(error, ImagesError::TooLarge { .. }));
    assert!(error.to_string().contains("at most 8.0 GB") && !error.to_string().contains('\n'), "{error}");
    let odd = SampleSettings { resolution: 96, ..SETTINGS };
    assert_eq!(MirrorImages::new(&world, &odd, &silent), Err(ImagesError::Resolution(96)));
    let chosen = MirrorImages::automatic(&world, &silent).unwrap();
    assert!(chosen.bytes() < 120_000_000 && chosen.sets.len() == 2, "{} bytes", chosen.bytes());
}

#[test]
fn both_sides_of_a_double_sided_mirror_have_images() {
    let mut scene = floor_and_mirror();
    scene.materials[1].double_sided = true;
    let floor = rectangle(Vec3::new(-4.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    let green = lumenscope_tests::diffuse("back", Vec3::new(0.1, 0.7, 0.2), Vec3::ZERO);
    add(&mut scene, "back floor", floor, green);
    lumenscope_tests::add_point_lamp(&mut scene, Vec3::new(-1.5, 2.0, 0.3), Vec3::splat(40.0));
    scene.camera.eye.x = -scene.camera.eye.x;
    let solution = solved(scene, 0.3);
    let (reflectors, images) = samples(&solution);
    assert_eq!(images.sets.iter().map(|s| s.back).collect::<Vec<_>>(), [false, true]);
    let nearest = Nearest { images: &images, selection: Selection::Angle, count: 4 };
    let (found, exact) = picture(&solution, &nearest, &reflectors, Splat::Box);
    let mean = |p: &MirrorPicture| p.radiance.iter().sum::<Vec3>() / p.mirrored as f32;
    let (found_mean, wanted) = (mean(&found), mean(&exact));
    println!("{found_mean} for {wanted}, {:.2} % holes", 100.0 * found.hole_share());
    // Without images of the back nothing would be shown: the mean would be black.
    assert!(exact.mirrored > 1_000 && wanted.min_element() > 0.0);
    assert!((found_mean - wanted).abs().max_element() < 0.05 * wanted.max_element());
}
