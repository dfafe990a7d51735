//! The messages of the control socket. Both ends are the same binary, so nothing here is kept
//! compatible, except what `--json` prints.

use gaiter_flow::account::{Filter, Listed, Whole};
use gaiter_flow::patient::erasure::Erasure;
use gaiter_flow::patient::person::{KnownVisits, Person};
use serde::{Deserialize, Serialize};

use super::status::Status;
use crate::station::operator::act::Setting;

/// The longest list that is returned.
pub const LIST_MOST: u32 = 1000;

/// The fewest digits that name a scan.
pub const DIGITS_LEAST: usize = 4;

/// A request to the station.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "ask")]
pub enum Request {
    Status,
    /// Its scans, newest first.
    Scans {
        /// Which scans; all if `None`.
        filter: Option<Filter>,
        /// The largest number of scans.
        limit: u32,
    },
    /// One scan, with its patient.
    Show {
        /// The beginning of its id.
        scan: String,
    },
    /// Why a scan is where it is.
    ExplainScan {
        /// The beginning of its id.
        scan: String,
    },
    /// Why a file is where it is.
    ExplainFile {
        /// Its full path, as the bytes of the file system.
        path: Vec<u8>,
    },
    /// Try a refused scan again, and a waiting scan at once.
    Retry {
        /// The beginning of its id.
        scan: String,
    },
    /// A held scan belongs to the patient for whom it came in.
    Release {
        /// The beginning of its id.
        scan: String,
    },
    /// A scan that came in without a patient belongs to this patient.
    Assign {
        /// The beginning of its id.
        scan: String,
        /// The patient's id.
        patient: String,
    },
    /// A scan does not belong to a patient: it becomes unassigned again, or stays with the others.
    Unassign {
        /// The beginning of its id.
        scan: String,
        /// The patient's id; needed if it belongs to more than one.
        #[serde(default)]
        patient: Option<String>,
    },
    /// A scan that was refused, is held, or is stored without a patient needs no decision any more.
    GiveUp {
        /// The beginning of its id.
        scan: String,
    },
    /// A person sets measures of a record.
    Amend {
        /// The beginning of the scan's id.
        scan: String,
        /// The patient's id; needed if the scan belongs to more than one.
        #[serde(default)]
        patient: Option<String>,
        /// What is set, why, and by whom.
        #[serde(flatten)]
        setting: Setting,
    },
    /// A person names the affected leg of a patient.
    NameAffected {
        /// The patient's id.
        patient: String,
        /// `left`, `right`, `both` or `none`; `not-named` takes it back.
        affected: String,
    },
    /// The next scan belongs to this patient.
    NameNext {
        /// The patient's id.
        patient: String,
        /// Replace another patient who is named and not scanned yet; otherwise that case is refused.
        #[serde(default = "replaces")]
        replace: bool,
    },
    /// The next scan belongs to the patient of an entry of the worklist.
    NameListed {
        /// The entry's key, as the operator's page has it.
        entry: String,
        /// As of a name.
        #[serde(default = "replaces")]
        replace: bool,
    },
    /// No patient is named for the next scan any more, and no press waits for its export.
    CallOff,
    /// Who is named for the next scan.
    Next,
    /// An order of the practice software names the patient of the next scan.
    Order {
        /// The bytes of the order's file.
        bytes: Vec<u8>,
    },
    /// All that the station holds of a person.
    Person {
        /// The patient's id.
        patient: String,
    },
    /// What the station knows of a patient whose visits are compared.
    Visits {
        /// The patient's id.
        patient: String,
    },
    /// A person's data was disclosed.
    Disclosed {
        /// The patient's id.
        patient: String,
        /// Which user of the machine did it.
        by: String,
    },
    /// All that the station holds of a person is to be erased.
    Erase {
        /// The patient's id.
        patient: String,
        /// The same, given a second time.
        again: String,
        /// Which user of the machine asks.
        by: String,
        /// What servers are owed is left undone.
        leaves_owed: bool,
    },
    /// What has become of the erasure of a person.
    Erasure {
        /// The patient's id.
        patient: String,
    },
    /// No scan is taken in or delivered until an operator resumes.
    Pause,
    /// End the pause.
    Resume,
    /// The link to the operator's page.
    Page,
}

/// The default of `replace`.
fn replaces() -> bool {
    true
}

/// An answer of the station.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "is", content = "of")]
pub enum ControlAnswer {
    Status(Box<Status>),
    /// Scans, newest first.
    Scans(Vec<Listed>),
    Scan(Box<Whole>),
    /// All that the station holds of a person.
    Person(Box<Person>),
    /// What the station knows of a patient whose visits are compared.
    Visits(KnownVisits),
    /// What has become of the erasure of a person; `None` if none was asked for.
    Erasure(Option<Erasure>),
    /// A sentence for people.
    Sentence(String),
    /// Nothing was done.
    Fault(ControlFault),
}

/// Why nothing was done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ControlFault {
    /// Stable code.
    pub code: String,
    /// Message in English.
    pub message: String,
    /// The same in the station's language, if that is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub local: Option<String>,
    /// What the page shows instead of the text of the code: a sentence with figures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on_page: Option<String>,
    pub kind: ControlFaultKind,
}

/// Whose fault it is that nothing was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControlFaultKind {
    /// The request makes no sense, or not in this state.
    Request,
    /// What the request names is not known.
    Unknown,
    /// The station could not do it now.
    Failed,
}

impl ControlFault {
    /// Creates a fault with this code.
    pub fn new(kind: ControlFaultKind, code: &str, message: impl Into<String>) -> ControlFault {
        let message = message.into();
        ControlFault { code: code.to_owned(), message, local: None, on_page: None, kind }
    }
}
