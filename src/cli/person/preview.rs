//! What an erasure will remove, what it cannot, and what the law requires, before the id is asked for again.

use std::fmt::Display;

use gaiter_flow::patient::erasure::{Owed, OwedStep};
use gaiter_flow::patient::person::{OnServer, Person, PersonScan, PersonStore, WhoseScan};
use gaiter_language::Language;

use crate::cli::terminal_safe;

/// The text for the terminal. `leaves_owed`: whether what servers are owed is left undone.
pub(super) fn render(person: &Person, leaves_owed: bool, language: Language) -> String {
    let part = |heading, lines: &[String]| format!("{}\n{}\n", language.text(heading), list(lines));
    let mut text = part("erase.will", &removed(person, language));
    text += &part("erase.will_not", &left(person, language));
    if !person.owed.is_empty() {
        let heading = if leaves_owed { "erase.leaves_owed" } else { "erase.owed_first" };
        text += &part(heading, &owed(&person.owed, language));
    }
    text + &format!("{}\n", language.text("erase.law"))
}

/// Lines of a list.
pub(super) fn list(lines: &[String]) -> String {
    lines.iter().map(|line| format!("  - {line}\n")).collect()
}

/// What servers are owed, or were left with.
pub(super) fn owed(owed: &[Owed], language: Language) -> Vec<String> {
    let line = |of: &Owed| {
        let key = match of.step {
            OwedStep::TakeBack => "erase.owed_take_back",
            OwedStep::Correct => "erase.owed_correction",
        };
        let store = language.word("page.part.store", &of.store);
        let unknown = || language.text("erase.not_known").to_owned();
        let known = |text: Option<&str>| text.map_or_else(unknown, terminal_safe);
        let (place, reference) = (known(of.place.as_deref()), known(of.reference.as_deref()));
        let scan = of.sha256.get(..8).unwrap_or_default();
        let words: [(&str, &dyn Display); 4] =
            [("store", &store), ("place", &place), ("reference", &reference), ("scan", &scan)];
        language.filled(key, &words)
    };
    owed.iter().map(line).collect()
}

fn removed(person: &Person, language: Language) -> Vec<String> {
    let filled = |key, words: &[(&str, &dyn Display)]| language.filled(key, words);
    let mut lines: Vec<String> = person.stores.iter().map(|of| of_store(of, language)).collect();
    let count = |whose| person.scans.iter().filter(|scan| scan.whose == whose).count();
    let is_uncertain = |scan: &&PersonScan| scan.whose == WhoseScan::Uncertain;
    let uncertain = person.scans.iter().filter(is_uncertain);
    let (whole, held): (Vec<_>, Vec<_>) = uncertain.partition(|scan| scan.goes_whole);
    let kept = person.scans.iter().filter(|scan| !scan.kept.is_empty()).count();
    lines.push(filled("erase.scans", &[("count", &count(WhoseScan::Theirs)), ("kept", &kept)]));
    for (key, count) in [
        ("erase.shared", count(WhoseScan::Shared)),
        ("erase.uncertain", held.len()),
        ("erase.uncertain_whole", whole.len()),
    ] {
        if count > 0 {
            lines.push(filled(key, &[("count", &count)]));
        }
    }
    lines.extend(person.affected.as_ref().map(|_| language.text("erase.affected").to_owned()));
    lines.push(filled("erase.history", &[("count", &person.history.len())]));
    let further = person.orders.len() + person.journals.len();
    if further > 0 {
        lines.push(filled("erase.further", &[("count", &further)]));
    }
    lines
}

fn of_store(of: &PersonStore, language: Language) -> String {
    let place = terminal_safe(of.place.display());
    let name: &dyn Display = &language.word("page.part.store", &of.store);
    let own = of.cause.as_ref().map(|cause| cause.in_words(language));
    match own.or_else(|| of.fault.clone()) {
        Some(fault) => language
            .filled("erase.store_away", &[("store", name), ("place", &place), ("fault", &fault)]),
        None => language.filled(
            "erase.store",
            &[
                ("store", name),
                ("place", &place),
                ("records", &of.records.len()),
                ("others", &of.others.len()),
            ],
        ),
    }
}

