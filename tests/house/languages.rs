//! The files of texts: whole in every language, and no text that nothing shows.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use gaiter::config::words::LANGUAGES;
use gaiter_flow::booth::Signal;
use gaiter_flow::export::passed_over::PassedOver;
use gaiter_flow::trigger::PortState;
use gaiter_flow::{DeliveryState, Disposition};
use gaiter_language::Language;
use gaiter_leg::sections::around::Around;
use gaiter_leg::{Level, Side};
use gaiter_record::report::VIEWER;
use regex::Regex;
use toml::{Table, Value};

use crate::rules::{collect, packages, root};

/// The tables whose keys are codes, and where the codes come from. A text of such a table is shown if its
/// code stands in the source; every other text has its whole key there.
const BY_CODE: [(&str, &str); 66] = [
    ("act.affected", "`Affected::word`, and that none is named"),
    ("amend.value", "the values of `What`"),
    ("amend.words", "reason and name of `AmendFault`"),
    ("around", "`Around::word`"),
    ("cause", "`Cause::known`, and the errors of the system by their numbers"),
    ("complaint", "`Complaint::code`"),
    ("completeness.again", "`Again::key`"),
    ("completeness.check", "`Check::key`"),
    ("explain.closed", "`Closed::word`"),
    ("explain.passed_over", "`PassedOver::word`"),
    ("explain.within", "`PassedOver::word`"),
    ("finding", "the findings and doubts of a record"),
    ("heading.measurements", "the columns of `measurements.csv`"),
    ("heading.order", "the columns of `order.csv`"),
    ("leg", "`Side::word`"),
    ("leg.heading", "`Side::word`"),
    ("leg.only", "`Side::word`"),
    ("leg.short", "`Side::word`"),
    ("level", "`Level::name`"),
    ("ordering.side", "`OrderSide::word`"),
    ("ordering.why", "`State::word` of a figure of an order"),
    ("page.complaint", "what keeps the station from being ready"),
    ("page.done", "the verbs of the page's decisions"),
    ("page.fault", "why a decision was not carried out"),
    ("page.held", "why a scan is held"),
    ("page.label", "the page's own files, which the tests beside them read"),
    ("page.light", "`Signal::word`"),
    ("page.part.folder_state", "the state of an export folder"),
    ("page.part.passed_over", "`PassedOver::word`"),
    ("page.part.port", "the ports of the booth"),
    ("page.part.port_state", "`PortState::word`"),
    ("page.part.store", "the stores' names in the journal"),
    ("page.part.store_state", "whether a store takes records"),
    ("page.refused", "why a scan was refused"),
    ("page.scan", "the state of a scan on the page"),
    ("page.scan.closed", "why a scan needs no decision any longer"),
    ("picture.larger", "`Side::word`"),
    ("posture", "`Posture::word`"),
    ("report.by_hand.measure", "`Subject::word`"),
    ("report.caption", "the figures of a report"),
    ("report.notes", "`Severity::word`"),
    ("report.open.field", "`OPEN_FIELDS`"),
    ("report.source", "`SourceKind::word`"),
    ("report.time_from", "`AcquiredFrom::word`"),
    ("sizes.check.what", "the remarks on a size table"),
    ("sizes.fit", "`Fit::word`"),
    ("sizes.not_comparable", "`NotComparable::word`"),
    ("sizes.not_given", "`NotGiven::word`"),
    ("sizes.status", "`Status::word`"),
    ("statement", "`Statement::new` and the codes of `gaiter_leg`"),
    ("terminal.event", "`Event::word` of the journal"),
    ("terminal.intake", "whether scans are taken in"),
    ("terminal.port_state", "`PortState::word`"),
    ("terminal.state", "`Disposition::word` and `DeliveryState::word`"),
    ("viewer", "the 3D view's own script"),
    ("visits.affected", "`Affected::word`, and that none is named"),
    ("visits.caption", "the pictures of a report of visits"),
    ("visits.caution", "`Caution::code`"),
    ("visits.column", "the columns of a table of volumes"),
    ("visits.excess", "`Shown::word`"),
    ("visits.left_out", "`StoredFault::code`, and `record-removed`"),
    ("visits.limited", "`Limited::word`"),
    ("visits.no_reduction", "`NoReduction::word`"),
    ("visits.shown", "`Shown::word`"),
    ("visits.volume", "`Shown::word`"),
    ("visits.volume_by", "`VolumeBy::word`"),
];

