//! Every script of `fixtures/trigger` is heard exactly as it says itself.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use rig::faults::mock_port::script;
use rig::faults::player::{Player, parted};

fn scripts() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/trigger");
    let mut scripts: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    scripts.retain(|path| path.extension().is_some_and(|ending| ending == "script"));
    scripts.sort();
    assert!(scripts.len() > 10, "only {} scripts", scripts.len());
    scripts
}

#[test]
fn every_script_is_heard_as_it_says() {
    let mut wrong = String::new();
    for path in scripts() {
        let text = fs::read_to_string(&path).unwrap();
        let (toml, script) = parted(&text);
        let name = path.file_name().unwrap().display();
        for fault in Player::new(toml, script).play() {
            wrong += &format!("{name}: {fault}\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn an_hour_without_the_port_takes_no_memory_one_line_and_a_try_every_three_seconds() {
    let script = script("+0ms unplug\n+3600s plug\n+5s expect state open");
    let toml = "[trigger.serial]\nport = \"/p\"\ntokens = [\"PRESS\"]\n";
    let mut player = Player::new(toml, script.unwrap());
    // Nothing in it can grow: its size is that of the struct, the fault's text and empty buffers.
    assert_eq!(player.play(), Vec::<String>::new());
    assert!(player.lines <= 3, "{} lines", player.lines);
}

#[test]
fn a_loose_plug_for_an_hour_says_at_most_one_line_a_minute() {
    let lines: String = (0..1000).map(|_| "+1700ms unplug\n+1900ms plug\n").collect();
    let script = script(&lines).unwrap();
    let toml =
        "[trigger]\nsettle = \"0s\"\n[trigger.serial]\nport = \"/p\"\ntokens = [\"PRESS\"]\n";
    let mut player = Player::new(toml, script);
    assert_eq!(player.play(), Vec::<String>::new());
    assert!(player.lines <= 60, "{} lines", player.lines);
    assert!(player.stage.opened() > 300, "opened {} times", player.stage.opened());
}