fn left(person: &Person, language: Language) -> Vec<String> {
    let mut lines = Vec::new();
    for of in &person.handed_over {
        let key = if of.waits { "erase.handed_waits" } else { "erase.handed" };
        let file = terminal_safe(of.file.display());
        lines.push(language.filled(key, &[("file", &file), ("at", &of.at)]));
        for path in &of.attachments {
            let file = terminal_safe(path.display());
            lines.push(language.filled("erase.attachment", &[("file", &file)]));
        }
    }
    lines.extend(person.on_servers.iter().map(|of| on_server(of, language)));
    for path in &person.exports {
        let file = terminal_safe(path.display());
        lines.push(language.filled("erase.export", &[("file", &file)]));
    }
    for of in person.stores.iter().filter(|of| of.of_another > 0) {
        let place = terminal_safe(of.place.display());
        let words: [(&str, &dyn Display); 2] = [("count", &of.of_another), ("place", &place)];
        lines.push(language.filled("erase.of_another", &words));
    }
    lines.push(language.text("erase.elsewhere").to_owned());
    lines
}

fn on_server(of: &OnServer, language: Language) -> String {
    let key = match (&of.unfetched, of.is_withdrawn, &of.reference) {
        (Some(_), _, _) => "erase.on_server_unfetched",
        (None, _, None) => "erase.on_server_perhaps",
        (None, true, Some(_)) => "erase.on_server_withdrawn",
        (None, false, Some(_)) if of.is_withdrawing => "erase.on_server_withdrawing",
        (None, false, Some(_)) => "erase.on_server",
    };
    let at = of.at.map(|at| at.to_string()).unwrap_or_default();
    let file = of.unfetched.as_ref().map(|file| terminal_safe(file.display()));
    let file = file.unwrap_or_default();
    let place = terminal_safe(&of.place);
    let store = language.word("page.part.store", &of.store);
    let reference = terminal_safe(of.reference.as_deref().unwrap_or_default());
    let words: [(&str, &dyn Display); 5] = [
        ("store", &store),
        ("place", &place),
        ("reference", &reference),
        ("at", &at),
        ("file", &file),
    ];
    language.filled(key, &words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn scan(whose: &str, goes_whole: bool) -> serde_json::Value {
        json!({
            "sha256": "0".repeat(64), "whose": whose, "goes_whole": goes_whole,
            "state": "spooled", "first_seen": "2026-11-21T09:15:00Z", "format": "obj", "size": 12,
            "deliveries": [], "kept": [],
        })
    }

    #[test]
    fn a_server_that_may_have_a_record_without_a_receipt_is_named() {
        let on_server = |reference: Option<&str>| {
            json!({
                "sha256": "0".repeat(64), "store": "fhir", "place": "https://fhir.clinic.example/r4",
                "reference": reference, "at": "2026-11-21T09:15:00Z", "is_withdrawn": false,
                "unfetched": null,
            })
        };
        let row = |reference: Option<&str>| {
            let of: OnServer = serde_json::from_value(on_server(reference)).unwrap();
            super::on_server(&of, Language::En)
        };
        let unsure = row(None);
        assert!(unsure.contains("(https://fhir.clinic.example/r4): may have a record"), "{unsure}");
        assert!(row(Some("DiagnosticReport/17")).contains("DiagnosticReport/17, given on"));
        let mut waits = on_server(Some("DiagnosticReport/17"));
        waits["is_withdrawing"] = true.into();
        let waits: OnServer = serde_json::from_value(waits).unwrap();
        assert!(super::on_server(&waits, Language::En).contains("is to be taken back"));
    }

    #[test]
    fn a_held_scan_that_can_be_nobody_elses_is_not_told_to_stay_held() {
        let scans = [
            scan("theirs", true),
            scan("shared", false),
            scan("uncertain", false),
            scan("uncertain", true),
            scan("uncertain", true),
        ];
        let person = json!({
            "schema": "gaiter.person/1", "patient": "4711", "station": "t",
            "at": "2026-11-21T09:15:00Z", "scans": scans, "stores": [], "handed_over": [],
            "captures": [], "orders": [], "exports": [], "journals": [], "history": [], "on_servers": [],
        });
        let person: Person = serde_json::from_value(person).unwrap();
        let told = render(&person, false, Language::En);
        for line in [
            "this person's part of 1 scans that others have, too",
            "this person's name at 1 held scans, which may be another's and stay held",
            "2 held scans, which can be nobody else's but an erased person's",
        ] {
            assert!(told.contains(&format!("  - {line}\n")), "{line}: {told}");
        }
        assert!(
            render(&person, false, Language::De).contains("2 zurückgehaltene Scans, die sonst nur")
        );
    }
}
