//! What the volume and a probe show: spheres, grid lines, curves and maps, as pure data.

use super::{
    IrradianceVolume, SurfaceLight,
    cache::SeenLight,
    difference::Difference,
    grid::NONE,
    moments::Order,
    probe::{Probe, Quantity},
    slice::{bulk, compared, histogram, notes, signed_legend},
    trust::{SampleState, seen},
};
use crate::{
    inspection::{InspectionScene, Legend, SphereGlyph, ValueLine, robust_range},
    math::{colour::luminance, part::Part, sphere_map::DirectionBins},
    scene::world::World,
};
use glam::{UVec3, Vec3};

/// Size of a valid sample's sphere beside those of others, where validity is shown.
const VALID_SIZE: f32 = 0.35;

/// Share of the picture that shows through the lines of whole grids.
const FAINT: f32 = 0.6;

/// What the colour of a sample's sphere stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColourBy {
    /// Its light, direction by direction.
    #[default]
    Light,
    /// Its illuminance, mean over all directions, lx.
    Luminance,
    /// Its state: its place in [`SampleState::ALL`].
    Validity,
    /// How often its light changed since its rays were traced.
    Age,
    /// Distance to the nearest surface its rays see, m.
    Distance,
    /// How far its irradiance is from that of the volume it is compared with, direction by direction:
    /// |A − B| / max(B, 5 % of its mean), %.
    Error,
}

impl ColourBy {
    /// Every choice.
    pub const ALL: [Self; 6] =
        [Self::Light, Self::Luminance, Self::Validity, Self::Age, Self::Distance, Self::Error];

    /// Name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Luminance => "luminance",
            Self::Validity => "validity",
            Self::Age => "age",
            Self::Distance => "distance",
            Self::Error => "error",
        }
    }
}

/// Which samples are shown, and how.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct VolumeView {
    /// What the spheres are coloured by.
    pub colour_by: ColourBy,
    /// Radiance or irradiance.
    pub quantity: Quantity,
    /// Order of the moment shown as irradiance; orders the volume does not hold show order 1.
    pub moment: Order,
    /// Part of the light.
    pub part: Part,
    /// Samples of the first-level grid.
    pub first_level: bool,
    /// Samples of the second-level grids alone, and those in pockets.
    pub second_level: bool,
    /// Samples inside solids too.
    pub invalid: bool,
    /// Radius of a sphere as a share of the smallest edge of its cell.
    pub size: f32,
    /// Only samples near a plane: axis 0 to 2, and its coordinate, m.
    pub slice: Option<(u8, f32)>,
}

impl Default for VolumeView {
    fn default() -> Self {
        Self {
            colour_by: ColourBy::Light,
            quantity: Quantity::Irradiance,
            moment: Order::IRRADIANCE,
            part: Part::All,
            first_level: true,
            second_level: true,
            invalid: false,
            size: 0.2,
            slice: None,
        }
    }
}

/// Spheres at the volume's samples. Radiance is black in a volume that came from a file, and the error
/// where there is no volume to compare with, `against`.
pub fn volume_spheres(
    volume: &IrradianceVolume,
    world: &World,
    light: &impl SurfaceLight,
    view: &VolumeView,
    against: Option<&IrradianceVolume>,
) -> InspectionScene {
    if view.colour_by == ColourBy::Error {
        return error_spheres(volume, view, against);
    }
    let radiance = view.colour_by == ColourBy::Light && view.quantity == Quantity::Radiance;
    let seen_light = volume.seen(world, light).filter(|_| radiance);
    let mut scene = spheres(volume, view, |i| {
        let sample = &volume.samples()[i];
        let one = |value: f32| vec![Vec3::splat(value); volume.bins().len()];
        match (view.colour_by, view.quantity) {
            (ColourBy::Light, Quantity::Irradiance) => volume
                .sample_moment(i, view.moment, view.part)
                .unwrap_or_else(|| volume.sample_irradiance(i, view.part)),
            (ColourBy::Light, Quantity::Radiance) => volume.radiance_seen(i, seen_light.as_ref(), view.part),
            (ColourBy::Luminance, _) => {
                let values = volume.sample_irradiance(i, view.part);
                one(values.iter().map(|v| luminance(*v)).sum::<f32>() / values.len() as f32)
            }
            (ColourBy::Validity, _) => one(f32::from(sample.state as u8)),
            (ColourBy::Age, _) => one(volume.age(i) as f32),
            (ColourBy::Distance, _) => one(nearest_surface(world, sample.position)),
            (ColourBy::Error, _) => one(0.0),
        }
    });
    if view.colour_by == ColourBy::Validity {
        // Nearly all are valid: as large as the others they would hide them.
        for sphere in &mut scene.spheres {
            let state = volume.samples()[sphere.sample as usize].state;
            sphere.radius *= if state == SampleState::Free { VALID_SIZE } else { 1.0 };
        }
    }
    scene.legend = Some(legend_of(volume, view, &scene.sphere_bins));
    scene
}

