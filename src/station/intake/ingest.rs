//! Takes in one settled file after it was read: asks whether it is complete, and gives it to custody.

use std::io;
use std::os::unix::ffi::OsStrExt;

use gaiter_flow::export::companions;
use gaiter_flow::facts::IntakeState;
use gaiter_flow::patient::identity::{self, ID_NOT_ALLOWED, PATIENTS_DIFFER};
use gaiter_flow::round::{CaptureMatch, ExportContent, Opener};
use gaiter_flow::{Appeared, ScanId, Settled, StatedPatient, Verdict};
use gaiter_scan::{End, Format};
use jiff::Timestamp;
use tracing::{info, warn};

use super::inspection::{self, InspectFault};
use super::phantom::{self, CheckFault};
use super::stable_read::Export;
use crate::config::WithoutTrigger;
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::custody::quarantine::{self, Reason, Stage};
use crate::station::custody::spool::Companion;
use crate::station::custody::{Arrival, CustodyFault};
use crate::station::event::{StationEvent, short};
use crate::station::journal::JournalError;
use crate::station::measure::Inspection;
use crate::store::sums;

/// Whether a settled file may be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Admitted {
    /// It may be read.
    ToBeRead,
    /// It is too large and has been refused.
    Refused,
    /// Nothing may be taken in now.
    Shut,
}

/// The outcome for a settled file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Taken {
    /// It has been dealt with in this state.
    Done,
    /// Its format shows that more is to come.
    CutShort,
    /// Nothing is missing but the last line end.
    LineEnd,
    /// It changed while it was read.
    Changed,
}

