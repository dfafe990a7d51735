//! Deliveries in the journal.

mod amended;

use std::path::Path;

use gaiter_flow::{DeliveryState, DeliveryStep, ScanId, ScanState, ScanStep};
use gaiter_record::{ImagingRequest, Source};
use jiff::Timestamp;
use rusqlite::{Transaction, params};
use serde_json::json;

use super::delivery_row::{self, Due, Task, count, detail, step, update};
use super::row::{all, cell, json_cell, run, scan_id, value};
use super::scans::{set_state, state_of};
use super::withdrawal::{self, Overtaken, UNWANTED};
use super::{Event, Journal, JournalError, history};
pub use amended::GivenRevision;

impl Journal {
    /// All deliveries to make or withdraw, newest scan first: an operator at the booth must not wait for
    /// a backlog.
    pub fn pending(&self) -> Result<Vec<Due>, JournalError> {
        let cells = format!("SELECT {}, deliveries.state", delivery_row::cells());
        let due = format!(
            "{cells}
             FROM deliveries JOIN scans USING (sha256)
             WHERE deliveries.state IN (?1, ?2)
             UNION ALL
             {cells}
             FROM deliveries INDEXED BY deliveries_amended JOIN scans USING (sha256)
             WHERE amended = ?3 AND amended <> '' AND deliveries.state = ?4
                   AND coalesce(deliveries.code, '') NOT IN {UNWANTED}
             ORDER BY first_seen DESC, sha256"
        );
        let states = [DeliveryState::Pending, DeliveryState::Withdrawing, DeliveryState::Delivered];
        let [pending, withdrawing, delivered] = states.map(DeliveryState::word);
        let states = [pending, withdrawing, amended::DUE, delivered];
        all(&self.connection(), &due, states, |row| {
            let task = match cell(row, 7, DeliveryState::of_word)? {
                DeliveryState::Withdrawing => Task::Withdraw,
                DeliveryState::Delivered => Task::HandOver,
                _ => Task::Deliver,
            };
            delivery_row::due(row, task)
        })
    }

    /// Records a store's receipt. The last pending delivery makes the scan delivered. Earlier refused
    /// scans of the same patient need no further decision. Records that can be withdrawn now are marked,
    /// see `journal::withdrawal`.
    pub fn delivered(&self, due: &Due, folder: &Path) -> Result<(), JournalError> {
        let scan = &due.scan;
        self.change(|transaction| {
            match withdrawal::overtaken(transaction, due)? {
                Overtaken::Unwanted => withdrawal::made_in_vain(transaction, due, folder)?,
                overtaken => {
                    if overtaken == Overtaken::Refused {
                        step(transaction, due, DeliveryStep::Retry, None)?;
                    }
                    let place = folder.to_string_lossy();
                    step(transaction, due, DeliveryStep::Deliver, Some(&place))?;
                    history::append(transaction, Some(scan), Event::Delivered, &detail(due))?;
                    close_superseded(transaction, due)?;
                }
            }
            withdrawal::apply(transaction, scan)?;
            finish_if_done(transaction, scan)
        })
    }

    /// Notes that the record of a delivery lacks measures: a person must take them by hand or scan again. Once its
    /// patient has it, what a person has set since counts.
    pub fn lacks_measures(&self, due: &Due) -> Result<(), JournalError> {
        let noted = format!(
            "UPDATE scans SET incomplete = 1 WHERE sha256 = ?1 AND incomplete = 0
             AND NOT EXISTS (SELECT 1 FROM deliveries AS theirs
                             WHERE theirs.sha256 = ?1 AND theirs.patient = ?2 AND theirs.state = ?3
                                   AND coalesce(theirs.code, '') NOT IN {UNWANTED})"
        );
        let cells = [due.scan.as_str(), due.patient_cell(), DeliveryState::Delivered.word()];
        run(&self.connection(), &noted, cells)
    }

    /// Records that a store will never take a record, if other deliveries of the scan are pending: the scan is
    /// refused for that once they are made. Returns whether that is so. If not, nothing is changed: the scan is
    /// to be refused.
    pub fn refused_at_store(
        &self,
        due: &Due,
        code: &str,
        message: &str,
    ) -> Result<bool, JournalError> {
        self.change(|transaction| {
            if count(transaction, &due.scan, DeliveryState::Pending)? < 2 {
                return Ok(false);
            }
            step(transaction, due, DeliveryStep::Refuse, None)?;
            update(transaction, due, "code = ?4", &[&code])?;
            let reason = "UPDATE scans SET code = ?2, message = ?3 WHERE sha256 = ?1";
            run(transaction, reason, [due.scan.as_str(), code, message])?;
            let detail = json!({ "code": code, "store": due.store });
            history::append(transaction, Some(&due.scan), Event::Refused, &detail)?;
            Ok(true)
        })
    }

