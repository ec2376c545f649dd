//! `compare` of two irradiance volumes: numbers, maps of A − B on three planes, and a histogram.

use super::{
    page::{INK, Page},
    solve,
};
use lumenscope_core::{
    inspection::{Curve, InspectionScene, colours::ColourSettings},
    irradiance_volume::{
        IrradianceVolume,
        difference::Difference,
        inspect::VolumeView,
        slice::{difference_histogram, difference_slice},
    },
    math::{
        colour::{luminance, srgb8},
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
    maps(&all)?.write(&out.join("map.png"))?;
    let histogram = difference_histogram(&all);
    bars(&histogram).write(&out.join("histogram.png"))?;
    let mut table = String::from("relative_percent,share_percent\n");
    for p in &histogram.points {
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{},{}", p.x, p.y);
    }
    solve::write(&out.join("histogram.csv"), &table)?;
    eprintln!("{}: A - B on three planes, and how far A is from B", out.display());
    Ok(())
}

/// A − B on the planes through the middle of A across x, y and z, side by side, one scale for all.
fn maps(difference: &Difference) -> anyhow::Result<Page> {
    let (low, high) = difference.a.grid().bounds();
    let slices: Vec<(usize, InspectionScene)> = (0..3)
        .map(|axis| {
            let middle = 0.5 * (low[axis] + high[axis]);
            let view = VolumeView { slice: Some((axis as u8, middle)), ..VolumeView::default() };
            (axis, difference_slice(difference, &view))
        })
        .collect();
    let scale = LONGER / (high - low).max_element();
    let size =
        |axis: usize| [(axis + 1) % 3, (axis + 2) % 3].map(|i| ((high - low)[i] * scale).max(8.0) as usize);
    let width = MARGIN + (0..3).map(|axis| size(axis)[0].max(150) + MARGIN).sum::<usize>();
    let height = (0..3).map(|axis| size(axis)[1]).max().unwrap_or(0);
    let mut page = Page::new(width, HEAD + height + 2 * MARGIN);
    let mut most = 0.0f32;
    for (_, scene) in &slices {
        most = most.max(scene.legend.as_ref().map_or(0.0, |l| l.range[1]));
    }
    let mut colours = slices[0].1.colours(&ColourSettings::default());
    (colours.low, colours.high) = (-most.max(f32::MIN_POSITIVE), most.max(f32::MIN_POSITIVE));
    page.text(
        MARGIN,
        8,
        1,
        &format!("A - B, mean over directions: blue {:.3} to red {most:.3} lx", -most),
        INK,
    );
    let mut left = MARGIN;
    for (axis, scene) in &slices {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mesh = &scene.meshes[0];
        let columns = mesh.positions.iter().take_while(|p| p[v] == mesh.positions[0][v]).count();
        let rows = mesh.positions.len() / columns;
        let [w, h] = size(*axis);
        for y in 0..h {
            for x in 0..w {
                let column = (x * (columns - 1) + w / 2) / w.max(1);
                let row = ((h - 1 - y) * (rows - 1) + h / 2) / h.max(1);
                let value = luminance(mesh.values[row.min(rows - 1) * columns + column.min(columns - 1)]);
                page.put(left + x, HEAD + y, srgb8(colours.colour(value)));
            }
        }
        let names = ["x", "y", "z"];
        let title = format!("{} = {:.2} m", names[*axis], 0.5 * (low[*axis] + high[*axis]));
        page.text(left, 24, 1, &title, INK);
        page.text(left, HEAD + height + 4, 1, &format!("{} right, {} up", names[u], names[v]), INK);
        left += w.max(150) + MARGIN;
    }
    Ok(page)
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
    // The font has no minus as wide as a dash.
    let plain = |text: &str| text.replace('−', "-");
    page.text(MARGIN, 8, 1, &plain(&format!("{}: most {most:.1} % of {}", curve.name, curve.axes[1])), INK);
    let last = curve.points.last().map_or(0.0, |p| p.x);
    page.text(
        MARGIN,
        HEAD + height + 4,
        1,
        &plain(&format!("{}, 0 to {last:.0} and beyond", curve.axes[0])),
        INK,
    );
    page
}
