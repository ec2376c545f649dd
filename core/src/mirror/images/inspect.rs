//! Where a scene's reflectors are sampled, and what their samples show from its camera.

use super::{
    pass::{Nearest, diffuse, from_points, reflector_of_pixels},
    reproject::Splat,
    sample::{ReflectorImages, SampleSettings},
    select::Selection,
};
use crate::{
    inspection::{InspectionScene, Label, Line, NamedImage},
    math::image::LinearImage,
    mirror::reflectors::{NO_REFLECTOR, Reflectors},
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
    transport::LightTransportSolution,
};
use glam::{UVec2, Vec2, Vec3};

/// Size of the picture shown, pixels.
const SIZE: UVec2 = UVec2::new(320, 200);
/// Coarse, for a glance; the command line samples as finely as it is told.
const SETTINGS: SampleSettings = SampleSettings { element_m: 1.5, poses: 6, radius_m: 1.6, resolution: 64 };
/// Samples an element that are shown.
const NEAREST: usize = 2;
/// Colour of holes.
pub const HOLE: Vec3 = Vec3::new(1.0, 0.0, 1.0);

/// Centres of projection of the samples behind every reflector that the scene's camera sees, with the
/// pyramids of the two nearest to the mirrored eye; beside the scene what those two show, holes in magenta.
///
/// `None` where the camera sees no flat reflector.
pub fn images(solution: &LightTransportSolution) -> Option<InspectionScene> {
    let (world, camera) = (&solution.world, &solution.scene.camera);
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let shading = Shading::new(solution, &settings);
    let radiance = diffuse(&shading);
    let reflectors = Reflectors::new(&world.geometry);
    let buffer = GBuffer::new(world, camera, SIZE, Vec2::splat(0.5));
    let of_pixels = reflector_of_pixels(&reflectors, &buffer, camera.eye);
    let mut scene = InspectionScene::default();
    let mut sets = Vec::new();
    for (number, reflector) in reflectors.list.iter().enumerate() {
        if !of_pixels.contains(&(number as u32)) {
            continue;
        }
        let set = ReflectorImages::new((world, &radiance), number as u32, reflector, &SETTINGS);
        let eye = reflector.mirror_point(camera.eye);
        let nearest = Selection::Angle.nearest(&set, eye, NEAREST);
        for image in set.images() {
            let chosen = nearest.iter().any(|n| std::ptr::eq(*n, image));
            let colour = if chosen { Vec3::new(1.0, 0.35, 0.05) } else { Vec3::new(0.1, 0.5, 0.8) };
            let tick = 0.02 * SETTINGS.radius_m;
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                let ends = [image.eye - axis * tick, image.eye + axis * tick];
                scene.lines.push(Line { ends, colour });
            }
            let corners = [
                image.corner,
                image.corner + image.edge_u,
                image.corner + image.edge_u + image.edge_v,
                image.corner + image.edge_v,
            ];
            for (i, &corner) in corners.iter().enumerate() {
                scene.lines.push(Line { ends: [corner, corners[(i + 1) % 4]], colour });
                if chosen {
                    scene.lines.push(Line { ends: [image.eye, corner], colour });
                }
            }
        }
        let name = &world.geometry.materials[reflector.material as usize].name;
        let count = set.elements.len();
        let text = format!(
            "{name}: {count} hemispheres of {} images, {:.2} MB",
            SETTINGS.poses,
            set.bytes() as f64 * 1e-6
        );
        if let Some(image) = set.images().next() {
            scene.labels.push(Label { position: image.middle(), text: text.clone(), strong: false });
        }
        scene.notes.push(text);
        sets.push(set);
    }
    if sets.is_empty() {
        return None;
    }
    let points = Nearest { sets: &sets, selection: Selection::Angle, count: NEAREST };
    let picture = from_points(&points, &reflectors, &of_pixels, (camera, SIZE), Splat::Box);
    let brightest = picture.radiance.iter().map(|r| r.max_element()).fold(1e-6, f32::max).min(2000.0);
    let shown = LinearImage::from_fn(SIZE.x, SIZE.y, |x, y| {
        let i = (y * SIZE.x + x) as usize;
        if of_pixels[i] == NO_REFLECTOR {
            Vec3::splat(0.02)
        } else if picture.hole[i] {
            HOLE
        } else {
            4.0 * picture.radiance[i] / brightest
        }
    });
    scene
        .images
        .push(NamedImage { name: "mirrored by images-with-depth, holes in magenta".into(), image: shown });
    scene.notes.push(format!(
        "{} points in {} pixels of mirrors; {:.1} % are holes",
        picture.points,
        picture.mirrored,
        100.0 * picture.hole_share()
    ));
    Some(scene)
}
