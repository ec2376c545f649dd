//! The volume against the path tracer, in the scenes that the program ships.
//!
//! The indirect part of the office has a relative standard deviation of 3.5 a path, so the reference is kept
//! in `tests/golden`: 1,000 points in the open air, facing anywhere.

use super::*;
use lumenscope_core::{
    math::colour::luminance,
    radiosity::{RadiositySettings, RadiositySolution},
    scene::direct::{Receiver, total_irradiance},
};
use lumenscope_tests::golden::{self, Errors, Truth};
use rayon::prelude::*;

/// Errors with exact direct light, of the indirect part, and interpolated altogether.
fn measured(file: &str, scene: &str) -> [Errors; 3] {
    let world = golden::shipped(scene);
    let radiosity =
        RadiositySolution::solve(&world, &RadiositySettings::default(), &Progress::silent()).unwrap();
    let volume =
        IrradianceVolume::build(&world, &radiosity, &VolumeSettings::default(), &Progress::silent()).unwrap();
    let (truths, receivers) = (golden::read(file), golden::air_points(&world, golden::POINTS));
    let errors = |of: fn(&Truth) -> f32, found: &(dyn Fn(usize, &Receiver) -> f32 + Sync)| {
        let estimates: Vec<f32> = receivers.par_iter().enumerate().map(|(i, r)| found(i, r)).collect();
        let truths: Vec<(f32, f32)> = truths.iter().map(|t| (of(t), t.standard_error)).collect();
        golden::errors(&estimates, &truths)
    };
    let at = |r: &Receiver, part| luminance(volume.irradiance(r.position, r.normal, part));
    let direct = |i: usize, r: &Receiver| luminance(total_irradiance(&world, r, 64, i as u32));
    let errors = [
        errors(Truth::all, &|i, r| at(r, Part::Indirect) + direct(i, r)),
        errors(|t| t.indirect, &|_, r| at(r, Part::Indirect)),
        errors(Truth::all, &|_, r| at(r, Part::All)),
    ];
    for (name, e) in ["direct light exact", "indirect part", "interpolated"].iter().zip(&errors) {
        eprintln!("{scene}, {name}: {e}");
    }
    errors
}

#[test]
fn the_volume_agrees_with_the_reference_in_the_office() {
    let [exact, indirect, interpolated] = measured("air", "office/office.ron");
    for e in [&exact, &indirect, &interpolated] {
        assert!(e.median < 0.04 && e.flux.abs() < 0.02, "{} {}", e.median, e.flux);
    }
    // The project's bounds, for what lights things that move.
    assert!(exact.high < 0.15 && exact.signed.abs() < 0.02, "{} {}", exact.high, exact.signed);
}

#[test]
fn the_volume_agrees_with_the_reference_in_the_cornell_box() {
    let [exact, indirect, interpolated] = measured("cornell_air", "cornell/cornell.ron");
    for e in [&exact, &indirect] {
        assert!(e.median < 0.03 && e.high < 0.15, "{} {}", e.median, e.high);
        assert!(e.signed.abs() < 0.02 && e.flux.abs() < 0.02, "{} {}", e.signed, e.flux);
    }
    // Interpolated direct light leaks into shadows by up to a cell, where the 5 % floor counts it heavily.
    assert!(interpolated.median < 0.04 && interpolated.flux.abs() < 0.02, "{}", interpolated.median);
}

#[test]
fn the_offices_tables_take_what_is_said_of_them() {
    let world = golden::shipped("office/office.ron");
    let coarse =
        RadiositySettings { element_spacing_m: Some(0.3), gather_rays: 16, ..RadiositySettings::default() };
    let radiosity = RadiositySolution::solve(&world, &coarse, &Progress::silent()).unwrap();
    let settings = VolumeSettings { target_samples: 2287, ..VolumeSettings::default() };
    let volume = IrradianceVolume::build(&world, &radiosity, &settings, &Progress::silent()).unwrap();
    let samples = volume.samples().len();
    let (bins, harmonics) = (volume.table_bytes(), volume.harmonics().bytes());
    eprintln!(
        "{samples} samples: {bins} bytes a part as bins, {harmonics} all three as harmonics, {} held",
        volume.bytes()
    );
    // 578 texels of 8 bytes; nine coefficients of three channels, on 32 numbers, of the sum too.
    assert_eq!((bins, harmonics), (samples * 578 * 8, 3 * samples * 32 * 4));
    // 10.2 MB and 0.28 MB a part, as the README says.
    assert!(bins < 10_250_000 && harmonics < 3 * 285_000, "{bins} {harmonics}");
}
