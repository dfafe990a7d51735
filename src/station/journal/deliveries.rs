//! Deliveries in the journal.

use std::path::Path;

use jiff::Timestamp;
use rusqlite::{OptionalExtension, Transaction, params};
use serde_json::json;

use super::scans::{set_state, state_of};
use super::{Event, Journal, JournalError, cell, history, seal};
use crate::flow::identity::SAME_SCAN_OTHER_PATIENT;
use crate::flow::{DeliveryState, DeliveryStep, ScanId, ScanStep};
use crate::record::Patient;

/// A delivery to be made or taken back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Due {
    /// The scan.
    pub scan: ScanId,
    /// Whose it is; none while nobody named the patient.
    pub patient: Option<Patient>,
    /// The store's name.
    pub store: String,
    /// What is to be done there.
    pub task: Task,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    /// How often it was tried.
    pub attempts: u32,
}

/// What is to be done at a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Task {
    /// The record is to be put there.
    Deliver,
    /// The record for nobody is to be taken back.
    Withdraw,
}

impl Due {
    /// The patient's id as the journal's column holds it.
    pub fn patient_cell(&self) -> &str {
        self.patient.as_ref().map_or("", |patient| &patient.id)
    }
}

impl Journal {
    /// All deliveries to be made or taken back, the scans first seen last first: whoever stands at
    /// the booth is not to wait for a backlog.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn pending(&self) -> Result<Vec<Due>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT sha256, patient, sources, store, deliveries.state, first_seen, attempts,
                    deliveries.seal
             FROM deliveries JOIN scans USING (sha256)
             WHERE deliveries.state IN (?1, ?2) ORDER BY first_seen DESC, sha256",
        )?;
        let words = [DeliveryState::Pending.word(), DeliveryState::Withdrawing.word()];
        let mut rows = query.query(words)?;
        let mut pending = Vec::new();
        while let Some(row) = rows.next()? {
            let (scan, id, sources): (String, String, String) =
                (row.get(0)?, row.get(1)?, row.get(2)?);
            let (store, state): (String, String) = (row.get(3)?, row.get(4)?);
            // Read again although the start checked all: this decides whose folder it goes to.
            if row.get::<_, String>(7)? != seal::of_delivery(&scan, &id, &store, &sources) {
                return Err(JournalError::Seal { table: "deliveries" });
            }
            let sources = cell("sources", sources, |text| serde_json::from_str(text).ok())?;
            let task = match cell("state", state, DeliveryState::of_word)? {
                DeliveryState::Withdrawing => Task::Withdraw,
                _ => Task::Deliver,
            };
            pending.push(Due {
                scan: cell("sha256", scan, |text| ScanId::parse(text).ok())?,
                patient: (!id.is_empty()).then_some(Patient { id, sources }),
                store,
                task,
                first_seen: cell("first_seen", row.get(5)?, |text| text.parse().ok())?,
                attempts: row.get(6)?,
            });
        }
        Ok(pending)
    }

    /// The store has given its receipt. With the last pending delivery the scan is delivered. A record
    /// of the same scan for nobody is to be taken back where the patient is named, and one of a patient
    /// from whom it was taken.
    /// Says whether the spooled bytes have served: nothing is pending, held or refused.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn delivered(&self, due: &Due, folder: &Path) -> Result<bool, JournalError> {
        let scan = &due.scan;
        self.change(|transaction| {
            let place = folder.to_string_lossy();
            if is_superseded(transaction, due)? {
                // Somebody decided otherwise while it was in hand: now it is there to be taken back.
                set_code(transaction, due, UNASSIGNED)?;
                return Ok(false);
            }
            step(transaction, due, DeliveryStep::Deliver, Some(&place))?;
            history::append(transaction, Some(scan), Event::Delivered, &detail(due))?;
            withdraw_others(transaction, due)?;
            let pending = count(transaction, scan, DeliveryState::Pending)?;
            let kept_for = count(transaction, scan, DeliveryState::Held)?
                + count(transaction, scan, DeliveryState::Refused)?;
            if pending == 0 {
                let state = state_of(transaction, scan)?.after(ScanStep::Finish)?;
                set_state(transaction, scan, state)?;
            }
            Ok(pending == 0 && kept_for == 0)
        })
    }

    /// A store will never take a record, while other deliveries of the scan are still to be made;
    /// says whether that is so. Where none is, nothing is changed: the scan is to be refused.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn refused_at_store(&self, due: &Due, code: &str) -> Result<bool, JournalError> {
        self.change(|transaction| {
            if count(transaction, &due.scan, DeliveryState::Pending)? < 2 {
                return Ok(false);
            }
            step(transaction, due, DeliveryStep::Refuse, None)?;
            set_code(transaction, due, code)?;
            let detail = json!({ "code": code, "store": due.store });
            history::append(transaction, Some(&due.scan), Event::Refused, &detail)?;
            Ok(true)
        })
    }

    /// The record for nobody is gone from the store.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn withdrawn(&self, due: &Due) -> Result<(), JournalError> {
        self.change(|transaction| {
            if delivery_state(transaction, due)? != Some(DeliveryState::Withdrawing) {
                // Somebody decided otherwise while it was in hand: it is to be made again.
                return Ok(());
            }
            step(transaction, due, DeliveryStep::Gone, None)?;
            history::append(transaction, Some(&due.scan), Event::Withdrawn, &detail(due))
        })
    }

    /// An attempt failed for a reason that may pass.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn put_off(&self, due: &Due, code: &str, next_at: Timestamp) -> Result<(), JournalError> {
        self.connection().execute(
            "UPDATE deliveries SET attempts = attempts + 1, code = ?5, next_at = ?4
             WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
            params![due.scan.as_str(), due.patient_cell(), due.store, next_at.to_string(), code],
        )?;
        Ok(())
    }

    /// Who keeps the record of a scan in a store when another one's is taken back; none while nobody
    /// has it, and inner none for the folder of scans for nobody.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn keeper(
        &self,
        scan: &ScanId,
        store: &str,
    ) -> Result<Option<Option<String>>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT patient FROM deliveries
             WHERE sha256 = ?1 AND store = ?2 AND state = ?3
                   AND coalesce(code, '') NOT IN (?4, ?5)
             ORDER BY patient = '', changed_at LIMIT 1",
        )?;
        let cells = [scan.as_str(), store, DeliveryState::Delivered.word(), UNASSIGNED, SUPERSEDED];
        let found: Option<String> = query.query_row(cells, |row| row.get(0)).optional()?;
        Ok(found.map(|id| Some(id).filter(|id| !id.is_empty())))
    }

    /// The patients whose scan it is: neither held for them nor taken back from them.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn owners(&self, scan: &ScanId) -> Result<Vec<String>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT DISTINCT patient FROM deliveries
             WHERE sha256 = ?1 AND patient <> '' AND state NOT IN (?2, ?3, ?4)
                   AND coalesce(code, '') NOT IN (?5, ?6)",
        )?;
        let [held, withdrawing, withdrawn] =
            [DeliveryState::Held, DeliveryState::Withdrawing, DeliveryState::Withdrawn];
        let cells = [
            scan.as_str(),
            held.word(),
            withdrawing.word(),
            withdrawn.word(),
            UNASSIGNED,
            SUPERSEDED,
        ];
        let rows = query.query_map(cells, |row| row.get(0))?;
        Ok(rows.collect::<rusqlite::Result<_>>()?)
    }

    /// Why a delivery of the scan waits for a person; none where none does.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn held_for(&self, scan: &ScanId) -> Result<Option<String>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT coalesce(code, ?3) FROM deliveries WHERE sha256 = ?1 AND state = ?2 LIMIT 1",
        )?;
        let cells = [scan.as_str(), DeliveryState::Held.word(), SAME_SCAN_OTHER_PATIENT];
        Ok(query.query_row(cells, |row| row.get(0)).optional()?)
    }
}

