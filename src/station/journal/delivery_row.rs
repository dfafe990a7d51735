//! One delivery in the journal: its state and its steps.

use gaiter_flow::{DeliveryState, DeliveryStep, ScanId};
use gaiter_record::Patient;
use jiff::Timestamp;
use rusqlite::{Connection, Row, ToSql, Transaction, params_from_iter};
use serde_json::json;

use super::JournalError;
use super::integrity::seal;
use super::row::{cell, first, json_cell, patient_id, run, scan_id, time, value};

/// A delivery to make or withdraw.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Due {
    pub scan: ScanId,
    /// Its patient; `None` if no patient was named.
    pub patient: Option<Patient>,
    pub store: String,
    /// What to do there.
    pub task: Task,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    pub attempts: u32,
}

/// What to do at a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Task {
    /// The record is to be put there.
    Deliver,
    /// The record was put there and amended since: its latest revision is to be put there, too.
    HandOver,
    /// The record there is to be withdrawn, because the scan's record is now where it belongs.
    Withdraw,
}

impl Due {
    /// The patient's id as the journal's column holds it.
    pub fn patient_cell(&self) -> &str {
        self.patient.as_ref().map_or("", |patient| &patient.id)
    }
}

/// SQL: the columns of a delivery and its scan, as [`due`] takes them.
pub(super) fn cells() -> String {
    format!("{}, first_seen, attempts", seal::DELIVERIES.cells)
}

/// A delivery and what to do with it.
pub(super) fn due(row: &Row<'_>, task: Task) -> Result<Due, JournalError> {
    // Checked again although the start checked all rows: this decides whose folder it goes to.
    seal::DELIVERIES.check(row)?;
    let sources = json_cell(row, 3)?;
    Ok(Due {
        scan: scan_id(row, 0)?,
        patient: patient_id(row, 1)?.map(|id| Patient { id, sources }),
        store: row.get(2)?,
        task,
        first_seen: time(row, 5)?,
        attempts: row.get(6)?,
    })
}

/// Updates the row of a delivery. `set` is SQL; its parameters from `?4` on are these cells.
pub(super) fn update(
    connection: &Connection,
    due: &Due,
    set: &str,
    cells: &[&dyn ToSql],
) -> Result<(), JournalError> {
    let key: [&dyn ToSql; 3] = [&due.scan.as_str(), &due.patient_cell(), &due.store];
    let update =
        format!("UPDATE deliveries SET {set} WHERE sha256 = ?1 AND patient = ?2 AND store = ?3");
    run(connection, &update, params_from_iter(key.iter().chain(cells)))
}

/// The details of a delivery for the history.
pub(super) fn detail(due: &Due) -> serde_json::Value {
    json!({ "patient": due.patient_cell(), "store": due.store })
}

/// How many deliveries of a scan are in a state.
pub(super) fn count(
    connection: &Connection,
    scan: &ScanId,
    state: DeliveryState,
) -> Result<i64, JournalError> {
    let counted = "SELECT count(*) FROM deliveries WHERE sha256 = ?1 AND state = ?2";
    value(connection, counted, [scan.as_str(), state.word()])
}

/// The state of a delivery; `None` if it does not exist.
pub(super) fn delivery_state(
    connection: &Connection,
    due: &Due,
) -> Result<Option<DeliveryState>, JournalError> {
    first(
        connection,
        "SELECT state FROM deliveries WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
        [due.scan.as_str(), due.patient_cell(), &due.store],
        |row| cell(row, 0, DeliveryState::of_word),
    )
}

/// Advances a delivery by one step.
pub(super) fn step(
    transaction: &Transaction<'_>,
    due: &Due,
    step: DeliveryStep,
    folder: Option<&str>,
) -> Result<(), JournalError> {
    let state = delivery_state(transaction, due)?;
    let state = state.ok_or(JournalError::Unknown { what: "delivery" })?.after(step)?;
    let set =
        "state = ?4, code = NULL, next_at = NULL, changed_at = ?5, folder = coalesce(?6, folder)";
    update(transaction, due, set, &[&state.word(), &Timestamp::now().to_string(), &folder])
}
