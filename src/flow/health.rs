//! Whether the station is ready, end to end: not whether it runs, but whether scans become records.
//!
//! A fault that comes and goes must not make the station's word flicker: a source or a store is
//! complained of once it has been so for [`BLIP`]. Times are of the wall clock, for they outlast a
//! restart; where it was set back and a time lies in the future, the state is taken to be old.

use std::time::Duration;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::Facts;
use super::facts::{IntakeState, SourceFacts, SourceState, TriggerFacts};
use super::trigger::PortState;

/// How long a source or a store may be out of order without a complaint: longer than a look that
/// fell into a short break of the network, shorter than a person's patience.
pub const BLIP: Duration = Duration::from_secs(5);

/// How long a port may be out of order without a complaint: long enough to plug it in elsewhere.
pub const REPLUG: Duration = Duration::from_secs(60);

/// Something that keeps the station from being ready.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Complaint {
    /// Stable code.
    pub code: String,
    /// What is wrong, a sentence without its full stop.
    pub message: String,
    /// What a person can do, likewise.
    pub remedy: String,
}

/// What the journal says of scans without a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Backlog {
    /// Deliveries to be made.
    pub pending: u64,
    /// When the oldest of their scans was first seen.
    pub oldest: Option<Timestamp>,
}

impl Complaint {
    fn new(code: &str, message: String, remedy: &str) -> Complaint {
        Complaint { code: code.to_owned(), message, remedy: remedy.to_owned() }
    }

    /// The journal cannot be asked.
    pub fn journal() -> Complaint {
        let message = "the station's journal cannot be read".to_owned();
        Complaint::new("journal-failed", message, "look at the disk of the state folder")
    }
}

/// Everything that keeps the station from being ready, the worst first; nothing when it is.
/// `overdue` is how long a scan may be without a record.
pub fn complaints(
    facts: &Facts,
    backlog: &Backlog,
    overdue: Duration,
    now: Timestamp,
) -> Vec<Complaint> {
    let mut complaints: Vec<Complaint> = intake(facts).into_iter().collect();
    complaints.extend(stores(facts, now));
    complaints.extend(
        facts.sources.iter().enumerate().flat_map(|(place, source)| of_source(place, source, now)),
    );
    complaints
        .extend(facts.triggers.iter().filter_map(|(port, facts)| of_trigger(port, facts, now)));
    complaints.extend(facts.endpoints.iter().map(|(way, why)| {
        let message = format!("the {way} address of the page and of monitors cannot be had: {why}");
        let remedy = "see who listens there (ss -ltnp), and end it; the page has a new link then";
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
        let message = format!("a changed configuration was refused, the old one holds: {fault}");
        Complaint::new("reload-refused", message, "run gaiter check, mend the file, reload again")
    }));
    complaints
}

/// What helps against the cause of an alarm. Most stay until the station is restarted.
fn remedy(code: &str) -> &'static str {
    match code {
        "measuring-impaired" => {
            "see the log for what ends or keeps off measuring processes; scans wait, and it goes by itself"
        }
        "journal-refuses" => "undo what was changed in journal.db, then restart",
        _ => "see the README at this code, then restart",
    }
}

fn intake(facts: &Facts) -> Option<Complaint> {
    match facts.intake {
        IntakeState::Open => None,
        IntakeState::Paused => {
            let message = "a person has paused the station; exports stay where they are".to_owned();
            Some(Complaint::new("paused", message, "gaiter resume"))
        }
        IntakeState::DiskLow { free, floor } => {
            let message = format!(
                "the disk of the state folder has {} free and must keep {}; exports stay where \
                 they are",
                bytes(free),
                bytes(floor)
            );
            Some(Complaint::new("disk-low", message, "make room; the station goes on by itself"))
        }
    }
}

fn stores(facts: &Facts, now: Timestamp) -> impl Iterator<Item = Complaint> {
    facts.stores.iter().filter_map(move |(store, facts)| {
        let fault = facts.fault.as_ref().filter(|_| has_lasted(facts.since, now, BLIP))?;
        let message = format!("the record store \"{store}\" takes nothing: {fault}");
        let remedy = "see that it is mounted, writable and has room; nothing is lost meanwhile";
        Some(Complaint::new("store-fault", message, remedy))
    })
}

