//! Surfaces and lamps that a volume leaves out as sources of light.
//!
//! A ray that meets an ignored surface brings nothing (Greger 1996, §5.4); it is not traced on through
//! it, and shadows and light that other surfaces have from it stay. So the difference between a volume
//! and the same one ignoring a surface is the light that comes to the air straight from that surface.

use crate::scene::{Scene, Target, emitters::Emitter, geometry::Geometry};
use std::collections::BTreeSet;

/// What is left out.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Ignored {
    /// Objects: indices into the scene's.
    pub objects: BTreeSet<u32>,
    /// Materials, wherever they are used: indices into the scene's.
    pub materials: BTreeSet<u32>,
    /// Lamps without a surface: indices into the scene's.
    pub lamps: BTreeSet<u32>,
}

impl Ignored {
    /// These objects and lamps.
    pub fn of(targets: impl IntoIterator<Item = Target>) -> Self {
        let mut ignored = Self::default();
        for target in targets {
            match target {
                Target::Object(i) => ignored.objects.insert(i as u32),
                Target::Lamp(i) => ignored.lamps.insert(i as u32),
            };
        }
        ignored
    }

    /// What has a name in a scene: objects, lamps and materials, all that have it; and the first name that
    /// nothing has.
    pub fn named(scene: &Scene, names: &[String]) -> (Self, Option<String>) {
        fn of<'a>(names: impl Iterator<Item = &'a str>, wanted: &str) -> Vec<u32> {
            names.enumerate().filter(|(_, name)| *name == wanted).map(|(i, _)| i as u32).collect()
        }
        let (mut ignored, mut unknown) = (Self::default(), None);
        for name in names {
            let objects = of(scene.objects.iter().map(|o| o.name.as_str()), name);
            let lamps = of(scene.lamps.iter().map(|l| l.name.as_str()), name);
            let materials = of(scene.materials.iter().map(|m| m.name.as_str()), name);
            if objects.is_empty() && lamps.is_empty() && materials.is_empty() {
                unknown.get_or_insert_with(|| name.clone());
            }
            ignored.objects.extend(objects);
            ignored.lamps.extend(lamps);
            ignored.materials.extend(materials);
        }
        (ignored, unknown)
    }

    /// Whether nothing is ignored.
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty() && self.materials.is_empty() && self.lamps.is_empty()
    }

    /// Whether a triangle is.
    pub fn holds_triangle(&self, geometry: &Geometry, triangle: u32) -> bool {
        let t = triangle as usize;
        self.objects.contains(&geometry.object[t]) || self.materials.contains(&geometry.material[t])
    }

    /// Whether an emitter is.
    pub fn holds_emitter(&self, geometry: &Geometry, emitter: &Emitter) -> bool {
        match emitter {
            Emitter::Lamp { index, .. } => self.lamps.contains(&(*index as u32)),
            Emitter::Area(area) => area.triangles.first().is_some_and(|&t| self.holds_triangle(geometry, t)),
        }
    }
}
