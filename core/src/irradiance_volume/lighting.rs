//! Which samples light a point: the cell, the place in it, the weights, in numbers and drawn in the scene.
//!
//! For a unit normal n the volume answers E = Σ wᵢ Eᵢ(n) over the eight corners of the cell (Greger 1996,
//! Eq. 4.4 to 4.6); this takes the sum apart.

use super::{IrradianceVolume, trust::SampleState, visibility::PointState};
use crate::{
    inspection::{InspectionScene, Label, Legend, Line, SphereGlyph, robust_range},
    math::{colour::luminance, part::Part},
};
use glam::Vec3;

/// What lights a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// The point, m.
    pub position: Vec3,
    /// The unit normal that is asked about.
    pub normal: Vec3,
    /// Number of the cell.
    pub cell: u32,
    /// Level of the cell, 1 or 2.
    pub level: u8,
    /// Place in the cell, each in [0, 1].
    pub offset: Vec3,
    /// Lower and upper corner of the cell, m.
    pub bounds: [Vec3; 2],
    /// How far the answer can be trusted.
    pub state: PointState,
    /// Samples with a share, heaviest first, then those that would have one if they could be used.
    pub samples: Vec<LitBy>,
    /// Irradiance that the volume answers, lx per channel.
    pub irradiance: Vec3,
}

/// A sample that lights a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitBy {
    /// Number of the sample.
    pub id: u32,
    /// Where it is, m.
    pub position: Vec3,
    /// Its share, in [0, 1].
    pub weight: f32,
    /// Its share before samples that cannot be used were left out.
    pub trilinear: f32,
    /// How it came to its light; a masked one has no say.
    pub state: SampleState,
    /// Whether it sees the point; asked in a guarded volume alone.
    pub seen: bool,
    /// Its own irradiance towards the normal, lx per channel.
    pub irradiance: Vec3,
}

impl LitBy {
    /// Its state in one word; "hidden" where something stands between it and the point.
    pub fn word(&self) -> &'static str {
        if self.seen { self.state.name() } else { "hidden" }
    }
}

impl Lighting {
    /// The cell and the place in it in one line.
    pub fn place(&self) -> String {
        let o = self.offset;
        format!("cell {} of level {}, offset {:.3} {:.3} {:.3}", self.cell, self.level, o.x, o.y, o.z)
    }

    /// What is to be said of the state of the point; nothing where all is well.
    pub fn notice(&self) -> Option<String> {
        match self.state {
            PointState::Inside => None,
            PointState::Outside(metres) => {
                Some(format!("{metres:.2} m outside the volume: the nearest samples answer"))
            }
            PointState::Borrowed => {
                Some("no sample around sees this point: the nearest that does answers".into())
            }
            PointState::Unseen => Some("no sample sees this point: the volume leaves it dark".into()),
        }
    }
}

impl IrradianceVolume {
    /// What lights a point that faces a unit normal.
    pub fn lighting(&self, position: Vec3, normal: Vec3, part: Part) -> Lighting {
        let (at, weights) = (self.grid().locate(position), self.weights(position));
        let corner =
            |i: usize| self.grid().places()[self.grid().cells()[at.cell as usize].samples[i] as usize];
        let corners = self.grid().cells()[at.cell as usize].samples;
        let of_corner =
            |id: u32| corners.iter().position(|corner| *corner == id).map_or(0.0, |i| weights.trilinear[i]);
        let mut samples: Vec<LitBy> = (0..8)
            .filter(|&i| weights.trilinear[i] > 0.0 || weights.weights[i] > 0.0)
            .map(|i| {
                let (id, sample) = (weights.ids[i], self.samples()[weights.ids[i] as usize]);
                LitBy {
                    id,
                    position: sample.position,
                    weight: weights.weights[i],
                    // A lender's share before is what it has as a corner, if it is one.
                    trilinear: of_corner(id),
                    state: sample.state,
                    seen: weights.seen[i],
                    irradiance: self.at_sample(id, normal, part, self.settings().basis),
                }
            })
            .collect();
        samples.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.id.cmp(&b.id)));
        // A lender answers alone and stands for all eight.
        samples.dedup_by_key(|s| s.id);
        Lighting {
            position,
            normal,
            cell: at.cell,
            level: at.level,
            offset: at.offset,
            bounds: [corner(0).position, corner(7).position],
            state: weights.state,
            samples,
            irradiance: self.irradiance(position, normal, part),
        }
    }
}

/// Colour of a line to a sample by whether it has a say: orange, or grey where it is left out.
fn line_colour(sample: &LitBy) -> Vec3 {
    if sample.weight > 0.0 { Vec3::new(0.95, 0.55, 0.1) } else { Vec3::splat(0.3) }
}

/// The point with lines to the samples that light it, each a sphere of its irradiance by direction whose
/// volume goes with its share, with its number, share and state; and the cell.
pub fn scene(volume: &IrradianceVolume, lighting: &Lighting, part: Part) -> InspectionScene {
    let [low, high] = lighting.bounds;
    let edge = (high - low).abs().min_element();
    let mut scene = InspectionScene { bins: Some(volume.bins()), ..InspectionScene::default() };
    for sample in &lighting.samples {
        let radius = 0.25 * edge * sample.weight.max(0.01).cbrt();
        scene.spheres.push(SphereGlyph {
            centre: sample.position,
            radius,
            first_bin: scene.sphere_bins.len() as u32,
            sample: sample.id,
        });
        scene.sphere_bins.extend(volume.sample_irradiance(sample.id as usize, part));
        scene.lines.push(Line { ends: [lighting.position, sample.position], colour: line_colour(sample) });
        let e = luminance(sample.irradiance);
        let share = 100.0 * sample.weight;
        scene.labels.push(Label {
            position: sample.position + Vec3::Y * (radius + 0.05 * edge),
            text: format!("{share:.1} % #{} {}", sample.id, sample.word()),
            strong: sample.weight > 0.0,
        });
        scene.notes.push(format!(
            "#{}: {share:.1} % ({:.1} % trilinear), {}, {e:.4} lx towards the normal",
            sample.id,
            100.0 * sample.trilinear,
            sample.word()
        ));
    }
    let corner =
        |i: u32| low + (high - low) * Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    for i in 0..8u32 {
        for k in [1, 2, 4].map(|bit| i | bit).into_iter().filter(|k| *k != i) {
            scene.lines.push(Line { ends: [corner(i), corner(k)], colour: Vec3::splat(0.85) });
        }
    }
    let to = lighting.position + lighting.normal * 0.3 * edge;
    scene.lines.push(Line { ends: [lighting.position, to], colour: Vec3::ONE });
    scene.notes.insert(0, format!("{}: {:.4} lx", lighting.place(), luminance(lighting.irradiance)));
    scene.notes.extend(lighting.notice());
    scene.legend = Some(Legend {
        quantity: "irradiance".into(),
        unit: "lx".into(),
        range: robust_range(scene.sphere_bins.iter().map(|v| luminance(*v))),
        names: &[],
    });
    scene
}
