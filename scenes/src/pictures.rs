//! Small pictures made by formula: floor, paintings, a monitor's page, the sky behind the window.

use crate::random::Random;
use image::{ImageFormat, Rgb, RgbImage};
use std::io::Cursor;

/// PNG bytes of a picture given by its sRGB values over x right, y down in [0, 1).
fn png(width: u32, height: u32, mut colour: impl FnMut(f64, f64) -> [f64; 3]) -> Vec<u8> {
    let picture = RgbImage::from_fn(width, height, |x, y| {
        let at = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
        Rgb(colour(at(x, width), at(y, height)).map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8))
    });
    let mut bytes = Cursor::new(Vec::new());
    // Writing to memory cannot fail; an empty picture would show in the test of committed files.
    let _ = picture.write_to(&mut bytes, ImageFormat::Png);
    bytes.into_inner()
}

fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t)
}

/// Oak planks running along x: eight boards to the tile, mean reflectance about 0.25.
pub fn planks() -> Vec<u8> {
    let mut random = Random::new(11);
    let boards: Vec<(f64, f64)> =
        (0..8).map(|_| (random.between(-0.045, 0.045), random.between(0.0, 1.0))).collect();
    png(128, 128, |x, y| {
        let (shade, end) = boards[(y * 8.0) as usize];
        let across = (y * 8.0).fract();
        let along = (x - end).rem_euclid(1.0);
        let grain = 0.018 * ((across * 9.0 + 0.7 * (along * 6.0).sin() + end * 40.0) * 3.0).sin();
        let seam = if across < 0.07 || along < 0.009 { -0.12 } else { 0.0 };
        [0.62, 0.525, 0.405].map(|c| c + shade + grain + seam)
    })
}

/// Rolling hills under a low sun.
pub fn hills() -> Vec<u8> {
    png(128, 96, |x, y| {
        let sun = ((x - 0.68).powi(2) * 1.8 + (y - 0.36).powi(2)).sqrt();
        let mut colour = mix([0.93, 0.55, 0.35], [0.98, 0.86, 0.62], (y * 1.7).min(1.0));
        if sun < 0.11 {
            colour = [1.0, 0.95, 0.80];
        }
        let ridges = [
            (0.50, 0.06, 5.0, 0.4, [0.55, 0.45, 0.55]),
            (0.60, 0.08, 4.0, 1.9, [0.36, 0.38, 0.50]),
            (0.72, 0.07, 6.0, 0.0, [0.20, 0.34, 0.40]),
            (0.85, 0.06, 7.0, 2.6, [0.10, 0.24, 0.26]),
        ];
        for (level, height, rate, phase, shade) in ridges {
            if y > level - height * (x * rate + phase).sin() {
                colour = shade;
            }
        }
        colour
    })
}

/// Rectangles of primary colours between black bars.
pub fn bars() -> Vec<u8> {
    let fields: [([f64; 4], [f64; 3]); 6] = [
        ([0.34, 0.0, 1.0, 0.60], [0.80, 0.12, 0.10]),
        ([0.0, 0.62, 0.32, 1.0], [0.10, 0.22, 0.62]),
        ([0.84, 0.80, 1.0, 1.0], [0.95, 0.80, 0.15]),
        ([0.0, 0.0, 0.32, 0.26], [0.93, 0.91, 0.86]),
        ([0.0, 0.29, 0.32, 0.60], [0.93, 0.91, 0.86]),
        ([0.34, 0.62, 0.82, 1.0], [0.90, 0.88, 0.82]),
    ];
    png(96, 96, |x, y| {
        let bar = [0.33, 0.83].iter().zip([0.0, 0.61]).any(|(&at, from)| (x - at).abs() < 0.018 && y > from)
            || (y - 0.61).abs() < 0.018
            || ((y - 0.275).abs() < 0.016 && x < 0.33)
            || ((y - 0.80).abs() < 0.018 && x > 0.83);
        if bar {
            return [0.07, 0.07, 0.08];
        }
        let inside = |r: &[f64; 4]| x >= r[0] && y >= r[1] && x < r[2] && y < r[3];
        fields.iter().find(|(r, _)| inside(r)).map_or([0.93, 0.91, 0.86], |&(_, colour)| colour)
    })
}

/// Overlapping rings of colour.
pub fn rings() -> Vec<u8> {
    let rings = [
        (0.36, 0.34, 0.26, [0.95, 0.62, 0.18]),
        (0.66, 0.42, 0.22, [0.10, 0.48, 0.55]),
        (0.44, 0.70, 0.24, [0.75, 0.20, 0.28]),
        (0.74, 0.76, 0.14, [0.20, 0.26, 0.48]),
    ];
    png(96, 128, |x, y| {
        let mut colour = [0.94, 0.92, 0.86];
        for (cx, cy, radius, shade) in rings {
            let r = ((x - cx).powi(2) + ((y - cy) * 1.33).powi(2)).sqrt();
            if r < radius && (r / radius * 3.5).fract() < 0.68 {
                colour = [0, 1, 2].map(|i| 0.25 * colour[i] + 0.75 * shade[i]);
            }
        }
        colour
    })
}

