//! One delivery in the journal: its state, and a step on.

use jiff::Timestamp;
use rusqlite::{Connection, OptionalExtension, Transaction, params};
use serde_json::json;

use super::{Due, JournalError, cell};
use crate::flow::{DeliveryState, DeliveryStep, ScanId};

/// Says why a delivery is as it is.
pub(super) fn set_code(
    transaction: &Transaction<'_>,
    due: &Due,
    code: &str,
) -> Result<(), JournalError> {
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
    connection: &Connection,
    scan: &ScanId,
    state: DeliveryState,
) -> Result<i64, JournalError> {
    let mut query = connection
        .prepare_cached("SELECT count(*) FROM deliveries WHERE sha256 = ?1 AND state = ?2")?;
    Ok(query.query_row([scan.as_str(), state.word()], |row| row.get(0))?)
}

/// The state of a delivery; none where there is none.
pub(super) fn delivery_state(
    connection: &Connection,
    due: &Due,
) -> Result<Option<DeliveryState>, JournalError> {
    let word: Option<String> = connection
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
