//! Taking one settled file: read it whole, ask its format whether it is whole, give it to custody.

use std::io;
use std::os::unix::ffi::OsStrExt;

use jiff::Timestamp;
use tracing::{info, warn};

use super::assembly::Station;
use super::caught::caught;
use super::custody::{Arrival, CustodyFault};
use super::event::{StationEvent, short};
use super::journal::JournalError;
use super::quarantine::{Reason, Stage};
use super::source::{self, Export};
use crate::flow::identity::{ID_NOT_ALLOWED, SAME_SCAN_OTHER_PATIENT};
use crate::flow::{NameSays, Settled, Verdict};
use crate::scan::{self, Format};
use crate::store::sums;

/// What became of a settled file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Taken {
    /// It has been dealt with in this state.
    Done,
    /// Its format shows that more is to come.
    CutShort,
    /// It changed while it was read.
    Changed,
}

/// Why a file could not be taken now.
#[derive(Debug, thiserror::Error)]
pub enum TakeFault {
    /// The export could not be read.
    #[error("reading the export failed")]
    Source(#[source] io::Error),
    /// Custody failed.
    #[error(transparent)]
    Custody(#[from] CustodyFault),
    /// The journal failed.
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
}

/// Takes a settled file. Blocks.
///
/// # Errors
/// [`TakeFault`], after which the file is to be offered again.
pub fn take(station: &Station, settled: &Settled) -> Result<Taken, TakeFault> {
    let journal = station.custody.journal();
    if journal.was_sighted(&settled.path, settled.stamp)? {
        return Ok(Taken::Done);
    }
    let file = settled.path.file_name().unwrap_or_default();
    station.observer.tell(StationEvent::Settled { file: file.to_owned() });
    if settled.stamp.size > station.config.scanner.max_scan_bytes {
        refuse_unread(station, settled)?;
        journal.sighted(&settled.path, settled.stamp, None)?;
        return Ok(Taken::Done);
    }
    let Some(export) = source::read(&settled.path, settled.stamp).map_err(TakeFault::Source)?
    else {
        return Ok(Taken::Changed);
    };
    let name = file.to_string_lossy();
    // A look offers no other files.
    let Ok(format) = Format::of_file_name(&name) else { return Ok(Taken::Done) };
    if !settled.awaited && awaits_rest(&export, format) {
        station.observer.tell(StationEvent::AwaitsRest { file: file.to_owned() });
        return Ok(Taken::CutShort);
    }
    let says = station.identity.of_file_name(&name);
    let not_an_id = says == NameSays::NotAnId;
    let verdict = station.custody.admit(&Arrival {
        scan: &export.scan,
        bytes: &export.bytes,
        format,
        file_time: export.file_time,
        says,
    })?;
    journal.sighted(&settled.path, settled.stamp, Some(&export.scan))?;
    if not_an_id {
        warn!(event = "finding", scan = export.scan.short(), code = ID_NOT_ALLOWED);
    }
    announce(station, settled, &export, verdict);
    Ok(Taken::Done)
}

/// Whether the format shows that more is to come. A reader that panics shows nothing: the scan
/// goes on and is refused where it is measured.
fn awaits_rest(export: &Export, format: Format) -> bool {
    caught(|| scan::completeness(&export.bytes, format))
        .is_ok_and(|complete| complete.is_err_and(|fault| fault.may_be_mended_by_waiting()))
}

fn announce(station: &Station, settled: &Settled, export: &Export, verdict: Verdict) {
    let file = settled.path.file_name().unwrap_or_default().to_owned();
    let scan = short(&export.scan);
    match verdict {
        Verdict::New => {
            info!(event = "scan-spooled", scan, bytes = export.bytes.len());
            station.observer.tell(StationEvent::Spooled { file, scan });
            station.work.notify_one();
        }
        Verdict::Already => {
            info!(event = "scan-known", scan);
            station.observer.tell(StationEvent::Known { file, scan });
        }
        Verdict::Held => {
            warn!(event = "scan-held", scan, code = SAME_SCAN_OTHER_PATIENT);
            station.observer.tell(StationEvent::Held { scan });
        }
    }
}

/// Refuses a file for its size alone. It has no scan id; its name and state stand for it.
fn refuse_unread(station: &Station, settled: &Settled) -> Result<(), CustodyFault> {
    let (size, limit) = (settled.stamp.size, station.config.scanner.max_scan_bytes);
    let mut state = settled.path.as_os_str().as_bytes().to_vec();
    state.extend(format!("\0{:?}", settled.stamp).bytes());
    let name = format!("unread-{}", sums::scan_id(&state).short());
    let code = "scan-too-large";
    let message = format!("the file has {size} bytes, scanner.max_scan_bytes allows {limit}");
    let reason = Reason::new(code, message.clone(), Stage::Intake, Timestamp::now());
    station.custody.refuse_unread(&name, &reason)?;
    warn!(event = "scan-refused", scan = name, code, bytes = size);
    station.observer.tell(StationEvent::Refused { scan: None, code: code.to_owned(), message });
    Ok(())
}
