//! Whether the station is ready, end to end: not whether it runs, but whether scans become records.
//!
//! An intermittent fault must not make the reported state flicker: a source or a store is reported once
//! the fault has lasted for `BLIP`. Times are wall-clock times, because they must outlast a restart;
//! if the clock was set back and a time is in the future, the state counts as old.

use std::collections::BTreeMap;
use std::time::Duration;

use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp};

use super::Facts;
use super::cause::Cause;
use super::complaint::{Complaint, ComplaintFigures};
use super::facts::{IntakeState, SourceFacts, SourceState, StoreFacts, StoreRefusal, TriggerFacts};
use super::lifecycle::REVISION_REFUSED;
use super::trigger::PortState;
use super::words::age;
use super::worklist::AccessionNumbers;

/// How long a source or a store may be out of order before it is reported: longer than a look that hits
/// a short network break, shorter than the operator's patience.
pub(crate) const BLIP: Duration = Duration::from_secs(5);

/// How long a port may be out of order before it is reported: long enough to plug it in elsewhere.
const REPLUG: Duration = Duration::from_secs(60);

/// A certificate of the station that ends sooner is reported: a clinic's authority may need weeks for a new one.
pub const CERTIFICATE_ENDS_SOON: SignedDuration = SignedDuration::from_hours(30 * 24);

/// Complaint: exports were overwritten or deleted before they were taken.
const EXPORT_GONE: &str = "export-gone";

/// Alarm: an export is awaited, and what came is not read. Its figure is `unread`.
pub const EXPORT_PASSED_OVER: &str = "export-passed-over";

/// What is known about deliveries that are not made, and of what keeps them from servers soon.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Backlog {
    /// Deliveries that are still to be made.
    pub pending: u64,
    /// When the oldest of their scans was first seen.
    pub oldest: Option<Timestamp>,
    /// Scans of whose record a store takes no later revision.
    pub revisions_refused: u64,
    /// By store, records that are to be withdrawn, and are at an earlier address of it.
    pub moved: BTreeMap<String, u64>,
    /// By store, until when the certificate holds that the station shows there.
    pub certificates: BTreeMap<String, Timestamp>,
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
        Complaint::new("page-unavailable", ComplaintFigures::why(why).words("way", way))
    }));
    complaints.extend(late(backlog, overdue, now));
    let alarms = facts.alarms.iter();
    complaints.extend(alarms.map(|(code, alarm)| Complaint::new(code, alarm.figures.clone())));
    let refused = facts.refused_reload.iter();
    complaints.extend(refused.map(|fault| {
        Complaint::new("reload-refused", ComplaintFigures::why(&Cause::verbatim(fault)))
    }));
    complaints.extend(unfetched(facts, now));
    complaints.extend(worklist(facts, now));
    complaints.extend(numbers(facts, now));
    complaints.extend(revisions_refused(backlog));
    complaints.extend(moved(backlog));
    complaints.extend(certificates(backlog, now));
    complaints.extend(facts.views_apart());
    complaints
}

fn intake(facts: &Facts) -> Option<Complaint> {
    match facts.intake {
        IntakeState::Open => None,
        IntakeState::Paused => Some(Complaint::new("paused", ComplaintFigures::default())),
        IntakeState::DiskLow { free, floor } => {
            let figures = ComplaintFigures::default().count("free_bytes", free);
            Some(Complaint::new("disk-low", figures.count("floor_bytes", floor)))
        }
    }
}

fn gone(facts: &Facts) -> Option<Complaint> {
    let count = facts.gone();
    (count > 0).then(|| Complaint::new(EXPORT_GONE, ComplaintFigures::counted(count)))
}

fn stores(facts: &Facts, now: Timestamp) -> impl Iterator<Item = Complaint> {
    facts.stores.iter().filter_map(move |(store, facts)| {
        let fault = facts.refusal.as_ref().and_then(StoreRefusal::fault)?;
        let complaint = Complaint::new("store-fault", ComplaintFigures::why(fault)).about(store);
        has_lasted(facts.since, now, BLIP).then_some(complaint)
    })
}

/// The stores whose next record waits until somebody fetches the last.
fn unfetched(facts: &Facts, now: Timestamp) -> impl Iterator<Item = Complaint> {
    let waiting =
        move |facts: &StoreFacts| facts.waits_for_fetch() && has_lasted(facts.since, now, BLIP);
    let stores = facts.stores.iter().filter(move |(_, facts)| waiting(facts));
    stores.map(move |(store, facts)| {
        let figures = ComplaintFigures::default().seconds("since_s", age(facts.since, now));
        Complaint::notice("result-not-fetched", figures).about(store)
    })
}

