//! A measurement as a view: false colour, lines of equal illuminance, numbers, warnings.

use super::{
    Measurement,
    contours::{self, Contour},
    requirement::Requirement,
};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Label, Legend, Line},
    math::false_colour::{FalseColour, Palette},
};
use glam::Vec3;

/// How far the colours stand off what is measured, m.
const LIFT_M: f32 = 0.002;
/// How far the lines stand off the colours, m.
const LINE_LIFT_M: f32 = 0.003;
/// Numbers shown along an edge at most.
const NUMBERS: [u32; 2] = [9, 6];
/// Lines of equal illuminance, about.
const LEVELS: usize = 6;

const PLAIN: Vec3 = Vec3::new(0.02, 0.02, 0.02);
const WANTED: Vec3 = Vec3::new(0.9, 0.05, 0.03);

/// The measurement continued to the rectangle's edges, where the outermost points' values hold: nodes at
/// the border and at every point between.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Nodes along the first edge.
    pub width: usize,
    /// Nodes along the second edge.
    pub height: usize,
    /// Illuminance at each node, lx.
    pub values: Vec<Option<f32>>,
    /// Places of the nodes, m.
    pub positions: Vec<Vec3>,
}

/// Share of an edge at which node `i` of `cells` + 2 lies.
fn share(i: usize, cells: u32) -> f32 {
    ((i as f32 - 0.5) / cells as f32).clamp(0.0, 1.0)
}

impl Field {
    /// Of a measurement.
    pub fn new(measured: &Measurement) -> Self {
        let grid = &measured.grid;
        let (width, height) = (grid.nx as usize + 2, grid.ny as usize + 2);
        let mut field = Self { width, height, values: Vec::new(), positions: Vec::new() };
        for row in 0..height {
            for column in 0..width {
                let nearest = |i: usize, n: u32| i.saturating_sub(1).min(n as usize - 1);
                let cell = nearest(row, grid.ny) * grid.nx as usize + nearest(column, grid.nx);
                let mut position =
                    grid.corner + grid.edge_u * share(column, grid.nx) + grid.edge_v * share(row, grid.ny);
                if let Some(point) = grid.points[cell] {
                    // Tops may slope a little: as high as the point.
                    position += grid.normal * (point - position).dot(grid.normal);
                }
                field.values.push(measured.values[cell]);
                field.positions.push(position + grid.normal * LIFT_M);
            }
        }
        field
    }

    /// Triangles between nodes that all have a value: two a square.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let squares = (1..self.height).flat_map(|row| (1..self.width).map(move |column| (column, row)));
        let corners = squares
            .map(|(c, r)| [(c - 1, r - 1), (c, r - 1), (c, r), (c - 1, r)].map(|(c, r)| r * self.width + c));
        let known = corners.filter(|corners| corners.iter().all(|&i| self.values[i].is_some()));
        known.map(|corners| corners.map(|i| i as u32)).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
    }

    /// Place of a point given in lattice coordinates, m.
    pub fn position(&self, [x, y]: [f32; 2]) -> Vec3 {
        let (i, j) = ((x as usize).min(self.width - 2), (y as usize).min(self.height - 2));
        let (s, t) = (x - i as f32, y - j as f32);
        let at = |i: usize, j: usize| self.positions[j * self.width + i];
        at(i, j).lerp(at(i + 1, j), s).lerp(at(i, j + 1).lerp(at(i + 1, j + 1), s), t)
    }

    /// Lines of one level.
    pub fn contours(&self, level: f32) -> Vec<Contour> {
        let lattice = contours::Lattice { width: self.width, height: self.height, values: &self.values };
        contours::contours(&lattice, level)
    }
}

