//! A recorded walk: places on it, and the camera between them.

use anyhow::{Context, bail};
use glam::Vec3;
use lumenscope_core::scene::camera::Camera;
use std::path::Path;

/// A place on a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    seconds: f32,
    eye: Vec3,
    target: Vec3,
}

/// A walk through a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk(Vec<Place>);

/// Columns of the file.
const HEADER: &str = "seconds,eye_x,eye_y,eye_z,target_x,target_y,target_z";

impl Walk {
    /// Reads a CSV of places in the order of time.
    ///
    /// # Errors
    /// One line naming the file, the row and the cause.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let text =
            std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    fn parse(text: &str) -> anyhow::Result<Self> {
        let mut lines = text.lines().enumerate();
        if lines.next().is_none_or(|(_, header)| header.trim() != HEADER) {
            bail!("the header is not `{HEADER}`");
        }
        let mut places: Vec<Place> = Vec::new();
        for (index, line) in lines.filter(|(_, l)| !l.trim().is_empty()) {
            let numbers: Vec<f32> = line
                .split(',')
                .filter_map(|n| n.trim().parse().ok())
                .filter(|n: &f32| n.is_finite())
                .collect();
            let [seconds, ..] = numbers[..] else { bail!("line {}: `{line}`", index + 1) };
            if numbers.len() != 7 {
                bail!("line {}: seven finite numbers wanted, `{line}` found", index + 1);
            }
            if places.last().is_some_and(|last| last.seconds >= seconds) {
                bail!("line {}: {seconds} s is not after the line before", index + 1);
            }
            let at = |i: usize| Vec3::from_slice(&numbers[i..]);
            places.push(Place { seconds, eye: at(1), target: at(4) });
        }
        if places.len() < 2 {
            bail!("a walk has two places at least");
        }
        Ok(Self(places))
    }

    /// The camera at a share of the way, a Catmull–Rom curve through the places; the lens is `lens`'s.
    pub fn camera(&self, share: f32, lens: &Camera) -> Camera {
        let places = &self.0;
        let last = places.len() - 1;
        let (from, to) = (places[0].seconds, places[last].seconds);
        let seconds = from + share.clamp(0.0, 1.0) * (to - from);
        let i = places.partition_point(|p| p.seconds <= seconds).clamp(1, last) - 1;
        let t = ((seconds - places[i].seconds) / (places[i + 1].seconds - places[i].seconds)).clamp(0.0, 1.0);
        let four = [i.saturating_sub(1), i, i + 1, (i + 2).min(last)].map(|k| places[k]);
        Camera {
            eye: catmull_rom(four.map(|p| p.eye), t),
            target: catmull_rom(four.map(|p| p.target), t),
            ..*lens
        }
    }
}

fn catmull_rom([a, b, c, d]: [Vec3; 4], t: f32) -> Vec3 {
    let (t2, t3) = (t * t, t * t * t);
    0.5 * (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2 + (3.0 * (b - c) + d - a) * t3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_passes_its_places_and_bad_files_are_named() {
        let text = format!("{HEADER}\n0,0,0,0,0,0,-1\n2,1,0,0,1,0,-1\n4,1,0,2,1,0,1\n");
        let walk = Walk::parse(&text).unwrap();
        let lens = Camera::default();
        assert_eq!(walk.camera(0.0, &lens).eye, Vec3::ZERO);
        assert_eq!(walk.camera(0.5, &lens).eye, Vec3::X);
        assert_eq!(walk.camera(1.0, &lens).target, Vec3::new(1.0, 0.0, 1.0));
        for bad in ["a,b\n", &format!("{HEADER}\n0,0,0,0,0,0,-1\n"), &format!("{HEADER}\n1,0,0\n")] {
            assert!(Walk::parse(bad).is_err(), "{bad}");
        }
        let backwards = format!("{HEADER}\n2,0,0,0,0,0,-1\n1,1,0,0,1,0,-1\n");
        assert!(Walk::parse(&backwards).unwrap_err().to_string().contains("line 3"));
    }
}