/// The code of a delivered record that a person takes back from its patient.
pub(super) const UNASSIGNED: &str = "unassigned";

/// The code of a delivery that was to be made when a person decided otherwise. It may be in hand, so
/// it counts as made, and is taken back like one.
pub(super) const SUPERSEDED: &str = "superseded";

/// What is to be taken back from a store now that a record has reached it.
pub(super) fn withdraw_others(
    transaction: &Transaction<'_>,
    kept: &Due,
) -> Result<(), JournalError> {
    let mut query = transaction.prepare_cached(
        "SELECT patient FROM deliveries
         WHERE sha256 = ?1 AND store = ?2 AND state = ?3 AND patient <> ?4
               AND (code IN (?5, ?6) OR patient = '')",
    )?;
    let cells = [
        kept.scan.as_str(),
        &kept.store,
        DeliveryState::Delivered.word(),
        kept.patient_cell(),
        UNASSIGNED,
        SUPERSEDED,
    ];
    let others = query.query_map(cells, |row| row.get(0))?;
    let others: Vec<String> = others.collect::<rusqlite::Result<_>>()?;
    for id in others {
        let patient = (!id.is_empty()).then_some(Patient { id, sources: Vec::new() });
        step(transaction, &Due { patient, ..kept.clone() }, DeliveryStep::Withdraw, None)?;
    }
    Ok(())
}