/// A page of text beside a chart, as a monitor shows it.
pub fn page() -> Vec<u8> {
    png(128, 76, |x, y| {
        if y < 0.07 {
            return [0.20, 0.30, 0.46];
        }
        if x < 0.17 {
            let entry = (y * 16.0).fract() < 0.4 && x > 0.02 && x < 0.12 && y < 0.7;
            return if entry { [0.62, 0.68, 0.76] } else { [0.22, 0.25, 0.31] };
        }
        let chart = x > 0.60 && x < 0.95 && y > 0.18 && y < 0.60;
        if chart {
            let wave = 0.40 - 0.14 * ((x - 0.6) * 14.0).sin() * (x * 3.0).cos();
            return if y > wave { [0.93, 0.55, 0.22] } else { [0.84, 0.87, 0.90] };
        }
        let (row, word) = ((y * 26.0).floor(), (x * 23.0).floor());
        let written = (y * 26.0).fract() < 0.45
            && (row * 7.3 + word * 3.7).sin() > -0.55
            && x > 0.21
            && x < if y > 0.64 { 0.95 } else { 0.56 }
            && y > 0.14
            && y < 0.92;
        if written { [0.35, 0.37, 0.40] } else { [0.93, 0.93, 0.91] }
    })
}

/// The blue hour over a town: a factor on the radiance of the window's outside.
pub fn dusk() -> Vec<u8> {
    let mut random = Random::new(5);
    let towers: Vec<(f64, f64)> =
        (0..26).map(|_| (random.between(0.02, 0.05), random.between(0.08, 0.36))).collect();
    let mut left = 0.0;
    let spans: Vec<(f64, f64, f64)> = towers
        .iter()
        .map(|&(width, height)| {
            let span = (left, left + width, height);
            left += width * 1.15;
            span
        })
        .collect();
    png(128, 64, |x, y| {
        let sky = mix([0.24, 0.36, 0.66], [0.98, 0.72, 0.52], (y * 1.15).powf(2.2).min(1.0));
        let Some(tower) = spans.iter().find(|s| x >= s.0 && x < s.1 && y > 1.0 - s.2) else { return sky };
        let (column, row) = (((x - tower.0) * 128.0 / 2.0).floor(), (y * 32.0).floor());
        let lit = (column * 12.7 + row * 5.3 + tower.2 * 90.0).sin() > 0.55;
        if lit { [0.98, 0.80, 0.45] } else { [0.13, 0.16, 0.26] }
    })
}

/// Squares of light and dark with a few warm ones, eight by four.
pub fn checks() -> Vec<u8> {
    png(64, 32, |x, y| {
        let (column, row) = ((x * 8.0) as i32, (y * 4.0) as i32);
        match (column + row) % 2 {
            0 => [0.90, 0.89, 0.86],
            _ if (column * 3 + row) % 5 == 0 => [0.70, 0.22, 0.12],
            _ => [0.16, 0.17, 0.20],
        }
    })
}

/// Parquet: squares of five strips, laid crosswise in turn; mean reflectance about 0.2.
pub fn parquet() -> Vec<u8> {
    let mut random = Random::new(23);
    let shades: Vec<f64> = (0..80).map(|_| random.between(-0.055, 0.055)).collect();
    png(128, 128, |x, y| {
        let (column, row) = ((x * 4.0) as usize, (y * 4.0) as usize);
        let turned = (column + row) % 2 == 1;
        let (fx, fy) = ((x * 4.0).fract(), (y * 4.0).fract());
        let (across, along) = if turned { (fx, fy) } else { (fy, fx) };
        let strip = (across * 5.0) as usize;
        let shade = shades[(column + 4 * row) * 5 + strip];
        let inside = (across * 5.0).fract();
        let grain = 0.014 * ((inside * 7.0 + shade * 90.0 + 0.5 * (along * 9.0).sin()) * 3.0).sin();
        let seam = if inside < 0.10 || along < 0.02 { -0.10 } else { 0.0 };
        [0.60, 0.45, 0.31].map(|c| c + shade + grain + seam)
    })
}

