//! The shipped `config/station.toml` against the reader, so that neither can drift from the other.

use gaiter_leg::method::B1;
use gaiter_toml::Key;
use toml::de::DeTable;

use super::Config;
use super::load::{config, load};
use super::parse::{Absent, Reader};
use super::removed::REMOVED;
use super::words::TAPES;

const SHIPPED: &str = include_str!("../../config/station.toml");

/// Every key the reader asks for.
fn keys() -> Vec<Key> {
    let empty = DeTable::parse("").unwrap();
    let mut reader = Reader::new("", empty.get_ref(), &[], REMOVED);
    assert!(config(&mut reader).is_none(), "an empty file lacks the required keys");
    assert!(!reader.keys.is_empty());
    reader.keys
}

/// The key and the value of a line that sets one and has nothing else.
fn setting(line: &str) -> Option<(&str, &str)> {
    line.split_once(" = ").filter(|_| DeTable::parse(line).is_ok())
}

/// A key that the shipped file shows and does not set: its line without the `# ` before it.
fn off(line: &str) -> Option<&str> {
    line.strip_prefix("# ").filter(|line| setting(line).is_some())
}

/// The shipped file as (key with sections, the line that sets or shows it, the remarks above it).
fn entries() -> Vec<(String, &'static str, String)> {
    let (mut section, mut remarks, mut entries) = ("", String::new(), Vec::new());
    for line in SHIPPED.lines() {
        if let Some((name, _)) = off(line).and_then(setting) {
            entries.push((format!("{section}.{name}"), line, std::mem::take(&mut remarks)));
        } else if let Some(remark) = line.strip_prefix('#') {
            remarks.push_str(remark);
        } else if let Some(name) = line.strip_prefix('[') {
            section = name.trim_end_matches(']');
        } else if let Some((name, _)) = setting(line) {
            entries.push((format!("{section}.{name}"), line, std::mem::take(&mut remarks)));
        } else {
            remarks.clear();
        }
    }
    entries
}

#[test]
fn the_shipped_file_has_no_fault() {
    let faults = load(SHIPPED).err().unwrap_or_default();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn every_key_stands_in_the_shipped_file_in_the_order_of_the_reader_and_nothing_else() {
    let shown: Vec<String> = entries().into_iter().map(|(path, ..)| path).collect();
    let known: Vec<&str> = keys().iter().map(|key| key.path).collect();
    assert_eq!(shown, known);
}

#[test]
fn every_key_is_shown_with_its_default_or_as_having_none() {
    for (key, (path, line, remarks)) in keys().iter().zip(entries()) {
        let value = line.split_once(" = ").unwrap().1;
        let said = match key.absent {
            Absent::Required(_) => "Must be set".to_string(),
            Absent::Nothing(_) => "No default".to_string(),
            Absent::Default(_) => format!("Default: {value}."),
        };
        assert!(remarks.contains(&said), "{path} does not say: {said}");
        let has_none = matches!(key.absent, Absent::Nothing(_));
        assert_eq!(off(line).is_some(), has_none, "{path}: off is what has no default");
        let (Absent::Required(text) | Absent::Nothing(text) | Absent::Default(text)) = key.absent;
        assert_eq!(value.trim_matches(['[', ']', '"', '\'']), text.trim_matches(['[', ']']));
    }
}

#[test]
fn leaving_out_a_key_with_a_default_changes_nothing() {
    let said = |config: Config| format!("{config:?}");
    let whole = said(load(SHIPPED).unwrap());
    for key in keys() {
        let (_, line, _) = entries().into_iter().find(|(path, ..)| path == key.path).unwrap();
        let without = load(&SHIPPED.replace(&format!("\n{line}\n"), "\n"));
        match key.absent {
            Absent::Default(_) => assert_eq!(said(without.unwrap()), whole, "{line}"),
            Absent::Nothing(_) => assert_eq!(said(without.unwrap()), whole, "{line}"),
            Absent::Required(_) => {
                let faults = without.unwrap_err();
                let missing: Vec<&str> = faults.iter().map(|fault| fault.key.as_str()).collect();
                assert_eq!(missing, [key.path]);
            }
        }
    }
}

#[test]
fn a_key_that_is_off_loads_once_its_line_is_taken_into_use() {
    let lines: Vec<&str> = SHIPPED.lines().filter(|line| off(line).is_some()).collect();
    let [file_name, girths] = lines[..] else { panic!("{lines:?}") };
    let shipped = load(SHIPPED).unwrap();
    assert!(shipped.scanner.file_name.is_none(), "no file name names a patient");
    assert!(shipped.phantom.is_none(), "no phantom has girths that nobody measured");
    let on = |line: &str| load(&SHIPPED.replace(line, off(line).unwrap())).unwrap();
    let expression = on(file_name).scanner.file_name.unwrap();
    assert_eq!(expression.as_str(), "^(?<patient>P?[0-9]+)_");
    assert_eq!(on(girths).phantom.unwrap().name, "PHANTOM");
}

#[test]
fn every_tape_loads_as_the_word_that_records_show() {
    for (tape, _) in TAPES {
        let text = SHIPPED.replace("\ntape = \"shank\"\n", &format!("\ntape = \"{tape}\"\n"));
        assert_eq!(load(&text).unwrap().method.tape.word(), *tape);
    }
}

#[test]
fn b1_is_the_steepest_place_or_a_distance_above_b() {
    let line = "\nb1 = \"steepest\"\n";
    let with = |b1: &str| load(&SHIPPED.replace(line, &format!("\nb1 = \"{b1}\"\n")));
    assert_eq!(with("8cm").unwrap().method.levels.b1, B1::AboveB { distance_mm: 80.0 });
    for b1 in ["above-b", "8", "19mm", "201mm"] {
        let faults = with(b1).unwrap_err();
        assert_eq!(faults[0].key, "method.b1", "{b1}");
    }
}

#[test]
fn a_technician_has_at_most_95_keys_besides_those_of_servers() {
    let servers =
        ["store.fhir.", "store.hl7.", "store.dicom.", "store.archive.", "patient.worklist."];
    let of_a_server = |key: &&Key| servers.iter().any(|of| key.path.starts_with(of));
    let all = keys();
    assert!(all.len() - all.iter().filter(of_a_server).count() <= 95);
}

#[test]
fn no_removed_key_is_one_that_is_read() {
    for Key { path, .. } in keys() {
        assert!(REMOVED.iter().all(|(removed, _)| *removed != path), "{path}");
    }
}
