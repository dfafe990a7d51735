//! `gaiter scans`, `gaiter show` and `gaiter explain`: what the station knows about its scans.

use std::os::unix::ffi::OsStringExt;

use gaiter_flow::account::{Delivered, Happened, Listed, Whole, why_refused};
use gaiter_flow::patient::erasure::ERASED;
use gaiter_flow::words::bytes;
use gaiter_flow::{Closed, ScanState};
use gaiter_language::Language;
use serde_json::Value;

use super::args::{ExplainArgs, Named, OneArgs, ScansArgs};
use super::terminal::local;
use super::terminal::screen::width;
use super::{Exit, ask, complain, terminal_safe};
use crate::station::operator::control::protocol::{ControlAnswer, Request};

/// The labels of the columns of a list.
const LIST_LABELS: [&str; 6] = [
    "terminal.label.scan",
    "terminal.label.first_seen",
    "terminal.label.state",
    "terminal.label.format",
    "terminal.label.size",
    "terminal.label.why",
];

/// The least width of the column of states.
const STATE_LEAST: usize = 11;

/// The least width of the labels of one scan.
const LABEL_LEAST: usize = 11;

/// An empty line between the rows of one scan.
const NO_ROW: (&str, String) = ("", String::new());

/// Lists scans.
pub fn scans(args: &ScansArgs) -> Exit {
    let request = Request::Scans { filter: args.state, limit: args.limit };
    let taken = |answer| match answer {
        ControlAnswer::Scans(scans) => Some(scans),
        _ => None,
    };
    let table = |scans: &Vec<Listed>, language| list(scans, language);
    ask::answered(&args.ask, &request, taken, table, |_| Exit::Done)
}

/// One row per scan, newest first.
pub fn list(scans: &[Listed], language: Language) -> String {
    if scans.is_empty() {
        return format!("{}\n", language.text("terminal.no_scan"));
    }
    let labels = LIST_LABELS.map(|key| language.text(key));
    let states = scans.iter().map(|scan| language.word("terminal.state", scan.disposition.word()));
    let state = width(states.chain([labels[2]]), STATE_LEAST);
    let row = |[scan, seen, is, format, size, why]: [&str; 6]| {
        let line = format!("{scan:8}  {seen:19}  {is:state$}  {format:6}  {size:>8}  {why}");
        format!("{}\n", line.trim_end())
    };
    let rows = scans.iter().map(|scan| {
        let (seen, size) = (local(scan.first_seen), bytes(scan.size, language));
        let state = language.word("terminal.state", scan.disposition.word());
        row([&scan.scan, &seen, state, &scan.format, &size, &terminal_safe(why(scan, language))])
    });
    [row(labels)].into_iter().chain(rows).collect()
}

/// Why a scan is not delivered, as codes.
fn why(scan: &Listed, language: Language) -> String {
    let waits = scan.attempts > 0 && scan.state == ScanState::Spooled;
    let attempts =
        waits.then(|| language.filled("terminal.attempts", &[("count", &scan.attempts)]));
    let closed = scan.closed.map(|closed| closed.word().to_owned());
    let all = attempts.into_iter().chain(closed).chain(scan.code.clone());
    all.collect::<Vec<_>>().join(" ")
}

/// Shows one scan, with the patient's id.
pub fn show(args: &OneArgs) -> Exit {
    let request = Request::Show { scan: args.scan.clone() };
    let taken = |answer| match answer {
        ControlAnswer::Scan(whole) => Some(*whole),
        _ => None,
    };
    ask::answered(&args.ask, &request, taken, detail, |_| Exit::Done)
}

