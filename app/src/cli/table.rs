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

/// Points with the indirect irradiance there and its standard error, lx, as `irradiance --method reference
/// --part indirect` writes them.
///
/// # Errors
/// One line naming the file, the row and the cause.
pub fn read_reference(path: &Path) -> anyhow::Result<Vec<(PointRow, [Vec3; 2])>> {
    const HEADER: &str = "x,y,z,nx,ny,nz,E_r,E_g,E_b,stderr_r,stderr_g,stderr_b";
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut lines = text.lines().enumerate();
    if lines.next().is_none_or(|(_, header)| header != HEADER) {
        bail!("{}: the header is not `{HEADER}`", path.display());
    }
    lines
        .map(|(index, line)| {
            let numbers: Vec<f32> = line
                .split(',')
                .filter_map(|n| n.trim().parse().ok())
                .filter(|n: &f32| n.is_finite())
                .collect();
            let at = |i: usize| Vec3::from_slice(&numbers[3 * i..]);
            if numbers.len() != 12 || at(1).normalize_or_zero() == Vec3::ZERO {
                bail!("{}: line {}: twelve finite numbers wanted, `{line}` found", path.display(), index + 1);
            }
            Ok((PointRow { position: at(0), normal: at(1).normalize() }, [at(2), at(3)]))
        })
        .collect()
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
