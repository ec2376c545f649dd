//! Where a scene's reflectors are sampled, and what their samples show from its camera.

use super::{
    elements::SampleSettings,
    pass::{Frame, Nearest},
    select::Selection,
    sets::MirrorImages,
};
use crate::{
    inspection::{InspectionScene, Label, Line, NamedImage},
    math::{image::LinearImage, progress::Progress},
    mirror::{IMAGES, MirrorSettings, reflectors::Reflectors},
    superposition::{PassSettings, composite::DirectQuality, gbuffer::GBuffer, pass::Shading},
    transport::LightTransportSolution,
};
use glam::{UVec2, Vec2, Vec3};
use std::borrow::Cow;

/// Size of the picture shown, pixels.
const SIZE: UVec2 = UVec2::new(320, 200);
/// Coarse, for a glance, where the plan takes none.
const SETTINGS: SampleSettings = SampleSettings { element_m: 1.5, poses: 6, radius_m: 1.6, resolution: 64 };
/// Colour of holes.
pub const HOLE: Vec3 = Vec3::new(1.0, 0.0, 1.0);

/// Centres of projection of the samples behind every reflector that the scene's camera sees, with the
/// pyramids of those nearest to the mirrored eye; beside the scene what these show, holes in magenta.
/// The samples are those that mirrors are shown from, or where the plan has none coarse ones.
///
/// `None` where the camera sees no flat reflector, or so much is flat that the samples would not fit.
pub fn images(solution: &LightTransportSolution) -> Option<InspectionScene> {
    let (world, camera) = (&solution.world, &solution.scene.camera);
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let shading = Shading::new(solution, &settings);
    let reflectors = Reflectors::new(&world.geometry);
    let buffer = GBuffer::new(world, camera, SIZE, Vec2::splat(0.5));
    let frame = Frame::new(world, &reflectors, &buffer, camera);
    if frame.of_pixels.iter().all(|v| *v == 0) {
        return None;
    }
    let held = solution.mirror_images.as_deref().filter(|images| images.hold(&world.geometry));
    let images: Cow<MirrorImages> = match held {
        Some(images) => Cow::Borrowed(images),
        None => Cow::Owned(MirrorImages::new(world, &SETTINGS, &Progress::silent()).ok()?),
    };
    let planned = MirrorSettings::of(&solution.scene.plan).images;
    let count = planned.unwrap_or(IMAGES) as usize;
    let mut scene = InspectionScene::default();
    for view in &frame.views {
        let reflector = &reflectors.list[view.reflector as usize];
        let Some(set) = images.of(reflector, view.eye.position) else { continue };
        let nearest = Selection::Angle.nearest(set, view.eye.position, count);
        for (number, image) in set.images().enumerate() {
            let chosen = nearest.contains(&number);
            let colour = if chosen { Vec3::new(1.0, 0.35, 0.05) } else { Vec3::new(0.1, 0.5, 0.8) };
            let tick = 0.02 * set.settings.radius_m;
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
        let text = format!(
            "{name}: {} hemispheres of {} images of {}×{2}, {:.2} MB",
            set.elements.len(),
            set.settings.poses,
            set.settings.resolution,
            set.bytes() as f64 * 1e-6
        );
        if let Some(image) = set.images().next() {
            scene.labels.push(Label { position: image.middle(), text: text.clone(), strong: false });
        }
        scene.notes.push(text);
    }
    if images.rays < images.points() {
        scene.notes.push(format!(
            "{} of {} rays were traced anew for what has moved, {:.2} %",
            images.rays,
            images.points(),
            100.0 * images.rays as f64 / images.points() as f64
        ));
    }
    let points = Nearest { images: &images, selection: Selection::Angle, count };
    let picture = frame.from_ids(&points, &shading);
    let brightest = picture.radiance.iter().map(|r| r.max_element()).fold(1e-6, f32::max).min(2000.0);
    let shown = LinearImage::from_fn(SIZE.x, SIZE.y, |x, y| {
        let i = (y * SIZE.x + x) as usize;
        if frame.of_pixels[i] == 0 {
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
        "{} points in {} pixels of mirrors; {} of these are holes, {:.1} %",
        picture.points,
        picture.mirrored,
        picture.holes(),
        100.0 * picture.hole_share()
    ));
    Some(scene)
}
