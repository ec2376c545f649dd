//! `textures --scene`: the texture of one surface of a scene by the thesis's conversions and at the three stages,
//! against the path tracer.

use super::{
    Common,
    page::{INK, Page},
    solve,
};
use crate::{
    panels::texture::{NAMES, middle},
    widgets::field::{UNKNOWN, bulk},
};
use anyhow::{Context, bail};
use glam::Vec3;
use lumenscope_core::{
    io::exr,
    math::{
        colour::{luminance, srgb8},
        false_colour::{FalseColour, Palette},
        image::LinearImage,
        progress::Progress,
    },
    measure::{
        grid_orders::ORDERS,
        grid_texture::{GridReference, GridTexture, StageSettings},
        image::second_difference,
    },
    radiosity::RadiositySolution,
};
use std::{fmt::Write as _, path::Path};

/// Longer edge of a picture on the sheet, pixels.
const TILE: f32 = 220.0;
const MARGIN: usize = 12;
const HEAD: usize = 28;
const FOOT: usize = 44;

/// Farthest that an element may be from the point that is named, in spacings.
const REACH_SPACINGS: f32 = 4.0;

/// Prints how far each stage is from the path tracer; writes `stages.csv`, `stages.exr` with what each stage shows and
/// the reference, and `stages.png` with what is shown, its difference to the reference and its second difference.
///
/// # Errors
/// One line naming the file or option and the cause.
pub fn run(
    scene: &Path,
    at: Vec3,
    settings: &StageSettings,
    out: &Path,
    common: &Common,
) -> anyhow::Result<()> {
    solve::output_folder(out)?;
    let loaded = solve::load(scene, common)?;
    let solution = solve::solve(&loaded, false)?;
    let element = nearest(&solution.radiosity, at)?;
    let Some(grid) = GridTexture::of_element(&solution.radiosity, &solution.world, element) else {
        bail!(
            "--at {},{},{}: the surface there is curved and neither a ball nor the side of a cylinder, or small and lit at its corners",
            at.x,
            at.y,
            at.z
        );
    };
    let mut reference = GridReference::new(&grid, common.seed);
    solve::watched(|progress: &Progress| {
        progress.begin("irradiance of a texture");
        while !reference.is_done() {
            reference.more(&grid, &solution.world, progress)?;
        }
        anyhow::Ok(())
    })?;
    let wanted = reference.mean(&grid);
    let stages = grid.stages(settings);
    let mut csv = String::from("stage,texels,bytes,rel_mse,perceptual,largest_lx\n");
    println!(
        "{} x {} nodes over {:.2} x {:.2} m; {} paths a point, {:.2} % noise",
        grid.nodes[0],
        grid.nodes[1],
        grid.size_m.x,
        grid.size_m.y,
        reference.paths(),
        100.0 * reference.noise(&grid)
    );
    if let Some([taken, full]) = grid.samples() {
        println!("{taken} samples of {full}, where light bends");
    }
    let orders = grid.orders();
    let converted = ORDERS.iter().zip(orders.iter().flatten());
    for (name, stage) in converted.clone().chain(NAMES.iter().zip(&stages)) {
        let error = grid.judge(stage, &wanted).with_context(|| format!("stage {name}"))?;
        println!(
            "{name:<16} {:>8} texels  relMSE {:.2e}  perceptual {:.5}  largest {:+.1} lx",
            stage.texels(),
            error.rel_mse,
            error.perceptual,
            error.largest_lx
        );
        // Writing to a string cannot fail.
        let _ = writeln!(
            csv,
            "{name},{},{},{},{},{}",
            stage.texels(),
            stage.bytes(),
            error.rel_mse,
            error.perceptual,
            error.largest_lx
        );
    }
    solve::write(&out.join("stages.csv"), &csv)?;
    let at_points: Vec<LinearImage> = stages.iter().map(|s| grid.at_points(s)).collect();
    let orders: Vec<LinearImage> = converted.map(|(_, stage)| grid.at_points(stage)).collect();
    let names = ["reference", "stored", "hermite", "shown", "zero_order", "first_order"];
    let images = std::iter::once(&wanted).chain(&at_points).chain(&orders);
    let layers: Vec<(&str, &LinearImage)> = names.into_iter().zip(images).collect();
    exr::write_layers(&out.join("stages.exr"), &layers, "irradiance, lx")?;
    let scale = TILE / grid.size_m.max_element().max(1e-6);
    let size = [grid.size_m.x, grid.size_m.y].map(|m| ((m * scale) as u32).clamp(8, TILE as u32));
    let shown: Vec<LinearImage> = stages.iter().map(|s| s.picture(size)).collect();
    let page = sheet(&grid, &shown, &at_points, &wanted);
    let path = out.join("stages.png");
    page.write(&path)?;
    eprintln!("{}", path.display());
    Ok(())
}