/// What the colours of [`volume_spheres`] mean.
fn legend_of(volume: &IrradianceVolume, view: &VolumeView, values: &[Vec3]) -> Legend {
    let mut legend = legend(view.quantity, values);
    let named = match view.colour_by {
        ColourBy::Light if view.quantity == Quantity::Radiance || view.moment == Order::IRRADIANCE => None,
        ColourBy::Light if volume.orders().contains(&view.moment) => {
            Some((format!("moment of order {}", view.moment), "lx"))
        }
        ColourBy::Light => Some((format!("irradiance (no moment of order {} is held)", view.moment), "lx")),
        ColourBy::Luminance => Some(("mean illuminance of a sample".into(), "lx")),
        ColourBy::Validity => Some(("state of a sample".into(), "")),
        ColourBy::Age => Some(("changes of its light since its rays".into(), "")),
        ColourBy::Distance => Some(("distance to the nearest surface".into(), "m")),
        ColourBy::Error => Some(("relative error".into(), "%")),
    };
    if let Some((quantity, unit)) = named {
        (legend.quantity, legend.unit) = (quantity, unit.to_owned());
    }
    if view.colour_by == ColourBy::Validity {
        (legend.range, legend.names) = ([0.0, 3.0], &SampleState::NAMES);
    }
    legend
}

/// Spheres at the samples of A, coloured by A − B for a surface that faces that way, lx, signed.
pub fn difference_spheres(difference: &Difference, view: &VolumeView) -> InspectionScene {
    let mut scene = spheres(difference.a, view, |i| difference.at_sample(i));
    let most = bulk(&scene.sphere_bins);
    scene.legend = Some(signed_legend("difference of irradiance", most));
    let compared = compared(difference);
    scene.curves.push(histogram(&compared));
    scene.notes.extend(notes(&compared));
    scene
}

/// Spheres coloured by how far a volume is from another, and where it is farthest in words.
fn error_spheres(
    volume: &IrradianceVolume,
    view: &VolumeView,
    against: Option<&IrradianceVolume>,
) -> InspectionScene {
    let difference = against.map(|b| Difference::new(volume, b, view.part));
    let compared = difference.as_ref().map(compared);
    let mut scene = spheres(volume, view, |i| match difference.zip(compared.as_ref().map(|c| c.floor_lx)) {
        None => vec![Vec3::ZERO; volume.bins().len()],
        Some((d, floor)) => d.relative_at_sample(i, floor).map(|e| Vec3::splat(100.0 * e)).collect(),
    });
    let most = bulk(&scene.sphere_bins);
    scene.legend = Some(Legend { range: [0.0, most], ..legend_of(volume, view, &scene.sphere_bins) });
    match &compared {
        None => scene.notes.push("no volume to compare with is chosen: keep or path-trace one".into()),
        Some(c) => {
            scene.curves.push(histogram(c));
            scene.notes.extend(notes(c));
        }
    }
    scene
}

