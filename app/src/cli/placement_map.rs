//! The map of a measurement as a picture: false colour, lines of equal illuminance, numbers, verdict.

use super::page::{INK, Page};
use crate::widgets::placement_map::colours;
use lumenscope_core::{
    irradiance_volume::placement::{
        Measurement,
        inspect::{Field, levels},
        requirement::Requirement,
    },
    math::{colour::srgb8, false_colour::FalseColour},
};
use std::path::Path;

/// Longer side of the map, pixels.
const LONGER: f32 = 880.0;
const MARGIN: usize = 24;
const HEAD: usize = 96;
const FOOT: usize = 64;
const SMALLEST: usize = 520;

/// Writes the map; the first edge runs to the right, the second up.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write(path: &Path, measured: &Measurement, wanted: &Requirement) -> anyhow::Result<()> {
    let grid = &measured.grid;
    let (u, v) = (grid.edge_u.length(), grid.edge_v.length());
    let scale = LONGER / u.max(v);
    let size = [(u * scale) as usize, (v * scale) as usize].map(|n| n.max(40));
    let width = (size[0] + 2 * MARGIN).max(SMALLEST);
    let mut page = Page::new(width, size[1] + HEAD + FOOT);
    let field = Field::new(measured);
    let colours = colours(measured);
    let origin = [MARGIN, HEAD];
    surface(&mut page, origin, size, measured, &field, &colours);
    for level in levels(measured, wanted) {
        let red = wanted.mean_lx == Some(level);
        let ink = if red { [225, 50, 40] } else { [20, 20, 20] };
        for contour in field.contours(level) {
            let mut places: Vec<[f32; 2]> =
                contour.points.iter().map(|p| at(origin, size, measured, *p)).collect();
            if contour.closed {
                places.extend(places.first().copied());
            }
            for pair in places.windows(2) {
                page.line(pair[0], pair[1], ink);
            }
            if places.len() > 8 {
                let [x, y] = places[places.len() / 2];
                page.plate(x, y, &format!("{level:.0} lx"), ink);
            }
        }
    }
    numbers(&mut page, origin, size, measured, &colours);
    words(&mut page, measured, wanted);
    legend(&mut page, &colours);
    page.write(path)
}

/// Pixel of a point in lattice coordinates of a [`Field`].
fn at(origin: [usize; 2], size: [usize; 2], measured: &Measurement, [x, y]: [f32; 2]) -> [f32; 2] {
    let share = |x: f32, n: u32| ((x - 0.5) / n as f32).clamp(0.0, 1.0);
    [
        origin[0] as f32 + share(x, measured.grid.nx) * size[0] as f32,
        origin[1] as f32 + (1.0 - share(y, measured.grid.ny)) * size[1] as f32,
    ]
}

fn surface(
    page: &mut Page,
    origin: [usize; 2],
    size: [usize; 2],
    measured: &Measurement,
    field: &Field,
    colours: &FalseColour,
) {
    // Lattice coordinate of a share of an edge: the inverse of `at`, held between the outermost points.
    let lattice = |share: f32, cells: u32| (share * cells as f32 + 0.5).clamp(1.0, cells as f32);
    for row in 0..size[1] {
        for column in 0..size[0] {
            let x = lattice((column as f32 + 0.5) / size[0] as f32, measured.grid.nx);
            let y = lattice(1.0 - (row as f32 + 0.5) / size[1] as f32, measured.grid.ny);
            let (i, j) = ((x as usize).min(field.width - 2), (y as usize).min(field.height - 2));
            let (s, t) = (x - i as f32, y - j as f32);
            let value = |i: usize, j: usize| field.values[j * field.width + i];
            if let (Some(a), Some(b), Some(c), Some(d)) =
                (value(i, j), value(i + 1, j), value(i, j + 1), value(i + 1, j + 1))
            {
                let (low, high) = (a + (b - a) * s, c + (d - c) * s);
                page.put(origin[0] + column, origin[1] + row, srgb8(colours.colour(low + (high - low) * t)));
            }
        }
    }
}

fn numbers(
    page: &mut Page,
    origin: [usize; 2],
    size: [usize; 2],
    measured: &Measurement,
    colours: &FalseColour,
) {
    let grid = &measured.grid;
    let most = [size[0] / 56, size[1] / 28].map(|n| n.max(1) as u32);
    let [every_u, every_v] = [grid.nx.div_ceil(most[0]), grid.ny.div_ceil(most[1])];
    for j in (every_v / 2..grid.ny).step_by(every_v as usize) {
        for i in (every_u / 2..grid.nx).step_by(every_u as usize) {
            let Some(value) = measured.values[(j * grid.nx + i) as usize] else { continue };
            let [x, y] = at(origin, size, measured, [i as f32 + 1.0, j as f32 + 1.0]);
            let ink = if colours.position(value) > 0.6 { [10, 10, 10] } else { [240, 240, 240] };
            let text = format!("{value:.0}");
            page.text(x as usize - (4 * text.len()).min(x as usize), y as usize - 4, 1, &text, ink);
        }
    }
}

fn words(page: &mut Page, measured: &Measurement, wanted: &Requirement) {
    let statistics = measured.statistics();
    page.text(MARGIN, 14, 2, &measured.name, INK);
    if let Some(s) = statistics {
        let line = format!(
            "min {:.0} lx   mean {:.0} lx   max {:.0} lx   U0 {:.2}   min/max {:.2}",
            s.min_lx, s.mean_lx, s.max_lx, s.uniformity, s.diversity
        );
        page.text(MARGIN, 40, 1, &line, INK);
    }
    let short = wanted.shortfalls(statistics.as_ref());
    for (i, shortfall) in short.iter().take(3).enumerate() {
        page.text(MARGIN, 55 + 12 * i, 1, &format!("! {shortfall}"), [255, 120, 100]);
    }
    if short.is_empty() && !wanted.is_empty() {
        page.text(
            MARGIN,
            55,
            1,
            &format!("enough light for: {}", wanted.task.to_lowercase()),
            [130, 220, 150],
        );
    }
}

fn legend(page: &mut Page, colours: &FalseColour) {
    let (left, top, width) = (MARGIN, page.height - FOOT + 14, page.width - 2 * MARGIN);
    for x in 0..width {
        for y in 0..14 {
            let colour = colours.palette.colour(x as f32 / (width - 1) as f32);
            page.put(left + x, top + y, srgb8(colour));
        }
    }
    for tick in colours.ticks(6) {
        let x = left + (colours.position(tick) * (width - 1) as f32) as usize;
        (0..4).for_each(|y| page.put(x, top + 14 + y, INK));
        let text = format!("{tick}");
        page.text((x - (4 * text.len()).min(x)).max(2), top + 20, 1, &text, INK);
    }
    page.text(left, top + 34, 1, "illuminance in lx", INK);
}
