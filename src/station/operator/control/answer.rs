//! What the station answers to each request. Blocks on the journal, so it runs on a blocking thread.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use jiff::Timestamp;

use super::protocol::{
    Answer, DIGITS_LEAST, Fault, FaultKind, LIST_MOST, Request, SourceStatus, Status,
};
use crate::flow::explain::{Known, of_file};
use crate::flow::facts::IntakeState;
use crate::flow::health::age;
use crate::flow::page::next_shown;
use crate::flow::{ScanId, account};
use crate::record::gdt::OrderFault;
use crate::record::{Language, SourceKind};
use crate::station::assembly::Station;
use crate::station::booth::orders;
use crate::station::delivery::preview::Preview;
use crate::station::error::chain;
use crate::station::journal::{HistoryRow, JournalError};
use crate::station::operator::act::{Act, ActFault, act};
use crate::station::operator::overview::Overview;

/// Answers a request.
pub fn answer(station: &Station, request: &Request) -> Answer {
    let answered = match request {
        Request::Status => Ok(Answer::Status(Box::new(status(station)))),
        Request::Scans { filter, limit } => {
            let scans = station.custody.journal().list(*filter, (*limit).min(LIST_MOST));
            scans.map(Answer::Scans).map_err(Fault::from)
        }
        Request::Show { scan } => whole(station, scan).map(Box::new).map(Answer::Scan),
        Request::ExplainScan { scan } => {
            let whole = whole(station, scan);
            whole.map(|whole| {
                Answer::Sentence(account::explain(
                    &whole,
                    &station.board.facts().stores,
                    Timestamp::now(),
                ))
            })
        }
        Request::ExplainFile { path } => {
            let path = Path::new(OsStr::from_bytes(path));
            let known = known(station, path);
            known.map(|known| Answer::Sentence(of_file(&station.board.facts(), path, known)))
        }
        Request::Retry { scan } => acted(station, Some(scan), &Act::Retry),
        Request::Release { scan } => acted(station, Some(scan), &Act::Release),
        Request::Assign { scan, patient } => {
            acted(station, Some(scan), &Act::Assign(patient.clone()))
        }
        Request::Unassign { scan } => acted(station, Some(scan), &Act::Unassign),
        Request::GiveUp { scan } => acted(station, Some(scan), &Act::GiveUp),
        Request::NameNext { patient, replace } => {
            let (id, by) = (patient.clone(), SourceKind::Operator);
            acted(station, None, &Act::NameNext { id, by, replaces: *replace })
        }
        Request::CallOff => acted(station, None, &Act::CallOff),
        Request::Next => Ok(Answer::Sentence(next(station))),
        Request::Order { bytes } => ordered(station, bytes),
        Request::Pause => acted(station, None, &Act::Pause),
        Request::Resume => acted(station, None, &Act::Resume),
        Request::Page => page(station),
    };
    answered.unwrap_or_else(Answer::Fault)
}

/// The one scan whose id begins with these digits.
fn named(station: &Station, digits: &str) -> Result<ScanId, Fault> {
    let hexadecimal = digits.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
    if !hexadecimal || digits.len() < DIGITS_LEAST {
        let message =
            format!("a scan is named by the first {DIGITS_LEAST} or more digits of its id");
        return Err(Fault::new(FaultKind::Request, "scan-id-malformed", message));
    }
    let mut found = station.custody.journal().beginning_with(digits, 2)?;
    match (found.pop(), found.pop()) {
        (Some(scan), None) => Ok(scan),
        (Some(_), Some(_)) => {
            let message = format!("more than one scan's id begins with {digits}: give more digits");
            Err(Fault::new(FaultKind::Request, "scan-id-ambiguous", message))
        }
        (None, _) => {
            let message = format!("the station knows no scan whose id begins with {digits}");
            Err(Fault::new(FaultKind::Unknown, "scan-unknown", message))
        }
    }
}

fn whole(station: &Station, digits: &str) -> Result<account::Whole, Fault> {
    let scan = named(station, digits)?;
    let journal = station.custody.journal();
    let mut whole = journal.whole(&scan)?.ok_or_else(|| {
        Fault::new(FaultKind::Unknown, "scan-unknown", "the scan has just been forgotten")
    })?;
    let rows = journal.history(&scan)?.into_iter();
    let happened = |HistoryRow { at, event, detail }| account::Happened { at, event, detail };
    if let Some(Preview::Made(folder)) = station.previews.get(&scan) {
        whole.preview = Some(folder.display().to_string());
    }
    whole.history = rows.map(happened).collect();
    Ok(whole)
}

