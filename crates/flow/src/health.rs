//! Whether the station is ready, end to end: not whether it runs, but whether scans become records.
//!
//! An intermittent fault must not make the reported state flicker: a source or a store is reported once
//! the fault has lasted for `BLIP`. Times are wall-clock times, because they must outlast a restart;
//! if the clock was set back and a time is in the future, the state counts as old.

use std::time::Duration;

use gaiter_language::Language;
use jiff::Timestamp;
use jiff::tz::TimeZone;
use serde::{Deserialize, Serialize};

use super::Facts;
use super::facts::{IntakeState, SourceFacts, SourceState, StoreFacts, StoreRefusal, TriggerFacts};
use super::trigger::PortState;
use super::words::{age, ago, bytes, duration};

/// How long a source or a store may be out of order before it is reported: longer than a look that hits
/// a short network break, shorter than the operator's patience.
pub(crate) const BLIP: Duration = Duration::from_secs(5);

/// How long a port may be out of order before it is reported: long enough to plug it in elsewhere.
const REPLUG: Duration = Duration::from_secs(60);

/// Complaint: exports were overwritten or deleted before they were taken.
const EXPORT_GONE: &str = "export-gone";

/// Alarm: an export is awaited, and what came is not read.
pub const EXPORT_PASSED_OVER: &str = "export-passed-over";

/// Whether a complaint keeps the station from being ready.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Scans do not become records.
    #[default]
    Fault,
    /// They do, and a person should know something all the same.
    Notice,
}

/// Something that keeps the station from being ready, or that a person should know.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Complaint {
    /// Stable code.
    pub code: String,
    /// Whether it keeps the station from being ready.
    #[serde(default)]
    pub severity: Severity,
    /// The store or port that it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject: Option<String>,
    /// What is wrong, a sentence without its full stop.
    pub message: String,
    /// What the operator can do, in the same form.
    pub remedy: String,
}

/// What the journal knows about scans without a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Backlog {
    /// Deliveries that are still to be made.
    pub pending: u64,
    /// When the oldest of their scans was first seen.
    pub oldest: Option<Timestamp>,
}

impl Complaint {
    fn new(code: &str, message: String, remedy: &str) -> Complaint {
        let (code, remedy) = (code.to_owned(), remedy.to_owned());
        Complaint { code, severity: Severity::Fault, subject: None, message, remedy }
    }

    fn about(self, subject: &str) -> Complaint {
        Complaint { subject: Some(subject.to_owned()), ..self }
    }

    /// Whether it keeps the station from being ready.
    pub fn is_fault(&self) -> bool {
        self.severity == Severity::Fault
    }

    /// The journal cannot be read.
    pub fn journal() -> Complaint {
        let message = "the station's journal cannot be read".to_owned();
        Complaint::new("journal-failed", message, "look at the disk of the state folder")
    }
}

/// Everything that keeps the station from being ready, the worst first, then what a person should know. `overdue`
/// is how long a scan may be without a record.
pub fn complaints(
    facts: &Facts,
    backlog: &Backlog,
    overdue: Duration,
    now: Timestamp,
) -> Vec<Complaint> {
    let mut complaints: Vec<Complaint> = intake(facts).into_iter().chain(gone(facts)).collect();
    complaints.extend(stores(facts, now));
    complaints.extend(
        facts.sources.iter().enumerate().flat_map(|(place, source)| of_source(place, source, now)),
    );
    complaints
        .extend(facts.triggers.iter().filter_map(|(port, facts)| of_trigger(port, facts, now)));
    complaints.extend(facts.endpoints.iter().map(|(way, why)| {
        let message =
            format!("the {way} address of the page and of monitors is unavailable: {why}");
        let remedy = "find the program that listens there (ss -ltnp) and stop it; the page then \
                      has a new link";
        Complaint::new("page-unavailable", message, remedy)
    }));
    complaints.extend(late(backlog, overdue, now));
    complaints.extend(
        facts
            .alarms
            .iter()
            .map(|(code, alarm)| Complaint::new(code, alarm.message.clone(), remedy(code))),
    );
    complaints.extend(facts.refused_reload.iter().map(|fault| {
        let message =
            format!("a changed configuration was refused, the old one stays in force: {fault}");
        Complaint::new("reload-refused", message, "run gaiter check, fix the file, reload again")
    }));
    complaints.extend(unfetched(facts, now));
    complaints
}

