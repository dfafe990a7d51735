//! Operators' decisions in the journal. The caller has already moved the bytes and stored the decision;
//! `number` is the decision's position among those about the scan, from 1.

use gaiter_flow::lifecycle::{HANDED_OVER, SUPERSEDED, UNASSIGNED};
use gaiter_flow::{DeliveryState, DeliveryStep, ScanId, ScanState, ScanStep};
use gaiter_record::Patient;
use rusqlite::{Connection, Transaction, params};
use serde_json::{Value, json};

use super::deliveries::finish_if_done;
use super::delivery_row::{self, count, step, update};
use super::row::{all, first, json_cell, run};
use super::scans::{insert_delivery, needs_decision, set_state, state_of};
use super::withdrawal::UNWANTED;
use super::{Due, Event, Journal, JournalError, Task, history, withdrawal};

impl Journal {
    /// All deliveries of a scan in this state.
    pub fn deliveries_in(
        &self,
        scan: &ScanId,
        state: DeliveryState,
    ) -> Result<Vec<Due>, JournalError> {
        deliveries_in(&self.connection(), scan, state)
    }

    /// The ids of the patients a held scan may belong to, as far as known when it was held.
    pub fn candidates(&self, scan: &ScanId) -> Result<Vec<String>, JournalError> {
        candidates(&self.connection(), scan)
    }

    /// Applies an operator's retry of refused deliveries, or the release of a held scan to one patient: these
    /// deliveries are made. A release drops the other held ones. `number` is set if there is a decision.
    pub fn reopened(
        &self,
        scan: &ScanId,
        deliveries: &[Due],
        by: DeliveryStep,
        number: Option<usize>,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            make_again(transaction, scan, deliveries, by)?;
            let patients: Vec<&str> = deliveries.iter().map(Due::patient_cell).collect();
            let mut detail = json!({ "patients": patients });
            if let Some(number) = number {
                detail["decision"] = Value::from(number);
            }
            if by != DeliveryStep::Release {
                return history::append(transaction, Some(scan), Event::Retried, &detail);
            }
            drop_held(transaction, scan)?;
            history::append(transaction, Some(scan), Event::Released, &detail)
        })
    }

    /// Applies an operator's assignment of a scan to a patient, or that it is taken back from one: it then stays
    /// with the others it belongs to, or is unassigned again. Deliveries to others become unwanted. Those
    /// already made are withdrawn when a record that is wanted is in the same store.
    pub fn given_to(
        &self,
        scan: &ScanId,
        patients: &[Patient],
        stores: &[&str],
        event: Event,
        detail: &Value,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            belongs_to(transaction, scan, patients, stores)?;
            history::append(transaction, Some(scan), event, detail)
        })
    }

    /// Notes which leg of a patient a person named as affected; `None` if that was taken back.
    pub fn affected_named(
        &self,
        patient: &str,
        affected: Option<&str>,
    ) -> Result<(), JournalError> {
        let detail = json!({ "patient": patient, "affected": affected });
        self.change(|transaction| history::append(transaction, None, Event::AffectedNamed, &detail))
    }

    /// Applies an operator's decision to give a scan up: it needs no further decision.
    pub fn given_up(&self, scan: &ScanId, number: usize) -> Result<(), JournalError> {
        self.change(|transaction| {
            close(transaction, scan)?;
            let detail = json!({ "by": "operator", "decision": number });
            history::append(transaction, Some(scan), Event::GivenUp, &detail)
        })
    }
}

/// The ids of the patients a held scan may belong to.
pub(super) fn candidates(
    connection: &Connection,
    scan: &ScanId,
) -> Result<Vec<String>, JournalError> {
    let candidates = "SELECT candidates FROM scans WHERE sha256 = ?1";
    let found = first(connection, candidates, [scan.as_str()], |row| json_cell(row, 0))?;
    found.ok_or(JournalError::Unknown { what: "scan" })
}

/// All deliveries of a scan in this state.
pub(super) fn deliveries_in(
    connection: &Connection,
    scan: &ScanId,
    state: DeliveryState,
) -> Result<Vec<Due>, JournalError> {
    let found = format!(
        "SELECT {} FROM deliveries JOIN scans USING (sha256)
         WHERE sha256 = ?1 AND deliveries.state = ?2 ORDER BY patient, store",
        delivery_row::cells()
    );
    let cells = [scan.as_str(), state.word()];
    all(connection, &found, cells, |row| delivery_row::due(row, Task::Deliver))
}

