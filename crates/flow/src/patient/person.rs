//! All that a station knows of one person, for disclosure and for the preview of an erasure. Of other
//! patients it states only that there are some.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gaiter_record::{Acquired, SourceKind};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::account::{Happened, Summary};
use crate::cause::Cause;
use crate::patient::erasure::Owed;

/// What a station knows of a person.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Person {
    /// `gaiter.person/1`
    pub schema: String,
    /// The patient's id.
    pub patient: String,
    pub station: String,
    /// When this was put together.
    pub at: Timestamp,
    /// The scans that are or may be theirs, in the order in which they came.
    pub scans: Vec<PersonScan>,
    /// The record stores that are folders.
    pub stores: Vec<PersonStore>,
    /// What was given to practice software.
    pub handed_over: Vec<HandedOver>,
    /// What servers of a hospital were given.
    pub on_servers: Vec<OnServer>,
    /// What is still to be done at servers with their records, and with those of others whose scan is theirs.
    #[serde(default)]
    pub owed: Vec<Owed>,
    /// The waits for a scan of theirs.
    pub captures: Vec<PersonCapture>,
    /// Their affected leg, as a person named it; `None` if nobody did.
    pub affected: Option<NamedLeg>,
    /// Refused orders that name them: folders in the state folder.
    pub orders: Vec<PathBuf>,
    /// Files that still lie in an export folder: gaiter only reads there.
    pub exports: Vec<PathBuf>,
    /// Journals that were set aside and name them.
    pub journals: Vec<PathBuf>,
    /// The journal's entries about them and about scans that are theirs alone, oldest first.
    pub history: Vec<PersonEvent>,
}

/// What a station knows of a patient whose visits are compared, besides the records.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct KnownVisits {
    /// The names of the folders of the records that it delivered into the first store, oldest first.
    pub delivered: Vec<String>,
    /// The affected leg as a person named it: `left`, `right`, `both` or `none`; `None` if nobody did.
    pub affected: Option<String>,
    /// Whether a leg was named but what is kept of it cannot be read.
    #[serde(default)]
    pub is_affected_unreadable: bool,
}

/// Which leg of a patient a person named as affected.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedLeg {
    /// `left`, `right`, `both` or `none`.
    pub affected: String,
    pub at: Timestamp,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PersonScan {
    /// The hash of its bytes, 64 hexadecimal digits.
    pub sha256: String,
    /// Whether it is theirs.
    pub whose: WhoseScan,
    /// Whether it is erased with them: no one else has it, and all others to whom it may belong are erased.
    #[serde(default)]
    pub goes_whole: bool,
    #[serde(flatten)]
    pub summary: Summary,
    /// Where its record was delivered for them.
    pub deliveries: Vec<PersonDelivery>,
    /// The folders in the state folder that hold its bytes: spool, quarantine, preview.
    pub kept: Vec<PathBuf>,
}

/// Whether a scan is a person's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WhoseScan {
    /// It is theirs, and no one else has it.
    Theirs,
    /// Others have it, too.
    Shared,
    /// It waits for a person's decision, and may be another's: its bytes are not disclosed.
    Uncertain,
    /// It was theirs once, and a person took it back.
    TakenBack,
}

/// A delivery of a scan for a person.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PersonDelivery {
    pub store: String,
    /// Its state, as a word.
    pub state: String,
    /// Since when it is in this state.
    pub at: Option<Timestamp>,
    /// The record's folder, or by what a server has the record.
    pub folder: Option<String>,
    /// Who named the patient.
    pub sources: Vec<SourceKind>,
    /// Where a server has the record, or may have it, each place with its receipt, '' for none. Disclosed as
    /// [`OnServer`].
    #[serde(skip)]
    pub places: BTreeMap<String, String>,
}

/// What a folder store holds of a person.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PersonStore {
    /// Its name in the journal.
    pub store: String,
    pub place: PathBuf,
    /// Why it cannot be read now, in English.
    pub fault: Option<String>,
    /// The same as data, for people of another language.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<Cause>,
    /// The records, every revision, oldest first.
    pub records: Vec<PersonRecord>,
    /// Other files and folders that lie in the person's folder.
    pub others: Vec<PathBuf>,
    /// Records in the person's folder that name another patient, or no patient: they are not theirs.
    pub of_another: usize,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PersonRecord {
    pub folder: PathBuf,
    /// When the scan was taken; `None` if the record does not state it.
    pub acquired: Option<Acquired>,
    pub revision: Option<u32>,
    /// What people set, when and who.
    pub amendments: Vec<PersonAmendment>,
}

/// A measure that a person set in a record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PersonAmendment {
    /// Leg and measure.
    pub what: String,
    pub by: String,
    pub at: Timestamp,
    pub reason: String,
}

/// A result that was given to practice software.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HandedOver {
    /// The scan, 64 hexadecimal digits.
    pub sha256: String,
    /// The result's file in the exchange folder.
    pub file: PathBuf,
    pub at: Timestamp,
    /// It is still there: the practice software has not fetched it.
    pub waits: bool,
    /// Files that belong to it and lie in the exchange folder.
    pub attachments: Vec<PathBuf>,
}

/// A record that a server of a hospital was given.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OnServer {
    /// The scan, 64 hexadecimal digits.
    pub sha256: String,
    pub store: String,
    /// The server, as it was configured when it was given that.
    pub place: String,
    /// What identifies it there: a report's address, or a message's control id; `None` if no answer came yet,
    /// or if only a journal that was lost knew it. The server may then have nothing.
    pub reference: Option<String>,
    pub at: Option<Timestamp>,
    /// It was taken back: the server may keep it, marked as wrong.
    pub is_withdrawn: bool,
    /// It is to be taken back, and still counts there.
    #[serde(default)]
    pub is_withdrawing: bool,
    /// The message's file, while the receiver has not fetched it.
    pub unfetched: Option<PathBuf>,
}

/// A wait for a scan of a person: a press, or a name without a button.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PersonCapture {
    pub number: i64,
    /// When it began.
    pub at: Timestamp,
    /// Its state, as a word.
    pub state: String,
}

/// An entry of the journal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PersonEvent {
    /// The scan, 64 hexadecimal digits; '' if it is about none.
    pub scan: String,
    #[serde(flatten)]
    pub happened: Happened,
}

impl Person {
    /// Whether nothing is known of the person.
    pub fn is_unknown(&self) -> bool {
        self.scans.is_empty()
            && self.history.is_empty()
            && self.handed_over.is_empty()
            && self.on_servers.is_empty()
            && self.captures.is_empty()
            && self.affected.is_none()
            && self.orders.is_empty()
            && self.stores.iter().all(|of| of.records.is_empty() && of.others.is_empty())
    }

    /// Whether a scan of theirs is expected: a name waits, or an export has not come.
    pub fn is_awaited(&self) -> bool {
        self.captures.iter().any(|capture| matches!(capture.state.as_str(), "named" | "open"))
    }
}
