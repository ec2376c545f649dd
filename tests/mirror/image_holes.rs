//! Holes of images-with-depth: counted as they are shown, and there for a reason.

use crate::planar::floor_and_mirror;
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    math::progress::Progress,
    mirror::{
        MirrorMethod,
        images::{
            ImageWithDepth, MirrorImages, Selection, Splat,
            inspect::{HOLE, images},
            pass::{Frame, Nearest},
        },
        pass::mirror_image,
        reflectors::Reflectors,
    },
    scene::{accel::Ray, geometry::offset_origin, material::Material, world::World},
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
    transport::LightTransportSolution,
};
use lumenscope_tests::{add, cuboid, solved};
use std::sync::Arc;

/// The floor, its mirror and the block within walls, shown from as many images an element.
fn shown_from(count: u32) -> LightTransportSolution {
    let mut scene = floor_and_mirror();
    let walls = cuboid(Vec3::new(-0.5, -0.5, -3.0), Vec3::new(6.0, 4.0, 3.0), true);
    add(&mut scene, "walls", walls, Material::default());
    // Close to the mirror: what it hides is another from every eye.
    let post = cuboid(Vec3::new(0.3, 0.001, 0.5), Vec3::new(0.5, 1.6, 0.7), false);
    add(&mut scene, "post", post, Material::default());
    scene.plan.mirrors = Some(MirrorMethod::Images);
    scene.plan.mirror_images = Some(count);
    let solution = solved(scene, 0.5);
    let images = MirrorImages::automatic(&solution.world, &Progress::silent()).unwrap();
    LightTransportSolution { mirror_images: Some(Arc::new(images)), ..solution }
}

/// The number before some words.
fn before(note: &str, words: &str) -> usize {
    let ahead = note.split(words).next().unwrap();
    ahead.split_whitespace().last().unwrap().parse().unwrap()
}

#[test]
fn as_many_holes_are_counted_as_are_shown() {
    let mut counts = Vec::new();
    for count in [1, 2, 12] {
        let solution = shown_from(count);
        let view = images(&solution).unwrap();
        let picture = &view.images[0].image;
        let shown = picture.pixels.iter().filter(|p| **p == HOLE).count();
        let note = view.notes.last().unwrap();
        let (counted, mirrored) = (before(note, " of these"), before(note, " pixels"));
        assert_eq!(counted, shown, "{note}");
        let share = format!("are holes, {:.1} %", 100.0 * shown as f64 / mirrored as f64);
        assert!(note.ends_with(&share), "{note}");

        // Pictures count the same, and show what reflects as if dull there.
        let size = UVec2::new(picture.width, picture.height);
        let (camera, settings) = (
            &solution.scene.camera,
            PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() },
        );
        let buffer = GBuffer::new(&solution.world, camera, size, Vec2::splat(0.5));
        let reflectors = Reflectors::new(&solution.world.geometry);
        let shading = Shading::new(&solution, &settings);
        let mirrored = mirror_image(&shading, &reflectors, &buffer, camera, &settings).unwrap();
        assert_eq!(mirrored.holes, shown);
        println!("{note}");
        counts.push(shown);
    }
    assert!(counts[0] > 100 && counts.is_sorted_by(|a, b| a > b), "{counts:?}");
}

/// Whether a place is seen from an image's centre of projection through its element.
fn sees(world: &World, image: &ImageWithDepth, place: Vec3) -> bool {
    let normal = image.edge_u.cross(image.edge_v).normalize();
    let out = place - image.eye;
    let crossing = image.eye + out * (normal.dot(image.corner - image.eye) / normal.dot(out));
    let along = |edge: Vec3| (crossing - image.corner).dot(edge) / edge.length_squared();
    let inside = |c: f32| (0.0..=1.0).contains(&c);
    let towards = if normal.dot(out) < 0.0 { -normal } else { normal };
    let way = Ray::between(offset_origin(crossing, towards), crossing + 0.999 * (place - crossing));
    inside(along(image.edge_u)) && inside(along(image.edge_v)) && !world.accel.occluded(&way)
}

