//! What an erasure will remove, what it cannot, and what the law says, before the id is asked for again.

use std::fmt::Display;

use gaiter_flow::patient::person::{Person, PersonStore, WhoseScan};
use gaiter_language::Language;

use crate::cli::shown;

/// The text for the terminal.
pub(super) fn of(person: &Person, language: Language) -> String {
    let mut text = format!("{}\n", language.text("erase.will"));
    for line in removed(person, language) {
        text += &format!("  - {line}\n");
    }
    text += &format!("\n{}\n", language.text("erase.will_not"));
    for line in left(person, language) {
        text += &format!("  - {line}\n");
    }
    text + &format!("\n{}\n", language.text("erase.law"))
}

fn removed(person: &Person, language: Language) -> Vec<String> {
    let filled = |key, words: &[(&str, &dyn Display)]| language.filled(key, words);
    let mut lines: Vec<String> = person.stores.iter().map(|of| of_store(of, language)).collect();
    let count = |whose| person.scans.iter().filter(|scan| scan.whose == whose).count();
    let kept = person.scans.iter().filter(|scan| !scan.kept.is_empty()).count();
    lines.push(filled("erase.scans", &[("count", &count(WhoseScan::Theirs)), ("kept", &kept)]));
    for (key, whose) in
        [("erase.shared", WhoseScan::Shared), ("erase.uncertain", WhoseScan::Uncertain)]
    {
        if count(whose) > 0 {
            lines.push(filled(key, &[("count", &count(whose))]));
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
    let place = shown(of.place.display()).to_string();
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
        let file = shown(of.file.display()).to_string();
        lines.push(language.filled(key, &[("file", &file), ("at", &of.at)]));
        for path in &of.attachments {
            let file = shown(path.display()).to_string();
            lines.push(language.filled("erase.attachment", &[("file", &file)]));
        }
    }
    for path in &person.exports {
        let file = shown(path.display()).to_string();
        lines.push(language.filled("erase.export", &[("file", &file)]));
    }
    for of in person.stores.iter().filter(|of| of.of_another > 0) {
        let place = shown(of.place.display()).to_string();
        let words: [(&str, &dyn Display); 2] = [("count", &of.of_another), ("place", &place)];
        lines.push(language.filled("erase.of_another", &words));
    }
    lines.push(language.text("erase.elsewhere").to_owned());
    lines
}
