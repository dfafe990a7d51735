//! What the station answers to each request. Blocks on the journal, so it runs on a blocking thread.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use gaiter_flow::explain::{Asked, FileHistory, of_file};
use gaiter_flow::page::next_shown;
use gaiter_flow::words::age;
use gaiter_flow::{ScanId, account};
use gaiter_language::Language;
use gaiter_record::SourceKind;
use gaiter_record::gdt::OrderFault;
use gaiter_visits::Affected;
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::persons;
use super::protocol::{
    ControlAnswer, ControlFault, ControlFaultKind, DIGITS_LEAST, LIST_MOST, Request,
};
use super::status::{
    AlarmStatus, ComplaintStatus, PhantomStatus, SourceStatus, Status, WorklistStatus,
};
use crate::station::booth::orders;
use crate::station::delivery::preview::Preview;
use crate::station::journal::{JournalError, ScanRow};
use crate::station::operator::act::{self, ActFault};
use crate::station::operator::page::desk::Desk;
use crate::station::overview::Overview;
use crate::station::persons::visits;
use crate::station::runtime::chain;

/// Answers a request.
pub fn answer(desk: &Desk, request: &Request) -> ControlAnswer {
    let (core, booth) = (&desk.core, &desk.booth);
    let answered = match request {
        Request::Status => Ok(ControlAnswer::Status(Box::new(status(desk)))),
        Request::Scans { filter, limit } => {
            let scans = core.custody.journal().list(*filter, (*limit).min(LIST_MOST));
            scans.map(ControlAnswer::Scans).map_err(ControlFault::from)
        }
        Request::Show { scan } => whole(desk, scan).map(Box::new).map(ControlAnswer::Scan),
        Request::ExplainScan { scan } => {
            let (stores, now) = (core.board.facts().stores, Timestamp::now());
            let explained = |whole: account::Whole| {
                account::explain(&whole, &stores, now, core.config.language)
            };
            whole(desk, scan).map(explained).map(ControlAnswer::Sentence)
        }
        Request::ExplainFile { path } => {
            let path = Path::new(OsStr::from_bytes(path));
            let asked = Asked { language: core.config.language, zone: &TimeZone::system() };
            let explained = |known| of_file(&core.board.facts(), path, known, asked);
            known(desk, path).map(explained).map(ControlAnswer::Sentence)
        }
        Request::Retry { scan } => on_scan(desk, scan, |row| act::retry(core, row)),
        Request::Release { scan } => on_scan(desk, scan, |row| act::release(core, booth, row)),
        Request::Assign { scan, patient } => {
            on_scan(desk, scan, |row| act::assign(core, booth, row, patient))
        }
        Request::Unassign { scan, patient } => {
            on_scan(desk, scan, |row| act::unassign(core, row, patient.as_deref()))
        }
        Request::GiveUp { scan } => on_scan(desk, scan, |row| act::give_up(core, booth, row)),
        Request::Amend { scan, patient, setting } => {
            on_scan(desk, scan, |row| act::amend(core, booth, row, patient.as_deref(), setting))
                .inspect(|_| desk.summaries.read_again())
        }
        Request::NameAffected { patient, affected } => affected_leg(affected)
            .and_then(|affected| acted(desk, act::name_affected(core, patient, affected))),
        Request::NameNext { patient, replace } => {
            acted(desk, act::name_next(core, booth, patient, SourceKind::Operator, *replace))
        }
        Request::NameListed { entry, replace } => {
            acted(desk, act::name_listed(core, booth, entry, *replace))
        }
        Request::CallOff => acted(desk, act::call_off(core, booth)),
        Request::Next => Ok(ControlAnswer::Sentence(next(desk))),
        Request::Order { bytes } => ordered(desk, bytes),
        Request::Person { patient } => {
            persons::known(desk, patient).map(|person| ControlAnswer::Person(Box::new(person)))
        }
        Request::Visits { patient } => {
            visits(&core.custody, patient).map(ControlAnswer::Visits).map_err(ControlFault::from)
        }
        Request::Disclosed { patient, by } => persons::disclosed(desk, patient, by),
        Request::Erase { patient, again, by, leaves_owed } => {
            persons::erase(desk, patient, again, by, *leaves_owed)
        }
        Request::Erasure { patient } => {
            let erasures = core.custody.erasures();
            Ok(ControlAnswer::Erasure(erasures.of(&erasures.hash(patient))))
        }
        Request::Pause => acted(desk, act::pause(core, true)),
        Request::Resume => acted(desk, act::pause(core, false)),
        Request::Page => page(desk),
    };
    answered.unwrap_or_else(ControlAnswer::Fault)
}