/// Spheres at the samples that a view shows, without a legend.
pub(super) fn spheres(
    volume: &IrradianceVolume,
    view: &VolumeView,
    values: impl Fn(usize) -> Vec<Vec3>,
) -> InspectionScene {
    let cell = volume.grid().cell_size();
    let edge = cell.min_element();
    let inner = volume.grid().inner() as f32;
    let mut scene = InspectionScene { bins: Some(volume.bins()), ..InspectionScene::default() };
    let mut skipped = 0;
    for (i, sample) in volume.samples().iter().enumerate() {
        let level_shown = if sample.level == 1 { view.first_level } else { view.second_level };
        let in_slice = view.slice.is_none_or(|(axis, at)| {
            let axis = usize::from(axis.min(2));
            (sample.position[axis] - at).abs()
                <= 0.5 * cell[axis] / if view.second_level { inner } else { 1.0 }
        });
        if !level_shown || !in_slice {
            continue;
        }
        if !sample.valid && !view.invalid {
            skipped += 1;
            continue;
        }
        scene.spheres.push(SphereGlyph {
            centre: sample.position,
            radius: view.size * edge / if sample.level == 1 { 1.0 } else { inner },
            first_bin: scene.sphere_bins.len() as u32,
            sample: i as u32,
        });
        scene.sphere_bins.extend(values(i));
    }
    let states = SampleState::ALL
        .map(|state| (state, volume.samples().iter().filter(|s| s.state == state).count()))
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .map(|(state, count)| format!("{count} {}", state.name()));
    scene.notes.push(format!("samples: {}", states.collect::<Vec<_>>().join(", ")));
    scene.notes.push(format!(
        "{} of {} samples shown, {skipped} inside solids left out",
        scene.spheres.len(),
        volume.samples().len()
    ));
    scene
}

/// Distance to the nearest surface in 32 directions, m; 0 where none is seen.
fn nearest_surface(world: &World, position: Vec3) -> f32 {
    let bins = DirectionBins::new(4);
    let nearest = (0..bins.len())
        .filter_map(|b| seen(world, position, bins.centre(b)))
        .map(|(t, _)| t)
        .fold(f32::INFINITY, f32::min);
    if nearest.is_finite() { nearest } else { 0.0 }
}

/// Edges of the cells of both levels: those at the plane of the view, or of all of them, fainter, and of the second
/// level then without what lies inside a cell of the first.
pub fn grid_lines(volume: &IrradianceVolume, view: &VolumeView) -> InspectionScene {
    let grid = volume.grid();
    let (low, _) = grid.bounds();
    let (size, cell, inner) = (grid.size(), grid.cell_size(), grid.inner());
    let mut scene = InspectionScene::default();
    let transparency = if view.slice.is_some() { 0.0 } else { FAINT };
    let mut block = |low: Vec3, cell: Vec3, size: UVec3, level: usize| {
        let mut add = |ends| scene.value_lines.push(ValueLine { ends, value: level as f32, transparency });
        match view.slice {
            None => lattice(low, cell, size, &mut add),
            Some((axis, at)) => layer(low, cell, size, (usize::from(axis.min(2)), at), &mut add),
        }
    };
    if view.first_level {
        block(low, cell, size, 0);
    }
    for (c, _) in grid.second().iter().enumerate().filter(|(_, s)| view.second_level && **s != NONE) {
        let c = c as u32;
        let at = UVec3::new(c % size.x, c / size.x % size.y, c / (size.x * size.y));
        let corner = low + at.as_vec3() * cell;
        match view.slice {
            None => block(corner, cell, UVec3::ONE, 1),
            Some(_) => block(corner, cell / inner as f32, UVec3::splat(inner), 1),
        }
    }
    scene.legend = Some(Legend {
        quantity: "level of the grid".into(),
        unit: String::new(),
        range: [0.0, 1.0],
        names: &["first", "second"],
    });
    let in_pockets = match grid.pockets().len() {
        0 => String::new(),
        count => format!("{count} samples in pockets, "),
    };
    scene.notes.push(format!(
        "first level {} × {} × {} samples, {} second-level grids of {}³, {in_pockets}{} samples together",
        size.x + 1,
        size.y + 1,
        size.z + 1,
        grid.second_level_grids(),
        inner + 1,
        grid.places().len()
    ));
    scene
}