/// What the journal says of a file.
fn known(station: &Station, path: &Path) -> Result<Option<Known>, Fault> {
    let journal = station.custody.journal();
    let Some(scan) = journal.sighting(path)? else { return Ok(None) };
    let Some(scan) = scan else {
        let state = "was refused unread, for its size".to_owned();
        return Ok(Some(Known { state, at: None, scan: None }));
    };
    let Some(whole) = journal.whole(&scan)? else { return Ok(None) };
    let held = journal.held_for(&scan)?;
    let last = journal.history(&scan)?.pop();
    let at = last.and_then(|last| last.at.parse().ok());
    let state = account::in_words(&whole.summary, held.as_deref());
    Ok(Some(Known { state, at, scan: Some(scan.short().to_owned()) }))
}

/// Who is next, as the page says it; the ids are for the person who asks.
fn next(station: &Station) -> String {
    next_shown(&station.who_is_next().situation(), Language::En).sentence
}

/// The link to the operator's page, with what it takes to decide there.
fn page(station: &Station) -> Result<Answer, Fault> {
    let link = station.page.link().ok_or_else(|| {
        let message = "no page is served: set status.listen, or enable gaiter.socket";
        Fault::new(FaultKind::Failed, "page-not-served", message)
    })?;
    Ok(Answer::Sentence(link))
}

/// Carries out what a person decided.
fn acted(station: &Station, digits: Option<&str>, decided: &Act) -> Result<Answer, Fault> {
    let scan = digits.map(|digits| named(station, digits)).transpose()?;
    Ok(Answer::Sentence(act(station, scan.as_ref(), decided)?))
}

/// Hears an order that somebody brings.
fn ordered(station: &Station, bytes: &[u8]) -> Result<Answer, Fault> {
    let refused = |fault: OrderFault| {
        Fault::new(FaultKind::Request, fault.code(), format!("this is no order: {fault}"))
    };
    let order = orders::brought(station, bytes).map_err(refused)?;
    let (id, by) = (order.patient, SourceKind::Order);
    acted(station, None, &Act::NameNext { id, by, replaces: true })
}

fn status(station: &Station) -> Status {
    let Overview { facts, tally, disk, complaints, running, now } = Overview::take(station);
    let intake = match facts.intake {
        IntakeState::Open => "open",
        IntakeState::Paused => "paused",
        IntakeState::DiskLow { .. } => "disk_low",
    };
    let mut scans = std::collections::BTreeMap::new();
    if let Some(tally) = &tally {
        scans.extend(tally.scans.iter().map(|(word, count)| ((*word).to_owned(), *count)));
        let others =
            [("held", tally.held), ("closed", tally.closed), ("withdrawing", tally.withdrawing)];
        scans.extend(others.map(|(word, count)| (word.to_owned(), count)));
    }
    let (oldest, last) = tally.map_or((None, None), |tally| (tally.oldest, tally.last));
    let places = facts.sources.iter().enumerate();
    let stores = facts.stores.iter();
    let triggers = facts.triggers.iter();
    let alarms = facts.alarms.iter();
    Status {
        schema: "gaiter.status/1".to_owned(),
        ready: complaints.is_empty(),
        complaints,
        station: station.config.station.id.clone(),
        gaiter: env!("CARGO_PKG_VERSION").to_owned(),
        pid: std::process::id(),
        started: facts.started,
        running_s: running.as_secs(),
        now,
        intake: intake.to_owned(),
        oldest_age_s: oldest.as_ref().and_then(|seen| Some(age(seen.first_seen, now)?.as_secs())),
        oldest,
        last,
        scans,
        sources: places.map(|(place, source)| SourceStatus::of(place, source)).collect(),
        stores: stores.map(|(name, store)| ((*name).to_owned(), store.into())).collect(),
        triggers: triggers.map(|(name, port)| ((*name).to_owned(), port.into())).collect(),
        booth: station.booth.state(station.now()).into(),
        disk_free_bytes: disk.map(|disk| disk.free),
        disk_bytes: disk.map(|disk| disk.size),
        confinement: facts.confinement,
        measured: facts.measured,
        last_measurement_s: facts.last_measurement_s,
        alarms: alarms.map(|(code, alarm)| ((*code).to_owned(), alarm.into())).collect(),
        refused_reload: facts.refused_reload,
    }
}

impl From<JournalError> for Fault {
    fn from(error: JournalError) -> Fault {
        Fault::new(FaultKind::Failed, "journal-failed", chain(&error))
    }
}

impl From<ActFault> for Fault {
    fn from(fault: ActFault) -> Fault {
        let kind = match fault {
            ActFault::Unknown => FaultKind::Unknown,
            ActFault::NoScan
            | ActFault::NoOccasion(_)
            | ActFault::Several
            | ActFault::NotAnId
            | ActFault::AnotherNamed
            | ActFault::Somebodys => FaultKind::Request,
            ActFault::NoBytes
            | ActFault::Custody(_)
            | ActFault::Journal(_)
            | ActFault::Store(_) => FaultKind::Failed,
        };
        Fault::new(kind, fault.code(), chain(&fault))
    }
}
