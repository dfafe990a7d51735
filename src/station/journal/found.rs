//! Records that a store holds and the journal did not know, for example because it was lost.

use std::collections::BTreeSet;

use gaiter_flow::DeliveryState;
use gaiter_flow::lifecycle::UNASSIGNED;
use gaiter_flow::patient::identity::SAME_SCAN_OTHER_PATIENT;
use gaiter_record::Patient;
use rusqlite::{Transaction, params};
use serde_json::{Value, json};

use super::acts::belongs_to;
use super::deliveries::{close_superseded, finish_if_done};
use super::delivery_row::{delivery_state, detail, update};
use super::row::all;
use super::scans::{insert_delivery, insert_scan};
use super::withdrawal::{self, UNWANTED};
use super::{Due, Event, Journal, JournalError, ScanRow, Task, history};

/// A record that a store holds.
#[derive(Debug, Clone, Copy)]
pub struct FoundThere<'a> {
    pub row: &'a ScanRow,
    /// Its patient there; `None` if unassigned.
    pub patient: Option<&'a Patient>,
    pub store: &'a str,
    pub folder: &'a str,
}

impl FoundThere<'_> {
    /// The delivery that put it there.
    fn due(&self) -> Due {
        Due {
            scan: self.row.scan.clone(),
            patient: self.patient.cloned(),
            store: self.store.to_owned(),
            task: Task::Deliver,
            first_seen: self.row.first_seen,
            attempts: 0,
        }
    }

    fn detail(&self, number: Option<usize>) -> Value {
        let mut detail = detail(&self.due());
        if let Some(number) = number {
            detail["decision"] = Value::from(number);
        }
        detail
    }
}

impl Journal {
    /// Enters a record that a store holds and the journal did not know. Deliveries of the same scan to
    /// other patients, entered without knowing of it, are held, except those to `theirs`, who have the
    /// scan by an operator's decision. `number` is that of the last decision about the scan, if there is
    /// one.
    pub fn found(
        &self,
        found: &FoundThere<'_>,
        theirs: &BTreeSet<String>,
        number: Option<usize>,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            let scan = &found.row.scan;
            insert_scan(transaction, found.row)?;
            let known = delivery_state(transaction, &found.due())?;
            if known.is_some_and(|state| state != DeliveryState::Refused) {
                return Ok(());
            }
            enter_made(transaction, found, None)?;
            hold_others(transaction, found, theirs)?;
            close_superseded(transaction, &found.due())?;
            if number.is_some() {
                withdrawal::apply(transaction, scan)?;
            }
            finish_if_done(transaction, scan)?;
            history::append(transaction, Some(scan), Event::Found, &found.detail(number))
        })
    }

    /// Enters a record that a store holds for the wrong patient according to a decision. In each store
    /// that has it for another patient, the scan goes to these patients, or becomes unassigned if there
    /// are none. Without a number the bytes for that are missing, and the journal only notes that the
    /// record must not stay.
    pub fn found_against(
        &self,
        found: &FoundThere<'_>,
        patients: &[Patient],
        takers: &[&str],
        number: Option<usize>,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            let scan = &found.row.scan;
            insert_scan(transaction, found.row)?;
            enter_made(transaction, found, Some(UNASSIGNED))?;
            if number.is_some() {
                // Those that may hold an unwanted record of the scan.
                let unwanted = format!(
                    "SELECT DISTINCT store FROM deliveries WHERE sha256 = ?1
                     AND (state = 'withdrawing' OR state = 'delivered' AND code IN {UNWANTED})"
                );
                let stores: Vec<String> =
                    all(transaction, &unwanted, [scan.as_str()], |row| Ok(row.get(0)?))?;
                let is_there = |taker: &&str| stores.iter().any(|store| store == taker);
                let stores: Vec<&str> = takers.iter().copied().filter(is_there).collect();
                belongs_to(transaction, scan, patients, &stores)?;
            }
            history::append(transaction, Some(scan), Event::Found, &found.detail(number))
        })
    }
}

/// Enters the delivery that put a record in its place.
fn enter_made(
    transaction: &Transaction<'_>,
    found: &FoundThere<'_>,
    code: Option<&str>,
) -> Result<(), JournalError> {
    let (due, delivered) = (found.due(), DeliveryState::Delivered);
    transaction.execute(
        "DELETE FROM deliveries WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
        [due.scan.as_str(), due.patient_cell(), &due.store],
    )?;
    insert_delivery(transaction, &due.scan, found.patient, found.store, delivered, code)?;
    update(transaction, &due, "folder = ?4", &[&found.folder])
}

/// Corrects deliveries that were entered without knowing of a record: those to other patients are held,
/// and a pending unassigned one is dropped if the record names a patient.
fn hold_others(
    transaction: &Transaction<'_>,
    found: &FoundThere<'_>,
    theirs: &BTreeSet<String>,
) -> Result<(), JournalError> {
    let (scan, id) = (found.row.scan.as_str(), found.patient.map_or("", |patient| &patient.id));
    transaction.execute(
        "UPDATE deliveries SET state = ?3, code = ?4
         WHERE sha256 = ?1 AND patient <> ?2 AND patient <> '' AND state = ?5
               AND patient NOT IN (SELECT value FROM json_each(?6))",
        params![
            scan,
            id,
            DeliveryState::Held.word(),
            SAME_SCAN_OTHER_PATIENT,
            DeliveryState::Pending.word(),
            json!(theirs).to_string()
        ],
    )?;
    if !id.is_empty() {
        transaction.execute(
            "DELETE FROM deliveries WHERE sha256 = ?1 AND patient = '' AND state = ?2",
            [scan, DeliveryState::Pending.word()],
        )?;
    }
    Ok(())
}
