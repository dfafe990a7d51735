//! `gaiter calibrate` as a technician and a program use it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use rig::verb::{gaiter, stderr, stdout};
use serde_json::Value;
use support::mesh::Mesh;
use tempfile::TempDir;

/// A cylinder of 55 mm radius, as a scanner of this scale exports it.
fn cylinder(scale: f64) -> (TempDir, PathBuf) {
    let dir = TempDir::new().unwrap();
    let file = dir.path().join("PHANTOM.obj");
    let mesh = Mesh::column([0.0; 2], 55.0, 0.0, 400.0).scaled(scale);
    fs::write(&file, mesh.obj()).unwrap();
    (dir, file)
}

fn girth_cm() -> String {
    format!("{:.2}", TAU * 5.5)
}

#[test]
fn a_body_that_is_measured_right_is_told_so_for_people_and_for_programs() {
    let (_dir, file) = cylinder(1.0);
    let file = file.to_str().unwrap();
    let told = gaiter(&["calibrate", file, "--girths", &girth_cm()]);
    assert_eq!(told.status.code(), Some(0), "{}", stderr(&told));
    assert!(stdout(&told).ends_with("every girth is within 2 mm\n"), "{}", stdout(&told));
    let told = gaiter(&["calibrate", file, "--girths", &girth_cm(), "--json"]);
    let check: Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(check["schema"], "gaiter.phantom-check/1");
    assert_eq!(check["result"], "within");
    assert_eq!(check["figures"]["girths"].as_array().unwrap().len(), 5);
}

#[test]
fn a_scale_that_is_off_ends_with_65_and_the_figures() {
    let (_dir, file) = cylinder(0.97);
    let told = gaiter(&["calibrate", file.to_str().unwrap(), "--girths", &girth_cm()]);
    assert_eq!(told.status.code(), Some(65));
    // 3 % of 345.6 mm, and the facets of 40 sides.
    assert!(stdout(&told).contains("bias -10."), "{}", stdout(&told));
    let lenient =
        ["calibrate", file.to_str().unwrap(), "--girths", &girth_cm(), "--tolerance", "15"];
    assert_eq!(gaiter(&lenient).status.code(), Some(0));
}

#[test]
fn the_girths_come_from_the_configuration_unless_they_are_named() {
    let (dir, file) = cylinder(1.0);
    let config = dir.path().join("station.toml");
    let plain = "[station]\nid = \"b\"\nstate_dir = \"/s\"\n[scanner]\nexport_dirs = [\"/e\"]\n[store.folder]\npath = \"/r\"\n";
    let with = format!("{plain}[phantom]\ngirths = \"{}\"\n", girth_cm());
    for (text, code, what) in [(&with[..], 0, ""), (plain, 64, "phantom.girths")] {
        fs::write(&config, text).unwrap();
        let words = ["calibrate", file.to_str().unwrap(), "--config", config.to_str().unwrap()];
        let told = gaiter(&words);
        assert_eq!(told.status.code(), Some(code), "{}", stderr(&told));
        assert!(stderr(&told).contains(what), "{}", stderr(&told));
    }
}

#[test]
fn what_is_wrong_is_told_with_its_code() {
    let (dir, file) = cylinder(1.0);
    let file = file.to_str().unwrap();
    let missing = dir.path().join("none.obj");
    for (words, code, what) in [
        (["calibrate", file, "--girths", "90"], 65, "[phantom-not-there]"),
        (["calibrate", file, "--girths", "39.9:34.56"], 65, "[phantom-too-low]"),
        (["calibrate", file, "--girths", "34,56"], 64, "has no height"),
        (["calibrate", missing.to_str().unwrap(), "--girths", "34.56"], 66, "none.obj"),
    ] {
        let told = gaiter(&words);
        assert_eq!(told.status.code(), Some(code), "{words:?}: {}", stderr(&told));
        assert!(stderr(&told).contains(what), "{words:?}: {}", stderr(&told));
    }
}
