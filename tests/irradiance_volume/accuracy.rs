//! The volume against the path tracer, in the scenes that the program ships.
//!
//! The indirect part of the office has a relative standard deviation of 3.5 a path, so a reference worth
//! comparing with takes minutes. It is therefore kept beside this file, one CSV a scene, as
//! `lumenscope irradiance SCENE --points P.csv --method reference --part indirect --spp N --out R.csv`
//! wrote it with N = 65,536 (office) and 8,192 (Cornell box), at 1,000 points drawn uniformly from the
//! scene's bounds, of whose 288 rays none meets the back of a surface, and directions uniform on the
//! sphere. Each test first holds some rows to a fresh estimate, so that a changed scene is noticed.
//! Direct light is evaluated on the spot: it is a closed form times visibility.

use super::*;
use lumenscope_core::{
    math::colour::luminance,
    radiosity::{RadiositySettings, RadiositySolution},
    reference::irradiance::irradiance,
    scene::{
        direct::{Receiver, total_irradiance},
        import,
    },
};
use rayon::prelude::*;
use std::path::Path;

/// Points and directions with the light there, by luminance, lx.
struct Truth {
    receivers: Vec<Receiver>,
    indirect: Vec<f32>,
    direct: Vec<f32>,
    /// Standard error of `indirect`.
    noise: Vec<f32>,
}

/// Errors |E − E_ref| / max(E_ref, 5 % of the mean) over the points.
struct Errors {
    median: f32,
    percentile_95: f32,
    /// Mean of the same with its sign.
    signed: f32,
    /// Mean of E − E_ref over the mean of E_ref.
    flux: f32,
}

impl Truth {
    fn of(scene: &str, world: &World) -> Self {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("irradiance_volume/{scene}_indirect.csv"));
        let text = std::fs::read_to_string(path).unwrap();
        let rows: Vec<Vec<f32>> =
            text.lines().skip(1).map(|l| l.split(',').map(|n| n.parse().unwrap()).collect()).collect();
        let vector = |row: &[f32], i: usize| Vec3::from_slice(&row[3 * i..]);
        let receivers: Vec<Receiver> =
            rows.iter().map(|r| Receiver::new(vector(r, 0), vector(r, 1).normalize())).collect();
        for i in (0..rows.len()).step_by(rows.len() / 8) {
            let fresh = irradiance(world, &receivers[i], Part::Indirect, 4096, 77);
            let (now, then) = (luminance(fresh.mean), luminance(vector(&rows[i], 2)));
            let spread = luminance(fresh.standard_error).hypot(luminance(vector(&rows[i], 3)));
            // Nine rows and 63 degrees of freedom: five standard errors once in 20,000 runs.
            assert!(
                (now - then).abs() <= 5.0 * spread + 1e-3,
                "row {i} of {scene}_indirect.csv says {then} lx, the path tracer {now} ± {spread}: if the \
                 scene was changed, the file has to be written anew"
            );
        }
        let direct = receivers.par_iter().enumerate();
        Self {
            indirect: rows.iter().map(|r| luminance(vector(r, 2))).collect(),
            noise: rows.iter().map(|r| luminance(vector(r, 3))).collect(),
            direct: direct.map(|(i, r)| luminance(total_irradiance(world, r, 64, i as u32))).collect(),
            receivers,
        }
    }

    /// Errors of a method; `part` is what it gives.
    fn errors(&self, part: Part, of: impl Fn(usize, &Receiver) -> f32) -> Errors {
        let truth: Vec<f32> = match part {
            Part::Indirect => self.indirect.clone(),
            _ => self.indirect.iter().zip(&self.direct).map(|(i, d)| i + d).collect(),
        };
        let count = truth.len() as f32;
        let mean = truth.iter().sum::<f32>() / count;
        let found = self.receivers.iter().enumerate().map(|(i, r)| of(i, r));
        let difference: Vec<f32> = found.zip(&truth).map(|(e, t)| e - t).collect();
        let relative: Vec<f32> = difference.iter().zip(&truth).map(|(d, t)| d / t.max(0.05 * mean)).collect();
        let mut sizes: Vec<f32> = relative.iter().map(|e| e.abs()).collect();
        sizes.sort_by(f32::total_cmp);
        Errors {
            median: sizes[sizes.len() / 2],
            percentile_95: sizes[sizes.len() * 95 / 100],
            signed: relative.iter().sum::<f32>() / count,
            flux: difference.iter().sum::<f32>() / count / mean,
        }
    }

    fn median_noise(&self) -> f32 {
        let total: Vec<f32> = self.indirect.iter().zip(&self.direct).map(|(i, d)| i + d).collect();
        let mean = total.iter().sum::<f32>() / total.len() as f32;
        let mut noise: Vec<f32> =
            self.noise.iter().zip(&total).map(|(n, t)| n / t.max(0.05 * mean)).collect();
        noise.sort_by(f32::total_cmp);
        noise[noise.len() / 2]
    }
}

/// Errors with exact direct light, of the indirect part, and interpolated altogether.
fn measured(scene: &str) -> [Errors; 3] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let world = World::new(&import::load(&root.join(format!("{scene}/{scene}.ron"))).unwrap());
    let radiosity =
        RadiositySolution::solve(&world, &RadiositySettings::default(), &Progress::silent()).unwrap();
    let volume =
        IrradianceVolume::build(&world, &radiosity, &VolumeSettings::default(), &Progress::silent()).unwrap();
    let truth = Truth::of(scene, &world);
    eprintln!("{scene}: reference to {:.2} %", 100.0 * truth.median_noise());
    let at = |r: &Receiver, part| luminance(volume.irradiance(r.position, r.normal, part));
    let errors = [
        truth.errors(Part::All, |i, r| at(r, Part::Indirect) + truth.direct[i]),
        truth.errors(Part::Indirect, |_, r| at(r, Part::Indirect)),
        truth.errors(Part::All, |_, r| at(r, Part::All)),
    ];
    for (name, e) in ["direct light exact", "indirect part", "interpolated"].iter().zip(&errors) {
        eprintln!(
            "{scene}, {name}: median {:.2} %, 95th {:.1} %, signed {:+.2} %, flux {:+.2} %",
            100.0 * e.median,
            100.0 * e.percentile_95,
            100.0 * e.signed,
            100.0 * e.flux
        );
    }
    errors
}

#[test]
fn the_volume_agrees_with_the_reference_in_the_office() {
    let [exact, indirect, interpolated] = measured("office");
    for e in [&exact, &indirect, &interpolated] {
        assert!(e.median < 0.04 && e.flux.abs() < 0.02, "{} {}", e.median, e.flux);
    }
    // The project's bounds, for what lights things that move.
    assert!(
        exact.percentile_95 < 0.15 && exact.signed.abs() < 0.02,
        "{} {}",
        exact.percentile_95,
        exact.signed
    );
}

#[test]
fn the_volume_agrees_with_the_reference_in_the_cornell_box() {
    let [exact, indirect, interpolated] = measured("cornell");
    for e in [&exact, &indirect] {
        assert!(e.median < 0.03 && e.percentile_95 < 0.15, "{} {}", e.median, e.percentile_95);
        assert!(e.signed.abs() < 0.02 && e.flux.abs() < 0.02, "{} {}", e.signed, e.flux);
    }
    // Interpolated direct light leaks into shadows by up to a cell, where the 5 % floor counts it heavily.
    assert!(interpolated.median < 0.04 && interpolated.flux.abs() < 0.02, "{}", interpolated.median);
}