/// What helps against the cause of an alarm. Those of the booth clear with the next good press or order;
/// others stay until the station is restarted.
fn remedy(code: &str) -> &'static str {
    match code {
        "no-export" => "press the button and scan again",
        EXPORT_PASSED_OVER => {
            "see where and how the scanner exports; gaiter explain FILE says why a file is not read"
        }
        "order-refused" => "order again, or name the patient: gaiter patient set",
        "order-not-removed" => "let the station's user delete files in the folder of orders",
        "orders-out-of-reach" => "mount the folder of orders; it is read again by itself",
        "order-repeated" => "name the patient if this is a new scan of the same person",
        "phantom-check" => {
            "scan the known body again, alone and with nothing beside it; if it stays, have the scanner \
             calibrated before the next patient"
        }
        "erasure-pending" => {
            "mount the store that it waits for; it goes on by itself; for the own folder, restart"
        }
        "record-kept" => {
            "gaiter scans lists it as withdrawing, the log says what keeps it; restore what was changed, or \
             remove what is in the way"
        }
        "measuring-impaired" => {
            "see the log for what stops the measuring processes; scans wait, and the alarm clears \
             itself"
        }
        "journal-refuses" => "undo what was changed in journal.db, then restart",
        _ => "look up this code in /usr/share/doc/gaiter, then restart",
    }
}

fn intake(facts: &Facts) -> Option<Complaint> {
    match facts.intake {
        IntakeState::Open => None,
        IntakeState::Paused => {
            let message =
                "the operator has paused the station; exports stay where they are".to_owned();
            Some(Complaint::new("paused", message, "gaiter resume"))
        }
        IntakeState::DiskLow { free, floor } => {
            let message = format!(
                "the disk of the state folder has {} free and must keep {}; exports stay where \
                 they are",
                bytes(free, Language::En),
                bytes(floor, Language::En)
            );
            let remedy = "free some space; the station continues by itself";
            Some(Complaint::new("disk-low", message, remedy))
        }
    }
}

fn gone(facts: &Facts) -> Option<Complaint> {
    let message = match facts.gone() {
        0 => return None,
        1 => "1 export was overwritten or deleted before it was taken in".to_owned(),
        count => format!("{count} exports were overwritten or deleted before they were taken in"),
    };
    let remedy = "gaiter patient clear, then name the patient and export or scan again";
    Some(Complaint::new(EXPORT_GONE, message, remedy))
}

fn stores(facts: &Facts, now: Timestamp) -> impl Iterator<Item = Complaint> {
    facts.stores.iter().filter_map(move |(store, facts)| {
        let fault = facts.refusal.as_ref().and_then(StoreRefusal::fault)?;
        if !has_lasted(facts.since, now, BLIP) {
            return None;
        }
        let message = format!("the record store \"{store}\" accepts no records: {fault}");
        let remedy =
            "check that it is mounted, writable and has free space; nothing is lost meanwhile";
        Some(Complaint::new("store-fault", message, remedy).about(store))
    })
}

/// The stores whose next record waits until somebody fetches the last.
fn unfetched(facts: &Facts, now: Timestamp) -> impl Iterator<Item = Complaint> {
    let waiting =
        move |facts: &StoreFacts| facts.waits_for_fetch() && has_lasted(facts.since, now, BLIP);
    let stores = facts.stores.iter().filter(move |(_, facts)| waiting(facts));
    stores.map(move |(store, facts)| {
        let since = ago(facts.since, now, Language::En);
        let message = format!(
            "the practice software has not fetched a result for {since}; the next one waits for its place"
        );
        let remedy = "see that its import runs; records go to the patients' folders meanwhile; if it takes \
                      numbered files, see store.gdt.file_name";
        let complaint = Complaint::new("result-not-fetched", message, remedy).about(store);
        Complaint { severity: Severity::Notice, ..complaint }
    })
}

