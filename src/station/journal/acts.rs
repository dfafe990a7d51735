//! What a person decides, in the journal. The bytes have been put where they belong before.

use rusqlite::{Transaction, params};
use serde_json::json;

use super::deliveries::{SUPERSEDED, UNASSIGNED, count, step};
use super::scans::{insert_delivery, insert_scan, set_state, state_of};
use super::{Due, Event, Journal, JournalError, ScanRow, Task, cell, history};
use crate::flow::identity::SAME_SCAN_OTHER_PATIENT;
use crate::flow::{DeliveryState, DeliveryStep, ScanId, ScanState, ScanStep};
use crate::record::Patient;

impl Journal {
    /// Every delivery of a scan that is in a state.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn deliveries_in(
        &self,
        scan: &ScanId,
        state: DeliveryState,
    ) -> Result<Vec<Due>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT patient, sources, store, first_seen, attempts
             FROM deliveries JOIN scans USING (sha256)
             WHERE sha256 = ?1 AND deliveries.state = ?2 ORDER BY patient, store",
        )?;
        let mut rows = query.query([scan.as_str(), state.word()])?;
        let mut found = Vec::new();
        while let Some(row) = rows.next()? {
            let (id, sources): (String, String) = (row.get(0)?, row.get(1)?);
            let sources = cell("sources", sources, |text| serde_json::from_str(text).ok())?;
            found.push(Due {
                scan: scan.clone(),
                patient: (!id.is_empty()).then_some(Patient { id, sources }),
                store: row.get(2)?,
                task: Task::Deliver,
                first_seen: cell("first_seen", row.get(3)?, |text| text.parse().ok())?,
                attempts: row.get(4)?,
            });
        }
        Ok(found)
    }

    /// A person wants these deliveries made: refused ones again, held ones because the scan is this
    /// patient's.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn reopened(
        &self,
        scan: &ScanId,
        deliveries: &[Due],
        by: DeliveryStep,
        event: Event,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            for due in deliveries {
                step(transaction, due, by, None)?;
                begin_afresh(transaction, due)?;
            }
            reopen(transaction, scan)?;
            let patients: Vec<&str> = deliveries.iter().map(Due::patient_cell).collect();
            history::append(transaction, Some(scan), event, &json!({ "patients": patients }))
        })
    }

    /// A person says whose scan it is that came in for nobody, or is held. Deliveries for nobody that
    /// are still to be made, and held ones, are made for the patient instead; those for nobody that
    /// were made are followed by one for the patient, after which they are taken back.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn assigned(
        &self,
        scan: &ScanId,
        patient: &Patient,
        stores: &[&str],
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            give_way(transaction, scan, "patient = '' OR state = 'held'")?;
            for_whom(transaction, scan, Some(patient), stores)?;
            let detail = json!({ "patient": patient.id, "by": "operator" });
            history::append(transaction, Some(scan), Event::Assigned, &detail)
        })
    }

    /// A person takes a scan back from whoever has it: it is nobody's again. Records that were
    /// delivered go when the one for nobody lies in their store.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn unassigned(&self, scan: &ScanId, stores: &[&str]) -> Result<(), JournalError> {
        self.change(|transaction| {
            let taken: Vec<String> = {
                let mut query = transaction.prepare_cached(
                    "SELECT DISTINCT patient FROM deliveries
                     WHERE sha256 = ?1 AND patient <> '' AND state <> 'withdrawn'",
                )?;
                let rows = query.query_map([scan.as_str()], |row| row.get(0))?;
                rows.collect::<rusqlite::Result<_>>()?
            };
            transaction.execute(
                "UPDATE deliveries SET code = ?2
                 WHERE sha256 = ?1 AND patient <> '' AND state = 'delivered'",
                [scan.as_str(), UNASSIGNED],
            )?;
            give_way(transaction, scan, "patient <> ''")?;
            for_whom(transaction, scan, None, stores)?;
            let detail = json!({ "patients": taken, "by": "operator" });
            history::append(transaction, Some(scan), Event::Unassigned, &detail)
        })
    }

    /// A store holds this record, which the journal did not know. Deliveries of the same scan to
    /// other patients that were entered in ignorance of it are held.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn found(
        &self,
        row: &ScanRow,
        patient: Option<&Patient>,
        store: &str,
        folder: &str,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            let id = patient.map_or("", |patient| &patient.id);
            let scan = row.scan.as_str();
            insert_scan(transaction, row)?;
            let known: bool = transaction.query_row(
                "SELECT EXISTS (SELECT 1 FROM deliveries
                                WHERE sha256 = ?1 AND patient = ?2 AND store = ?3
                                      AND state <> ?4)",
                [scan, id, store, DeliveryState::Refused.word()],
                |row| row.get(0),
            )?;
            if known {
                return Ok(());
            }
            transaction.execute(
                "DELETE FROM deliveries WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
                [scan, id, store],
            )?;
            let delivered = DeliveryState::Delivered;
            insert_delivery(transaction, &row.scan, patient, store, delivered, None)?;
            transaction.execute(
                "UPDATE deliveries SET folder = ?4
                 WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
                [scan, id, store, folder],
            )?;
            transaction.execute(
                "UPDATE deliveries SET state = ?3, code = ?4
                 WHERE sha256 = ?1 AND patient <> ?2 AND patient <> '' AND state = ?5",
                params![
                    scan,
                    id,
                    DeliveryState::Held.word(),
                    SAME_SCAN_OTHER_PATIENT,
                    DeliveryState::Pending.word()
                ],
            )?;
            if !id.is_empty() {
                // A sighting that names nobody adds nothing to what is known.
                transaction.execute(
                    "DELETE FROM deliveries WHERE sha256 = ?1 AND patient = '' AND state = ?2",
                    [scan, DeliveryState::Pending.word()],
                )?;
            }
            finish_if_done(transaction, &row.scan)?;
            let detail = json!({ "patient": id, "store": store });
            history::append(transaction, Some(&row.scan), Event::Found, &detail)
        })
    }

    /// Whether the spooled bytes of a scan have served: nothing is pending, and nothing held.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn has_served(&self, scan: &ScanId) -> Result<bool, JournalError> {
        let connection = self.connection();
        let open = count(&connection, scan, DeliveryState::Pending)?
            + count(&connection, scan, DeliveryState::Held)?
            + count(&connection, scan, DeliveryState::Refused)?;
        Ok(open == 0)
    }
}

