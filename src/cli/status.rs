//! `gaiter status`: the state of the running station on one screen, the most important first.

mod phantom;
mod watch;

use std::fmt::Write;
use std::time::Duration;

use gaiter_flow::account::{Filter, Listed};
use gaiter_flow::complaint::Severity;
use gaiter_flow::words::{ago, bytes, duration};
use gaiter_language::Language;
use jiff::Timestamp;

use super::args::{AskArgs, StatusArgs};
use super::ask::{self, AskFault};
use super::terminal::clock::local;
use super::terminal::paint::{self, painted};
use super::terminal::screen::{self, wrapped};
use super::{Exit, complain, scans, shown};
use crate::station::operator::control::protocol::{Answer, Request};
use crate::station::operator::control::status::{ComplaintStatus, SourceStatus, Status};

/// How many of the last scans are shown. A screen of 24 lines has room for them.
const LAST_SCANS: u32 = 5;

/// How many of these may be held scans, shown first because the operator must look at them.
const HELD_SCANS: u32 = 3;

/// Width of the labels before the figures, with the gap after them.
const LABEL: usize = 11;

/// Queries and prints. Returns [`Exit::Io`] if the station is not ready, as `gaiter check` does.
pub fn status(args: &StatusArgs) -> Exit {
    if args.watch {
        return watch::watch(&args.ask);
    }
    if args.ask.json {
        return ask::told(&args.ask, &Request::Status, taken, |_| String::new(), exit);
    }
    let look = match Look::take(&args.ask) {
        Ok(look) => look,
        Err(fault) => return ask::refused(&args.ask, &fault),
    };
    match paint::print(table(&look, screen::size().map(|size| size.columns))) {
        Ok(()) => exit(&look.status),
        Err(error) => {
            complain(format_args!("gaiter: cannot print the answer: {error}"));
            Exit::Io
        }
    }
}

fn exit(status: &Status) -> Exit {
    if status.ready { Exit::Done } else { Exit::Io }
}

fn taken(answer: Answer) -> Option<Status> {
    match answer {
        Answer::Status(status) => Some(*status),
        _ => None,
    }
}

/// The content of the screen.
struct Look {
    status: Status,
    /// The last held scans, then the last of all scans, newest first.
    scans: Vec<Listed>,
}

impl Look {
    fn take(args: &AskArgs) -> Result<Look, AskFault> {
        let status = ask::ask(&args.config, &Request::Status)?;
        let status = taken(status).ok_or_else(AskFault::another_answer)?;
        // A station that only answers the status request is still shown.
        let listed = |filter, limit| match ask::ask(&args.config, &Request::Scans { filter, limit })
        {
            Ok(Answer::Scans(scans)) => scans,
            _ => Vec::new(),
        };
        let is_any_held = status.scans.get("held").is_some_and(|count| *count > 0);
        let held = if is_any_held { listed(Some(Filter::Held), HELD_SCANS) } else { Vec::new() };
        let scans = held_first(held, listed(None, LAST_SCANS));
        Ok(Look { status, scans })
    }
}

/// The held scans, then the others, as many as fit.
fn held_first(mut held: Vec<Listed>, mut newest: Vec<Listed>) -> Vec<Listed> {
    newest.retain(|scan| held.iter().all(|held| held.scan != scan.scan));
    held.append(&mut newest);
    held.truncate(LAST_SCANS as usize);
    held
}

/// One screen with colours. The first line shows whether all is well.
fn table(look: &Look, columns: Option<usize>) -> String {
    let status = &look.status;
    let mut text = String::new();
    if status.ready {
        text += &(painted(paint::GOOD, "ready") + "\n");
    }
    for ComplaintStatus { complaint, message, remedy } in &status.complaints {
        let (message, remedy) = (shown(message), shown(remedy));
        let (begin, colour) = match complaint.severity {
            Severity::Fault => ("not ready", paint::BAD),
            Severity::Notice => ("note", paint::CARE),
        };
        let said = format!("{begin}: {message} [{}]", complaint.code);
        wrapped(&said, columns).iter().for_each(|line| text += &(painted(colour, line) + "\n"));
        let within = columns.map(|columns| columns.saturating_sub(8));
        let lines = wrapped(&remedy, within);
        let _ = writeln!(text, "    do: {}", lines.join("\n        "));
    }
    let within = columns.map(|columns| columns.saturating_sub(LABEL));
    for (label, value) in rows(look) {
        let lines = wrapped(&shown(value), within).join(&format!("\n{:LABEL$}", ""));
        let label = painted(paint::LABEL, format_args!("{label:<9}"));
        let _ = writeln!(text, "{label}  {lines}");
    }
    if !look.scans.is_empty() {
        let _ = writeln!(text, "\n{}", scans::list(&look.scans).trim_end());
    }
    text
}

