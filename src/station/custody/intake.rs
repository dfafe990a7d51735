//! What is known about a scan when it comes in, as the spool and the journal store it.

use gaiter_flow::patient::identity::{
    ID_NOT_ALLOWED, NO_PRESS, PATIENTS_DIFFER, SAME_SCAN_OTHER_PATIENT,
};
use gaiter_flow::round::{CaptureMatch, Why};
use gaiter_flow::{ScanId, ScanState};
use gaiter_record::Patient;
use jiff::Timestamp;

use super::Arrival;
use crate::station::custody::spool::Intake;
use crate::station::journal::ScanRow;

/// The intake data of bytes that came in. The time of first sight never changes.
pub(super) fn intake(arrival: &Arrival<'_>, known: Option<&ScanRow>, held: Option<&str>) -> Intake {
    let now = Timestamp::now();
    let now = Timestamp::from_second(now.as_second()).unwrap_or(now);
    let not_an_id = arrival.whose.not_an_id.then_some(ID_NOT_ALLOWED);
    let findings = held.into_iter().chain(not_an_id).map(str::to_owned).collect();
    Intake {
        sha256: arrival.scan.to_string(),
        format: arrival.format.ending().to_owned(),
        size: u64::try_from(arrival.bytes.len()).unwrap_or(u64::MAX),
        first_seen: known.map_or(now, |row| row.first_seen),
        file_time: known.map_or(arrival.file_time, |row| row.file_time),
        pressed_at: known.map_or(arrival.pressed_at, |row| row.pressed_at),
        patient: arrival.whose.patient.clone(),
        held: held.is_some(),
        findings,
        geometry: arrival.geometry.to_owned(),
        judged: arrival.judged.clone(),
        candidates: candidates(arrival, held),
    }
}

/// The ids of the patients a held scan may belong to, each once, without those who already have it.
fn candidates(arrival: &Arrival<'_>, held: Option<&str>) -> Vec<String> {
    if held.is_none() {
        return Vec::new();
    }
    let judged = match &arrival.judged {
        CaptureMatch::Held { candidates, .. } => candidates.as_slice(),
        CaptureMatch::Of(_) | CaptureMatch::Unpressed | CaptureMatch::Known => &[],
    };
    let judged = judged.iter().map(|named| &named.id);
    let whose = &arrival.whose;
    let stated = whose.claims.iter().chain(&whose.patient).map(|patient| &patient.id);
    let mut candidates: Vec<String> = Vec::new();
    for id in judged.chain(stated) {
        if !candidates.contains(id) {
            candidates.push(id.clone());
        }
    }
    candidates
}

/// Why a scan in the spool is held.
pub(super) fn held_code(intake: &Intake) -> Option<&'static str> {
    let mut codes = Why::ALL.map(Why::word).into_iter().chain([NO_PRESS, PATIENTS_DIFFER]);
    let found = codes.find(|code| intake.findings.iter().any(|found| found == code));
    intake.held.then_some(found.unwrap_or(SAME_SCAN_OTHER_PATIENT))
}

/// The intake data of a scan whose bytes return to the spool.
pub(super) fn intake_of(row: &ScanRow, patient: Option<&Patient>) -> Intake {
    Intake {
        sha256: row.scan.to_string(),
        format: row.format.clone(),
        size: row.size,
        first_seen: row.first_seen,
        file_time: row.file_time,
        pressed_at: row.pressed_at,
        patient: patient.cloned(),
        held: false,
        findings: Vec::new(),
        geometry: String::new(),
        judged: CaptureMatch::Unpressed,
        candidates: Vec::new(),
    }
}

/// The journal row of an intake. A held scan has nothing to deliver without a decision.
pub(super) fn row(intake: &Intake, scan: &ScanId) -> ScanRow {
    ScanRow {
        scan: scan.clone(),
        format: intake.format.clone(),
        size: intake.size,
        first_seen: intake.first_seen,
        file_time: intake.file_time,
        pressed_at: intake.pressed_at,
        state: if intake.held { ScanState::Delivered } else { ScanState::Spooled },
    }
}