/// The keys and texts of a language's file, in its order.
fn texts(language: Language) -> Vec<(String, String)> {
    let path = root().join(format!("crates/language/src/{}.toml", language.tag()));
    let mut texts = Vec::new();
    gather("", &fs::read_to_string(path).unwrap().parse().unwrap(), &mut texts);
    assert!(texts.len() > 400, "only {} texts of {language:?}", texts.len());
    texts
}

fn gather(before: &str, table: &Table, texts: &mut Vec<(String, String)>) {
    for (name, value) in table {
        match value {
            Value::Table(table) => gather(&format!("{before}{name}."), table, texts),
            value => texts.push((format!("{before}{name}"), value.as_str().unwrap().to_owned())),
        }
    }
}

#[test]
fn every_language_has_its_file_and_can_be_chosen() {
    let tags: BTreeSet<&str> = Language::ALL.map(Language::tag).into();
    let files = fs::read_dir(root().join("crates/language/src")).unwrap();
    let files: Vec<String> =
        files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    let files = files.iter().filter_map(|name| name.strip_suffix(".toml"));
    assert_eq!(files.collect::<BTreeSet<_>>(), tags);
    let words = LANGUAGES.iter().map(|(word, language)| [*word, language.tag()]);
    assert_eq!(words.collect::<BTreeSet<_>>(), tags.iter().map(|tag| [*tag; 2]).collect());
    // The 3D view asks for its words by key, for some of a side by how they end.
    for (key, _) in Language::En.table("viewer") {
        let ending = key.strip_prefix("left").or(key.strip_prefix("right"));
        let is_of_a_side = ending.is_some_and(|ending| VIEWER.contains(&format!("}}{ending}`")));
        assert!(is_of_a_side || VIEWER.contains(key), "the 3D view does not use {key}");
    }
}

#[test]
fn every_language_has_the_same_keys_in_the_same_order() {
    let keys = |language| texts(language).into_iter().map(|(key, _)| key).collect::<Vec<_>>();
    let english = keys(Language::En);
    for language in Language::ALL {
        let keys = keys(language);
        let first = english.iter().zip(&keys).find(|(english, key)| english != key);
        assert_eq!(first, None, "{language:?} differs from there on");
        assert_eq!(keys.len(), english.len(), "{language:?}");
    }
}

#[test]
fn a_text_has_the_same_places_in_every_language() {
    let place =
        Regex::new(r"\{(?:[a-z0-9_]+(?::(?:[0-9*]|[a-z]+))?|[a-z]+(?:\.[a-z0-9_-]+)+)\}").unwrap();
    let places = |text: &str| -> BTreeSet<String> {
        place.find_iter(text).map(|place| place.as_str().to_owned()).collect()
    };
    let english = texts(Language::En);
    for language in Language::ALL {
        for ((key, english), (_, text)) in english.iter().zip(texts(language)) {
            assert_eq!(places(english), places(&text), "{language:?}, {key}");
            assert!(!place.replace_all(&text, "").contains(['{', '}']), "{language:?}, {key}");
            assert!(!text.is_empty(), "{language:?}, {key}");
        }
    }
}

/// The key for which a text stands.
fn stands_for(text: &str) -> Option<&str> {
    text.strip_prefix('{')?.strip_suffix('}').filter(|key| key.contains('.'))
}

#[test]
fn a_text_that_stands_for_another_key_finds_it() {
    for language in Language::ALL {
        for (key, text) in texts(language) {
            let Some(other) = stands_for(&text) else { continue };
            let below = |key: &str| language.table(key).map(|(_, text)| text).collect::<Vec<_>>();
            assert_eq!(language.find(&key), language.find(other), "{language:?}, {key}");
            assert_eq!(below(&key), below(other), "{language:?}, {key}");
            assert!(language.find(&key).is_some() || !below(&key).is_empty(), "{key}: {text}");
        }
    }
}

/// What the source says of the texts.
#[derive(Debug, Default)]
struct Named {
    /// All its literals.
    literals: BTreeSet<String>,
    /// The tables in which it looks up a code.
    tables: BTreeSet<String>,
    /// What looks like a key but is none.
    unknown: BTreeSet<String>,
}

