//! What `fly` writes: a table, a report, and the chart of Bastos 1999, Fig. 6.20.

use super::{
    fly::{Options, Row},
    plot::{Panel, Plot},
    solve,
};
use lumenscope_core::{glossy::GlossyMethod, gpu::Stage, measure::chart::Point};
use serde_json::json;
use std::{fmt::Write as _, path::Path};

/// Writes the table, the report and the chart.
///
/// # Errors
/// One line naming the file and the cause.
pub(super) fn write(
    out: &Path,
    options: &Options,
    adapter: &str,
    rows: &[(Row, [f64; 4])],
    plain: [&Row; 2],
) -> anyhow::Result<()> {
    solve::output_folder(out)?;
    let mut table = String::from(
        "reflectors,mirrors,views,median_ms,p95_ms,frames_per_second,views_percent,convolution_percent,modulation_percent,shading_percent",
    );
    for stage in Stage::ALL {
        let _ = write!(table, ",{}_ms", stage.name());
    }
    table.push('\n');
    let mut list = Vec::new();
    for (row, shares) in rows {
        let stages = row.stages.unwrap_or([f64::NAN; 7]);
        let numbers = [row.views, row.percentile(0.5), row.percentile(0.95), 1000.0 / row.mean()];
        let cells: Vec<String> =
            numbers.iter().chain(shares).chain(&stages).map(|x| format!("{x:.3}")).collect();
        let _ = writeln!(table, "{},{},{}", row.reflectors, row.mirrors(), cells.join(","));
        let stages: serde_json::Map<String, serde_json::Value> =
            Stage::ALL.iter().zip(stages).map(|(s, ms)| (format!("{}_ms", s.name()), json!(ms))).collect();
        list.push(json!({
            "reflectors": row.reflectors,
            "images_an_element": row.images,
            "mirrored_views": row.views,
            "median_ms": row.percentile(0.5),
            "p95_ms": row.percentile(0.95),
            "frames_per_second": 1000.0 / row.mean(),
            "stages": stages,
        }));
    }
    solve::write(&out.join("fly.csv"), &table)?;
    chart(options, rows).write(out, "fly")?;
    let report = json!({
        "scene": options.scene,
        "adapter": adapter,
        "size": options.size,
        "frames": options.frames,
        "glossy": options.glossy.map_or("sharp", GlossyMethod::name),
        "rows": list,
        "without_reflectors_ms": plain.map(|r| r.percentile(0.5)),
    });
    solve::write(&out.join("fly.json"), &format!("{report:#}\n"))
}

/// Frames a second of each method: along the walk with the most reflectors, as Bastos 1999, Fig. 6.20, and by the
/// number of reflectors.
fn chart(options: &Options, rows: &[(Row, [f64; 4])]) -> Plot {
    let rows = || rows.iter().map(|(row, _)| row);
    let most = rows().map(|row| row.reflectors).max().unwrap_or(0);
    let mut names: Vec<String> = Vec::new();
    for row in rows() {
        if !names.contains(&row.mirrors()) {
            names.push(row.mirrors());
        }
    }
    let of = |name: &String, points: &dyn Fn(&Row) -> Vec<Point>| {
        rows().filter(|row| row.mirrors() == *name).flat_map(points).collect()
    };
    let along = |row: &Row| -> Vec<Point> {
        let frames = (1..).zip(&row.milliseconds).filter(|_| row.reflectors == most);
        frames.map(|(frame, ms)| [f64::from(frame), 1000.0 / ms]).collect()
    };
    let mean = |row: &Row| vec![[row.reflectors as f64, 1000.0 / row.mean()]];
    let panel = |title: String, x: &str, points: &dyn Fn(&Row) -> Vec<Point>| Panel {
        title,
        axes: [x.into(), "frames a second".into()],
        lines: names.iter().map(|name| of(name, points)).collect(),
        level: None,
        front: false,
    };
    let panels = vec![
        panel(format!("{most} reflectors, along the walk"), "frame", &along),
        panel("the whole walk".into(), "reflectors", &mean),
    ];
    let [width, height] = options.size;
    let scene = options.scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Plot { title: format!("{scene}: {width}x{height}"), names, panels }
}
