//! From layers to the display, and what is drawn over them.

use super::*;
use lumenscope_core::{
    inspection::{ColouredMesh, InspectionScene, Line, SphereGlyph, ValueLine},
    math::{
        false_colour::{FalseColour, Palette},
        sphere_map::DirectionBins,
    },
    superposition::{
        PassSettings,
        composite::{self, Display, ToneCurve},
        overlay, render,
    },
};
use lumenscope_tests::cornell;

#[test]
fn the_display_is_the_same_within_one_step() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let heat = |logarithmic| FalseColour { palette: Palette::Inferno, low: 0.5, high: 60.0, logarithmic };
    for display in [
        Display { ev100: 4.0, ..Display::default() },
        Display { ev100: 3.0, tone: ToneCurve::Linear, false_colour: None },
        Display { false_colour: Some(heat(false)), ..Display::default() },
        Display { false_colour: Some(heat(true)), ..Display::default() },
    ] {
        let weights = [1.0, 0.5, 2.0, 1.0, 1.0];
        let settings = FrameSettings {
            display,
            weights,
            ..frame_settings(solution.scene.camera, DirectQuality::Elements)
        };
        gpu.frame(&settings);
        let wanted = composite::display(&gpu.layers().sum(weights), &display);
        // One step of 255 for the rounding of pow, log and the sums in f32.
        let worst = gpu
            .output()
            .iter()
            .zip(&wanted)
            .flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)))
            .max();
        assert!(worst <= Some(1), "{display:?}: {worst:?} steps");
    }
}

#[test]
fn an_outline_surrounds_the_selected_object_alone() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let plain = frame_settings(solution.scene.camera, DirectQuality::Elements);
    gpu.frame(&plain);
    let before = gpu.output();
    let block = solution.scene.objects.iter().position(|o| o.name == "short block").unwrap() as u32;
    gpu.frame(&FrameSettings { highlighted: Some(block), ..plain });
    let after = gpu.output();
    let on_block: Vec<bool> = gpu
        .triangles()
        .iter()
        .map(|&t| t != u32::MAX && solution.world.geometry.object[t as usize] == block)
        .collect();
    let changed = before.iter().zip(&after).filter(|(a, b)| a != b).count();
    assert!(changed > 50, "{changed} pixels outlined");
    assert!(changed < on_block.len() / 10, "{changed} pixels outlined");
    assert!((0..after.len()).all(|i| !on_block[i] || before[i] == after[i]), "the object itself changed");
}

#[test]
fn inspection_scenes_are_drawn_as_the_overlay_says() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let solution = solved(cornell());
    gpu.upload(&solution);
    let bins = DirectionBins::new(5);
    let glyph = |centre, first_bin| SphereGlyph { centre, radius: 0.12, first_bin, sample: 0 };
    let scene = InspectionScene {
        spheres: vec![
            glyph(Vec3::new(-0.5, 1.5, 0.3), 0),
            glyph(Vec3::new(0.7, 0.3, -0.6), bins.len() as u32),
            glyph(Vec3::new(0.1, 1.2, 0.5), 0),
        ],
        sphere_bins: (0..2 * bins.len())
            .map(|i| Vec3::new((i % 17) as f32, (i % 11) as f32, (i % 5) as f32))
            .collect(),
        bins: Some(bins),
        meshes: vec![ColouredMesh {
            positions: vec![
                Vec3::new(-0.9, 0.02, 0.9),
                Vec3::new(0.0, 0.02, 0.9),
                Vec3::new(-0.9, 0.9, -0.9),
            ],
            values: vec![Vec3::ZERO, Vec3::splat(8.0), Vec3::splat(16.0)],
            triangles: vec![[0, 1, 2]],
            transparency: 0.4,
        }],
        value_lines: vec![ValueLine {
            ends: [Vec3::new(0.9, 0.1, 0.9), Vec3::new(-0.9, 1.9, -0.9)],
            value: 12.0,
            transparency: 0.5,
        }],
        lines: vec![Line {
            ends: [Vec3::new(-0.9, 0.1, 0.9), Vec3::new(0.9, 1.9, -0.9)],
            colour: Vec3::new(1.0, 0.2, 0.1),
        }],
        ..InspectionScene::default()
    };
    let camera = solution.scene.camera;
    let settings = frame_settings(camera, DirectQuality::Elements);
    let pass = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &pass);
    let plain = composite::display(&layers.total(), &settings.display);
    let over = |palette| FalseColour { palette, low: 0.0, high: 16.0, logarithmic: false };
    for palette in [Palette::Viridis, Palette::Natural] {
        let colour = over(palette);
        gpu.renderer.set_inspection(&gpu.context.device, &gpu.context.queue, Some(&scene), &colour).unwrap();
        gpu.frame(&settings);
        let mut wanted = plain.clone();
        overlay::draw(&mut wanted, &buffer, &camera, &scene, &colour);
        let drawn = plain.iter().zip(&wanted).filter(|(a, b)| a != b).count();
        assert!(drawn > 500, "only {drawn} pixels of overlay");
        let off = gpu
            .output()
            .iter()
            .zip(&wanted)
            .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2))
            .count();
        // Edges of lines, triangles and bins fall on the other side of a pixel's centre now and then.
        println!("overlay, {palette:?}: {off} of {} pixels differ, {drawn} are drawn", wanted.len());
        assert!(off * 100 <= wanted.len(), "{palette:?}: {off} pixels differ");
    }
    let colour = over(Palette::Viridis);
    gpu.renderer.set_inspection(&gpu.context.device, &gpu.context.queue, None, &colour).unwrap();
    gpu.frame(&settings);
    let left = gpu.output().iter().zip(&plain).filter(|(a, b)| a[0].abs_diff(b[0]) > 2).count();
    assert!(left * 100 <= plain.len(), "{left} pixels of overlay are left");
}
