//! Deliveries in the journal.

use std::path::Path;

use jiff::Timestamp;
use rusqlite::{OptionalExtension, params};

use super::scans::state_of;
use super::{Journal, JournalError, cell};
use crate::flow::{DeliveryState, DeliveryStep, ScanId, ScanStep};
use crate::record::Patient;

/// A delivery to be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Due {
    /// The scan.
    pub scan: ScanId,
    /// Whose it is; none while nobody named the patient.
    pub patient: Option<Patient>,
}

impl Journal {
    /// All deliveries to be made: fresh ones first, then by time of first sight.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn pending(&self) -> Result<Vec<Due>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT sha256, patient, sources FROM deliveries JOIN scans USING (sha256)
             WHERE deliveries.state = ?1 ORDER BY attempts > 0, first_seen, sha256",
        )?;
        let rows = query.query_map([DeliveryState::Pending.word()], |row| {
            Ok((row.get(0)?, row.get::<_, String>(1)?, row.get(2)?))
        })?;
        let due = |(sha256, id, sources): (String, String, String)| {
            let sources = cell("sources", sources, |text| serde_json::from_str(text).ok())?;
            Ok(Due {
                scan: cell("sha256", sha256, |text| ScanId::parse(text).ok())?,
                patient: (!id.is_empty()).then_some(Patient { id, sources }),
            })
        };
        rows.map(|row| due(row?)).collect()
    }

    /// The store has given its receipt. With the last pending delivery the scan is delivered.
    /// Says whether the spooled bytes have served: nothing is pending, and nothing held.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn delivered(&self, due: &Due, store: &str, folder: &Path) -> Result<bool, JournalError> {
        let mut connection = self.connection();
        let transaction = connection.transaction()?;
        let (scan, patient) = (due.scan.as_str(), patient_cell(due));
        let state: Option<String> = transaction
            .query_row(
                "SELECT state FROM deliveries WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
                [scan, patient, store],
                |row| row.get(0),
            )
            .optional()?;
        let state = state.ok_or(JournalError::Unknown { what: "delivery" })?;
        let state = cell("state", state, DeliveryState::of_word)?.after(DeliveryStep::Deliver)?;
        transaction.execute(
            "UPDATE deliveries SET state = ?4, next_at = NULL, folder = ?5
             WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
            params![scan, patient, store, state.word(), folder.to_string_lossy()],
        )?;
        let open = |state: DeliveryState| -> rusqlite::Result<i64> {
            transaction.query_row(
                "SELECT count(*) FROM deliveries WHERE sha256 = ?1 AND state = ?2",
                [scan, state.word()],
                |row| row.get(0),
            )
        };
        let (pending, held) = (open(DeliveryState::Pending)?, open(DeliveryState::Held)?);
        if pending == 0 {
            let state = state_of(&transaction, &due.scan)?.after(ScanStep::Finish)?;
            transaction
                .execute("UPDATE scans SET state = ?2 WHERE sha256 = ?1", [scan, state.word()])?;
        }
        transaction.commit()?;
        Ok(pending == 0 && held == 0)
    }

    /// An attempt failed for a reason that may pass.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn put_off(&self, due: &Due, store: &str, next_at: Timestamp) -> Result<(), JournalError> {
        self.connection().execute(
            "UPDATE deliveries SET attempts = attempts + 1, next_at = ?4
             WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
            params![due.scan.as_str(), patient_cell(due), store, next_at.to_string()],
        )?;
        Ok(())
    }

    /// Whether a delivery of the scan waits for a person.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn is_held(&self, scan: &ScanId) -> Result<bool, JournalError> {
        Ok(self.connection().query_row(
            "SELECT EXISTS (SELECT 1 FROM deliveries WHERE sha256 = ?1 AND state = ?2)",
            [scan.as_str(), DeliveryState::Held.word()],
            |row| row.get(0),
        )?)
    }
}

fn patient_cell(due: &Due) -> &str {
    due.patient.as_ref().map_or("", |patient| &patient.id)
}