/// The worklist, if its server does not answer. Patients can be named without it.
fn worklist(facts: &Facts, now: Timestamp) -> Option<Complaint> {
    let worklist = facts.worklist.as_ref()?;
    let figures = ComplaintFigures::why(worklist.fault.as_ref()?);
    let has_lasted = has_lasted(worklist.since, now, REPLUG);
    has_lasted.then(|| Complaint::notice("worklist-out-of-reach", figures))
}

/// The hospital's accession numbers, if an id that is read may be one: it names nobody then.
fn numbers(facts: &Facts, now: Timestamp) -> Option<Complaint> {
    let worklist = facts.worklist.as_ref()?;
    let code = match worklist.numbers? {
        AccessionNumbers::LikeIds => "worklist-numbers-like-ids",
        // The first answer may be on its way.
        AccessionNumbers::Unseen if has_lasted(worklist.since, now, REPLUG) => {
            "worklist-numbers-unseen"
        }
        AccessionNumbers::Unseen | AccessionNumbers::Apart => return None,
    };
    Some(Complaint::notice(code, ComplaintFigures::default()))
}

fn of_source(place: usize, source: &SourceFacts, now: Timestamp) -> Vec<Complaint> {
    let folder = |figures: ComplaintFigures| figures.count("export_dir", place as u64);
    let state = match &source.state {
        SourceState::NotLooked | SourceState::Watched => None,
        SourceState::OutOfReach(why) => Some(("source-out-of-reach", ComplaintFigures::why(why))),
        SourceState::NotMounted(why) => Some(("source-not-mounted", ComplaintFigures::why(why))),
        SourceState::Taken => Some(("source-taken", ComplaintFigures::default())),
        SourceState::Stalled => {
            let since = age(source.since, now);
            Some(("source-stalled", ComplaintFigures::default().seconds("since_s", since)))
        }
    };
    let state = state.filter(|_| has_lasted(source.since, now, BLIP));
    let state = state.map(|(code, figures)| Complaint::new(code, folder(figures)));
    let overdue = source.waiting.values().filter(|file| file.overdue).count();
    let files = (overdue > 0)
        .then(|| Complaint::new("export-not-taken", folder(ComplaintFigures::counted(overdue))));
    state.into_iter().chain(files).collect()
}

fn of_trigger(port: &str, trigger: &TriggerFacts, now: Timestamp) -> Option<Complaint> {
    let since = trigger.unsound_since.filter(|since| has_lasted(*since, now, REPLUG))?;
    let code = match trigger.state {
        PortState::Absent => "trigger-absent",
        PortState::Busy => "trigger-busy",
        PortState::Denied => "trigger-denied",
        PortState::Failed => "trigger-failed",
        PortState::Stuck => "trigger-stuck",
        PortState::Hung => "trigger-hung",
        PortState::NotLooked | PortState::Settling | PortState::Open => "trigger-unsteady",
    };
    let figures = trigger.why.as_ref().map(ComplaintFigures::why).unwrap_or_default();
    let figures = figures.seconds("since_s", age(since, now));
    Some(Complaint::new(code, figures).about(port))
}

fn late(backlog: &Backlog, overdue: Duration, now: Timestamp) -> Option<Complaint> {
    let waited = age(backlog.oldest?, now);
    if waited.is_some_and(|waited| waited <= overdue) {
        return None;
    }
    let case = if waited.is_some() { "waits" } else { "set_back" };
    let figures = ComplaintFigures::default().words("case", case).seconds("waited_s", waited);
    Some(Complaint::new("delivery-overdue", figures))
}

/// The records are kept, and stores still have earlier ones.
fn revisions_refused(backlog: &Backlog) -> Option<Complaint> {
    let count = usize::try_from(backlog.revisions_refused).unwrap_or(usize::MAX);
    (count > 0).then(|| Complaint::notice(REVISION_REFUSED, ComplaintFigures::counted(count)))
}

/// Records for the wrong patient are at a server whose address is no longer the store's.
fn moved(backlog: &Backlog) -> impl Iterator<Item = Complaint> {
    backlog.moved.iter().map(|(store, count)| {
        let figures = ComplaintFigures::counted(usize::try_from(*count).unwrap_or(usize::MAX));
        Complaint::notice("store-moved", figures).about(store)
    })
}

/// Certificates of the station that end soon, or have ended: servers let it in no more then.
fn certificates(backlog: &Backlog, now: Timestamp) -> impl Iterator<Item = Complaint> {
    backlog.certificates.iter().filter_map(move |(store, until)| {
        let left = until.duration_since(now);
        let case = if left.is_negative() { "ended" } else { "soon" };
        let days = u64::try_from(left.as_hours() / 24).unwrap_or_default();
        let figures = ComplaintFigures::default().words("case", case).count("days", days);
        let notice = Complaint::notice("certificate-ends", figures).about(store);
        (left < CERTIFICATE_ENDS_SOON).then_some(notice)
    })
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
