//! Completions and manual pages: that shells and `man` take them, and what stands in them.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

use rig::verb::{code, gaiter, stdout};

/// Verbs that every table of verbs must hold.
const VERBS: [&str; 5] = ["status", "extract", "reextract", "completions", "man"];

/// The verb by which the station calls itself.
const HIDDEN: &str = "measure";

#[test]
fn every_shell_s_completions_know_the_verbs_and_not_the_hidden_one() {
    for shell in ["bash", "zsh", "fish"] {
        let output = gaiter(&["completions", shell]);
        assert_eq!(code(&output), Some(0));
        let script = stdout(&output);
        VERBS.iter().for_each(|verb| assert!(script.contains(verb), "{shell}: {verb}"));
        let hidden = |line: &&str| line.split(|c: char| !c.is_alphanumeric()).any(|w| w == HIDDEN);
        // Descriptions may use the word; nothing else may.
        let named: Vec<&str> =
            script.lines().filter(hidden).filter(|line| !line.contains("Measure")).collect();
        assert!(named.is_empty(), "{shell}: {named:?}");
    }
    assert_eq!(code(&gaiter(&["completions", "tcsh"])), Some(64));
}

#[test]
fn bash_takes_its_completions_and_completes_by_them() {
    let script = stdout(&gaiter(&["completions", "bash"]));
    let ask = "\nCOMP_WORDS=(gaiter reext); COMP_CWORD=1; _gaiter gaiter reext gaiter\n\
               printf '%s\\n' \"${COMPREPLY[@]}\"\n";
    let mut bash = Command::new("bash");
    bash.arg("--norc").stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut bash = bash.spawn().unwrap();
    bash.stdin.take().unwrap().write_all((script + ask).as_bytes()).unwrap();
    let output = bash.wait_with_output().unwrap();
    assert_eq!(stdout(&output), "reextract\n", "{output:?}");
}

#[test]
fn the_manual_has_a_page_for_every_verb_that_people_use() {
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(code(&gaiter(&["man", dir.path().to_str().unwrap()])), Some(0));
    let page = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    assert_eq!(page("gaiter.1"), stdout(&gaiter(&["man"])));
    let verb_of = |name: &str| name.strip_prefix("gaiter-")?.strip_suffix(".1").map(str::to_owned);
    let names = fs::read_dir(dir.path()).unwrap().map(|entry| entry.unwrap().file_name());
    let names: Vec<String> = names.filter_map(|name| verb_of(&name.to_string_lossy())).collect();
    assert!(VERBS.into_iter().chain(["patient-set"]).all(|verb| names.iter().any(|n| n == verb)));
    for verb in names {
        let text = page(&format!("gaiter-{verb}.1"));
        let example = format!("gaiter {}", verb.replace('-', " "));
        let text_plain = text.replace("\\-", "-").replace("give-up", "give up");
        let example = example.replace("gdt order", "gdt-order");
        assert!(
            text_plain.contains("Examples:") && text_plain.contains(&example),
            "{verb}:\n{text}"
        );
        assert!(text.contains(".TH ") && text.contains(".SH SYNOPSIS"), "{verb}:\n{text}");
    }
    assert!(!dir.path().join(format!("gaiter-{HIDDEN}.1")).exists());
    assert!(page("gaiter.1").contains("Exit codes"));
    assert_eq!(code(&gaiter(&["man", dir.path().join("missing").to_str().unwrap()])), Some(66));
}

#[test]
fn man_itself_finds_no_fault_in_the_pages() {
    let dir = tempfile::tempdir().unwrap();
    gaiter(&["man", dir.path().to_str().unwrap()]);
    for page in fs::read_dir(dir.path()).unwrap() {
        let page = page.unwrap().path();
        // Where there is no man, the pages' structure is what was looked at above.
        let Ok(output) = Command::new("man").args(["--warnings", "-l"]).arg(&page).output() else {
            return;
        };
        assert!(output.status.success() && output.stderr.is_empty(), "{page:?}: {output:?}");
        assert!(stdout(&output).contains("SYNOPSIS"), "{page:?}");
    }
}
