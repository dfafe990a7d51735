//! Scans in the journal, and the patients named for them.

use std::ops::Range;

use gaiter_flow::round::CaptureMatch;
use gaiter_flow::{DeliveryState, DeliveryStep, ScanId, ScanState, ScanStep};
use gaiter_record::Patient;
use jiff::Timestamp;
use rusqlite::{Transaction, params};
use serde_json::json;

use super::integrity::seal;
use super::row::{
    all, cell, count, first, if_any, json_text, patient_id, run, scan_id, time, value,
};
use super::{Event, Journal, JournalError, captures, history};

/// What the journal knows of a scan itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScanRow {
    pub scan: ScanId,
    /// The file-name ending of its format.
    pub format: String,
    /// Size, bytes.
    pub size: u64,
    /// When the station first saw it; never changes.
    pub first_seen: Timestamp,
    /// Its file's own time.
    pub file_time: Option<Timestamp>,
    /// When the button was pressed for it; `None` if it answered no press.
    pub pressed_at: Option<Timestamp>,
    pub state: ScanState,
}

/// A scan that comes in.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'a> {
    pub row: &'a ScanRow,
    /// Its patient; `None` if no patient was named.
    pub patient: Option<&'a Patient>,
    /// Why an operator must decide; `None` if its records are to be made.
    pub held: Option<&'static str>,
    /// The patient of each source, if they differ.
    pub claims: &'a [Patient],
    /// The captures that it answers.
    pub judged: &'a CaptureMatch,
    /// The fingerprint of what was read in it; '' if nothing was.
    pub geometry: &'a str,
    /// The ids of all patients it may belong to, if an operator must decide.
    pub candidates: &'a [String],
}

impl Journal {
    /// What is known about a scan; `None` if it was never seen.
    pub fn scan(&self, scan: &ScanId) -> Result<Option<ScanRow>, JournalError> {
        let sealed = seal::SCANS.cells;
        let known = format!("SELECT {sealed}, state, pressed_at FROM scans WHERE sha256 = ?1");
        first(&self.connection(), &known, [scan.as_str()], |row| {
            seal::SCANS.check(row)?;
            Ok(ScanRow {
                scan: scan.clone(),
                format: row.get(1)?,
                size: count(row, 2)?,
                first_seen: time(row, 3)?,
                file_time: if_any(row, 4, time)?,
                pressed_at: if_any(row, 7, time)?,
                state: cell(row, 6, ScanState::of_word)?,
            })
        })
    }

    /// All scans in a state.
    pub fn scans_in(&self, state: ScanState) -> Result<Vec<ScanId>, JournalError> {
        let found = "SELECT sha256 FROM scans WHERE state = ?1 ORDER BY 1";
        all(&self.connection(), found, [state.word()], |row| scan_id(row, 0))
    }

    /// The patients for whom a scan is known, including held ones; `None` stands for no patient.
    pub fn patients(&self, scan: &ScanId) -> Result<Vec<Option<String>>, JournalError> {
        let known = "SELECT patient FROM deliveries WHERE sha256 = ?1";
        all(&self.connection(), known, [scan.as_str()], |row| patient_id(row, 0))
    }

    /// The first scan with a fingerprint; `None` if there is none.
    pub fn of_geometry(&self, geometry: &str) -> Result<Option<ScanId>, JournalError> {
        let found =
            "SELECT sha256 FROM scans WHERE geometry = ?1 ORDER BY first_seen, rowid LIMIT 1";
        first(&self.connection(), found, [geometry], |row| scan_id(row, 0))
    }

    /// The refused scans with these sizes, in bytes, newest first, at most `limit`.
    pub fn refused_of(
        &self,
        sizes: Range<u64>,
        limit: u32,
    ) -> Result<Vec<(ScanId, u64)>, JournalError> {
        let refused = "SELECT sha256, size FROM scans WHERE state = ?1 AND size >= ?2 AND size < ?3
                       ORDER BY first_seen DESC LIMIT ?4";
        let (least, most) = (sizes.start.cast_signed(), sizes.end.cast_signed());
        let cells = params![ScanState::Refused.word(), least, most, limit];
        all(&self.connection(), refused, cells, |row| Ok((scan_id(row, 0)?, count(row, 1)?)))
    }

    /// Enters a new scan, its deliveries, one for each store, and what it means for captures.
    ///
    /// # Errors
    /// See [`JournalError`]; nothing is entered then.
    pub fn enter(&self, entry: &Entry<'_>, stores: &[&str]) -> Result<(), JournalError> {
        let Entry { row, patient, held, claims, judged, geometry, candidates } = *entry;
        self.change(|transaction| {
            insert_scan(transaction, row)?;
            let candidates = json_text(candidates)?;
            transaction.execute(
                "UPDATE scans SET candidates = ?2,
                        geometry = CASE geometry WHEN '' THEN ?3 ELSE geometry END
                 WHERE sha256 = ?1",
                [row.scan.as_str(), &candidates, geometry],
            )?;
            let state = if held.is_some() { DeliveryState::Held } else { DeliveryState::Pending };
            for store in stores {
                insert_delivery(transaction, &row.scan, patient, store, state, held)?;
            }
            if held.is_some() {
                // A scan that was given up before needs a decision again.
                needs_decision(transaction, &row.scan)?;
            }
            captures::answer(transaction, &row.scan, judged)?;
            let event = if held.is_some() { Event::Held } else { Event::Entered };
            let id = patient.map_or("", |patient| &patient.id);
            let mut detail = json!({ "patient": id, "state": state.word() });
            if let Some(code) = held {
                detail["code"] = json!(code);
            }
            if !claims.is_empty() {
                detail["claims"] = json!(claims);
            }
            history::append(transaction, Some(&row.scan), event, &detail)
        })
    }

