//! What the command line says before it does anything: which configuration it takes, and where a patient's
//! id belongs.

#![allow(clippy::unwrap_used)]

use std::process::{Command, Output};

use rig::verb::{code, gaiter, program, stderr, stdout};

/// Runs a verb with `GAITER_CONFIG` set to this.
fn with_config(args: &[&str], config: &str) -> Output {
    Command::new(program()).args(args).env("GAITER_CONFIG", config).output().unwrap()
}

#[test]
fn the_environment_names_the_configuration_unless_an_option_does() {
    for verb in [["check"].as_slice(), &["status"], &["patient", "show"], &["run"]] {
        let output = with_config(verb, "/nowhere/of-environment.toml");
        assert_eq!(code(&output), Some(66), "{verb:?}");
        assert!(stderr(&output).contains("/nowhere/of-environment.toml"), "{}", stderr(&output));
        let option = ["--config", "/nowhere/of-option.toml"];
        let output = with_config(&[verb, &option].concat(), "/nowhere/of-environment.toml");
        assert!(stderr(&output).contains("/nowhere/of-option.toml"), "{}", stderr(&output));
    }
    // A variable that is set to nothing names nothing.
    let help = stdout(&with_config(&["check", "--help"], ""));
    assert!(help.contains("[default: /etc/gaiter/station.toml]"), "{help}");
    assert!(help.contains("GAITER_CONFIG"), "{help}");
}

#[test]
fn scans_are_measured_with_a_configuration_only_if_an_option_names_it() {
    let output = with_config(&["extract", "missing.obj"], "/nowhere/of-environment.toml");
    assert!(stderr(&output).contains("missing.obj") && !stderr(&output).contains("nowhere"));
}

#[test]
fn a_patients_id_as_an_argument_is_refused_with_the_command_that_asks_for_it() {
    for (args, command) in [
        (["patient", "set", "4711"], "gaiter patient set"),
        (["assign", "abcd1234", "4711"], "gaiter assign abcd1234"),
    ] {
        let output = gaiter(&args);
        assert_eq!(code(&output), Some(64), "{args:?}");
        let said = stderr(&output);
        assert!(said.contains("is never an argument") && said.contains(command), "{said}");
        assert!(!said.contains("4711"), "the id is not repeated: {said}");
    }
    let output = gaiter(&["patient", "4711"]);
    assert_eq!(code(&output), Some(64));
    assert!(stderr(&output).contains("gaiter patient set asks for the id"), "{}", stderr(&output));
}

#[test]
fn a_report_of_nothing_says_what_was_looked_for() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_string_lossy().into_owned();
    for (name, expected) in
        [("missing", "there is no such file or folder"), (".", "neither a record.json nor")]
    {
        let output = gaiter(&["report", &path(name), "--out", &path("out")]);
        assert_eq!(code(&output), Some(66));
        let said = stderr(&output);
        assert!(said.contains(expected) && said.contains("a patient's folder"), "{said}");
    }
}