fn of_source(place: usize, source: &SourceFacts, now: Timestamp) -> Vec<Complaint> {
    let since = ago(source.since, now, Language::En);
    let state = match &source.state {
        SourceState::NotLooked | SourceState::Watched => None,
        SourceState::OutOfReach(why) => Some((
            "source-out-of-reach",
            format!("export folder {place} cannot be listed: {why}"),
            "see that the scanner's computer is on and its share is mounted",
        )),
        SourceState::NotMounted(why) => Some((
            "source-not-mounted",
            format!("export folder {place} is there, but not what should be mounted on it: {why}"),
            "mount it; files in the bare folder are not taken in",
        )),
        SourceState::Taken => Some((
            "source-taken",
            format!("another station on this machine uses export folder {place}"),
            "stop one of the two, or give each its own folder; nothing is taken in from it here",
        )),
        SourceState::Stalled => Some((
            "source-stalled",
            format!("export folder {place} has not answered for {since}"),
            "see that the scanner's computer is on and the network works",
        )),
    };
    let state = state.filter(|_| has_lasted(source.since, now, BLIP));
    let state = state.map(|(code, message, remedy)| Complaint::new(code, message, remedy));
    let overdue = source.waiting.values().filter(|file| file.overdue).count();
    let files = (overdue > 0).then(|| {
        let message = format!("{} in export folder {place} not taken in", counted(overdue, "file"));
        let remedy = "gaiter explain FILE says what each waits for";
        Complaint::new("export-not-taken", message, remedy)
    });
    state.into_iter().chain(files).collect()
}

fn of_trigger(port: &str, trigger: &TriggerFacts, now: Timestamp) -> Option<Complaint> {
    let since = trigger.unsound_since.filter(|since| has_lasted(*since, now, REPLUG))?;
    let since = ago(since, now, Language::En);
    let (code, what, remedy) = match trigger.state {
        PortState::Absent => {
            ("trigger-absent", "is not there", "plug it in; see the page on the booth for its port")
        }
        PortState::Busy => {
            ("trigger-busy", "belongs to another program", "end that program; see fuser -v PORT")
        }
        PortState::Denied => (
            "trigger-denied",
            "cannot be opened (no permission)",
            "give the station's user access to the port: see 70-gaiter.rules",
        ),
        PortState::Failed => ("trigger-failed", "does not work", "see its cable and its adapter"),
        PortState::Stuck => {
            ("trigger-stuck", "has a contact that is stuck closed", "see the button and its cable")
        }
        PortState::Hung => {
            ("trigger-hung", "hangs in its driver", "unplug it and plug it in again")
        }
        PortState::NotLooked | PortState::Settling | PortState::Open => {
            ("trigger-unsteady", "comes and goes", "see its cable and its plug")
        }
    };
    let why = trigger.why.as_ref().map_or(String::new(), |why| format!(": {why}"));
    let message = format!("the {port} port of the booth {what}, for {since}{why}");
    Some(Complaint::new(code, message, remedy))
}

fn late(backlog: &Backlog, overdue: Duration, now: Timestamp) -> Option<Complaint> {
    let message = match age(backlog.oldest?, now) {
        None => "a scan has no record and came in before the clock was set back".to_owned(),
        Some(waiting) if waiting <= overdue => return None,
        Some(waiting) => {
            format!("a scan has waited {} for its record", duration(waiting, Language::En))
        }
    };
    let remedy = "gaiter scans --state spooled lists what waits, gaiter explain ID says for what";
    Some(Complaint::new("delivery-overdue", message, remedy))
}

/// Whether something has lasted for `least`; a start in the future counts as long ago.
pub(crate) fn has_lasted(since: Timestamp, now: Timestamp, least: Duration) -> bool {
    age(since, now).is_none_or(|age| age >= least)
}

/// A time in readable form in a time zone, without a fraction.
pub fn local(time: Timestamp, zone: &TimeZone) -> String {
    time.to_zoned(zone.clone()).strftime("%Y-%m-%d %H:%M:%S").to_string()
}

/// A number of things.
pub fn counted(count: usize, of: &str) -> String {
    if count == 1 { format!("1 {of}") } else { format!("{count} {of}s") }
}

#[cfg(test)]
mod tests;
