//! `gaiter status`: the state of the running station on one screen, the most important first.

mod phantom;
mod views;

use std::fmt::{Display, Write};
use std::time::Duration;

use gaiter_flow::account::{Filter, Listed};
use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::{Complaint, Severity};
use gaiter_flow::export::passed_over::listed;
use gaiter_flow::words::{ago, bytes, decimals, duration};
use gaiter_language::Language;
use jiff::Timestamp;

use super::args::AskArgs;
use super::ask::{self, AskFault};
use super::terminal::screen::{self, width, wrapped};
use super::terminal::{self, local, painted};
use super::{Exit, exit_of_printing, scans, terminal_safe};
use crate::station::operator::control::protocol::{ControlAnswer, Request};
use crate::station::operator::control::status::{
    ComplaintStatus, SourceStatus, Status, TriggerStatus, WorklistStatus,
};

/// Heights of a chart's bars.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// How many of the last scans are shown. A screen of 24 lines has room for them.
const LAST_SCANS: u32 = 5;

/// How many of these may be held scans, shown first because the operator must look at them.
const HELD_SCANS: u32 = 3;

/// The least width of the labels before the figures.
const LABEL_LEAST: usize = 9;

/// The gap behind the labels.
const GAP: usize = 2;

/// Queries and prints. Returns [`Exit::Io`] if the station is not ready, as `gaiter check` does.
pub fn status(args: &AskArgs) -> Exit {
    if args.json {
        return ask::answered(args, &Request::Status, taken, |_, _| String::new(), exit);
    }
    let look = match Look::take(args) {
        Ok(look) => look,
        Err(fault) => return ask::refused(args, &fault),
    };
    let columns = screen::terminal_columns();
    let printed = terminal::print_painted(table(&look, ask::language(&args.config), columns));
    exit_of_printing("the answer", printed).max(exit(&look.status))
}

fn exit(status: &Status) -> Exit {
    if status.ready { Exit::Done } else { Exit::Io }
}