fn rows(look: &Look) -> Vec<(String, String)> {
    let (status, now) = (&look.status, look.status.now);
    let mut rows = vec![("light".to_owned(), at_booth(status))];
    rows.extend(status.booth.advice.clone().map(|advice| ("orders".to_owned(), advice)));
    rows.extend(around(status, now));
    let oldest = match (&status.oldest, status.oldest_age_s) {
        (Some(oldest), Some(age_s)) => format!(
            "{} has waited {} for its record",
            oldest.scan,
            duration(Duration::from_secs(age_s), Language::En)
        ),
        _ => "no scan is waiting for its record".to_owned(),
    };
    let mut row = |label: &str, value: String| rows.push((label.to_owned(), value));
    row("oldest", oldest);
    let words_of = ["spooled", "delivered", "refused", "held"];
    let mut counts: Vec<String> = words_of
        .map(|word| format!("{} {word}", status.scans.get(word).unwrap_or(&0)))
        .into_iter()
        .collect();
    let back = status.scans.get("withdrawing").filter(|count| **count > 0);
    counts.extend(back.map(|count| format!("{count} to be withdrawn")));
    let counts = if status.scans.is_empty() { "unknown".to_owned() } else { counts.join(", ") };
    row("scans", counts);
    let last = status.last.as_ref().map(|last| {
        let (seen, ago) = (last.first_seen, ago(last.first_seen, now, Language::En));
        let listed = look.scans.iter().find(|scan| scan.scan == last.scan);
        let state = listed.map_or(last.state.word(), |scan| scan.disposition.word());
        format!("{} seen {}, {ago} ago: {state}", last.scan, local(seen))
    });
    row("last scan", last.unwrap_or_else(|| "none yet".to_owned()));
    let last =
        status.last_measurement_s.map_or(String::new(), |s| format!(", the last in {s:.1} s"));
    row("measured", format!("{} in this run{last}", status.measured));
    rows.extend(status.phantom.iter().flat_map(|phantom| phantom::rows(phantom, now)));
    let mut row = |label: &str, value: String| rows.push((label.to_owned(), value));
    if let Some(missing) = status.confinement.and_then(|found| found.missing()) {
        row(
            "guards",
            format!("measuring processes run without {missing}, which this machine lacks"),
        );
    }
    let disk = match (status.disk_free_bytes, status.disk_bytes) {
        (Some(free), Some(size)) => {
            format!("{} free of {}", bytes(free, Language::En), bytes(size, Language::En))
        }
        _ => "unknown".to_owned(),
    };
    row("disk", disk);
    let ago = duration(Duration::from_secs(status.running_s), Language::En);
    let process = format!("gaiter {}, process {}, running for {ago}", status.gaiter, status.pid);
    row("station", format!("{}, {process}", status.station));
    rows
}

/// The surroundings of the station: export folders, ports, stores.
fn around(status: &Status, now: Timestamp) -> Vec<(String, String)> {
    let intake = match status.intake.as_str() {
        "open" => "scans are taken in".to_owned(),
        "paused" => "paused: exports are not taken in".to_owned(),
        other => format!("{}: exports are not taken in", other.replace('_', " ")),
    };
    let mut rows = vec![("intake".to_owned(), intake)];
    rows.extend(
        status
            .sources
            .iter()
            .map(|source| (format!("export {}", source.export_dir), said_of(source, now))),
    );
    rows.extend(status.triggers.iter().map(|(port, trigger)| {
        let time = ago(trigger.since, now, Language::En);
        let state = trigger.state.replace('_', " ");
        let why = trigger.why.as_ref().map_or(String::new(), |why| format!(": {why}"));
        let heard = match (trigger.presses, trigger.ids) {
            (presses, 0) => format!("{presses} presses"),
            (_, ids) => format!("{ids} ids"),
        };
        let garbage = trigger.garbage;
        let text = format!("{port}: {state} for {time}{why}, {heard}, {garbage} bytes of garbage");
        ("trigger".to_owned(), text)
    }));
    if status.stores.is_empty() {
        rows.push(("store".to_owned(), "nothing delivered yet in this run".to_owned()));
    }
    rows.extend(status.stores.iter().map(|(name, store)| {
        let time = ago(store.since, now, Language::En);
        let state = match &store.fault {
            None => format!("has accepted records for {time}"),
            Some(fault) => format!("has accepted no records for {time}: {fault}"),
        };
        ("store".to_owned(), format!("{name}: {state}"))
    }));
    rows
}

/// The state of the light and the awaited exports, in words.
fn at_booth(status: &Status) -> String {
    let booth = &status.booth;
    let mut text = match booth.light.as_str() {
        "ready" => "ready for the next scan",
        "armed" => "waits for the export of a press",
        "receiving" => "a scan is being processed",
        "done" => "the last scan was delivered",
        "no_export" => "no export came after the last press",
        _ => "operator action needed",
    }
    .to_owned();
    if booth.awaited > 1 {
        let _ = write!(text, ", {} exports are awaited", booth.awaited);
    }
    if booth.named {
        text.push_str(", a patient is named for the next press");
    }
    if booth.in_doubt {
        text.push_str(", a press may have been missed: scans of named patients are held");
    }
    text
}

/// The state of one export folder in words.
fn said_of(source: &SourceStatus, now: Timestamp) -> String {
    let time = ago(source.since, now, Language::En);
    let why = source.why.as_ref().map_or(String::new(), |why| format!(": {why}"));
    let mut text = match source.state.as_str() {
        "watched" => "looked through".to_owned(),
        "not_looked" => "not looked at yet".to_owned(),
        state => format!("{} for {time}{why}", state.replace('_', " ")),
    };
    if let Some(last) = source.last_look {
        let _ = write!(text, ", last {} ago", ago(last, now, Language::En));
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
        let unread = source.unread.iter();
        let unread: Vec<String> =
            unread.map(|(why, count)| format!("{count} {}", why.replace('_', " "))).collect();
        if !unread.is_empty() {
            let _ = write!(text, " (may be exports: {})", unread.join(", "));
        }
    }
    if source.gone > 0 {
        let _ = write!(text, ", {} gone before they were taken in", source.gone);
    }
    text
}

#[cfg(test)]
mod tests;
