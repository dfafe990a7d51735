//! `gaiter status`: how the running station is, on one screen.

use std::fmt::Write;
use std::time::Duration;

use jiff::Timestamp;

use super::args::AskArgs;
use super::{Exit, ask, shown};
use crate::flow::health::{age, bytes, words};
use crate::station::control::protocol::{Answer, Request, SourceStatus, Status};

/// Asks and prints; ends as [`Exit::Io`] when the station is not ready, as `gaiter check` does.
pub fn status(args: &AskArgs) -> Exit {
    let taken = |answer| match answer {
        Answer::Status(status) => Some(*status),
        _ => None,
    };
    let exit = |status: &Status| if status.ready { Exit::Done } else { Exit::Io };
    ask::told(args, &Request::Status, taken, table, exit)
}

/// One screen; the first line says whether all is well.
fn table(status: &Status) -> String {
    let mut text = String::new();
    if status.ready {
        text.push_str("ready\n");
    }
    for complaint in &status.complaints {
        let (message, remedy) = (shown(&complaint.message), shown(&complaint.remedy));
        let _ = writeln!(text, "not ready: {message} [{}]\n    do: {remedy}", complaint.code);
    }
    text.push('\n');
    for (label, value) in rows(status) {
        let _ = writeln!(text, "{label:<9}  {}", shown(value));
    }
    text
}

fn rows(status: &Status) -> Vec<(String, String)> {
    let row = |label: &str, value: String| (label.to_owned(), value);
    let now = status.now;
    let mut rows = vec![row(
        "station",
        format!(
            "{}, gaiter {}, process {}, running for {}",
            status.station,
            status.gaiter,
            status.pid,
            words(age(status.started, now))
        ),
    )];
    let oldest = match (&status.oldest, status.oldest_age_s) {
        (Some(oldest), Some(age_s)) => format!(
            "{} has waited {} for its record",
            oldest.scan,
            words(Duration::from_secs(age_s))
        ),
        _ => "no scan waits for its record".to_owned(),
    };
    rows.push(row("oldest", oldest));
    let last = status.last.as_ref().map(|last| {
        let (seen, ago) = (last.first_seen, words(age(last.first_seen, now)));
        format!("{} seen {}, {ago} ago: {}", last.scan, utc(seen), last.state)
    });
    rows.push(row("last scan", last.unwrap_or_else(|| "none yet".to_owned())));
    let words_of = ["spooled", "delivered", "refused", "held"];
    let counts = words_of.map(|word| format!("{} {word}", status.scans.get(word).unwrap_or(&0)));
    let counts = if status.scans.is_empty() { "unknown".to_owned() } else { counts.join(", ") };
    rows.push(row("scans", counts));
    let intake = match status.intake.as_str() {
        "open" => "scans are taken in".to_owned(),
        "paused" => "paused: exports stay where they are".to_owned(),
        other => format!("{}: exports stay where they are", other.replace('_', " ")),
    };
    rows.push(row("intake", intake));
    rows.extend(
        status
            .sources
            .iter()
            .map(|source| (format!("export {}", source.export_dir), said_of(source, now))),
    );
    if status.stores.is_empty() {
        rows.push(row("store", "nothing delivered yet in this run".to_owned()));
    }
    rows.extend(status.stores.iter().map(|(name, store)| {
        let since = words(age(store.since, now));
        let state = match &store.fault {
            None => format!("takes records since {since}"),
            Some(fault) => format!("takes nothing since {since}: {fault}"),
        };
        ("store".to_owned(), format!("{name}: {state}"))
    }));
    rows.push(row("booth", at_booth(status)));
    rows.extend(status.triggers.iter().map(|(port, trigger)| {
        let since = words(age(trigger.since, now));
        let state = trigger.state.replace('_', " ");
        let why = trigger.why.as_ref().map_or(String::new(), |why| format!(": {why}"));
        let heard = match (trigger.presses, trigger.ids) {
            (presses, 0) => format!("{presses} presses"),
            (_, ids) => format!("{ids} ids"),
        };
        let garbage = trigger.garbage;
        let text =
            format!("{port}: {state} since {since}{why}, {heard}, {garbage} bytes of garbage");
        ("trigger".to_owned(), text)
    }));
    let disk = match (status.disk_free_bytes, status.disk_bytes) {
        (Some(free), Some(size)) => format!("{} free of {}", bytes(free), bytes(size)),
        _ => "unknown".to_owned(),
    };
    rows.push(row("disk", disk));
    let last =
        status.last_measurement_s.map_or(String::new(), |s| format!(", the last in {s:.1} s"));
    rows.push(row("measured", format!("{} in this run{last}", status.measured)));
    rows
}

/// What the light shows and what is awaited, in words.
fn at_booth(status: &Status) -> String {
    let booth = &status.booth;
    let mut text = match booth.light.as_str() {
        "ready" => "ready for the next scan",
        "armed" => "waits for the export of a press",
        "receiving" => "a scan is on its way to its record",
        "done" => "the last scan has its record",
        "no_export" => "no export came after the last press",
        _ => "a person must look",
    }
    .to_owned();
    if booth.awaited > 1 {
        let _ = write!(text, ", {} exports are awaited", booth.awaited);
    }
    if booth.named {
        text.push_str(", a patient is named for the next press");
    }
    if booth.in_doubt {
        text.push_str(", a press may have gone unheard: scans of named patients are held");
    }
    text
}

/// One export folder in words.
fn said_of(source: &SourceStatus, now: Timestamp) -> String {
    let since = words(age(source.since, now));
    let why = source.why.as_ref().map_or(String::new(), |why| format!(": {why}"));
    let mut text = match source.state.as_str() {
        "watched" => "looked through".to_owned(),
        "not_looked" => "not looked at yet".to_owned(),
        state => format!("{} since {since}{why}", state.replace('_', " ")),
    };
    if let Some(last) = source.last_look {
        let _ = write!(text, ", last {} ago", words(age(last, now)));
    }
    if let Some(kind) = &source.file_system {
        let _ = write!(text, ", {kind}{}", if source.polled { " (polled)" } else { "" });
    }
    let _ = write!(text, ", {} waiting", source.waiting);
    if source.overdue > 0 {
        let _ = write!(text, " ({} for too long)", source.overdue);
    }
    if source.ignored > 0 {
        let _ = write!(text, ", {} passed over", source.ignored);
    }
    text
}

/// A time as every log and folder name has it, without its fraction.
pub fn utc(time: Timestamp) -> String {
    time.strftime("%Y-%m-%d %H:%M:%S UTC").to_string()
}

#[cfg(test)]
mod tests;
