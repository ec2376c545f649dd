//! Loading, checking and solving a scene for the subcommands, with progress on stderr.

use super::Common;
use anyhow::{Context, bail};
use lumenscope_core::{
    math::progress::Progress,
    scene::{Scene, check::Severity, import, world::World},
    superposition::plan::Plan,
    transport::{LightTransportSolution, live::LiveTransport},
};
use std::{
    io::{IsTerminal, Write},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// A scene with its plan.
pub struct Loaded {
    /// The scene.
    pub scene: Arc<Scene>,
    /// What will be computed for it.
    pub plan: Plan,
}

/// Loads a scene, repeats its warnings on stderr, and plans it.
///
/// # Errors
/// One line naming the file and the cause.
pub fn load(path: &Path, common: &Common) -> anyhow::Result<Loaded> {
    let mut scene = import::load(path)?;
    common.elements.apply(&mut scene.plan)?;
    for warning in &scene.warnings {
        eprintln!("{}: warning: {warning}", path.display());
    }
    let plan = Plan::new(&scene, &World::new(&scene), common.tolerance, common.seed);
    Ok(Loaded { scene: Arc::new(scene), plan })
}

/// Solves a loaded scene.
///
/// # Errors
/// When a solver fails.
pub fn solve(loaded: &Loaded, with_volume: bool) -> anyhow::Result<LightTransportSolution> {
    Ok(live(loaded, with_volume)?.current().clone())
}

/// Solves a loaded scene, ready to follow changes.
///
/// # Errors
/// When a solver fails.
pub fn live(loaded: &Loaded, with_volume: bool) -> anyhow::Result<LiveTransport> {
    let mut settings = loaded.plan.solve.clone();
    if with_volume {
        settings.volume.get_or_insert_with(|| loaded.plan.volume.clone());
    }
    watched(|progress| LiveTransport::solve(loaded.scene.clone(), settings, progress, &mut |_| {}))
        .with_context(|| loaded.scene.name.clone())
}

/// Runs `work` and shows its progress on stderr.
pub fn watched<T>(work: impl FnOnce(&Progress) -> T) -> T {
    let progress = Progress::default();
    let done = AtomicBool::new(false);
    std::thread::scope(|threads| {
        threads.spawn(|| show(&progress, &done));
        let result = work(&progress);
        done.store(true, Ordering::Relaxed);
        result
    })
}

fn show(progress: &Progress, done: &AtomicBool) {
    let terminal = std::io::stderr().is_terminal();
    let mut last = String::new();
    while !done.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(50));
        let (stage, share) = progress.state();
        if terminal {
            eprint!("\r{stage:<24}{:>4.0} %", share * 100.0);
            let _ = std::io::stderr().flush();
        } else if stage != last {
            eprintln!("{stage}");
        }
        last = stage;
    }
    if terminal {
        eprint!("\r{:<30}\r", "");
    }
}

/// The `check` subcommand: prints what was found; an error when any of it will likely make light wrong.
///
/// # Errors
/// When the scene cannot be loaded or a finding is a warning.
pub fn check(path: &Path) -> anyhow::Result<()> {
    let scene = import::load(path)?;
    for warning in &scene.warnings {
        println!("loading: {warning}");
    }
    let findings = lumenscope_core::scene::check::check(&scene);
    for finding in &findings {
        println!("{finding}");
    }
    let warnings = findings.iter().filter(|f| f.severity == Severity::Warning).count();
    println!(
        "{}: {} triangles, {} findings, {warnings} warnings",
        path.display(),
        scene.triangle_count(),
        findings.len()
    );
    if warnings > 0 {
        bail!("{}: {warnings} findings will likely make light wrong", path.display());
    }
    Ok(())
}

/// Creates a folder for output.
///
/// # Errors
/// One line naming the folder and the cause.
pub fn output_folder(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create the folder {}", folder.display()))
}

/// Writes a text file.
///
/// # Errors
/// One line naming the file and the cause.
pub fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}