impl Named {
    fn add(&mut self, path: &Path, keys: &BTreeSet<String>) {
        let text = fs::read_to_string(path).unwrap();
        let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let literal = Regex::new(r#"(?s)//[^\n]*|'"'|"((?:[^"\\]|\\.)*)""#).unwrap();
        // Where a code follows, a table may be a single word: `.word("leg", code)`.
        let looked_up = Regex::new(r#"\.(?:word|table)\(\s*"([a-z_]+)""#).unwrap();
        let before_code = Regex::new(r"^([a-z_.]+)\.\{").unwrap();
        let key = Regex::new(r"^[a-z_]+(?:\.[A-Za-z0-9_-]+)+$").unwrap();
        let file = Regex::new(r"\.(?:css|html|js|json|pdf|svg)$").unwrap();
        let is_table = |word: &str| keys.iter().any(|key| key.starts_with(&format!("{word}.")));
        let is_key = |word: &str| {
            let is_of_texts = is_table(word.split('.').next().unwrap());
            is_of_texts && key.is_match(word) && !file.is_match(word)
        };

        self.tables.extend(looked_up.captures_iter(text).map(|found| found[1].to_owned()));
        for word in literal.captures_iter(text).filter_map(|found| found.get(1)) {
            let word = word.as_str();
            let before =
                before_code.captures(word).map_or(word, |found| found.get(1).unwrap().as_str());
            let is_by_code = (before != word || is_key(word)) && is_table(before);
            self.tables.extend(is_by_code.then(|| before.to_owned()));
            let is_unknown = is_key(word) && !is_table(word) && !keys.contains(word);
            self.unknown.extend(is_unknown.then(|| word.to_owned()));
            self.literals.insert(word.to_owned());
        }
    }
}

/// The source without its tests. The keys of `station.toml` look like those of texts.
fn named(keys: &BTreeSet<String>) -> Named {
    let mut files = Vec::new();
    packages().iter().for_each(|package| collect(&package.join("src"), &mut files));
    let mut named = Named::default();
    let left_out = ["config", "config.rs", "tests", "tests.rs"].map(Some);
    for path in files {
        let mut names = path.strip_prefix(root()).unwrap().iter();
        if !names.any(|name| left_out.contains(&name.to_str())) {
            named.add(&path, keys);
        }
    }
    named
}

#[test]
fn every_key_in_the_source_has_a_text_and_every_text_is_shown() {
    let texts = texts(Language::En);
    let keys: BTreeSet<String> = texts.iter().map(|(key, _)| key.clone()).collect();
    let Named { literals, tables, unknown } = named(&keys);
    assert!(unknown.is_empty(), "no text for {unknown:?}");
    assert_eq!(tables, BY_CODE.map(|(table, _)| table.to_owned()).into(), "BY_CODE lists them");
    let is_shown = |key: &str| {
        let is_of = |table: &String| {
            let code = key.strip_prefix(&format!("{table}."));
            // Behind the code stands which of its texts it is.
            let mut codes =
                code.into_iter().flat_map(|code| [code, code.split('.').next().unwrap()]);
            ["page.label", "viewer"].contains(&table.as_str()) && code.is_some()
                || codes.any(|code| {
                    // A complaint may have a text of its own for what it is about.
                    let parts = code.rsplit_once('-').map(|(code, subject)| [code, subject]);
                    literals.contains(code)
                        || parts.is_some_and(|of| of.iter().all(|of| literals.contains(*of)))
                })
        };
        literals.contains(key) || tables.iter().any(is_of)
    };
    let stood_for: BTreeSet<&str> = texts.iter().filter_map(|(_, text)| stands_for(text)).collect();
    let dead: Vec<&String> =
        keys.iter().filter(|key| !is_shown(key) && !stood_for.contains(key.as_str())).collect();
    assert!(dead.is_empty(), "nothing shows {dead:?}");
}

#[test]
fn every_word_that_the_program_hands_out_has_its_text() {
    let sides = ["leg", "leg.heading", "leg.only", "leg.short", "picture.larger"]
        .map(|table| Side::BOTH.map(|side| (table, side.word())));
    let words = sides.concat().into_iter().chain(Level::ALL.map(|of| ("level", of.name())));
    let words = words.chain(Around::ALL.map(|of| ("around", of.word())));
    let words = words.chain(Signal::ALL.map(|of| ("page.light", of.word())));
    let words = words.chain(PortState::ALL.map(|of| ("page.part.port_state", of.word())));
    let words = words.chain(PortState::ALL.map(|of| ("terminal.port_state", of.word())));
    let words = words.chain(Disposition::ALL.map(|of| ("terminal.state", of.word())));
    let words = words.chain(DeliveryState::ALL.map(|of| ("terminal.state", of.word())));
    let unread = PassedOver::ALL.into_iter().filter(|of| of.is_unread());
    let words = words.chain(unread.map(|of| ("page.part.passed_over", of.word())));
    for (table, word) in words {
        for language in Language::ALL {
            assert!(language.find(&format!("{table}.{word}")).is_some(), "{language:?}, {word}");
        }
    }
}

/// The files of `crates/leg/src` whose codes are keys of texts.
const TEXTS_OF_LEG: [&str; 11] = [
    "comparison/opinion.rs",
    "doubt.rs",
    "finding.rs",
    "frame/soles.rs",
    "frame/stance.rs",
    "level.rs",
    "levels/at_height.rs",
    "levels/extremum.rs",
    "sectioned_leg.rs",
    "sections/axis_fit.rs",
    "surface/nurbs.rs",
];

#[test]
fn every_statement_of_a_record_has_its_text() {
    let leg = TEXTS_OF_LEG.map(|path| format!("crates/leg/src/{path}"));
    let paths = leg.into_iter().chain(["crates/record/src/statement.rs".to_owned()]);
    let source: String = paths.map(|path| fs::read_to_string(root().join(path)).unwrap()).collect();
    // Figures and files have names of one word or with underscores.
    let key = Regex::new(r#""([a-z]+(?:-[a-z]+)+)""#).unwrap();
    let keys: BTreeSet<&str> =
        key.captures_iter(&source).map(|found| found.get(1).unwrap().as_str()).collect();
    assert!(keys.len() > 40, "only {keys:?}");
    // Codes whose figures choose between texts.
    for key in keys.into_iter().filter(|key| !["no-surface", "ord-disagrees"].contains(key)) {
        for language in Language::ALL {
            assert!(language.find(&format!("statement.{key}")).is_some(), "{language:?}, {key}");
        }
    }
}

#[test]
fn every_store_of_the_configuration_has_its_text() {
    let shipped: Table = include_str!("../../config/station.toml").parse().unwrap();
    // Those that are off stand in comments.
    let commented = Regex::new(r"(?m)^#? ?\[store\.([a-z0-9_]+)\]").unwrap();
    let names = commented.captures_iter(include_str!("../../config/station.toml"));
    let names: BTreeSet<String> = names.map(|found| found[1].to_owned()).collect();
    assert!(names.is_superset(&shipped["store"].as_table().unwrap().keys().cloned().collect()));
    assert!(names.len() >= 3, "only {names:?}");
    for name in names {
        for language in Language::ALL {
            let key = format!("page.part.store.{name}");
            assert!(language.find(&key).is_some(), "{language:?}, {key}");
        }
    }
}

/// The codes in the first column of a page's table behind these words.
fn of_table(before: &str) -> Vec<String> {
    let pages = [
        include_str!("../../docs/codes.md"),
        include_str!("../../docs/patients.md"),
        include_str!("../../docs/operate.md"),
    ]
    .concat();
    let (_, table) = pages.split_once(before).unwrap();
    let rows = table.lines().skip_while(|line| !line.starts_with("| `"));
    let rows = rows.take_while(|line| line.starts_with("| `"));
    let codes = rows.flat_map(|row| row.split('|').nth(1).unwrap().split('`').skip(1).step_by(2));
    codes.map(str::to_owned).collect()
}

#[test]
fn every_code_of_the_documents_has_its_texts_in_every_language() {
    // A result for the practice software that waits, and one that was handed over: no scan is refused.
    let no_refusal = ["result-not-fetched", "result-handed-over"];
    for (before, table, parts, least) in [
        ("under `findings` and `doubts`:", "finding", &["title", "meaning", "action"][..], 30),
        ("| held as |", "page.held", &["what", "next"], 9),
        ("Refusals, in `reason.json`", "page.refused", &["what", "next"], 35),
        ("## When it is not ready", "page.complaint", &["what", "next"], 20),
        ("## When it is not ready", "complaint", &["message", "remedy"], 20),
    ] {
        let codes = of_table(before);
        assert!(codes.len() >= least, "only {codes:?}");
        let scans = codes.iter().filter(|code| !no_refusal.contains(&code.as_str()));
        // All ports share the texts of `trigger-any`.
        let scans = scans.filter(|code| !code.starts_with("trigger-"));
        let keys =
            scans.flat_map(|code| parts.iter().map(move |part| format!("{table}.{code}.{part}")));
        for key in keys {
            for language in Language::ALL {
                assert!(language.find(&key).is_some(), "{language:?} has no {key}");
            }
        }
    }
}