fn of_source(place: usize, source: &SourceFacts, now: Timestamp) -> Vec<Complaint> {
    let since = ago(source.since, now);
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
            "mount it; what lies in the bare folder is not taken",
        )),
        SourceState::Taken => Some((
            "source-taken",
            format!("another station on this machine works export folder {place}"),
            "end one of the two, or give each its own folder; nothing is taken from it here",
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
        let message = format!("export folder {place} holds {} not taken", counted(overdue, "file"));
        let remedy = "gaiter explain FILE says what each waits for";
        Complaint::new("export-not-taken", message, remedy)
    });
    state.into_iter().chain(files).collect()
}

fn of_trigger(port: &str, trigger: &TriggerFacts, now: Timestamp) -> Option<Complaint> {
    let since = trigger.unsound_since.filter(|since| has_lasted(*since, now, REPLUG))?;
    let since = ago(since, now);
    let (code, what, remedy) = match trigger.state {
        PortState::Absent => {
            ("trigger-absent", "is not there", "plug it in; see the README for its port")
        }
        PortState::Busy => {
            ("trigger-busy", "belongs to another program", "end that program; see fuser -v PORT")
        }
        PortState::Denied => (
            "trigger-denied",
            "may not be opened",
            "give the station's user the port: see 70-gaiter.rules",
        ),
        PortState::Failed => ("trigger-failed", "does not work", "see its cable and its adapter"),
        PortState::Stuck => {
            ("trigger-stuck", "has a contact that sticks closed", "see the button and its cable")
        }
        PortState::Hung => {
            ("trigger-hung", "does not come back from its driver", "unplug it and plug it in again")
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
        Some(waiting) => format!("a scan has waited {} for its record", words(waiting)),
    };
    let remedy = "gaiter scans --state spooled lists what waits, gaiter explain ID says for what";
    Some(Complaint::new("delivery-overdue", message, remedy))
}

/// How long ago a time was; none where it lies in the future, for the clock was set back.
pub fn age(since: Timestamp, now: Timestamp) -> Option<Duration> {
    Duration::try_from(now.duration_since(since)).ok()
}

/// Whether something has lasted so long; one whose beginning lies in the future is taken to be old.
pub fn has_lasted(since: Timestamp, now: Timestamp, least: Duration) -> bool {
    age(since, now).is_none_or(|age| age >= least)
}

/// How long ago a time was, in words.
pub fn ago(since: Timestamp, now: Timestamp) -> String {
    age(since, now).map_or_else(|| "an unknown time".to_owned(), words)
}

/// A time as people read it, without its fraction.
pub fn utc(time: Timestamp) -> String {
    time.strftime("%Y-%m-%d %H:%M:%S UTC").to_string()
}

/// A duration as people say it, the largest unit that fits and no fraction.
pub fn words(duration: Duration) -> String {
    const UNITS: [(u64, &str); 4] =
        [(86_400, "day"), (3600, "hour"), (60, "minute"), (1, "second")];
    let seconds = duration.as_secs();
    let unit = UNITS.into_iter().find(|(length, _)| seconds >= 2 * length);
    let (length, unit) = unit.unwrap_or((1, "second"));
    let count = seconds / length;
    if count == 1 { format!("1 {unit}") } else { format!("{count} {unit}s") }
}

/// A number of things.
pub fn counted(count: usize, of: &str) -> String {
    if count == 1 { format!("1 {of}") } else { format!("{count} {of}s") }
}

/// A size as people say it, in decimal units as disks are sold.
pub fn bytes(size: u64) -> String {
    const UNITS: [(u64, &str); 3] = [(1_000_000_000, "GB"), (1_000_000, "MB"), (1000, "kB")];
    match UNITS.into_iter().find(|(length, _)| size >= *length) {
        Some((length, unit)) => format!("{:.1} {unit}", size as f64 / length as f64),
        None => format!("{size} B"),
    }
}

#[cfg(test)]
mod tests;
