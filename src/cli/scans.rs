//! `gaiter scans`, `gaiter show` and `gaiter explain`: what the station knows about its scans.

use std::fmt::Write;
use std::os::unix::ffi::OsStringExt;

use gaiter_flow::ScanState;
use gaiter_flow::account::{Happened, Listed, Whole};
use gaiter_flow::words::bytes;
use gaiter_language::Language;

use super::args::{ExplainArgs, Named, OneArgs, ScansArgs};
use super::terminal::clock::local;
use super::{Exit, ask, complain, shown};
use crate::station::operator::control::protocol::{Answer, Request};

/// Lists scans.
pub fn scans(args: &ScansArgs) -> Exit {
    let request = Request::Scans { filter: args.state, limit: args.limit };
    let taken = |answer| match answer {
        Answer::Scans(scans) => Some(scans),
        _ => None,
    };
    ask::told(&args.ask, &request, taken, |scans| list(scans), |_| Exit::Done)
}

/// One row per scan, newest first.
pub fn list(scans: &[Listed]) -> String {
    if scans.is_empty() {
        return "No scan to show.\n".to_owned();
    }
    let mut text = format!(
        "{:8}  {:19}  {:11}  {:6}  {:>8}  {}\n",
        "scan", "first seen", "state", "format", "size", "why"
    );
    for scan in scans {
        let mut why = scan.code.clone().unwrap_or_default();
        if let Some(closed) = scan.closed {
            why = format!("{} {why}", closed.word());
        }
        if scan.attempts > 0 && scan.state == ScanState::Spooled {
            why = format!("{} attempts {why}", scan.attempts);
        }
        let line = format!(
            "{:8}  {:19}  {:11}  {:6}  {:>8}  {}",
            scan.scan,
            local(scan.first_seen),
            scan.disposition.word(),
            scan.format,
            bytes(scan.size, Language::En),
            shown(why.trim())
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Shows one scan, with the patient's id.
pub fn show(args: &OneArgs) -> Exit {
    let request = Request::Show { scan: args.scan.clone() };
    let taken = |answer| match answer {
        Answer::Scan(whole) => Some(*whole),
        _ => None,
    };
    ask::told(&args.ask, &request, taken, detail, |_| Exit::Done)
}

fn detail(whole: &Whole) -> String {
    let summary = &whole.summary;
    let mut rows = vec![
        ("scan", whole.scan.clone()),
        ("state", whole.disposition().word().to_owned()),
        ("first seen", local(summary.first_seen)),
        ("file's time", summary.file_time.map_or("unknown".to_owned(), local)),
        ("format", format!("{}, {}", summary.format, bytes(summary.size, Language::En))),
    ];
    if let Some(code) = &summary.code {
        let message = summary.message.as_deref().unwrap_or_default();
        rows.push(("refused", format!("[{code}] {message}")));
    }
    rows.extend(summary.closed.map(|why| ("closed", why.word().to_owned())));
    rows.extend(whole.candidates.iter().map(|id| ("candidate", id.clone())));
    rows.extend(whole.preview.clone().map(|folder| ("preview", folder)));
    for delivery in &whole.deliveries {
        rows.push(("", String::new()));
        rows.push(("patient", delivery.patient.clone().unwrap_or_else(|| "none is named".into())));
        let code = delivery.code.as_ref().map_or(String::new(), |code| format!(" [{code}]"));
        let to_go = if delivery.is_to_go() { ", to be withdrawn" } else { "" };
        rows.push(("store", format!("{}: {}{code}{to_go}", delivery.store, delivery.state.word())));
        if delivery.attempts > 0 {
            let next = delivery.next_at.map(|at| format!(", next {}", local(at)));
            rows.push(("attempts", format!("{}{}", delivery.attempts, next.unwrap_or_default())));
        }
        rows.extend(delivery.folder.clone().map(|folder| ("record", folder)));
    }
    rows.push(("", String::new()));
    rows.extend(whole.history.iter().map(|row| {
        let Happened { at, event, detail } = row;
        let at = at.parse().map_or_else(|_| at.clone(), local);
        ("history", format!("{at}  {event}  {detail}"))
    }));
    let lines = rows.into_iter().map(|(label, value)| {
        let line = format!("{label:<11}  {}", shown(value));
        format!("{}\n", line.trim_end())
    });
    lines.collect()
}

/// Explains why a file or scan is where it is.
pub fn explain(args: &ExplainArgs) -> Exit {
    let request = match Named::of(&args.what) {
        Named::Scan(scan) => Request::ExplainScan { scan },
        Named::File(path) => match std::path::absolute(&path) {
            Ok(path) => Request::ExplainFile { path: path.into_os_string().into_vec() },
            Err(error) => {
                complain(format_args!("gaiter: {}: {error}", shown(path.display())));
                return Exit::Usage;
            }
        },
    };
    ask::sentence(&args.ask, &request)
}