/// The one scan whose id begins with these digits.
fn named(desk: &Desk, digits: &str) -> Result<ScanId, ControlFault> {
    let hexadecimal = digits.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
    if !hexadecimal || digits.len() < DIGITS_LEAST {
        return Err(desk.fault(ControlFaultKind::Request, "scan-id-malformed", |language| {
            language.filled("act.fault.few_digits", &[("count", &DIGITS_LEAST)])
        }));
    }
    let mut found = desk.core.custody.journal().beginning_with(digits, 2)?;
    match (found.pop(), found.pop()) {
        (Some(scan), None) => Ok(scan),
        (Some(_), Some(_)) => {
            Err(desk.fault(ControlFaultKind::Request, "scan-id-ambiguous", |language| {
                language.filled("act.fault.ambiguous", &[("digits", &digits)])
            }))
        }
        (None, _) => Err(desk.fault(ControlFaultKind::Unknown, "scan-unknown", |language| {
            language.filled("act.fault.no_such", &[("digits", &digits)])
        })),
    }
}

fn whole(desk: &Desk, digits: &str) -> Result<account::Whole, ControlFault> {
    let scan = named(desk, digits)?;
    let journal = desk.core.custody.journal();
    let mut whole = journal.whole(&scan)?.ok_or_else(|| {
        desk.fault(ControlFaultKind::Unknown, "scan-unknown", |language| {
            language.text("act.fault.forgotten").to_owned()
        })
    })?;
    whole.history = journal.history(&scan)?;
    if let Some(Preview::Made(folder)) = desk.previews.get(&scan) {
        whole.preview = Some(folder.display().to_string());
    }
    Ok(whole)
}

/// What the journal knows about a file.
fn known(desk: &Desk, path: &Path) -> Result<Option<FileHistory>, ControlFault> {
    let (journal, language) = (desk.core.custody.journal(), desk.core.config.language);
    let Some(scan) = journal.sighting(path)? else { return Ok(None) };
    let Some(scan) = scan else {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let key = match desk.core.phantom_of(&name) {
            Some(_) => "explain.state.phantom",
            None => "explain.state.too_large",
        };
        let state = language.text(key).to_owned();
        return Ok(Some(FileHistory { state, why: None, at: None, scan: None, again_since: None }));
    };
    let same_as = journal.same_as(path)?;
    let is_again = same_as.is_some();
    let scan = same_as.unwrap_or(scan);
    let Some(whole) = journal.whole(&scan)? else { return Ok(None) };
    let last = journal.history(&scan)?.pop();
    let at = last.and_then(|last| last.at.parse().ok());
    let state = account::in_words(&whole, language);
    let why = whole.held_as().map(|code| account::why_held(code, language));
    let again_since = is_again.then_some(whole.summary.first_seen);
    Ok(Some(FileHistory { state, why, at, scan: Some(scan.short().to_owned()), again_since }))
}

/// The affected leg of a word; `None` for one that takes it back.
fn affected_leg(word: &str) -> Result<Option<Affected>, ControlFault> {
    if word == Affected::NOT_NAMED {
        return Ok(None);
    }
    let affected = Affected::of_word(word).map(Some);
    affected.ok_or_else(|| {
        ControlFault::new(ControlFaultKind::Request, "request-malformed", "this names no leg")
    })
}

/// Who is next, in the page's words; the operator who asks may see the ids.
fn next(desk: &Desk) -> String {
    let language = desk.core.config.language;
    desk.booth.who_is_next(|booth| next_shown(&booth, language).said.text)
}

/// The link to the operator's page, with the token needed to decide there.
fn page(desk: &Desk) -> Result<ControlAnswer, ControlFault> {
    let link = desk.link().ok_or_else(|| {
        let facts = desk.core.board.facts();
        let why = facts.endpoints.values().next();
        desk.fault(ControlFaultKind::Failed, "page-not-served", |language| match why {
            Some(why) => {
                language.filled("act.fault.page_address", &[("why", &why.in_words(language))])
            }
            None => language.text("act.fault.no_page").to_owned(),
        })
    })?;
    Ok(ControlAnswer::Sentence(link))
}

/// Carries out an operator's decision about the one scan whose id begins with these digits.
fn on_scan(
    desk: &Desk,
    digits: &str,
    decide: impl FnOnce(&ScanRow) -> Result<String, ActFault>,
) -> Result<ControlAnswer, ControlFault> {
    let scan = named(desk, digits)?;
    let row = desk.core.custody.journal().scan(&scan).map_err(ActFault::from);
    let row = row.and_then(|row| row.ok_or(ActFault::Unknown));
    acted(desk, row.and_then(|row| decide(&row)))
}

