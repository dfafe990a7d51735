//! The parts of the station that can fail: export folders, ports of the booth, stores.

use gaiter_language::Language;
use gaiter_record::phantom::CheckResult;
use jiff::Timestamp;
use serde::Serialize;

use crate::Facts;
use crate::export::passed_over::listed;
use crate::facts::{
    PhantomFacts, SourceFacts, SourceState, StoreRefusal, TriggerFacts, WorklistFacts,
};
use crate::health::{BLIP, has_lasted};
use crate::trigger::PortState;

/// One part on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PartShown {
    pub name: String,
    /// Its state, in a word or two.
    pub word: &'static str,
    /// `good`, `wait` or `bad`; it decides colour and sign.
    pub health: &'static str,
    pub why: Option<String>,
}

/// All parts; a short fault that clears itself does not count, as in the complaints.
pub(super) fn parts_shown(facts: &Facts, now: Timestamp, language: Language) -> Vec<PartShown> {
    let is_only = facts.sources.len() == 1;
    let sources = facts.sources.iter().enumerate().map(|(place, source)| {
        let name = match is_only {
            true => language.text("page.part.folder").to_owned(),
            false => language.filled("page.part.folder_numbered", &[("number", &place)]),
        };
        let health = match source.state {
            SourceState::NotLooked => "wait",
            SourceState::Watched => "good",
            _ => "bad",
        };
        let word = language.word("page.part.folder_state", source.state.word());
        let why = source.state.why().map(|why| why.in_words(language));
        let why = why.or_else(|| not_taken(source, language));
        PartShown { name, word, health, why }
    });
    let stores = facts.stores.iter().map(|(store, facts)| {
        let (health, state) = match &facts.refusal {
            None => ("good", "good"),
            Some(StoreRefusal::NotFetched) => ("wait", "unfetched"),
            Some(_) if !has_lasted(facts.since, now, BLIP) => ("wait", "wait"),
            Some(_) => ("bad", "bad"),
        };
        let name = language.word("page.part.store", store).to_owned();
        let word = language.word("page.part.store_state", state);
        let why = facts.refusal.as_ref().and_then(StoreRefusal::fault);
        let why = why.map(|why| why.in_words(language));
        PartShown { name, word, health, why }
    });
    let ports = facts.triggers.iter().map(|(port, facts)| port_shown(port, facts, language));
    let is_due = facts.is_phantom_due(now);
    let phantom = facts.phantom.iter().map(|phantom| phantom_shown(phantom, is_due, language));
    let worklist = facts.worklist.iter().map(|worklist| worklist_shown(worklist, language));
    sources.chain(ports).chain(worklist).chain(stores).chain(phantom).collect()
}

/// What lies in a folder and is not read, and what was there and is gone.
fn not_taken(source: &SourceFacts, language: Language) -> Option<String> {
    let unread = source.passed_over.iter().filter(|(why, _)| why.is_unread());
    let unread = listed(unread.map(|(why, count)| (why.word(), *count)), language);
    let unread =
        (!unread.is_empty()).then(|| language.filled("page.part.not_read", &[("list", &unread)]));
    let gone = (source.gone_count > 0)
        .then(|| language.filled("page.part.gone", &[("count", &source.gone_count)]));
    let all: Vec<String> = unread.into_iter().chain(gone).collect();
    (!all.is_empty()).then(|| all.join(" "))
}

fn phantom_shown(phantom: &PhantomFacts, is_due: bool, language: Language) -> PartShown {
    let result = phantom.checks.last().map(|check| check.result);
    let (key, health) = match result {
        Some(CheckResult::Beyond) => ("page.part.phantom.beyond", "bad"),
        Some(CheckResult::NotMeasured) => ("page.part.phantom.not_measured", "bad"),
        Some(CheckResult::Within) if !is_due => ("page.part.phantom.within", "good"),
        Some(CheckResult::Within) | None => ("page.part.phantom.due", "wait"),
    };
    let name = language.text("page.part.phantom.name").to_owned();
    PartShown { name, word: language.text(key), health, why: None }
}

fn worklist_shown(worklist: &WorklistFacts, language: Language) -> PartShown {
    let (word, health) = match (&worklist.fault, worklist.answered) {
        (Some(_), _) => ("page.part.worklist.away", "bad"),
        (None, None) => ("page.part.worklist.not_asked", "wait"),
        (None, Some(_)) => ("page.part.worklist.answers", "good"),
    };
    let left_out = (worklist.left_out > 0)
        .then(|| language.filled("page.part.worklist.left_out", &[("count", &worklist.left_out)]));
    PartShown {
        name: language.text("page.part.worklist.name").to_owned(),
        word: language.text(word),
        health,
        why: worklist.fault.as_ref().map(|why| why.in_words(language)).or(left_out),
    }
}

fn port_shown(port: &str, facts: &TriggerFacts, language: Language) -> PartShown {
    let name = language.find(&format!("page.part.port.{port}"));
    let health = match facts.state {
        PortState::Open => "good",
        state if state.is_fault() => "bad",
        _ => "wait",
    };
    PartShown {
        name: name.unwrap_or_else(|| language.text("page.part.port.reader")).to_owned(),
        word: language.word("page.part.port_state", facts.state.word()),
        health,
        why: facts.why.as_ref().map(|why| why.in_words(language)),
    }
}
