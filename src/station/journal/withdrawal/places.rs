//! Where servers have a record, or may have it. The address of a server may be changed while it has one: the record
//! is withdrawn where it is, and not counted as withdrawn because another server does not have it.

use std::collections::BTreeMap;
use std::path::Path;

use gaiter_flow::{DeliveryState, ScanId};
use rusqlite::Connection;

use crate::station::journal::delivery_row::update;
use crate::station::journal::meta::BEGUN;
use crate::station::journal::row::{all, count, first, json_cell, json_text};
use crate::station::journal::{Due, Event, Journal, JournalError, history};

impl Journal {
    /// Notes that a server at this place may have the record of a delivery from now on; with its receipt, that it has.
    pub fn put_at(
        &self,
        due: &Due,
        place: &str,
        receipt: Option<&Path>,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            let before = places(transaction, due)?;
            let mut places = before.clone();
            let known = places.entry(place.to_owned()).or_default();
            if let Some(receipt) = receipt {
                *known = receipt.to_string_lossy().into_owned();
            }
            if places == before {
                return Ok(());
            }
            update(transaction, due, "places = ?4", &[&json_text(&places)?])
        })
    }

    /// The places where servers have the record of a delivery, or may have it, each with its receipt, '' for none.
    /// Empty if no server was asked to take it, or if only a journal that was lost knew.
    pub fn places(&self, due: &Due) -> Result<BTreeMap<String, String>, JournalError> {
        places(&self.connection(), due)
    }

    /// Notes that the record is withdrawn from this place. Returns whether another is left.
    pub fn gone_from(&self, due: &Due, place: &str) -> Result<bool, JournalError> {
        self.change(|transaction| {
            let mut places = places(transaction, due)?;
            if places.remove(place).is_some() {
                update(transaction, due, "places = ?4", &[&json_text(&places)?])?;
            }
            Ok(!places.is_empty())
        })
    }

    /// Forgets, by a person's decision, the places of records of a scan that are to be withdrawn, except where their
    /// stores are now: there they are withdrawn. Returns whether there was any.
    pub fn withdraw_here(&self, scan: &ScanId) -> Result<bool, JournalError> {
        self.change(|transaction| {
            let withdrawing = DeliveryState::Withdrawing.word();
            let forgotten = transaction.execute(
                "UPDATE deliveries
                 SET places = (SELECT json_group_object(at.key, at.value)
                               FROM json_each(deliveries.places) AS at
                               WHERE at.key = (SELECT value FROM meta WHERE name = ?3 || store))
                 WHERE sha256 = ?1 AND state = ?2 AND EXISTS (
                     SELECT 1 FROM json_each(deliveries.places) AS at
                     WHERE at.key IS NOT (SELECT value FROM meta WHERE name = ?3 || store))",
                [scan.as_str(), withdrawing, BEGUN],
            )?;
            if forgotten > 0 {
                let detail = serde_json::json!({ "by": "operator", "withdrawn_here": forgotten });
                history::append(transaction, Some(scan), Event::Retried, &detail)?;
            }
            Ok(forgotten > 0)
        })
    }
}

fn places(connection: &Connection, due: &Due) -> Result<BTreeMap<String, String>, JournalError> {
    let places = "SELECT places FROM deliveries WHERE sha256 = ?1 AND patient = ?2 AND store = ?3";
    let cells = [due.scan.as_str(), due.patient_cell(), &due.store];
    Ok(first(connection, places, cells, |row| json_cell(row, 0))?.unwrap_or_default())
}

/// By store, how many records are to be withdrawn that are not where it is now.
pub(in crate::station::journal) fn elsewhere(
    connection: &Connection,
) -> Result<BTreeMap<String, u64>, JournalError> {
    let found = all(
        connection,
        "SELECT store, count(*) FROM deliveries
         WHERE state = ?1 AND places <> '{}'
               AND NOT EXISTS (SELECT 1 FROM json_each(deliveries.places) AS at
                               WHERE at.key = (SELECT value FROM meta WHERE name = ?2 || store))
         GROUP BY store",
        [DeliveryState::Withdrawing.word(), BEGUN],
        |row| Ok((row.get(0)?, count(row, 1)?)),
    )?;
    Ok(found.into_iter().collect())
}
