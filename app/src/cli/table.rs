//! CSV tables of points and of irradiance.

use anyhow::{Context, bail};
use glam::Vec3;
use std::{fmt::Write, path::Path};

/// A point and a unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRow {
    /// Position, m.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

/// Reads `x,y,z,nx,ny,nz` rows under a header line.
///
/// # Errors
/// One line naming the file, the row and the cause.
pub fn read_points(path: &Path) -> anyhow::Result<Vec<PointRow>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut lines = text.lines().enumerate();
    let header = lines.next().map(|(_, h)| h.replace(' ', "")).unwrap_or_default();
    if header != "x,y,z,nx,ny,nz" {
        bail!("{}: the header is `{header}`, not `x,y,z,nx,ny,nz`", path.display());
    }
    let mut rows = Vec::new();
    for (index, line) in lines.filter(|(_, l)| !l.trim().is_empty()) {
        let numbers: Vec<f32> = line.split(',').filter_map(|n| n.trim().parse().ok()).collect();
        let [x, y, z, nx, ny, nz] = numbers[..] else {
            bail!("{}: line {}: six numbers wanted, `{line}` found", path.display(), index + 1);
        };
        let (position, normal) = (Vec3::new(x, y, z), Vec3::new(nx, ny, nz).normalize_or_zero());
        if !position.is_finite() || normal == Vec3::ZERO {
            bail!(
                "{}: line {}: the position must be finite and the normal not zero",
                path.display(),
                index + 1
            );
        }
        rows.push(PointRow { position, normal });
    }
    Ok(rows)
}

/// One column: its header and its values, one a row.
pub type Column = (&'static str, Vec<f32>);

/// The points again, then `columns`.
pub fn format_points(points: &[PointRow], columns: &[Column]) -> String {
    let mut text = String::from("x,y,z,nx,ny,nz");
    for (name, _) in columns {
        let _ = write!(text, ",{name}");
    }
    text.push('\n');
    for (i, row) in points.iter().enumerate() {
        let (p, n) = (row.position, row.normal);
        let _ = write!(text, "{},{},{},{},{},{}", p.x, p.y, p.z, n.x, n.y, n.z);
        for (_, values) in columns {
            let _ = write!(text, ",{}", values[i]);
        }
        text.push('\n');
    }
    text
}