    /// Refuses a scan for good, and with it every pending delivery.
    pub fn refused(&self, scan: &ScanId, code: &str, message: &str) -> Result<(), JournalError> {
        self.change(|transaction| {
            let state = state_of(transaction, scan)?.after(ScanStep::Refuse)?;
            set_state(transaction, scan, state)?;
            transaction.execute(
                "UPDATE scans SET code = ?2, message = ?3, closed = NULL WHERE sha256 = ?1",
                params![scan.as_str(), code, message],
            )?;
            let pending = DeliveryState::Pending;
            transaction.execute(
                "UPDATE deliveries SET state = ?2, code = ?3, next_at = NULL, changed_at = ?5
                 WHERE sha256 = ?1 AND state = ?4",
                params![
                    scan.as_str(),
                    pending.after(DeliveryStep::Refuse)?.word(),
                    code,
                    pending.word(),
                    Timestamp::now().to_string(),
                ],
            )?;
            history::append(transaction, Some(scan), Event::Refused, &json!({ "code": code }))
        })
    }

    /// Counts a measurement of the scan that ended without a result. Returns the count.
    pub fn crashed(&self, scan: &ScanId) -> Result<u32, JournalError> {
        let counted = "UPDATE scans SET crashes = crashes + 1 WHERE sha256 = ?1 RETURNING crashes";
        value(&self.connection(), counted, [scan.as_str()])
    }

    /// Notes that a measurement of the scan had a result: those before it that had none were not the scan's fault.
    pub fn measured(&self, scan: &ScanId) -> Result<(), JournalError> {
        let noted = "UPDATE scans SET crashes = 0 WHERE sha256 = ?1 AND crashes > 0";
        run(&self.connection(), noted, [scan.as_str()])
    }
}

/// Inserts a scan unless it is already there.
pub(super) fn insert_scan(
    transaction: &Transaction<'_>,
    row: &ScanRow,
) -> Result<(), JournalError> {
    let (scan, size) = (row.scan.as_str(), row.size.cast_signed());
    let first_seen = row.first_seen.to_string();
    let file_time = row.file_time.map(|time| time.to_string());
    let file_cell = file_time.as_deref().unwrap_or_default();
    let seal = seal::of_cells(&[scan, &row.format, &size.to_string(), &first_seen, file_cell]);
    run(
        transaction,
        "INSERT INTO scans (sha256, format, size, first_seen, file_time, state, changed_at, seal,
                            pressed_at)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)
         ON CONFLICT (sha256) DO NOTHING",
        params![
            scan,
            row.format,
            size,
            first_seen,
            file_time,
            row.state.word(),
            Timestamp::now().to_string(),
            seal,
            row.pressed_at.map(|time| time.to_string())
        ],
    )
}

/// Takes back that a scan needs no further decision.
pub(super) fn needs_decision(
    transaction: &Transaction<'_>,
    scan: &ScanId,
) -> Result<(), JournalError> {
    run(transaction, "UPDATE scans SET closed = NULL WHERE sha256 = ?1", [scan.as_str()])
}

/// Inserts a delivery. One that was withdrawn, or is about to be, becomes one to make again; one that
/// was made stays.
pub(super) fn insert_delivery(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    patient: Option<&Patient>,
    store: &str,
    state: DeliveryState,
    code: Option<&str>,
) -> Result<(), JournalError> {
    let sources = patient.map_or(&[][..], |patient| &patient.sources);
    let sources = json_text(sources)?;
    let id = patient.map_or("", |patient| &patient.id);
    let seal = seal::of_cells(&[scan.as_str(), id, store, &sources]);
    run(
        transaction,
        "INSERT INTO deliveries (sha256, patient, store, sources, state, code, changed_at, seal)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)
         ON CONFLICT (sha256, patient, store) DO UPDATE
         SET sources = ?4, state = ?5, code = ?6, changed_at = ?7, seal = ?8, attempts = 0,
             next_at = NULL, folder = NULL
         WHERE state IN ('withdrawn', 'withdrawing') OR deliveries.code = 'superseded'",
        params![
            scan.as_str(),
            id,
            store,
            sources,
            state.word(),
            code,
            Timestamp::now().to_string(),
            seal
        ],
    )
}

/// Sets a scan's state. A reason that is known stays with a refusal only.
pub(super) fn set_state(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    state: ScanState,
) -> Result<(), JournalError> {
    run(
        transaction,
        "UPDATE scans SET state = ?2, changed_at = ?3, code = iif(?2 = 'refused', code, NULL),
                message = iif(?2 = 'refused', message, NULL)
         WHERE sha256 = ?1",
        params![scan.as_str(), state.word(), Timestamp::now().to_string()],
    )
}

/// The state of a scan that must exist.
pub(super) fn state_of(
    transaction: &Transaction<'_>,
    scan: &ScanId,
) -> Result<ScanState, JournalError> {
    let state = "SELECT state FROM scans WHERE sha256 = ?1";
    let found = first(transaction, state, [scan.as_str()], |row| cell(row, 0, ScanState::of_word))?;
    found.ok_or(JournalError::Unknown { what: "scan" })
}