/// Two systems of five lines with notes, stems and a heading.
pub fn staves() -> Vec<u8> {
    png(96, 128, |x, y| {
        let paper = [0.95, 0.93, 0.87];
        let ink = [0.12, 0.11, 0.11];
        if y < 0.10 {
            return if y > 0.035 && y < 0.07 && x > 0.30 && x < 0.70 { ink } else { paper };
        }
        if !(0.07..=0.93).contains(&x) {
            return paper;
        }
        let system = ((y - 0.10) * 8.0).floor();
        let inside = ((y - 0.10) * 8.0).fract();
        let line = (inside - 0.25) * 10.0;
        if (0.0..5.0).contains(&line) && line.fract() < 0.35 {
            return mix(paper, ink, 0.75);
        }
        let beat = ((x - 0.07) * 18.0).floor();
        let at = ((x - 0.07) * 18.0).fract();
        let pitch = 0.30 + 0.055 * ((beat * 2.3 + system * 1.7).sin() * 3.5).round();
        let head = ((at - 0.4) / 0.30).powi(2) + ((inside - pitch) / 0.06).powi(2) < 1.0;
        let stem = (at - 0.66).abs() < 0.09 && inside < pitch && inside > pitch - 0.28;
        let bar = beat % 4.0 == 3.0 && at > 0.9 && (0.25..0.72).contains(&inside);
        if (head || stem) && beat % 4.0 != 3.0 || bar { ink } else { paper }
    })
}

/// A woven rug: borders around a field of lozenges.
pub fn carpet() -> Vec<u8> {
    png(128, 96, |x, y| {
        let edge = (x.min(1.0 - x) * 1.33).min(y.min(1.0 - y));
        let (red, navy, gold, pale) =
            ([0.52, 0.15, 0.12], [0.13, 0.17, 0.30], [0.74, 0.58, 0.30], [0.80, 0.73, 0.60]);
        if edge < 0.025 {
            return pale;
        }
        if edge < 0.14 {
            let along = if (x.min(1.0 - x)) * 1.33 < y.min(1.0 - y) { y * 12.0 } else { x * 16.0 };
            let lozenge = (along.fract() - 0.5).abs() / 0.42 + ((edge - 0.08) / 0.045).abs();
            return if lozenge < 1.0 { gold } else { navy };
        }
        if edge < 0.155 {
            return gold;
        }
        let (u, w) = ((x - 0.5).abs() * 1.33, (y - 0.5).abs());
        let medallion = u / 0.44 + w / 0.30;
        if medallion < 0.35 {
            return gold;
        }
        if medallion < 1.0 {
            return if (medallion * 7.0).fract() < 0.3 { pale } else { navy };
        }
        if ((x * 18.0).fract() - 0.5).abs() + ((y * 14.0).fract() - 0.5).abs() < 0.22 { gold } else { red }
    })
}

/// A garden on a bright afternoon: sky, trees, a lawn; a factor on the radiance of a window's outside.
pub fn garden() -> Vec<u8> {
    let mut random = Random::new(31);
    // Crowns of trees, far ones first: middle, radius, shade.
    let crowns: Vec<[f64; 4]> = (0..60)
        .map(|i| {
            let near = f64::from(i) / 60.0;
            let y = 0.62 + 0.13 * near + random.between(-0.06, 0.03);
            [random.between(-0.05, 1.05), y, random.between(0.05, 0.11), near + random.between(-0.15, 0.15)]
        })
        .collect();
    let leaves: Vec<f64> = (0..64 * 64).map(|_| random.between(-0.05, 0.05)).collect();
    png(96, 128, |x, y| {
        let mut colour = mix([0.62, 0.77, 0.98], [0.97, 0.97, 0.94], (y * 1.7).min(1.0));
        for [cx, cy, radius, near] in &crowns {
            let (dx, dy) = ((x - cx) / radius, (y - cy) / (1.15 * radius));
            let reach = dx * dx + dy * dy + 0.25 * (9.0 * dx + 3.0 * cx).sin() * (8.0 * dy).sin();
            if reach < 1.0 {
                let lit = (0.45 - 0.45 * dy + 0.2 * dx).clamp(0.0, 1.0);
                let shade = mix([0.24, 0.36, 0.24], [0.56, 0.66, 0.38], lit);
                colour = mix([0.60, 0.70, 0.68], shade, 0.45 + 0.55 * near.clamp(0.0, 1.0));
            }
        }
        let lawn = 0.80 + 0.012 * (x * 9.0).sin();
        if y > lawn {
            colour = mix([0.48, 0.58, 0.30], [0.62, 0.68, 0.40], ((y - lawn) * 5.0).min(1.0));
        }
        let leaf =
            if y > 0.5 { leaves[(x * 64.0) as usize % 64 + 64 * ((y * 64.0) as usize % 64)] } else { 0.0 };
        colour.map(|c| (c + leaf * c).min(1.0))
    })
}