/// A probe's sphere of radius `radius` (m), radial plots, unfolded maps and numbers.
pub fn probe_scene(probe: &Probe, quantity: Quantity, part: Part, radius: f32) -> InspectionScene {
    let values = probe.values(quantity, part);
    let legend = legend(quantity, &values);
    let s = probe.statistics(part);
    let mut notes = vec![
        format!(
            "illuminance over all directions: {:.4} to {:.4} lx, mean {:.4} lx",
            s.min_lx, s.max_lx, s.mean_lx
        ),
        format!("facing up {:.4} lx, facing down {:.4} lx", s.up_lx, s.down_lx),
        format!("radiance up to {:.4} cd/m², mean {:.4} cd/m²", s.max_radiance, s.mean_radiance),
    ];
    if probe.back_face_fraction > 0.25 {
        notes.push(format!(
            "inside a solid: {:.0} % of rays meet back faces",
            100.0 * probe.back_face_fraction
        ));
    }
    InspectionScene {
        spheres: vec![SphereGlyph { centre: probe.position, radius, first_bin: 0, sample: u32::MAX }],
        sphere_bins: values,
        bins: Some(probe.bins),
        images: probe.unfolded(quantity, part).into(),
        curves: probe.radial_plots(quantity, part),
        legend: Some(legend),
        notes,
        ..InspectionScene::default()
    }
}

impl IrradianceVolume {
    /// Radiance coming to one sample from each bin, cd/m² per channel; the direct part is emitters seen.
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn sample_radiance(
        &self,
        sample: usize,
        world: &World,
        light: &impl SurfaceLight,
        part: Part,
    ) -> Vec<Vec3> {
        self.radiance_seen(sample, self.seen(world, light).as_ref(), part)
    }

    /// Light as its rays see it; `None` in a volume that came from a file.
    fn seen<'a>(&'a self, world: &'a World, light: &impl SurfaceLight) -> Option<SeenLight<'a>> {
        Some(self.transport.as_ref()?.met.seen(world, light.radiosity(), &self.settings.ignored))
    }

    fn radiance_seen(&self, sample: usize, seen: Option<&SeenLight>, part: Part) -> Vec<Vec3> {
        let mut radiance = vec![Vec3::ZERO; self.bins().len()];
        let (Some(transport), Some(seen)) = (&self.transport, seen) else { return radiance };
        if part != Part::Direct {
            transport.met.reflected(sample, seen, &mut radiance);
        }
        if part != Part::Indirect {
            transport.met.add_emitted(sample, seen, &mut radiance);
        }
        radiance
    }
}

fn legend(quantity: Quantity, values: &[Vec3]) -> Legend {
    let range = robust_range(values.iter().map(|v| luminance(*v)));
    Legend { quantity: quantity.name().into(), unit: quantity.unit().into(), range, names: &[] }
}

/// Lines along each axis through the corners of a block of cells.
fn lattice(low: Vec3, cell: Vec3, size: UVec3, add: &mut impl FnMut([Vec3; 2])) {
    let high = low + size.as_vec3() * cell;
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 0..=size[u] {
            for j in 0..=size[v] {
                let mut from = low;
                from[u] += i as f32 * cell[u];
                from[v] += j as f32 * cell[v];
                let mut to = from;
                to[axis] = high[axis];
                add([from, to]);
            }
        }
    }
}

/// The lines of a block of cells in a plane across an axis, where the plane meets the block.
fn layer(low: Vec3, cell: Vec3, size: UVec3, (axis, at): (usize, f32), add: &mut impl FnMut([Vec3; 2])) {
    let high = low + size.as_vec3() * cell;
    if at < low[axis] || at > high[axis] {
        return;
    }
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    for (along, across) in [(u, v), (v, u)] {
        for i in 0..=size[across] {
            let mut from = low;
            from[axis] = at;
            from[across] += i as f32 * cell[across];
            let mut to = from;
            to[along] = high[along];
            add([from, to]);
        }
    }
}
