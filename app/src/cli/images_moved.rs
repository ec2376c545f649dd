//! What images-with-depth cost when something moves: kept, and taken anew.

use super::solve;
use anyhow::{Context, bail};
use glam::{Affine3A, Vec3};
use lumenscope_core::{
    math::progress::Progress,
    mirror::images::{ImageWithDepth, MirrorImages},
    scene::{Scene, Target, world::World},
};
use std::{fmt::Write as _, path::Path, sync::Arc, time::Instant};

/// Times each way, in turns.
const ROUNDS: usize = 5;

/// Moves each of some objects alone, and prints and writes what keeping the images costs; `anew` takes them of nothing.
///
/// # Errors
/// Where an object is not known or not movable; and where what is kept is not what is taken anew.
pub fn run(
    scene: &Scene,
    taken: &MirrorImages,
    (names, by): (&[String], Vec3),
    anew: &dyn Fn(&World) -> anyhow::Result<MirrorImages>,
    out: &Path,
) -> anyhow::Result<()> {
    let world = World::new(scene);
    let mut text = String::from("object,rays,points,share_percent,images_changed,images,kept_ms,anew_ms\n");
    println!(
        "{:<24}{:>12}{:>12}{:>9}{:>18}{:>11}{:>11}{:>8}",
        "moved", "rays", "points", "share %", "images changed", "kept, ms", "anew, ms", "ratio"
    );
    for name in names {
        let object = scene.objects.iter().position(|o| o.name == *name);
        let object = object.with_context(|| format!("no object is called `{name}`"))?;
        if !scene.objects[object].movable {
            bail!("`{name}` is not movable");
        }
        let mut moved = scene.clone();
        let placed = Affine3A::from_translation(by) * scene.objects[object].world_from_object;
        moved.place(Target::Object(object), placed);
        let mut there = world.clone();
        there.follow(&moved);
        let (mut kept_ms, mut anew_ms) = (Vec::new(), Vec::new());
        let mut kept = MirrorImages::default();
        for _ in 0..ROUNDS {
            let began = Instant::now();
            let followed = taken.followed(&there, u64::MAX, &Progress::silent())?;
            kept_ms.push(1e3 * began.elapsed().as_secs_f64());
            let began = Instant::now();
            let fresh = anew(&there)?;
            anew_ms.push(1e3 * began.elapsed().as_secs_f64());
            kept = followed.context("the images are gone")?;
            if kept.sets != fresh.sets {
                bail!("`{name}`: the images kept are not those taken anew");
            }
        }
        let [kept_ms, anew_ms] = [kept_ms, anew_ms].map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[ROUNDS / 2]
        });
        let list = |of: &MirrorImages| -> Vec<Arc<ImageWithDepth>> {
            of.sets.iter().flat_map(|set| set.elements.iter().flatten().cloned()).collect()
        };
        let (before, now) = (list(taken), list(&kept));
        let changed = now.len() - before.iter().zip(&now).filter(|(a, b)| Arc::ptr_eq(a, b)).count();
        let (rays, points) = (kept.rays, kept.points());
        let share = 100.0 * rays as f64 / points.max(1) as f64;
        println!(
            "{name:<24}{rays:>12}{points:>12}{share:>9.2}{:>18}{kept_ms:>11.1}{anew_ms:>11.1}{:>8.1}",
            format!("{changed} of {}", now.len()),
            anew_ms / kept_ms
        );
        let _ = writeln!(text, "{name},{rays},{points},{share},{changed},{},{kept_ms},{anew_ms}", now.len());
    }
    solve::write(&out.join("moved.csv"), &text)
}