/// Restarts deliveries from the beginning, and their scan.
pub(super) fn make_again(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    deliveries: &[Due],
    by: DeliveryStep,
) -> Result<(), JournalError> {
    for due in deliveries {
        step(transaction, due, by, None)?;
        update(transaction, due, "attempts = 0", &[])?;
    }
    transaction.execute(
        "UPDATE scans SET crashes = 0, closed = NULL WHERE sha256 = ?1",
        [scan.as_str()],
    )?;
    reopen(transaction, scan)
}

/// Drops the held deliveries of a scan.
pub(super) fn drop_held(transaction: &Transaction<'_>, scan: &ScanId) -> Result<(), JournalError> {
    let dropped = "DELETE FROM deliveries WHERE sha256 = ?1 AND state = 'held'";
    run(transaction, dropped, [scan.as_str()])
}

/// Closes a scan: it needs no further decision.
pub(super) fn close(transaction: &Transaction<'_>, scan: &ScanId) -> Result<(), JournalError> {
    let given_up = "UPDATE scans SET closed = 'given-up' WHERE sha256 = ?1";
    run(transaction, given_up, [scan.as_str()])
}

/// Gives a scan to these patients only; without patients it becomes unassigned.
pub(super) fn belongs_to(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    patients: &[Patient],
    stores: &[&str],
) -> Result<(), JournalError> {
    needs_decision(transaction, scan)?;
    drop_held(transaction, scan)?;
    let whose: Vec<Option<&Patient>> = match patients {
        [] => vec![None],
        patients => patients.iter().map(Some).collect(),
    };
    let ids: Vec<&str> =
        whose.iter().map(|patient| patient.map_or("", |patient| &patient.id)).collect();
    give_way(transaction, scan, &json!(ids).to_string())?;
    for patient in whose {
        for_whom(transaction, scan, patient, stores)?;
    }
    withdrawal::apply(transaction, scan)?;
    finish_if_done(transaction, scan)
}

/// Marks the deliveries to other patients as unwanted. One that was made must be withdrawn. One that was
/// pending or refused may be running, or may have been made anyway. The delivered unassigned record is
/// left out: it is withdrawn when a patient has the record, and until then it is the keeper for others.
fn give_way(transaction: &Transaction<'_>, scan: &ScanId, ids: &str) -> Result<(), JournalError> {
    transaction.execute(
        &format!(
            "UPDATE deliveries SET code = ?3
             WHERE sha256 = ?1 AND patient NOT IN (SELECT value FROM json_each(?2)) AND patient <> ''
                   AND state = 'delivered' AND coalesce(code, '') NOT IN {UNWANTED}"
        ),
        [scan.as_str(), ids, UNASSIGNED],
    )?;
    run(
        transaction,
        "UPDATE deliveries SET state = 'delivered', code = ?3, next_at = NULL
         WHERE sha256 = ?1 AND patient NOT IN (SELECT value FROM json_each(?2))
               AND state IN ('pending', 'refused')",
        [scan.as_str(), ids, SUPERSEDED],
    )
}

/// Enters the deliveries of a scan to the patient an operator assigned it to.
pub(super) fn for_whom(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    patient: Option<&Patient>,
    stores: &[&str],
) -> Result<(), JournalError> {
    let state = state_of(transaction, scan)?;
    let delivery = match state {
        // It stays refused until an operator retries it, now for this patient.
        ScanState::Refused => DeliveryState::Refused,
        ScanState::Spooled | ScanState::Delivered => DeliveryState::Pending,
    };
    // A record of this patient that was to be withdrawn stays.
    let id = patient.map_or("", |patient| &patient.id);
    transaction.execute(
        "UPDATE deliveries SET code = NULL
         WHERE sha256 = ?1 AND patient = ?2 AND state = 'delivered' AND code IN (?3, ?4)",
        params![scan.as_str(), id, UNASSIGNED, HANDED_OVER],
    )?;
    for store in stores {
        insert_delivery(transaction, scan, patient, store, delivery, None)?;
    }
    if state == ScanState::Delivered && count(transaction, scan, DeliveryState::Pending)? > 0 {
        reopen(transaction, scan)?;
    }
    Ok(())
}

fn reopen(transaction: &Transaction<'_>, scan: &ScanId) -> Result<(), JournalError> {
    let state = state_of(transaction, scan)?.after(ScanStep::Reopen)?;
    set_state(transaction, scan, state)
}
