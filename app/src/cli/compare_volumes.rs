//! `compare` of two irradiance volumes: numbers, maps of A − B on three planes, and a histogram.

use super::{
    page::{INK, Page},
    solve,
};
use lumenscope_core::{
    inspection::{ColouredMesh, Curve, InspectionScene, colours::ColourSettings},
    irradiance_volume::{
        IrradianceVolume,
        difference::Difference,
        inspect::VolumeView,
        slice::{difference_histogram, difference_slice, slice_over, volume_slice},
    },
    math::{
        colour::{luminance, srgb8},
        false_colour::{FalseColour, Palette},
        part::Part,
    },
};
use std::{fmt::Write as _, path::Path};

/// Longer side of a map, pixels.
const LONGER: f32 = 480.0;

/// Margin around maps, and rows for words above them.
const MARGIN: usize = 16;
const HEAD: usize = 40;

/// Compares two volumes, A − B, part by part, and prints JSON; writes `map.png`, `histogram.png` and
/// `histogram.csv` where there is a folder for them.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(a: &Path, b: &Path, out: Option<&Path>) -> anyhow::Result<()> {
    let (a, b) = (IrradianceVolume::load(a)?, IrradianceVolume::load(b)?);
    let of = |part| serde_json::to_value(Difference::new(&a, &b, part).statistics());
    let all = Difference::new(&a, &b, Part::All);
    let report = serde_json::json!({
        "all": of(Part::All)?, "direct": of(Part::Direct)?, "indirect": of(Part::Indirect)?,
        "same_samples": all.same_samples(),
    });
    println!("{}", serde_json::to_string_pretty(&report)?);
    let Some(out) = out else { return Ok(()) };
    solve::output_folder(out)?;
    maps(&all).write(&out.join("map.png"))?;
    let histogram = difference_histogram(&all);
    bars(&histogram).write(&out.join("histogram.png"))?;
    let mut table = String::from("relative_percent,share_percent\n");
    for p in &histogram.points {
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{},{}", p.x, p.y);
    }
    solve::write(&out.join("histogram.csv"), &table)?;
    eprintln!("{}: A, B and A - B on three planes, and how far A is from B", out.display());
    Ok(())
}

/// A, B and A − B on the planes through the middle of A across x, y and z: a row each, A and B on one scale.
fn maps(difference: &Difference) -> Page {
    let Difference { a, b, part } = *difference;
    let (low, high) = a.grid().bounds();
    let middle = |axis: usize| 0.5 * (low[axis] + high[axis]);
    let row = |made: &dyn Fn(&VolumeView) -> InspectionScene| {
        [0, 1, 2].map(|axis| {
            made(&VolumeView { slice: Some((axis as u8, middle(axis))), part, ..VolumeView::default() })
        })
    };
    let most = |row: &[InspectionScene; 3]| {
        let ends = row.iter().filter_map(|s| s.legend.as_ref()).map(|l| l.range[1]);
        ends.fold(f32::MIN_POSITIVE, f32::max)
    };
    // B on A's planes: its own grid may reach farther.
    let rows = [
        row(&|v| volume_slice(a, v)),
        row(&|v| slice_over(a, b, v)),
        row(&|v| difference_slice(difference, v)),
    ];
    let bright = most(&rows[0]).max(most(&rows[1]));
    let apart = most(&rows[2]);
    let found: Vec<FalseColour> =
        rows[..2].iter().flatten().map(|scene| scene.colours(&ColourSettings::default())).collect();
    let darkest = found.iter().map(|c| c.low).fold(bright, f32::min);
    let logarithmic = darkest > 0.0 && found.iter().any(|c| c.logarithmic);
    let light = FalseColour { low: darkest, high: bright, logarithmic, ..found[0] };
    let signed = FalseColour::over([-apart, apart], Palette::Viridis);
    let scale = LONGER / (high - low).max_element();
    let size =
        |axis: usize| [(axis + 1) % 3, (axis + 2) % 3].map(|i| ((high - low)[i] * scale).max(8.0) as usize);
    let width = MARGIN + (0..3).map(|axis| size(axis)[0].max(150) + MARGIN).sum::<usize>();
    let height = (0..3).map(|axis| size(axis)[1]).max().unwrap_or(0);
    let mut page = Page::new(width, 3 * (HEAD + height + MARGIN) + MARGIN);
    let titles = [
        format!(
            "A, mean over directions: {:.3} to {bright:.3} lx, {} scale",
            light.low,
            if light.logarithmic { "logarithmic" } else { "linear" }
        ),
        String::from("B, the same"),
        format!("A − B: blue {:.3} to red {apart:.3} lx", -apart),
    ];
    for (i, (row, title)) in rows.iter().zip(&titles).enumerate() {
        let top = i * (HEAD + height + MARGIN);
        page.text(MARGIN, top + 8, 1, title, INK);
        let mut left = MARGIN;
        for (axis, scene) in row.iter().enumerate() {
            let names = ["x", "y", "z"];
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let words = format!("{} = {:.2} m, {} →, {} ↑", names[axis], middle(axis), names[u], names[v]);
            page.text(left, top + 26, 1, &words, INK);
            let colours = if i < 2 { &light } else { &signed };
            plane(&mut page, [left, top + HEAD], size(axis), &scene.meshes[0], v, colours);
            left += size(axis)[0].max(150) + MARGIN;
        }
    }
    page
}

/// A slice's mesh as a picture, rows along the axis `v` upward.
fn plane(
    page: &mut Page,
    [left, top]: [usize; 2],
    [w, h]: [usize; 2],
    mesh: &ColouredMesh,
    v: usize,
    colours: &FalseColour,
) {
    let columns = mesh.positions.iter().take_while(|p| p[v] == mesh.positions[0][v]).count();
    let rows = mesh.positions.len() / columns;
    for (y, x) in (0..h).flat_map(|y| (0..w).map(move |x| (y, x))) {
        let column = (x * (columns - 1) + w / 2) / w.max(1);
        let row = ((h - 1 - y) * (rows - 1) + h / 2) / h.max(1);
        let value = luminance(mesh.values[row.min(rows - 1) * columns + column.min(columns - 1)]);
        page.put(left + x, top + y, srgb8(colours.colour(value)));
    }
}

/// A histogram as bars.
fn bars(curve: &Curve) -> Page {
    let (width, height) = (640, 300);
    let mut page = Page::new(width + 2 * MARGIN, height + HEAD + 2 * MARGIN);
    let most = curve.points.iter().map(|p| p.y).fold(1e-6f32, f32::max);
    let wide = width / curve.points.len().max(1);
    for (i, p) in curve.points.iter().enumerate() {
        let tall = (p.y / most * height as f32) as usize;
        for x in 0..wide.saturating_sub(2) {
            for y in 0..tall {
                page.put(MARGIN + i * wide + x, HEAD + height - 1 - y, [90, 150, 230]);
            }
        }
    }
    page.text(MARGIN, 8, 1, &format!("{}: most {most:.1} % of {}", curve.name, curve.axes[1]), INK);
    let last = curve.points.last().map_or(0.0, |p| p.x);
    page.text(MARGIN, HEAD + height + 4, 1, &format!("{}, 0 to {last:.0} and beyond", curve.axes[0]), INK);
    page
}
