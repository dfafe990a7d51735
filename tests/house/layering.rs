//! The rules of the house, read from the source: who may use whom, and how long a file may be.
//! `src/lib.rs` states them for readers.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

/// A layer, the layers it may use besides itself, and the crates it may use besides `std`.
struct Rule {
    layer: &'static str,
    layers: &'static [&'static str],
    crates: &'static [&'static str],
}

const PURE: [Rule; 9] = [
    Rule { layer: "language", layers: &[], crates: &["toml"] },
    Rule { layer: "scan", layers: &[], crates: &["nalgebra", "rayon", "thiserror", "tobj"] },
    Rule { layer: "spline", layers: &[], crates: &["nalgebra", "rayon", "thiserror"] },
    Rule { layer: "leg", layers: &["scan", "spline"], crates: &["nalgebra", "rayon", "thiserror"] },
    Rule { layer: "cad", layers: &["spline"], crates: &["nalgebra", "thiserror", "zmij"] },
    Rule {
        layer: "sizes",
        layers: &["leg"],
        crates: &["jiff", "libm", "serde", "sha2", "thiserror", "toml"],
    },
    Rule {
        layer: "record",
        layers: &["language", "scan", "spline", "leg", "cad", "sizes"],
        crates: &[
            "base64",
            "encoding_rs",
            "flate2",
            "jiff",
            "nalgebra",
            "pdf_writer",
            "schemars",
            "serde",
            "serde_json",
            "sha2",
            "subsetter",
            "thiserror",
            "tiny_skia",
        ],
    },
    Rule {
        layer: "visits",
        layers: &["language", "leg", "record"],
        crates: &["jiff", "nalgebra", "serde", "thiserror"],
    },
    Rule {
        layer: "flow",
        layers: &["language", "scan", "sizes", "record"],
        crates: &["jiff", "regex", "serde", "thiserror"],
    },
];

/// Layers with effects, and which of the others they may use.
const EFFECTS: [Rule; 3] = [
    Rule { layer: "store", layers: &["sizes", "record", "flow"], crates: &[] },
    Rule {
        layer: "station",
        layers: &[
            "language", "scan", "leg", "sizes", "record", "visits", "flow", "store", "config",
        ],
        crates: &[],
    },
    Rule {
        layer: "config",
        layers: &["language", "leg", "cad", "sizes", "record", "visits", "flow", "store"],
        crates: &[],
    },
];

/// What no pure layer may name.
const EFFECTFUL: [&str; 9] = [
    "std::fs",
    "std::env",
    "std::net",
    "std::process",
    "std::thread",
    "Instant",
    "SystemTime",
    "HashMap",
    "HashSet",
];

/// Longest file, lines.
const LINES_MAX: usize = 400;

/// Most files of one folder.
const FILES_MAX: usize = 20;

/// Most folders within each other, below `src` or `tests`.
const DEPTH_MAX: usize = 3;

/// Every crate of Cargo.toml, so that a new one cannot slip into a pure layer unseen.
fn dependencies() -> Vec<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let named = ["dependencies", "dev-dependencies"].map(|part| manifest[part].as_table().unwrap());
    let names = named.iter().flat_map(|part| part.keys()).map(|name| name.replace('-', "_"));
    names.filter(|name| !name.starts_with("gaiter_")).collect()
}

pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    collect(folder, &mut found);
    assert!(!found.is_empty(), "no file in {}", folder.display());
    found
}

/// The Rust files of a layer: `src/<layer>.rs` and everything below `src/<layer>/`.
fn files(layer: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let file = root().join(format!("src/{layer}.rs"));
    found.extend(file.exists().then_some(file));
    collect(&root().join("src").join(layer), &mut found);
    collect(&root().join("crates").join(layer).join("src"), &mut found);
    assert!(!found.is_empty(), "no file of layer {layer}: the rule looks at nothing");
    found
}

pub fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Code lines with their numbers: comments, and the tests at the foot of a file, may name anything.
fn code(path: &Path) -> Vec<(usize, String)> {
    if path.file_stem().is_some_and(|stem| stem == "tests") {
        return Vec::new();
    }
    let text = fs::read_to_string(path).unwrap();
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    let lines = code.lines().enumerate().map(|(index, line)| (index + 1, line));
    let lines = lines.map(|(number, line)| (number, line.split("//").next().unwrap().to_owned()));
    lines.filter(|(_, line)| !line.trim().is_empty()).collect()
}

