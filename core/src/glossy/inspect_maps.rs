//! Maps of the light around reflectors, as pictures; and in the scene what the first holds, where it holds it to be.

use super::environment::{Environment, Environments, MapOwner};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Label, Legend, NamedImage},
    irradiance_volume::panorama::direction,
    math::{colour::luminance, image::LinearImage},
    scene::{Scene, geometry::Geometry},
};
use glam::{Vec2, Vec3};

/// Maps that are shown as pictures, at most.
const MOST_SHOWN: usize = 6;

/// Columns and rows of the shell in the scene.
const SHELL: [u32; 2] = [96, 48];

/// Distances of neighbours whose ratio is beyond this are not joined: something stands in front there.
const TORN: f32 = 1.3;

/// The maps of a scene: each as a picture, its middle named, and of the largest the radiance at the distance that it
/// knows; `None` where there is none.
pub fn maps(scene: &Scene, geometry: &Geometry, environments: &Environments) -> Option<InspectionScene> {
    let first = environments.list.first()?;
    let name = |map: &Environment| {
        let object = match map.of {
            MapOwner::Curved { object, .. } => object,
            MapOwner::Flat { triangle } => geometry.object[triangle as usize],
        };
        scene.objects.get(object as usize).map_or("reflector", |o| o.name.as_str()).to_owned()
    };
    let mut out = InspectionScene { meshes: vec![shell(first)], ..InspectionScene::default() };
    for map in environments.list.iter().take(MOST_SHOWN) {
        let [width, height] = map.size;
        let pixels = map.texels.iter().map(|t| t.truncate()).collect();
        out.images.push(NamedImage { name: name(map), image: LinearImage { width, height, pixels } });
        out.labels.push(Label { position: map.centre, text: name(map), strong: false });
    }
    let mut values: Vec<f32> = out.meshes[0].values.iter().map(|v| luminance(*v)).collect();
    values.sort_by(f32::total_cmp);
    // A lamp is many times as bright as all that it lights.
    let high = values.get(values.len() * 9 / 10).copied().unwrap_or(1.0).max(f32::MIN_POSITIVE);
    out.legend = Some(Legend {
        quantity: format!("radiance that the map of {} holds", name(first)),
        unit: "cd/m²".into(),
        range: [0.0, high],
        names: &[],
    });
    out.notes.push(format!(
        "{} maps of the light around reflectors, {} texels; the largest from {:.2}, {:.2}, {:.2} m",
        environments.list.len(),
        environments.list.iter().map(|m| m.texels.len()).sum::<usize>(),
        first.centre.x,
        first.centre.y,
        first.centre.z
    ));
    Some(out)
}

/// What a map holds, where it holds it to be: each direction's radiance at its distance.
fn shell(map: &Environment) -> ColouredMesh {
    let [across, down] = SHELL;
    let mut mesh = ColouredMesh::default();
    let mut distances = Vec::new();
    for row in 0..=down {
        for column in 0..=across {
            let along = direction(Vec2::new(column as f32 / across as f32, row as f32 / down as f32));
            let texel = map.towards(along);
            mesh.positions.push(map.centre + along * (0.995 * texel.w));
            mesh.values.push(texel.truncate());
            distances.push(texel.w);
        }
    }
    for row in 0..down {
        for column in 0..across {
            let a = row * (across + 1) + column;
            let [b, c, d] = [a + 1, a + across + 1, a + across + 2];
            let around = [a, b, c, d].map(|i| distances[i as usize]);
            let (near, far) = around.into_iter().fold((f32::MAX, 0.0f32), |(l, h), t| (l.min(t), h.max(t)));
            if far < TORN * near && mesh.values[a as usize] != Vec3::ZERO {
                mesh.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
    }
    mesh
}