/// Deliveries that a person's word overtakes. Refused and held ones are not in hand and go; pending
/// ones may be, and are taken back when the one that was wanted is made.
fn give_way(transaction: &Transaction<'_>, scan: &ScanId, which: &str) -> Result<(), JournalError> {
    transaction.execute(
        &format!(
            "DELETE FROM deliveries
             WHERE sha256 = ?1 AND state IN ('refused', 'held') AND ({which})"
        ),
        [scan.as_str()],
    )?;
    transaction.execute(
        &format!(
            "UPDATE deliveries SET state = ?2, code = ?3, next_at = NULL
             WHERE sha256 = ?1 AND state = ?4 AND ({which})"
        ),
        [scan.as_str(), DeliveryState::Delivered.word(), SUPERSEDED, DeliveryState::Pending.word()],
    )?;
    Ok(())
}

/// The deliveries of a scan to whom a person says it belongs.
fn for_whom(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    patient: Option<&Patient>,
    stores: &[&str],
) -> Result<(), JournalError> {
    let state = state_of(transaction, scan)?;
    let delivery = match state {
        // It stays refused until somebody retries it, now for this patient.
        ScanState::Refused => DeliveryState::Refused,
        ScanState::Spooled | ScanState::Delivered => DeliveryState::Pending,
    };
    // What was to be taken back from this very one stays.
    transaction.execute(
        "UPDATE deliveries SET code = NULL WHERE sha256 = ?1 AND patient = ?2 AND code = ?3",
        [scan.as_str(), patient.map_or("", |patient| &patient.id), UNASSIGNED],
    )?;
    for store in stores {
        insert_delivery(transaction, scan, patient, store, delivery, None)?;
    }
    if state == ScanState::Delivered && count(transaction, scan, DeliveryState::Pending)? > 0 {
        reopen(transaction, scan)?;
    }
    finish_if_done(transaction, scan)
}

/// A scan of which nothing is pending any more is delivered.
fn finish_if_done(transaction: &Transaction<'_>, scan: &ScanId) -> Result<(), JournalError> {
    let state = state_of(transaction, scan)?;
    if state == ScanState::Spooled && count(transaction, scan, DeliveryState::Pending)? == 0 {
        set_state(transaction, scan, state.after(ScanStep::Finish)?)?;
    }
    Ok(())
}

fn begin_afresh(transaction: &Transaction<'_>, due: &Due) -> Result<(), JournalError> {
    transaction.execute(
        "UPDATE deliveries SET attempts = 0 WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
        [due.scan.as_str(), due.patient_cell(), &due.store],
    )?;
    transaction.execute("UPDATE scans SET crashes = 0 WHERE sha256 = ?1", [due.scan.as_str()])?;
    Ok(())
}

fn reopen(transaction: &Transaction<'_>, scan: &ScanId) -> Result<(), JournalError> {
    let state = state_of(transaction, scan)?.after(ScanStep::Reopen)?;
    set_state(transaction, scan, state)
}
