//! Views of mirrors: the flat reflectors in the scene, and how their materials reflect by angle.

use super::{
    MirrorSettings,
    reflectors::{Reflector, Reflectors},
    views::{Eye, mirrored_views},
};
use crate::{
    inspection::{Curve, InspectionScene, Label, Legend, Line, NamedImage},
    math::image::LinearImage,
    scene::{brdf::Specular, camera::Camera, geometry::Geometry, material::Material},
};
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// Aspect of the picture that views are counted for.
const ASPECT: f32 = 16.0 / 9.0;
/// Width and height of a reflectance map.
const MAP_SIZE: u32 = 65;
/// Reflectance maps shown, at most.
const MOST_MAPS: usize = 8;

/// Outlines of the flat reflectors, those that the camera needs a mirrored view for in orange, and from their
/// middles a line along the normal.
pub fn reflectors(geometry: &Geometry, depth: MirrorSettings, camera: &Camera) -> InspectionScene {
    let found = Reflectors::new(geometry);
    let views = mirrored_views(geometry, &found, Eye::new(camera, ASPECT), depth.depth);
    let mut scene = InspectionScene::default();
    scene.notes.push(format!(
        "{} flat reflectors, {} curved polished triangles; {} mirrored views from the scene's camera, {} deep",
        found.list.len(),
        found.curved,
        views.len(),
        views.last().map_or(0, |v| v.depth),
    ));
    for (i, reflector) in found.list.iter().enumerate() {
        let seen = views.iter().filter(|v| v.reflector == i as u32).count();
        let colour = if seen > 0 { Vec3::new(1.0, 0.35, 0.05) } else { Vec3::new(0.1, 0.5, 0.8) };
        for ends in outline(geometry, reflector) {
            scene.lines.push(Line { ends, colour });
        }
        let (middle, reach) = middle(geometry, reflector);
        scene.lines.push(Line { ends: [middle, middle + reflector.normal * (0.3 * reach)], colour });
        let material = &geometry.materials[reflector.material as usize].name;
        scene.labels.push(Label {
            position: middle + reflector.normal * (0.3 * reach),
            text: format!("{material}: {seen} views"),
            strong: true,
        });
    }
    scene
}

/// Edges that only one triangle of a reflector has.
fn outline(geometry: &Geometry, reflector: &Reflector) -> Vec<[Vec3; 2]> {
    let mut edges: BTreeMap<[[u32; 3]; 2], (u32, [Vec3; 2])> = BTreeMap::new();
    for &t in &reflector.triangles {
        let corners = geometry.positions[t as usize];
        for i in 0..3 {
            let ends = [corners[i], corners[(i + 1) % 3]];
            let mut key = ends.map(|p| p.to_array().map(f32::to_bits));
            key.sort_unstable();
            edges.entry(key).or_insert((0, ends)).0 += 1;
        }
    }
    edges.into_values().filter(|(count, _)| *count == 1).map(|(_, ends)| ends).collect()
}

/// Middle of a reflector and the root of its area.
fn middle(geometry: &Geometry, reflector: &Reflector) -> (Vec3, f32) {
    let corners = reflector.triangles.iter().flat_map(|&t| geometry.positions[t as usize]);
    let sum: Vec3 = corners.sum();
    (sum / (3 * reflector.triangles.len()) as f32, reflector.area.sqrt())
}

/// The reflectance of every polished material by angle: a map over the disc of normals that a sphere shows
/// (Bastos 1999, Fig. 6.23), and its red, green and blue over the angle to the normal.
///
/// `None` where nothing is polished.
pub fn reflectance(geometry: &Geometry) -> Option<InspectionScene> {
    let mut scene = InspectionScene {
        legend: Some(Legend {
            quantity: "reflectance".into(),
            unit: "1".into(),
            range: [0.0, 1.0],
            names: &[],
        }),
        ..InspectionScene::default()
    };
    for material in geometry.materials.iter().filter(|m| m.is_specular()).take(MOST_MAPS) {
        if let Some(specular) = lobe(material) {
            add_reflectance(&mut scene, &material.name, &specular);
        }
    }
    (!scene.images.is_empty()).then_some(scene)
}

/// Puts the map of a lobe into a view, its red, green and blue over the angle, and some of its values in words.
pub fn add_reflectance(scene: &mut InspectionScene, name: &str, specular: &Specular) {
    scene.images.push(NamedImage { name: name.to_owned(), image: map(specular) });
    for (channel, colour) in ["red", "green", "blue"].into_iter().enumerate() {
        scene.curves.push(Curve {
            name: format!("{name}, {colour}"),
            axes: ["angle to the normal, °".into(), "reflectance F".into()],
            points: (0..=90)
                .map(|degrees| {
                    let cos_theta = (degrees as f32).to_radians().cos().max(0.0);
                    Vec2::new(degrees as f32, specular.reflectance(cos_theta)[channel])
                })
                .collect(),
            radial: false,
        });
    }
    scene.notes.push(format!(
        "{name}: {:.3} at normal incidence, {:.3} at 60°, {:.3} at 80°",
        specular.reflectance(1.0),
        specular.reflectance(0.5),
        specular.reflectance(80f32.to_radians().cos())
    ));
}

/// The lobe of a material without its texture.
fn lobe(material: &Material) -> Option<Specular> {
    let plain = Material { reflectance_texture: None, ..material.clone() };
    plain.brdf_at(Vec2::ZERO, &[]).specular
}

/// Reflectance at a radius of the map: there the normal makes the angle arcsin r with the view.
fn at_radius(specular: &Specular, radius: f32) -> Vec3 {
    specular.reflectance((1.0 - radius * radius).max(0.0).sqrt())
}

/// Reflectance over the disc of normals; black around it.
pub fn map(specular: &Specular) -> LinearImage {
    LinearImage::from_fn(MAP_SIZE, MAP_SIZE, |x, y| {
        let half = 0.5 * (MAP_SIZE - 1) as f32;
        let at = (Vec2::new(x as f32, y as f32) - half) / half;
        if at.length() > 1.0 { Vec3::ZERO } else { at_radius(specular, at.length()) }
    })
}
