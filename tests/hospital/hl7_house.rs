//! A receiver of HL7 v2 of a test's own: stores that send to it, and the messages that it has.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use gaiter::store::Peer;
use gaiter::store::hl7::{Hl7Store, Hl7Way};
use gaiter_https::TlsFiles;
use gaiter_language::Language;
use gaiter_record::hl7::Hl7Rules;
use support::records::hl7_rules;
use tempfile::TempDir;

use crate::fhir_house::Store;
use crate::server::{House, hl7};

/// How long an answer is waited for.
pub const LONG: Duration = Duration::from_secs(30);

/// How long one is waited for that does not come.
pub const SHORT: Duration = Duration::from_secs(4);

/// The fields of each segment of a message.
pub type Message = Vec<Vec<String>>;

/// How messages are written for the receiver of this name, in German.
pub fn rules(receiver: &str) -> Hl7Rules {
    Hl7Rules { language: Language::De, ..hl7_rules(receiver) }
}

/// A store with a state folder of its own, which goes with it.
pub struct Sender {
    pub store: Store,
    pub state: TempDir,
}

impl Sender {
    pub fn new(way: Hl7Way, rules: Hl7Rules) -> Sender {
        let state = tempfile::tempdir().unwrap();
        let store = Box::new(Hl7Store::new(way, rules, state.path(), ""));
        Sender { store, state }
    }

    /// The same with a store for another way.
    pub fn by(self, way: Hl7Way, rules: Hl7Rules) -> Sender {
        let store = Box::new(Hl7Store::new(way, rules, self.state.path(), ""));
        Sender { store, state: self.state }
    }
}

impl House {
    pub fn of_hl7() -> House {
        House::new(hl7())
    }

    /// A way to it.
    pub fn way(&self, way: &str, tls: Option<TlsFiles>, limit: Duration) -> Hl7Way {
        let (host, port) = ("localhost".to_owned(), self.server.port(way));
        Hl7Way::Mllp(Peer { host, port, tls, limit })
    }

    /// A store that sends to it without TLS.
    pub fn sender(&self, limit: Duration) -> Sender {
        Sender::new(self.way("plain", None, limit), rules(&self.name))
    }

    /// The messages that it has taken, in their order. No other was sent to it.
    #[track_caller]
    pub fn messages(&self) -> Vec<Message> {
        let faults = fs::read_to_string(self.server.path("faults")).unwrap_or_default();
        let own = format!("{} ", self.name);
        let faults: Vec<&str> = faults.lines().filter(|line| line.starts_with(&own)).collect();
        assert!(faults.is_empty(), "{faults:?}");
        let entries = fs::read_dir(self.path("messages")).into_iter().flatten();
        let paths = entries.map(|entry| entry.unwrap().path());
        let is_whole = |path: &PathBuf| path.extension().is_some_and(|of| of == "hl7");
        let mut paths: Vec<_> = paths.filter(is_whole).collect();
        paths.sort();
        paths.iter().map(|path| message(path)).collect()
    }

    /// Waits until it has taken so many messages, and no more: a busy receiver takes one after its sender has gone.
    #[track_caller]
    pub fn has_taken(&self, count: usize, what: &str) {
        let until = Instant::now() + LONG;
        while self.messages().len() < count && Instant::now() < until {
            sleep(Duration::from_millis(20));
        }
        assert_eq!(self.messages().len(), count, "{what}");
    }

    /// The control ids of the messages, each once.
    #[track_caller]
    pub fn controls(&self) -> Vec<String> {
        let mut controls: Vec<String> =
            self.messages().into_iter().map(|mut message| message[0].remove(9)).collect();
        controls.sort();
        controls.dedup();
        controls
    }
}

/// A file as a message.
pub fn message(path: &Path) -> Message {
    let text = fs::read_to_string(path).unwrap();
    let segments = text.split('\r').filter(|segment| !segment.is_empty());
    segments.map(|segment| segment.split('|').map(str::to_owned).collect()).collect()
}

/// The segments of a name.
pub fn segments_named<'a>(message: &'a [Vec<String>], name: &str) -> Vec<&'a Vec<String>> {
    message.iter().filter(|segment| segment[0] == name).collect()
}