/// Round illuminances at which lines are drawn, and the required mean where it lies between them, lx.
pub fn levels(measured: &Measurement, requirement: &Requirement) -> Vec<f32> {
    let Some(s) = measured.statistics() else { return Vec::new() };
    let colours =
        FalseColour { palette: Palette::default(), low: s.min_lx, high: s.max_lx, logarithmic: false };
    let mut levels: Vec<f32> =
        colours.ticks(LEVELS).into_iter().filter(|l| *l > s.min_lx && *l < s.max_lx).collect();
    levels.extend(requirement.mean_lx.filter(|m| *m > s.min_lx && *m < s.max_lx));
    levels.sort_by(f32::total_cmp);
    levels.dedup();
    levels
}

/// False colour, lines of equal illuminance with their values, numbers on a grid, and what falls short.
/// The line of the required mean is red.
pub fn scene(measured: &Measurement, requirement: &Requirement) -> InspectionScene {
    let field = Field::new(measured);
    let mut scene = InspectionScene { notes: notes(measured, requirement), ..InspectionScene::default() };
    let mesh = ColouredMesh {
        positions: field.positions.clone(),
        values: field.values.iter().map(|v| Vec3::splat(v.unwrap_or(0.0))).collect(),
        triangles: field.triangles().collect(),
        ..ColouredMesh::default()
    };
    scene.meshes.push(mesh);
    for level in levels(measured, requirement) {
        let colour = if requirement.mean_lx == Some(level) { WANTED } else { PLAIN };
        for contour in field.contours(level) {
            let above = measured.grid.normal * LINE_LIFT_M;
            let places: Vec<Vec3> = contour.points.iter().map(|p| field.position(*p) + above).collect();
            scene.lines.extend(places.windows(2).map(|w| Line { ends: [w[0], w[1]], colour }));
            if let (true, [first, .., last]) = (contour.closed, &places[..]) {
                scene.lines.push(Line { ends: [*last, *first], colour });
            }
            // A line of a few steps has no room for its value.
            if places.len() > 6 {
                let text = format!("{level:.0} lx");
                scene.labels.push(Label { position: places[places.len() / 2], text, strong: true });
            }
        }
    }
    scene.labels.extend(numbers(measured));
    let range = measured.statistics().map_or([0.0, 0.0], |s| [s.min_lx, s.max_lx]);
    scene.legend = Some(Legend { quantity: "illuminance".into(), unit: "lx".into(), range, names: &[] });
    scene
}

/// Values at some of the points, so many that they can be read.
pub fn numbers(measured: &Measurement) -> Vec<Label> {
    let grid = &measured.grid;
    let [every_u, every_v] = [grid.nx.div_ceil(NUMBERS[0]), grid.ny.div_ceil(NUMBERS[1])];
    let mut labels = Vec::new();
    for j in (every_v / 2..grid.ny).step_by(every_v as usize) {
        for i in (every_u / 2..grid.nx).step_by(every_u as usize) {
            let cell = (j * grid.nx + i) as usize;
            if let (Some(value), Some(point)) = (measured.values[cell], grid.points[cell]) {
                let position = point + grid.normal * LIFT_M;
                labels.push(Label { position, text: format!("{value:.0}"), strong: false });
            }
        }
    }
    labels
}

/// The measurement in words and numbers, warnings first.
pub fn notes(measured: &Measurement, requirement: &Requirement) -> Vec<String> {
    let statistics = measured.statistics();
    let mut notes: Vec<String> = requirement
        .shortfalls(statistics.as_ref())
        .iter()
        .map(|s| format!("{}: {s}", measured.name))
        .collect();
    if let Some(s) = statistics {
        notes.push(format!(
            "{}: illuminance {:.1} to {:.1} lx, mean {:.1} lx, U₀ {:.2}, E_min/E_max {:.2}, {} points",
            measured.name, s.min_lx, s.max_lx, s.mean_lx, s.uniformity, s.diversity, s.points
        ));
    }
    if measured.inside > 0 {
        notes.push(format!("{} points inside things are left out", measured.inside));
    }
    notes
}
