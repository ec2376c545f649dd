//! A probe as OpenEXR: the sphere as a map that any viewer shows, and the bins it is made of.
//!
//! Two parts. `latitude_longitude` is an environment map by OpenEXR's convention, its `R`, `G`, `B` the
//! radiance. `direction_bins` holds each bin exactly once: the upper hemisphere's square on the left, the
//! lower one's on the right. The layers of both are `radiance_all_cd_per_m2`, `irradiance_direct_lx` and so
//! on, those of moments `moment_4_all_lx`; attributes say the position, the mapping and the measure.

use super::{
    IoError,
    exr::{Part as ExrPart, write_parts},
};
use crate::{
    irradiance_volume::{
        moments::Order,
        probe::{Probe, Quantity},
    },
    math::{image::LinearImage, part::Part, sphere_values::SphereValues},
};
use glam::Vec3;
use std::path::Path;

/// Rows of the map for each row of bins: a bin is at least three pixels wide at the equator.
const ROWS_A_BIN: u32 = 6;

/// Quantities and parts in a file, with the names of their layers.
pub const LAYERS: [(&str, Quantity, Part); 6] = [
    ("radiance_all_cd_per_m2", Quantity::Radiance, Part::All),
    ("radiance_direct_cd_per_m2", Quantity::Radiance, Part::Direct),
    ("radiance_indirect_cd_per_m2", Quantity::Radiance, Part::Indirect),
    ("irradiance_all_lx", Quantity::Irradiance, Part::All),
    ("irradiance_direct_lx", Quantity::Irradiance, Part::Direct),
    ("irradiance_indirect_lx", Quantity::Irradiance, Part::Indirect),
];

/// Parts of a moment that a file holds, with their names.
const PARTS: [(&str, Part); 3] = [("all", Part::All), ("direct", Part::Direct), ("indirect", Part::Indirect)];

/// Writes a probe and its moments of these orders; `smooth` interpolates the map between bins, the bins
/// themselves stay.
///
/// # Errors
/// [`IoError::Write`] naming the file and the cause.
pub fn write_probe(path: &Path, probe: &Probe, orders: &[Order], smooth: bool) -> Result<(), IoError> {
    let (n, [x, y, z]) = (probe.bins.n(), probe.position.to_array());
    let mut spheres: Vec<(String, Vec<Vec3>)> = LAYERS
        .iter()
        .map(|&(name, quantity, part)| (name.to_owned(), probe.values(quantity, part)))
        .collect();
    for &order in orders {
        spheres.extend(PARTS.map(|(name, part)| {
            (format!("moment_{}_{name}_lx", String::from(order)), probe.moment(order, part))
        }));
    }
    let images = |draw: &dyn Fn(SphereValues<'_>) -> LinearImage| -> Vec<(&str, LinearImage)> {
        let image = |values: &Vec<Vec3>| draw(SphereValues { bins: probe.bins, values });
        spheres.iter().map(|(name, values)| (name.as_str(), image(values))).collect()
    };
    let bins = images(&|sphere| sphere.unfolded());
    let maps = images(&|sphere| sphere.map((ROWS_A_BIN * n).max(90), smooth));
    let common = |mapping: String| {
        [
            ("position", format!("{x} {y} {z} m")),
            (
                "quantities",
                "radiance L(w) in cd/m2 from direction w; irradiance E(n) in lx of a plane facing n, \
              E(n) = integral of L(w) max(0, n.w) dw; lamps without a surface only in E; moment of order k in lx, \
              H(w) = (k + 1)/2 integral of L(v) max(0, w.v)^k dv"
                    .into(),
            ),
            ("colour", "linear RGB, Rec. 709 primaries; luminance 0.2126 R + 0.7152 G + 0.0722 B".into()),
            ("directionBins", format!("{} bins of {} sr", probe.bins.len(), probe.bins.solid_angle())),
            ("mapping", mapping),
        ]
    };
    let on_map =
        common("latitude-longitude: +y on top, +z in the middle, +x in the middle of the left half".into());
    let on_squares = common(format!(
        "two squares of {n} x {n} bins, upper (+y) hemisphere left, lower right; u = +x to the right, v = +z down; \
         Shirley-Chiu concentric map to the disc, lifted by |y| = 1 - r^2: bins of equal solid angle"
    ));
    let mut map_layers: Vec<(&str, &LinearImage)> = vec![("", &maps[0].1)];
    map_layers.extend(maps.iter().map(|(name, image)| (*name, image)));
    let bin_layers: Vec<(&str, &LinearImage)> = bins.iter().map(|(name, image)| (*name, image)).collect();
    let parts = [
        ExrPart {
            name: "latitude_longitude",
            layers: &map_layers,
            note: "light at one point by direction, as an environment map; R, G, B are its radiance in cd/m2",
            attributes: &on_map,
            is_environment: true,
        },
        ExrPart {
            name: "direction_bins",
            layers: &bin_layers,
            note: "light at one point by direction, one pixel a bin",
            attributes: &on_squares,
            is_environment: false,
        },
    ];
    write_parts(path, &parts)
}