/// Pixels that a point's square reaches beyond the place it was seen at: here it is about as wide as a pixel.
const REACH: i32 = 2;

#[test]
fn holes_are_what_none_of_the_chosen_images_has_seen() {
    let solution = shown_from(1);
    let (world, camera) = (&solution.world, &solution.scene.camera);
    let size = UVec2::new(160, 120);
    let buffer = GBuffer::new(world, camera, size, Vec2::splat(0.5));
    let reflectors = Reflectors::new(&world.geometry);
    let frame = Frame::new(world, &reflectors, &buffer, camera);
    let images = solution.mirror_images.as_ref().unwrap();
    let nearest = Nearest { images, selection: Selection::Angle, count: 1 };
    let hole = frame.from_points(&nearest, Splat::Box).hole;
    // What a pixel of a mirror shows, with the direction it is seen along.
    let shown = |pixel: usize| {
        let view = &frame.views[(frame.of_pixels[pixel] as usize).checked_sub(1)?];
        let reflector = &reflectors.list[view.reflector as usize];
        let along = reflector.mirror_direction((buffer.position[pixel] - camera.eye).normalize());
        let origin = offset_origin(buffer.position[pixel], view.clip_normal);
        let hit = world.accel.trace(&Ray::new(origin, along))?;
        let set = images.of(reflector, view.eye.position)?;
        let chosen = Selection::Angle.nearest(set, view.eye.position, 1);
        let chosen: Vec<&ImageWithDepth> = chosen.into_iter().map(|number| set.image(number)).collect();
        Some((world.geometry.surface(hit.triangle, hit.barycentric, along), along, chosen))
    };
    let was_seen = |pixel: usize| {
        let (surface, _, chosen) = shown(pixel)?;
        Some(chosen.into_iter().any(|image| sees(world, image, surface.position)))
    };
    let seen: Vec<Option<bool>> = (0..hole.len()).map(was_seen).collect();
    // Squares that face their sample leave cracks where the eye sees a surface less slanted than the sample does.
    let is_crack = |pixel: usize| {
        shown(pixel).is_some_and(|(surface, along, chosen)| {
            let cosine = |along: Vec3| -surface.geometric_normal.dot(along);
            let slanted =
                |i: &&ImageWithDepth| cosine((surface.position - i.eye).normalize()) < cosine(along);
            chosen.iter().filter(|image| sees(world, image, surface.position)).all(slanted)
        })
    };
    let near = |pixel: usize, wanted: bool| {
        let (x, y) = (pixel as i32 % size.x as i32, pixel as i32 / size.x as i32);
        let inside = |x: i32, y: i32| (0..size.x as i32).contains(&x) && (0..size.y as i32).contains(&y);
        let around = (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| (x + dx, y + dy)));
        around
            .into_iter()
            .any(|(x, y)| inside(x, y) && seen[(y * size.x as i32 + x) as usize] == Some(wanted))
    };
    let (mut holes, mut unseen, mut cracks) = (0, 0, 0);
    for (pixel, &was_seen) in seen.iter().enumerate().filter(|(_, s)| s.is_some()) {
        let at = UVec2::new(pixel as u32 % size.x, pixel as u32 / size.x);
        if hole[pixel] && !near(pixel, false) {
            assert!(is_crack(pixel), "a hole at {at} where all was seen");
            cracks += 1;
        }
        assert!(hole[pixel] || near(pixel, true), "no hole at {at} where nothing was seen");
        holes += usize::from(hole[pixel]);
        unseen += usize::from(was_seen == Some(false));
    }
    println!("{holes} holes, {cracks} of them cracks; {unseen} pixels show what was not seen");
    assert!(unseen > 100 && 10 * cracks < holes, "{unseen} {cracks} {holes}");
}