/// Why a file could not be taken now.
#[derive(Debug, thiserror::Error)]
pub enum TakeFault {
    /// The export could not be read.
    #[error("reading the export failed")]
    Source(#[source] io::Error),
    /// The export could not be inspected.
    #[error(transparent)]
    Inspect(#[from] InspectFault),
    /// A scan of the phantom could not be taken.
    #[error("a scan of the known body could not be taken")]
    Phantom(#[from] CheckFault),
    #[error(transparent)]
    Custody(#[from] CustodyFault),
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
}

/// Splits settled files into those that were already dealt with in this state and the others. If the
/// journal cannot answer, a file counts as not dealt with: taking it will meet the same fault and
/// report it. Blocks.
pub fn dealt_with(core: &Core, settled: Vec<Settled>) -> (Vec<Settled>, Vec<Settled>) {
    let journal = core.custody.journal();
    settled.into_iter().partition(|file| {
        !file.has_late_companion
            && journal.was_sighted(&file.path, file.group.stamp).unwrap_or(false)
    })
}

/// Whether a settled file may be read; one that is too large is refused here. Blocks.
///
/// # Errors
/// [`TakeFault`]; the file must then be offered again.
pub fn admitted(core: &Core, settled: &Settled) -> Result<Admitted, TakeFault> {
    if settled.group.stamp.size > core.config.scanner.max_scan_bytes {
        refuse_unread(core, settled)?;
        core.custody.journal().sighted(&settled.path, settled.group.stamp, None)?;
        return Ok(Admitted::Refused);
    }
    let bytes = companions::bytes(&settled.group.stamp, &settled.group.companions);
    if core.intake_gate(bytes) != IntakeState::Open {
        return Ok(Admitted::Shut);
    }
    Ok(Admitted::ToBeRead)
}

/// When contents of exports began, by which the station decides whose they are.
pub struct Beginnings {
    /// That of the file that is taken.
    pub own: Appeared,
    /// Those of others that are seen and not taken.
    pub others: Vec<Appeared>,
}

/// Takes a settled file that has been read. Blocks.
///
/// # Errors
/// [`TakeFault`]; the file must then be offered again.
pub fn take(
    booth: &Booth,
    settled: &Settled,
    beginnings: Beginnings,
    export: &Export,
) -> Result<Taken, TakeFault> {
    let core = booth.core();
    let file = settled.path.file_name().unwrap_or_default();
    let name = file.to_string_lossy();
    // A look only offers files with a known format.
    let Ok(format) = Format::of_file_name(&name) else { return Ok(Taken::Done) };
    let Inspection { end, fingerprint } = match core.custody.known(&export.scan, "")? {
        // Its bytes were inspected when they first came.
        Some(_) => inspection::NOTHING_SHOWN,
        None => inspection::inspected(core, export, format)?,
    };
    let awaits = match end {
        End::Whole => None,
        End::NoLineEnd => Some(Taken::LineEnd),
        End::CutShort => Some(Taken::CutShort),
    };
    if let Some(awaits) = awaits.filter(|_| !settled.awaited) {
        core.observer.notify(StationEvent::AwaitsRest { file: file.to_owned() });
        return Ok(awaits);
    }
    if let Some(phantom) = core.phantom_of(&name) {
        phantom::take(core, phantom, export, format)?;
        sighted(core, settled, None)?;
        return Ok(Taken::Done);
    }
    let companions = fresh(core, settled, export)?;
    let named = core.identity.of_file_name(&name);
    let stated = [named.clone(), beside(core, &companions)];
    let is_cut_short = end == End::CutShort;
    let fingerprint = fingerprint.unwrap_or_default();
    let found = Found { beginnings, settled, format, is_cut_short, fingerprint, companions };
    let (verdict, same_as) = admit(booth, export, found, stated)?;
    if let Verdict::Held(_) = verdict {
        booth.ended(&export.scan, &[]);
    }
    let scan = export.scan.short();
    if export.left_out > 0 {
        warn!(event = "companions-left-out", scan, count = export.left_out);
    }
    if settled.group.is_shared {
        warn!(event = "companion-shared", scan);
    }
    announce(core, settled, export, verdict);
    let named = match &named {
        StatedPatient::Patient(patient) => Some(patient.id.as_str()),
        StatedPatient::Nothing | StatedPatient::NotAnId => None,
    };
    if core.custody.erasures().refuse(&export.scan, named) {
        // Its path may name the person: it is read again at the next start, and known by its hash.
        return Ok(Taken::Done);
    }
    sighted(core, settled, Some(&export.scan))?;
    if let (Verdict::Already, Some(same_as)) = (verdict, &same_as) {
        core.custody.journal().sighted_again(&settled.path, same_as)?;
    }
    Ok(Taken::Done)
}

/// Notes that a file and those that go with it were dealt with in this state. It comes last: if that fails, it is read
/// again and found to be known.
fn sighted(core: &Core, settled: &Settled, scan: Option<&ScanId>) -> Result<(), JournalError> {
    let journal = core.custody.journal();
    for companion in &settled.group.companions {
        journal.sighted(&companion.path, companion.stamp, scan)?;
    }
    journal.sighted(&settled.path, settled.group.stamp, scan)
}

/// The files that lie beside an export and were made for it, without those that an earlier scan under
/// the same stem was taken with and left behind.
fn fresh(core: &Core, settled: &Settled, export: &Export) -> Result<Vec<Companion>, JournalError> {
    let journal = core.custody.journal();
    let mut fresh = Vec::new();
    for file in &export.companions {
        let its = settled.group.companions.iter().find(|its| its.name_ending == file.name_ending);
        let Some(its) = its else { continue };
        let used = journal.sighted_as(&its.path)?;
        let used = used.filter(|(_, scan)| scan.as_ref().is_some_and(|scan| *scan != export.scan));
        if companions::is_fresh(&its.stamp, used.map(|(stamp, _)| stamp).as_ref()) {
            fresh.push(file.clone());
        } else {
            info!(event = "companion-stale", scan = export.scan.short());
        }
    }
    Ok(fresh)
}

/// What is known about an export apart from its bytes.
struct Found<'a> {
    beginnings: Beginnings,
    settled: &'a Settled,
    format: Format,
    /// Its format shows that more was to come.
    is_cut_short: bool,
    /// The fingerprint of what is read in it; '' if nothing is.
    fingerprint: String,
    companions: Vec<Companion>,
}

/// Gives an export to custody, for the capture that it answers. Returns custody's verdict, and the earlier scan
/// of other bytes with the same fingerprint.
fn admit(
    booth: &Booth,
    export: &Export,
    found: Found<'_>,
    stated: [StatedPatient; 2],
) -> Result<(Verdict, Option<ScanId>), TakeFault> {
    let core = booth.core();
    let (custody, scan) = (&core.custody, &export.scan);
    // No press and no other export may come between the judgement and its consequences.
    let mut captures = booth.hold();
    custody.enter_kept(|kept, judged| {
        captures.answer(judged, kept, false, core.now());
        core.work.notify_one();
    })?;
    let known = custody.known(scan, &found.fingerprint)?;
    let same_as = known.clone().filter(|known| known != scan);
    let Settled { path, group, writing, .. } = found.settled;
    let content = ExportContent {
        began: found.beginnings.own,
        others: found.beginnings.others,
        is_known: known.is_some() || custody.is_sibling(path, group.stamp)?,
        is_cut_short: found.is_cut_short,
        completes: match &known {
            Some(_) => None,
            None => custody.completed_by(&export.bytes, writing.read())?,
        },
    };
    if let Some(known) = &known {
        captures.known(known);
    }
    let judged = captures.match_content(&content);
    let hold = core.config.capture.without_trigger == WithoutTrigger::Hold;
    let whose = identity::of_judged(&judged, hold, stated);
    let judged = match whose.held {
        Some(PATIENTS_DIFFER) => judged.contradicted(),
        _ => judged,
    };
    let not_an_id = whose.not_an_id;
    let admitted = custody.admit(&Arrival {
        scan,
        bytes: &export.bytes,
        format: found.format,
        file_time: export.file_time,
        whose,
        pressed_at: pressed_at(core, &judged)?,
        judged: judged.clone(),
        companions: &found.companions,
        geometry: &found.fingerprint,
        known,
    });
    let now = core.now();
    match &admitted {
        Ok(Verdict::New) => captures.answer(&judged, scan, false, now),
        Ok(Verdict::Held(_)) => captures.answer(&judged, scan, true, now),
        Ok(Verdict::Already) => {}
        // Its bytes may be kept already. Then it answers the capture, and no other export may.
        Err(_) if custody.spool().holds(scan) => captures.answer(&judged, scan, true, now),
        Err(_) => {}
    }
    let verdict = admitted?;
    if not_an_id {
        warn!(event = "finding", scan = scan.short(), code = ID_NOT_ALLOWED);
    }
    Ok((verdict, same_as))
}

/// What the scanner's own measures beside a scan state about the patient; two such files state nothing.
fn beside(core: &Core, companions: &[Companion]) -> StatedPatient {
    let mut measures = companions.iter().filter(|file| file.name_ending.ends_with("ord"));
    match (measures.next(), measures.next()) {
        (Some(file), None) => core.identity.of_sidecar(&String::from_utf8_lossy(&file.bytes)),
        _ => StatedPatient::Nothing,
    }
}

/// When the button was pressed for an export that certainly answers that press.
fn pressed_at(core: &Core, judged: &CaptureMatch) -> Result<Option<Timestamp>, JournalError> {
    match judged {
        CaptureMatch::Of(capture) if capture.by == Opener::Press => {
            core.custody.journal().captured_at(capture.number)
        }
        _ => Ok(None),
    }
}

fn announce(core: &Core, settled: &Settled, export: &Export, verdict: Verdict) {
    let scan = short(&export.scan);
    match verdict {
        Verdict::New => {
            info!(event = "scan-spooled", scan, bytes = export.bytes.len());
            let file = settled.path.file_name().unwrap_or_default().to_owned();
            core.observer.notify(StationEvent::Spooled { file, scan });
            core.work.notify_one();
        }
        Verdict::Already => {
            info!(event = "scan-known", scan);
        }
        Verdict::Held(code) => {
            warn!(event = "scan-held", scan, code);
            core.observer.notify(StationEvent::Held { scan });
        }
    }
}

/// Refuses a file because of its size alone. It has no scan id, so its path and state identify it.
fn refuse_unread(core: &Core, settled: &Settled) -> Result<(), CustodyFault> {
    let (size, limit) = (settled.group.stamp.size, core.config.scanner.max_scan_bytes);
    let mut state = settled.path.as_os_str().as_bytes().to_vec();
    state.extend(format!("\0{:?}", settled.group.stamp).bytes());
    let code = "scan-too-large";
    let message = format!("the file has {size} bytes, scanner.max_scan allows {limit}");
    let reason = Reason::new(code, message.clone(), Stage::Intake, Timestamp::now());
    let name = quarantine::unread(sums::scan_id(&state).short());
    core.custody.refuse_unread(&name, &reason)?;
    warn!(event = "scan-refused", scan = name, code, bytes = size);
    core.observer.notify(StationEvent::Refused { code: code.to_owned(), message });
    Ok(())
}
