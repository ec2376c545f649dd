//! The irradiance sphere at one point as two volumes have it, side by side, and how far they are apart.

use super::{
    sphere_image::{ImageSlot, SphereValues, key},
    sphere_pair::{self, Ball, Look, Turn},
    value_table::{self, Row},
};
use crate::session::NamedVolume;
use egui::Ui;
use glam::Vec3;
use lumenscope_core::{irradiance_volume::IrradianceVolume, math::part::Part};
use std::sync::Arc;

const MEANING: &str = "Irradiance of a plane facing each direction here, interpolated from this volume, lx";
const APART: &str = "Root mean square difference over all directions, as a share of the mean; by rays: the sphere \
                     above, sampled at the point itself";

/// What is remembered between frames.
#[derive(Clone, Default)]
pub struct Memory {
    slots: [ImageSlot; 2],
    /// Held, so that no other volume gets the address of one of them.
    volumes: Option<[Arc<IrradianceVolume>; 2]>,
    asked: u64,
    found: [Arc<[Vec3]>; 2],
}

/// Where the spheres are, and how they look.
pub struct Asked<'a> {
    /// The point, m.
    pub position: Vec3,
    /// Part of the light.
    pub part: Part,
    /// Changes when the light does.
    pub light_key: u64,
    /// The sphere found by rays at the point itself.
    pub traced: SphereValues<'a>,
    /// How the balls are drawn.
    pub look: Look<'a>,
    /// From irradiance to display colour, sRGB.
    pub colour: &'a dyn Fn(Vec3) -> [u8; 3],
}

/// Shows A and B, and what they differ.
pub fn show(
    ui: &mut Ui,
    memory: &mut Memory,
    turn: &mut Turn,
    [a, b]: [NamedVolume<'_>; 2],
    asked: &Asked<'_>,
) {
    let volumes = [a.volume, b.volume];
    let light = (asked.position.to_array().map(f32::to_bits), asked.part, asked.light_key);
    let addresses = volumes.map(|v| Arc::as_ptr(v) as usize);
    let wanted = key((addresses, light));
    if memory.asked != wanted {
        memory.volumes = Some(volumes.map(Arc::clone));
        memory.asked = wanted;
        memory.found = volumes.map(|volume| {
            let bins = volume.bins();
            (0..bins.len()).map(|i| volume.irradiance(asked.position, bins.centre(i), asked.part)).collect()
        });
    }
    let Memory { slots, found: [of_a, of_b], .. } = memory;
    let [of_a, of_b] =
        [(a, &*of_a), (b, &*of_b)].map(|(named, values)| SphereValues { bins: named.volume.bins(), values });
    let ball = |title, values| Ball { title, meaning: MEANING, values, unit: "lx", colour: asked.colour };
    let look = Look { picture_key: key((asked.look.picture_key, wanted)), ..asked.look };
    let titles = [a, b].map(|named| named.name);
    sphere_pair::show(ui, slots, turn, look, [ball(titles[0], of_a), ball(titles[1], of_b)]);
    let apart = |name, of: &SphereValues<'_>, from: &SphereValues<'_>| {
        Row::one(name, 100.0 * of.relative_difference(from), "%", APART)
    };
    let rows = [
        apart("A from B", &of_a, &of_b),
        apart("A from rays", &of_a, &asked.traced),
        apart("B from rays", &of_b, &asked.traced),
    ];
    value_table::show(ui, "two volumes", &rows);
}