fn detail(whole: &Whole, language: Language) -> String {
    let summary = &whole.summary;
    let text = |key| language.text(key).to_owned();
    let state = language.word("terminal.state", whole.disposition().word()).to_owned();
    let file_time = summary.file_time.map_or_else(|| text("terminal.unknown"), local);
    let format = format!("{}, {}", summary.format, bytes(summary.size, language));
    let mut rows = vec![
        ("terminal.label.scan", whole.scan.clone()),
        ("terminal.label.state", state),
        ("terminal.label.first_seen", local(summary.first_seen)),
        ("terminal.label.file_time", file_time),
        ("terminal.label.format", format),
    ];
    if let Some(code) = &summary.code {
        let why = why_refused(summary, language).unwrap_or_default();
        rows.push(("terminal.label.refused", format!("[{code}] {why}")));
    }
    let closed = |why: Closed| language.word("page.scan.closed", why.word()).to_owned();
    rows.extend(summary.closed.map(|why| ("terminal.label.closed", closed(why))));
    let candidate = |id: &String| if id == ERASED { text("terminal.erased") } else { id.clone() };
    rows.extend(whole.candidates.iter().map(|id| ("terminal.label.candidate", candidate(id))));
    rows.extend(whole.preview.clone().map(|folder| ("terminal.label.preview", folder)));
    rows.extend(whole.deliveries.iter().flat_map(|of| of_delivery(of, language)));
    rows.push(NO_ROW);
    let history = whole.history.iter();
    rows.extend(history.map(|row| ("terminal.label.history", happened(row, language))));
    let label = |key: &'static str| if key.is_empty() { "" } else { language.text(key) };
    let width = width(rows.iter().map(|(key, _)| label(key)), LABEL_LEAST);
    let lines = rows.iter().map(|(key, value)| {
        let line = format!("{:<width$}  {}", label(key), terminal_safe(value));
        format!("{}\n", line.trim_end())
    });
    lines.collect()
}

/// The rows of a delivery: keys of labels, and values.
fn of_delivery(of: &Delivered, language: Language) -> Vec<(&'static str, String)> {
    let nobody = || language.text("terminal.nobody").to_owned();
    let code = of.code.as_ref().map_or(String::new(), |code| format!(" [{code}]"));
    let to_go = if of.is_to_go() { language.text("terminal.to_go") } else { "" };
    let state = language.word("terminal.state", of.state.word());
    let mut rows = vec![
        NO_ROW,
        ("terminal.label.patient", of.patient.clone().unwrap_or_else(nobody)),
        ("terminal.label.store", format!("{}: {state}{code}{to_go}", of.store)),
    ];
    if of.attempts > 0 {
        let next = of.next_at.map(|at| language.filled("terminal.next", &[("at", &local(at))]));
        let attempts = format!("{}{}", of.attempts, next.unwrap_or_default());
        rows.push(("terminal.label.attempts", attempts));
    }
    rows.extend(of.folder.clone().map(|folder| ("terminal.label.record", folder)));
    rows
}

/// One row of a scan's history: when, what, and the details as `name: value`.
fn happened(row: &Happened, language: Language) -> String {
    let at = row.at.parse().map_or_else(|_| row.at.clone(), local);
    let what = language.word("terminal.event", &row.event);
    let detail = match serde_json::from_str(&row.detail) {
        Ok(Value::Object(detail)) => {
            let pairs = detail.iter().map(|(name, value)| format!("{name}: {}", plain(value)));
            pairs.collect::<Vec<_>>().join(", ")
        }
        _ => row.detail.clone(),
    };
    format!("{at}  {what}  {detail}")
}

/// A value without the signs of JSON, as far as it can be read without them.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(all) => all.iter().map(plain).collect::<Vec<_>>().join(" "),
        Value::Null => "–".to_owned(),
        other => other.to_string(),
    }
}

/// Explains why a file or scan is where it is.
pub fn explain(args: &ExplainArgs) -> Exit {
    let request = match Named::from_arg(&args.what) {
        Named::Scan(scan) => Request::ExplainScan { scan },
        Named::File(path) => match std::path::absolute(&path) {
            Ok(path) => Request::ExplainFile { path: path.into_os_string().into_vec() },
            Err(error) => {
                complain(format_args!("gaiter: {}: {error}", terminal_safe(path.display())));
                return Exit::Usage;
            }
        },
    };
    ask::sentence(&args.ask, &request)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_details_of_the_history_are_told_as_names_and_values() {
        let row = |event: &str, detail: &str| Happened {
            at: "then".to_owned(),
            event: event.to_owned(),
            detail: detail.to_owned(),
        };
        let detail = r#"{"patients":["4711","0815"],"by":"operator","decision":3,"code":null}"#;
        let assigned = row("given-up", detail);
        let said = Language::ALL.map(|language| happened(&assigned, language));
        assert!(said[0].starts_with("then  given up  "), "{said:?}");
        assert!(said[1].starts_with("then  aufgegeben  "), "{said:?}");
        for pair in ["patients: 4711 0815", "by: operator", "decision: 3", "code: –"] {
            assert!(said.iter().all(|said| said.contains(pair)), "{said:?}");
        }
        assert_eq!(happened(&row("new", "{}"), Language::De), "then  new  ");
        assert_eq!(happened(&row("new", "no JSON"), Language::De), "then  new  no JSON");
    }
}