fn taken(answer: ControlAnswer) -> Option<Status> {
    match answer {
        ControlAnswer::Status(status) => Some(*status),
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
            Ok(ControlAnswer::Scans(scans)) => scans,
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
fn table(look: &Look, language: Language, columns: Option<usize>) -> String {
    let status = &look.status;
    let mut text = String::new();
    if status.ready {
        text += &(painted(terminal::GOOD, language.text("terminal.ready")) + "\n");
    }
    for ComplaintStatus { complaint, .. } in &status.complaints {
        text += &complained(complaint, language, columns);
    }
    let rows = rows(look, language);
    let width = width(rows.iter().map(|(label, _)| label.as_str()), LABEL_LEAST);
    let gap = width + GAP;
    let within = columns.map(|columns| columns.saturating_sub(gap));
    for (label, value) in rows {
        let lines = wrapped(&terminal_safe(value), within).join(&format!("\n{:gap$}", ""));
        let label = painted(terminal::LABEL, format_args!("{label:<width$}"));
        let _ = writeln!(text, "{label}{:GAP$}{lines}", "");
    }
    if !look.scans.is_empty() {
        let _ = writeln!(text, "\n{}", scans::list(&look.scans, language).trim_end());
    }
    text
}

/// A complaint, and what to do about it.
fn complained(complaint: &Complaint, language: Language, columns: Option<usize>) -> String {
    let (message, remedy) = (complaint.message(language), complaint.remedy(language));
    let (key, colour) = match complaint.severity {
        Severity::Fault => ("terminal.not_ready", terminal::BAD),
        Severity::Notice => ("terminal.note", terminal::CARE),
    };
    let sentence =
        format!("{}: {} [{}]", language.text(key), terminal_safe(message), complaint.code);
    let lines = wrapped(&sentence, columns).into_iter();
    let mut text: String = lines.map(|line| painted(colour, line) + "\n").collect();
    let before = format!("    {}: ", language.text("terminal.do"));
    let indent = before.chars().count();
    let within = columns.map(|columns| columns.saturating_sub(indent));
    let lines = wrapped(&terminal_safe(remedy), within).join(&format!("\n{:indent$}", ""));
    let _ = writeln!(text, "{before}{lines}");
    text
}

/// The rows below the complaints: labels and values.
fn rows(look: &Look, language: Language) -> Vec<(String, String)> {
    let (status, now) = (&look.status, look.status.now);
    let label = |key| language.text(key).to_owned();
    let mut rows = vec![(label("terminal.label.light"), at_booth(status, language))];
    let late = status.booth.orders_come_late.map(|late| late.in_words(language));
    rows.extend(late.map(|advice| (label("terminal.label.orders"), advice)));
    rows.extend(around(status, now, language));
    rows.extend(of_scans(look, language));
    rows.extend(status.phantom.iter().flat_map(|of| phantom::rows(of, now, language)));
    rows.extend(views::rows(&status.views, language));
    if let Some(missing) = status.confinement.and_then(|found| found.missing()) {
        let guards = language.filled("terminal.guards", &[("missing", &missing)]);
        rows.push((label("terminal.label.guards"), guards));
    }
    let disk = match (status.disk_free_bytes, status.disk_bytes) {
        (Some(free), Some(size)) => {
            let (free, size) = (bytes(free, language), bytes(size, language));
            language.filled("terminal.disk", &[("free", &free), ("size", &size)])
        }
        _ => label("terminal.unknown"),
    };
    rows.push((label("terminal.label.disk"), disk));
    let words: [(&str, &dyn Display); 4] = [
        ("station", &status.station),
        ("version", &status.gaiter),
        ("pid", &status.pid),
        ("time", &duration(Duration::from_secs(status.running_s), language)),
    ];
    rows.push((label("terminal.label.station"), language.filled("terminal.station", &words)));
    rows
}

/// The rows about scans.
fn of_scans(look: &Look, language: Language) -> [(String, String); 4] {
    let status = &look.status;
    let text = |key| language.text(key).to_owned();
    let oldest = match (&status.oldest, status.oldest_age_s) {
        (Some(oldest), Some(age_s)) => {
            let time = duration(Duration::from_secs(age_s), language);
            language.filled("terminal.oldest", &[("scan", &oldest.scan), ("time", &time)])
        }
        _ => text("terminal.none_waits"),
    };
    let last = status.last.as_ref().map(|last| {
        let listed = look.scans.iter().find(|scan| scan.scan == last.scan);
        let state = listed.map_or(last.state.word(), |scan| scan.disposition.word());
        let words: [(&str, &dyn Display); 4] = [
            ("scan", &last.scan),
            ("at", &local(last.first_seen)),
            ("time", &ago(last.first_seen, status.now, language)),
            ("state", &language.word("terminal.state", state)),
        ];
        language.filled("terminal.last", &words)
    });
    let count = &status.measured;
    let measured = match status.last_measurement_s {
        Some(s) => {
            let s = decimals(s, 1, language);
            language.filled("terminal.measured_last", &[("count", count), ("s", &s)])
        }
        None => language.filled("terminal.measured", &[("count", count)]),
    };
    [
        (text("terminal.label.oldest"), oldest),
        (text("terminal.label.scans"), counts(status, language)),
        (text("terminal.label.last_scan"), last.unwrap_or_else(|| text("terminal.none_yet"))),
        (text("terminal.label.measured"), measured),
    ]
}

/// How many scans are in each state.
fn counts(status: &Status, language: Language) -> String {
    if status.scans.is_empty() {
        return language.text("terminal.unknown").to_owned();
    }
    let counted = |state: &str| {
        let count = status.scans.get(state).unwrap_or(&0);
        format!("{count} {}", language.word("terminal.state", state))
    };
    let mut counts = ["spooled", "delivered", "refused", "held"].map(counted).to_vec();
    let back = status.scans.get("withdrawing").filter(|count| **count > 0);
    counts.extend(back.map(|count| language.filled("terminal.to_withdraw", &[("count", count)])));
    counts.join(", ")
}

/// The surroundings of the station: export folders, ports, stores.
fn around(status: &Status, now: Timestamp, language: Language) -> Vec<(String, String)> {
    let text = |key| language.text(key).to_owned();
    let intake = language.word("terminal.intake", &status.intake).to_owned();
    let mut rows = vec![(text("terminal.label.intake"), intake)];
    rows.extend(status.sources.iter().map(|source| {
        let label = language.filled("terminal.label.export", &[("number", &source.export_dir)]);
        (label, state_of(source, now, language))
    }));
    rows.extend(status.triggers.iter().map(|(port, trigger)| {
        (text("terminal.label.trigger"), of_port(port, trigger, now, language))
    }));
    rows.extend(
        status.worklist.iter().map(|worklist| {
            (text("terminal.label.worklist"), of_worklist(worklist, now, language))
        }),
    );
    if status.stores.is_empty() {
        rows.push((text("terminal.label.store"), text("terminal.store.none")));
    }
    rows.extend(status.stores.iter().map(|(name, store)| {
        let time = ago(store.since, now, language);
        let why = match store.waits_for_fetch {
            true => Some(language.text("explain.not_fetched").to_owned()),
            false => store.cause.as_ref().map(|cause| cause.in_words(language)),
        };
        let key = if why.is_some() { "terminal.store.bad" } else { "terminal.store.good" };
        let words: [(&str, &dyn Display); 3] =
            [("store", name), ("time", &time), ("why", &why.unwrap_or_default())];
        (text("terminal.label.store"), language.filled(key, &words))
    }));
    rows
}

/// The state of one port of the booth.
fn of_port(port: &str, trigger: &TriggerStatus, now: Timestamp, language: Language) -> String {
    let words: [(&str, &dyn Display); 3] = [
        ("port", &port),
        ("state", &language.word("terminal.port_state", &trigger.state)),
        ("time", &ago(trigger.since, now, language)),
    ];
    let state = language.filled("terminal.port.state", &words);
    let state = with_why(state, trigger.cause.as_ref(), language);
    let received = match (trigger.presses, trigger.ids) {
        (presses, 0) => language.filled("terminal.port.presses", &[("count", &presses)]),
        (_, ids) => language.filled("terminal.port.ids", &[("count", &ids)]),
    };
    let garbage = language.filled("terminal.port.garbage", &[("count", &trigger.garbage)]);
    [state, received, garbage].join(", ")
}

/// The state of the worklist.
fn of_worklist(worklist: &WorklistStatus, now: Timestamp, language: Language) -> String {
    match (&worklist.cause, worklist.answered) {
        (Some(why), _) => {
            let words: [(&str, &dyn Display); 2] =
                [("time", &ago(worklist.since, now, language)), ("why", &why.in_words(language))];
            language.filled("terminal.worklist.away", &words)
        }
        (None, Some(answered)) => {
            let words: [(&str, &dyn Display); 2] =
                [("count", &worklist.entries), ("time", &ago(answered, now, language))];
            language.filled("terminal.worklist.answers", &words)
        }
        (None, None) => language.text("terminal.worklist.not_asked").to_owned(),
    }
}

/// A state with the reason for it.
fn with_why(state: String, why: Option<&Cause>, language: Language) -> String {
    match why {
        Some(why) => format!("{state}: {}", why.in_words(language)),
        None => state,
    }
}

/// The state of the light and the awaited exports.
fn at_booth(status: &Status, language: Language) -> String {
    let booth = &status.booth;
    let light = match booth.light.as_str() {
        "ready" => "terminal.light.ready",
        "armed" => "terminal.light.armed",
        "receiving" => "terminal.light.receiving",
        "done" => "terminal.light.done",
        "no_export" => "terminal.light.no_export",
        "paused" => "terminal.light.paused",
        _ => "terminal.light.attention",
    };
    let awaited = (booth.awaited > 1)
        .then(|| language.filled("terminal.light.awaited", &[("count", &booth.awaited)]));
    let named = booth.named.then(|| language.text("terminal.light.named").to_owned());
    let in_doubt = booth.in_doubt.then(|| language.text("terminal.light.in_doubt").to_owned());
    let all = [Some(language.text(light).to_owned()), awaited, named, in_doubt];
    all.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The state of one export folder.
fn state_of(source: &SourceStatus, now: Timestamp, language: Language) -> String {
    let counted = |key, count: usize| language.filled(key, &[("count", &count)]);
    let state = language.word("page.part.folder_state", &source.state);
    let state = match source.state.as_str() {
        "watched" => language.text("terminal.folder.watched").to_owned(),
        "not_looked" => state.to_owned(),
        _ => {
            let time = ago(source.since, now, language);
            let state =
                language.filled("terminal.folder.since", &[("state", &state), ("time", &time)]);
            with_why(state, source.cause.as_ref(), language)
        }
    };
    let last = source.last_look.map(|last| {
        language.filled("terminal.folder.last", &[("time", &ago(last, now, language))])
    });
    let kind = source.file_system.as_ref().map(|kind| match source.polled {
        true => language.filled("terminal.folder.polled", &[("kind", kind)]),
        false => kind.clone(),
    });
    let waiting = match source.overdue {
        0 => counted("terminal.folder.waiting", source.waiting),
        overdue => {
            let words: [(&str, &dyn Display); 2] =
                [("count", &source.waiting), ("overdue", &overdue)];
            language.filled("terminal.folder.overdue", &words)
        }
    };
    let unread = listed(source.unread.iter().map(|(why, count)| (why.as_str(), *count)), language);
    let ignored = (source.ignored > 0).then(|| match unread.as_str() {
        "" => counted("terminal.folder.ignored", source.ignored),
        unread => {
            let words: [(&str, &dyn Display); 2] = [("count", &source.ignored), ("list", &unread)];
            language.filled("terminal.folder.unread", &words)
        }
    });
    let gone = (source.gone > 0).then(|| counted("terminal.folder.gone", source.gone));
    let all = [Some(state), last, kind, Some(waiting), ignored, gone];
    all.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests;