fn is_superseded(transaction: &Transaction<'_>, due: &Due) -> Result<bool, JournalError> {
    Ok(transaction.query_row(
        "SELECT EXISTS (SELECT 1 FROM deliveries
                        WHERE sha256 = ?1 AND patient = ?2 AND store = ?3 AND code = ?4)",
        [due.scan.as_str(), due.patient_cell(), &due.store, SUPERSEDED],
        |row| row.get(0),
    )?)
}

fn set_code(transaction: &Transaction<'_>, due: &Due, code: &str) -> Result<(), JournalError> {
    transaction.execute(
        "UPDATE deliveries SET code = ?4 WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
        [due.scan.as_str(), due.patient_cell(), &due.store, code],
    )?;
    Ok(())
}

/// What the history says of a delivery.
pub(super) fn detail(due: &Due) -> serde_json::Value {
    json!({ "patient": due.patient_cell(), "store": due.store })
}

/// How many deliveries of a scan are in a state.
pub(super) fn count(
    connection: &rusqlite::Connection,
    scan: &ScanId,
    state: DeliveryState,
) -> Result<i64, JournalError> {
    let mut query = connection
        .prepare_cached("SELECT count(*) FROM deliveries WHERE sha256 = ?1 AND state = ?2")?;
    Ok(query.query_row([scan.as_str(), state.word()], |row| row.get(0))?)
}

/// The state of a delivery; none where there is none.
pub(super) fn delivery_state(
    transaction: &Transaction<'_>,
    due: &Due,
) -> Result<Option<DeliveryState>, JournalError> {
    let word: Option<String> = transaction
        .query_row(
            "SELECT state FROM deliveries WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
            [due.scan.as_str(), due.patient_cell(), &due.store],
            |row| row.get(0),
        )
        .optional()?;
    word.map(|word| cell("state", word, DeliveryState::of_word)).transpose()
}

/// Takes a delivery one step on.
pub(super) fn step(
    transaction: &Transaction<'_>,
    due: &Due,
    step: DeliveryStep,
    folder: Option<&str>,
) -> Result<(), JournalError> {
    let state = delivery_state(transaction, due)?;
    let state = state.ok_or(JournalError::Unknown { what: "delivery" })?.after(step)?;
    transaction.execute(
        "UPDATE deliveries SET state = ?4, code = NULL, next_at = NULL, changed_at = ?5,
                folder = coalesce(?6, folder)
         WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
        params![
            due.scan.as_str(),
            due.patient_cell(),
            due.store,
            state.word(),
            Timestamp::now().to_string(),
            folder
        ],
    )?;
    Ok(())
}