/// The shown element nearest to a point.
fn nearest(radiosity: &RadiositySolution, at: Vec3) -> anyhow::Result<u32> {
    let away = |i: &usize| radiosity.elements()[*i].position.distance(at);
    let shown = (0..radiosity.elements().len()).filter(|&i| radiosity.elements()[i].is_shown());
    let found =
        shown.min_by(|a, b| away(a).total_cmp(&away(b))).context("nothing in the scene takes light")?;
    let most = REACH_SPACINGS * radiosity.transport().map.spacing_m;
    if away(&found) > most {
        bail!("--at {},{},{}: no surface within {most:.2} m", at.x, at.y, at.z);
    }
    Ok(found as u32)
}

/// A row a kind of picture, a column a stage; the ranges below.
fn sheet(grid: &GridTexture, shown: &[LinearImage], at_points: &[LinearImage], wanted: &LinearImage) -> Page {
    let (w, h) = (shown[0].width as usize, shown[0].height as usize);
    let mut page = Page::new(3 * (w + MARGIN) + MARGIN, HEAD + 3 * (h + MARGIN) + FOOT);
    let bends: Vec<LinearImage> = shown.iter().map(second_difference).collect();
    let covered = |pixel: usize| grid.covers(middle(pixel, [w as u32, h as u32]));
    let of_surface = |image: &LinearImage| -> Vec<Vec3> {
        (0..w * h).filter(|&i| covered(i)).map(|i| image.pixels[i]).collect()
    };
    let high = bulk(shown.iter().flat_map(of_surface));
    let off = |stage: usize, i: usize| luminance(at_points[stage].pixels[i] - wanted.pixels[i]);
    let points = (0..wanted.pixels.len()).filter(|&i| grid.is_judged(i));
    let offs = points.flat_map(|i| (0..3).map(move |stage| (stage, i)));
    let most = bulk(offs.map(|(stage, i)| Vec3::splat(off(stage, i))));
    let bend = bulk(bends.iter().flat_map(of_surface).filter(|p| p.x != 0.0));
    let light = FalseColour::over([0.0, high], Palette::Viridis);
    let signed = |range: f32| FalseColour::over([-range, range], Palette::Diverging);
    for stage in 0..3 {
        let left = MARGIN + stage * (w + MARGIN);
        page.text(left, 10, 1, NAMES[stage], INK);
        for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
            let point = [x * wanted.width as usize / w, y * wanted.height as usize / h];
            let point = point[1] * wanted.width as usize + point[0];
            let judged = grid.is_judged(point).then(|| signed(most).colour(off(stage, point)));
            if !covered(y * w + x) {
                (0..3).for_each(|row| page.put(left + x, HEAD + row * (h + MARGIN) + y, UNKNOWN));
                continue;
            }
            let colours = [
                srgb8(light.colour(luminance(shown[stage].pixels[y * w + x]))),
                judged.map_or(UNKNOWN, srgb8),
                srgb8(signed(bend).colour(luminance(bends[stage].pixels[y * w + x]))),
            ];
            for (row, colour) in colours.into_iter().enumerate() {
                page.put(left + x, HEAD + row * (h + MARGIN) + y, colour);
            }
        }
    }
    let top = HEAD + 3 * (h + MARGIN);
    page.text(MARGIN, top, 1, &format!("shown, 0 to {high:.0} lx"), INK);
    page.text(MARGIN, top + 12, 1, &format!("less the path tracer, ±{most:.2} lx"), INK);
    page.text(MARGIN, top + 24, 1, &format!("second difference, ±{bend:.3} lx a pixel²"), INK);
    page
}
