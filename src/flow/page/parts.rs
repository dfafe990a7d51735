//! The parts of the station that can fail: export folders, ports of the booth, stores.

use jiff::Timestamp;
use serde::Serialize;

use super::words::{Both, say};
use crate::flow::Facts;
use crate::flow::facts::{SourceState, TriggerFacts};
use crate::flow::health::{BLIP, has_lasted};
use crate::flow::trigger::PortState;
use crate::record::Language;

/// One part on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PartShown {
    /// What it is.
    pub name: String,
    /// Its state, in a word or two.
    pub word: &'static str,
    /// `good`, `wait` or `bad`; it decides colour and sign.
    pub health: &'static str,
    /// Why, in the system's own words.
    pub why: Option<String>,
}

/// All parts; a short fault that clears itself does not count, as in the complaints.
pub(super) fn shown(facts: &Facts, now: Timestamp, language: Language) -> Vec<PartShown> {
    let sources = facts.sources.iter().enumerate().map(|(place, source)| {
        let name = match (facts.sources.len(), language) {
            (1, _) => say(language, ("Export folder", "Exportordner")).to_owned(),
            (_, Language::En) => format!("Export folder {place}"),
            (_, Language::De) => format!("Exportordner {place}"),
        };
        let (word, health, why) = source_state(&source.state);
        PartShown { name, word: say(language, word), health, why: why.cloned() }
    });
    let stores = facts.stores.iter().map(|(store, facts)| {
        let fault = facts.fault.as_ref();
        let (word, health) = match fault {
            None => (("takes records", "nimmt an"), "good"),
            Some(_) if !has_lasted(facts.since, now, BLIP) => {
                (("is tried again", "neuer Versuch"), "wait")
            }
            Some(_) => (("accepts no records", "nimmt nichts an"), "bad"),
        };
        let (name, word) = (store_name(store, language), say(language, word));
        PartShown { name, word, health, why: fault.cloned() }
    });
    let ports = facts.triggers.iter().map(|(port, facts)| port_shown(port, facts, language));
    sources.chain(ports).chain(stores).collect()
}

fn source_state(state: &SourceState) -> (Both, &'static str, Option<&String>) {
    match state {
        SourceState::NotLooked => (("not looked at yet", "noch nicht angesehen"), "wait", None),
        SourceState::Watched => (("watched", "wird beobachtet"), "good", None),
        SourceState::OutOfReach(why) => (("out of reach", "nicht erreichbar"), "bad", Some(why)),
        SourceState::NotMounted(why) => {
            (("not mounted", "Freigabe nicht eingehängt"), "bad", Some(why))
        }
        SourceState::Taken => {
            (("used by another station", "wird von einer anderen Station bearbeitet"), "bad", None)
        }
        SourceState::Stalled => (("does not answer", "antwortet nicht"), "bad", None),
    }
}

fn store_name(store: &str, language: Language) -> String {
    let both = match store {
        "folder" => ("Records", "Messakten"),
        "copy" => ("Second record folder", "Zweiter Aktenordner"),
        "gdt" => ("Practice software", "Praxissoftware"),
        other => return other.to_owned(),
    };
    say(language, both).to_owned()
}

fn port_shown(port: &str, facts: &TriggerFacts, language: Language) -> PartShown {
    let name = match port {
        "serial" => ("Button (serial port)", "Knopf (serielle Schnittstelle)"),
        "usb" => ("Button (USB)", "Knopf (USB)"),
        "keys" => ("Button (keyboard)", "Knopf (Tastatur)"),
        _ => ("Reader", "Lesegerät"),
    };
    let (word, health) = match facts.state {
        PortState::Open => (("ready", "bereit"), "good"),
        PortState::NotLooked | PortState::Settling => (("opening", "wird geöffnet"), "wait"),
        PortState::Absent => (("not there", "nicht vorhanden"), "bad"),
        PortState::Busy => (("used by another program", "von anderem Programm belegt"), "bad"),
        PortState::Denied => (("no permission", "kein Zugriff"), "bad"),
        PortState::Failed => (("does not work", "arbeitet nicht"), "bad"),
        PortState::Stuck => (("contact sticks", "Kontakt klemmt"), "bad"),
        PortState::Hung => (("driver hangs", "Treiber hängt"), "bad"),
    };
    let (name, word) = (say(language, name).to_owned(), say(language, word));
    PartShown { name, word, health, why: facts.why.clone() }
}