/// Words that follow `prefix` in a line, up to the next character that belongs to no name.
fn named<'a>(line: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    let name = |rest: &'a str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next();
    line.match_indices(prefix).filter_map(move |(at, _)| name(&line[at + prefix.len()..]))
}

fn layers_used(rule: &Rule, faults: &mut Vec<String>) {
    for path in files(rule.layer) {
        for (number, line) in code(&path) {
            for used in named(&line, "crate::").filter(|used| *used != rule.layer) {
                if !rule.layers.contains(&used) {
                    let place = format!("{}:{number}", path.display());
                    faults.push(format!("{place}: `{}` may not use `crate::{used}`", rule.layer));
                }
            }
        }
    }
}

#[test]
fn a_layer_uses_only_layers_above_it() {
    let mut faults = Vec::new();
    // Those of the pure layers are crates: their manifests say what they use.
    EFFECTS.iter().for_each(|rule| layers_used(rule, &mut faults));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_surface_fits_go_from_knots_to_grids_to_clouds() {
    let mut faults = Vec::new();
    for (folder, later) in [("knots", ["grid", "cloud"]), ("grid", ["cloud", "tensor"])] {
        for path in files_below(&root().join("crates/spline/src").join(folder)) {
            for (number, line) in code(&path) {
                let used = named(&line, "crate::").find(|used| later.contains(used));
                let place = format!("{}:{number}", path.display());
                faults.extend(used.map(|used| format!("{place}: `{folder}` may not use `{used}`")));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn pure_layers_use_only_their_crates_and_no_effects() {
    let dependencies = dependencies();
    assert!(dependencies.len() > 10, "Cargo.toml was not read: {dependencies:?}");
    let mut faults = Vec::new();
    for rule in &PURE {
        for path in files(rule.layer) {
            for (number, line) in code(&path) {
                let banned =
                    dependencies.iter().filter(|name| !rule.crates.contains(&name.as_str()));
                let crates = banned.map(|name| format!("{name}::"));
                let effects = EFFECTFUL.iter().map(|&word| word.to_owned());
                for word in crates.chain(effects).filter(|word| contains_word(&line, word)) {
                    let place = format!("{}:{number}", path.display());
                    faults.push(format!("{place}: `{}` may not use `{word}`", rule.layer));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Whether `word` stands in the line and is not the tail of a longer name.
fn contains_word(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
    })
}

#[test]
fn every_pure_layer_switches_clippys_bans_on() {
    for rule in &PURE {
        let text = fs::read_to_string(root().join(format!("crates/{}/src/lib.rs", rule.layer)));
        let ban = "#![deny(clippy::disallowed_methods, clippy::disallowed_types)]";
        assert!(text.unwrap().contains(ban), "the layer {} lacks {ban}", rule.layer);
    }
}

#[test]
fn every_file_says_what_it_is_and_none_is_too_long() {
    let mut found = Vec::new();
    ["src", "crates", "tests", "benches", "examples"]
        .iter()
        .for_each(|f| collect(&root().join(f), &mut found));
    assert!(found.len() > 50, "only {} files were looked at", found.len());
    for path in found {
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("//!"), "{} does not open with `//!`", path.display());
        let lines = text.lines().count();
        assert!(lines <= LINES_MAX, "{} has {lines} lines", path.display());
    }
}

#[test]
fn no_folder_is_too_full_or_too_deep() {
    let mut seen = 0;
    for top in ["src", "tests", "benches", "examples"] {
        folders_hold(&root().join(top), 0, &mut seen);
    }
    assert!(seen > 40, "only {seen} folders were looked at");
}

fn folders_hold(folder: &Path, depth: usize, seen: &mut usize) {
    *seen += 1;
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_code = |path: &PathBuf| !path.ends_with("node_modules");
    let (folders, files): (Vec<_>, Vec<_>) =
        entries.filter(is_code).partition(|path| path.is_dir());
    assert!(files.len() <= FILES_MAX, "{} has {} files", folder.display(), files.len());
    for folder in folders {
        assert!(depth < DEPTH_MAX, "{} lies too deep", folder.display());
        folders_hold(&folder, depth + 1, seen);
    }
}
