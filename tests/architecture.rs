//! The one-way flow: earlier modules never name later ones. Reads the sources and holds the wall.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Modules of the core in the order light passes through them. Rooms share one rank and must not
/// name each other's passes or views.
const ORDER: [&[&str]; 8] = [
    &["math"],
    &["scene"],
    &["reference", "radiosity", "irradiance_volume", "mirror", "glossy"],
    &["transport"],
    &["superposition"],
    &["gpu"],
    &["measure", "io"],
    &["registry"],
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_path_buf).unwrap_or_default()
}

fn sources(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() && path.file_name().is_some_and(|n| n != "target") {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn rank(module: &str) -> Option<usize> {
    ORDER.iter().position(|names| names.contains(&module))
}

/// Modules of the crate that a source names through `crate::`, outside comments.
fn named_modules(text: &str) -> Vec<String> {
    let code: String =
        text.lines().map(|l| l.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
    let mut names = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + 7..];
        let mut word = |s: &str| {
            let name: String =
                s.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if !name.is_empty() {
                names.push(name);
            }
        };
        if let Some(group) = rest.strip_prefix('{') {
            let mut depth = 0;
            let mut start = 0;
            for (i, c) in group.char_indices() {
                match c {
                    '{' => depth += 1,
                    '}' if depth == 0 => {
                        word(&group[start..i]);
                        break;
                    }
                    '}' => depth -= 1,
                    ',' if depth == 0 => {
                        word(&group[start..i]);
                        start = i + 1;
                    }
                    _ => {}
                }
            }
        } else {
            word(rest);
        }
    }
    names
}

#[test]
fn earlier_modules_never_name_later_ones() {
    let core = root().join("core/src");
    let mut arrows = 0;
    for path in sources(&core, "rs") {
        let relative = path.strip_prefix(&core).unwrap_or(&path);
        let own = relative
            .components()
            .next()
            .map(|c| c.as_os_str().to_string_lossy().into_owned())
            .unwrap_or_default();
        let own = own.trim_end_matches(".rs");
        let stage = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let Some(own_rank) = rank(own) else { continue };
        let late = matches!(stage.as_str(), "inspect" | "pass" | "gpu");
        for named in named_modules(&fs::read_to_string(&path).unwrap_or_default()) {
            let Some(named_rank) = rank(&named) else { continue };
            arrows += 1;
            let allowed = named_rank <= own_rank || (late && named != "registry");
            assert!(allowed, "{} names the later module `{named}`", relative.display());
        }
    }
    assert!(arrows > 50, "the wall was not looked at: {arrows} arrows found");
}

#[test]
fn core_knows_no_window() {
    let manifest = fs::read_to_string(root().join("core/Cargo.toml")).unwrap_or_default();
    for name in ["egui", "eframe", "winit", "rfd"] {
        assert!(!manifest.lines().any(|l| l.starts_with(name)), "core depends on {name}");
    }
    assert!(manifest.contains("wgpu"), "the manifest was not read");
}

#[test]
fn every_source_is_small_and_says_what_it_is() {
    let mut files = sources(&root().join("core"), "rs");
    files.extend(sources(&root().join("app"), "rs"));
    files.extend(sources(&root().join("shaders"), "wgsl"));
    assert!(files.len() > 40, "only {} sources found", files.len());
    for path in files {
        let text = fs::read_to_string(&path).unwrap_or_default();
        assert!(text.lines().count() <= 600, "{} is over 600 lines", path.display());
        let first = text.lines().next().unwrap_or("");
        let said = first.starts_with("//") || first.starts_with("#![doc");
        assert!(said, "{} does not begin by saying what it is", path.display());
    }
}