    /// Records an attempt that failed for a reason that may pass. A delivery that is no longer to be made, or
    /// was made before, is left as it is: its code states why.
    pub fn put_off(&self, due: &Due, code: &str, next_at: Timestamp) -> Result<(), JournalError> {
        if due.task == Task::HandOver {
            return Ok(());
        }
        run(
            &self.connection(),
            "UPDATE deliveries SET attempts = attempts + 1, code = ?5, next_at = ?4
             WHERE sha256 = ?1 AND patient = ?2 AND store = ?3
                   AND state IN ('pending', 'withdrawing')",
            params![due.scan.as_str(), due.patient_cell(), due.store, next_at.to_string(), code],
        )
    }

    /// The request with which a scan was to be delivered to a patient, whether the patient still has it or not.
    pub fn request_of(
        &self,
        scan: &ScanId,
        patient: &str,
    ) -> Result<Option<ImagingRequest>, JournalError> {
        let sources = "SELECT sources FROM deliveries WHERE sha256 = ?1 AND patient = ?2";
        let cells = [scan.as_str(), patient];
        let sources: Vec<Vec<Source>> =
            all(&self.connection(), sources, cells, |row| json_cell(row, 0))?;
        Ok(sources.into_iter().flatten().find_map(|source| source.request))
    }

    /// Reports whether the spooled bytes of a scan are no longer needed: none of its deliveries is pending,
    /// refused, or held for a decision that is still open.
    pub fn has_served(&self, scan: &ScanId) -> Result<bool, JournalError> {
        let served = format!(
            "SELECT NOT EXISTS (
                 SELECT 1 FROM deliveries JOIN scans USING (sha256)
                 WHERE sha256 = ?1 AND (deliveries.state IN ('pending', 'refused')
                                        OR deliveries.state = 'held' AND {IS_NEEDED}))"
        );
        value(&self.connection(), &served, [scan.as_str()])
    }

    /// The patients the scan belongs to: neither those it is held for nor those it was withdrawn from.
    pub fn owners(&self, scan: &ScanId) -> Result<Vec<String>, JournalError> {
        let owners = format!(
            "SELECT DISTINCT patient FROM deliveries
             WHERE sha256 = ?1 AND patient <> '' AND state NOT IN ('held', 'withdrawing', 'withdrawn')
                   AND coalesce(code, '') NOT IN {UNWANTED}"
        );
        all(&self.connection(), &owners, [scan.as_str()], |row| Ok(row.get(0)?))
    }
}

/// Marks a scan as delivered if none of its deliveries is pending; as refused if a store will never take its record:
/// a person decides about it.
pub(super) fn finish_if_done(
    transaction: &Transaction<'_>,
    scan: &ScanId,
) -> Result<(), JournalError> {
    let state = state_of(transaction, scan)?;
    if state == ScanState::Spooled && count(transaction, scan, DeliveryState::Pending)? == 0 {
        let step = match count(transaction, scan, DeliveryState::Refused)? {
            0 => ScanStep::Finish,
            _ => ScanStep::Refuse,
        };
        set_state(transaction, scan, state.after(step)?)?;
    }
    Ok(())
}

/// SQL: the bytes of a held scan are needed: it waits for a decision, or it was given up before any record
/// was made of it, so that they are nowhere else.
pub(super) const IS_NEEDED: &str = "(scans.closed IS NULL OR NOT EXISTS (
    SELECT 1 FROM deliveries AS made
    WHERE made.sha256 = scans.sha256 AND made.state = 'delivered'))";

/// Closes earlier refused scans of this patient and no other, because a later scan could be measured.
pub(super) fn close_superseded(
    transaction: &Transaction<'_>,
    due: &Due,
) -> Result<(), JournalError> {
    let Some(patient) = &due.patient else { return Ok(()) };
    let closed = all(
        transaction,
        "UPDATE scans SET closed = 'superseded'
         WHERE state = 'refused' AND closed IS NULL
               AND (first_seen, rowid) < (SELECT first_seen, rowid FROM scans WHERE sha256 = ?1)
               AND EXISTS (SELECT 1 FROM deliveries AS theirs WHERE theirs.sha256 = scans.sha256
                           AND theirs.patient = ?2 AND theirs.state = 'refused')
               AND NOT EXISTS (SELECT 1 FROM deliveries AS others
                               WHERE others.sha256 = scans.sha256 AND others.patient <> ?2)
         RETURNING sha256",
        [due.scan.as_str(), &patient.id],
        |row| scan_id(row, 0),
    )?;
    for scan in closed {
        let detail = json!({ "by": due.scan.short() });
        history::append(transaction, Some(&scan), Event::Superseded, &detail)?;
    }
    Ok(())
}