/// The answer to an operator's decision that was carried out or refused.
fn acted(desk: &Desk, acted: Result<String, ActFault>) -> Result<ControlAnswer, ControlFault> {
    if let Err(ActFault::Custody(fault)) = &acted {
        desk.core.check_corruption(fault);
    }
    desk.core.work.notify_one();
    let language = desk.core.config.language;
    acted.map(ControlAnswer::Sentence).map_err(|fault| {
        let kind = match fault {
            ActFault::Unknown => ControlFaultKind::Unknown,
            ActFault::NoOccasion { .. }
            | ActFault::Several(_)
            | ActFault::NotAnId
            | ActFault::AnotherNamed
            | ActFault::EntryGone
            | ActFault::NotSet(_)
            | ActFault::HasPatient => ControlFaultKind::Request,
            ActFault::NoBytes(_)
            | ActFault::NotAmended(_)
            | ActFault::Custody(_)
            | ActFault::Journal(_)
            | ActFault::Store(_) => ControlFaultKind::Failed,
        };
        let on_page = fault.on_page(language);
        let has_own = !matches!(fault, ActFault::Custody(_) | ActFault::Journal(_));
        let local = (language != Language::En && has_own).then(|| fault.in_words(language));
        ControlFault { local, on_page, ..ControlFault::new(kind, fault.code(), chain(&fault)) }
    })
}

/// Applies an order that a client hands in.
fn ordered(desk: &Desk, bytes: &[u8]) -> Result<ControlAnswer, ControlFault> {
    let refused = |fault: OrderFault| {
        desk.fault(ControlFaultKind::Request, fault.code(), |language| {
            language.filled("act.fault.no_order", &[("why", &fault.in_words(language))])
        })
    };
    let order = orders::brought(&desk.booth, bytes).map_err(refused)?;
    let Desk { core, booth, .. } = desk;
    acted(desk, act::name_next(core, booth, &order.patient, SourceKind::Order, true))
}

fn status(desk: &Desk) -> Status {
    let overview = Overview::take(&desk.core);
    let (is_ready, oldest) = (overview.is_ready(), overview.oldest().cloned());
    let Overview { facts, tally, disk, complaints, running, now } = overview;
    let mut scans = std::collections::BTreeMap::new();
    if let Some(tally) = &tally {
        scans.extend(tally.scans.iter().map(|(word, count)| ((*word).to_owned(), *count)));
        let others =
            [("held", tally.held), ("closed", tally.closed), ("withdrawing", tally.withdrawing)];
        scans.extend(others.map(|(word, count)| (word.to_owned(), count)));
    }
    let last = tally.and_then(|tally| tally.last);
    let places = facts.sources.iter().enumerate();
    let stores = facts.stores.iter();
    let triggers = facts.triggers.iter();
    let alarms = facts.alarms.iter();
    let due = facts.is_phantom_due(now);
    Status {
        schema: "gaiter.status/1".to_owned(),
        ready: is_ready,
        complaints: complaints.into_iter().map(ComplaintStatus::from).collect(),
        station: desk.core.config.station.id.clone(),
        gaiter: env!("CARGO_PKG_VERSION").to_owned(),
        pid: std::process::id(),
        started: facts.started,
        running_s: running.as_secs(),
        now,
        intake: facts.intake.word().to_owned(),
        oldest_age_s: oldest.as_ref().and_then(|seen| Some(age(seen.first_seen, now)?.as_secs())),
        oldest,
        last,
        scans,
        sources: places.map(|(place, source)| SourceStatus::from_facts(place, source)).collect(),
        stores: stores.map(|(name, store)| ((*name).to_owned(), store.into())).collect(),
        triggers: triggers.map(|(name, port)| ((*name).to_owned(), port.into())).collect(),
        booth: desk.booth.state().into(),
        disk_free_bytes: disk.map(|disk| disk.free),
        disk_bytes: disk.map(|disk| disk.size),
        confinement: facts.confinement,
        measured: facts.measured,
        last_measurement_s: facts.last_measurement_s,
        worklist: facts.worklist.as_ref().map(WorklistStatus::from),
        phantom: facts.phantom.map(|phantom| PhantomStatus { due, checks: phantom.checks }),
        views: facts.views,
        alarms: alarms
            .map(|(code, alarm)| ((*code).to_owned(), AlarmStatus::from_alarm(code, alarm)))
            .collect(),
        refused_reload: facts.refused_reload,
    }
}

impl Desk {
    /// A fault with a message that is made for English and for the station's language.
    pub(super) fn fault(
        &self,
        kind: ControlFaultKind,
        code: &str,
        message: impl Fn(Language) -> String,
    ) -> ControlFault {
        let language = self.core.config.language;
        let local = (language != Language::En).then(|| message(language));
        ControlFault { local, ..ControlFault::new(kind, code, message(Language::En)) }
    }
}

impl From<JournalError> for ControlFault {
    fn from(error: JournalError) -> ControlFault {
        ControlFault::new(ControlFaultKind::Failed, "journal-failed", chain(&error))
    }
}
