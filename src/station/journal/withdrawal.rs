//! Which records are to be withdrawn: one rule for a scan and a store, applied with every change of its
//! deliveries. So whatever an operator decides while deliveries are running, and in whatever order these
//! end, in the end a record is only with those the scan belongs to.
//!
//! A delivery becomes unwanted by its code, while its state shows what the store may hold: `delivered` with
//! [`UNASSIGNED`] was made; `delivered` with [`SUPERSEDED`] may be running, or may have been made by a run
//! that ended before it could record that. Both are withdrawn as soon as the store holds a record that is
//! wanted, so that a folder always has one of the scan; at a server at once, because others treat the wrong
//! patient by it. Withdrawing a record that is not there does nothing.

pub(super) mod places;

use std::path::Path;

use gaiter_flow::lifecycle::{HANDED_OVER, SUPERSEDED, UNASSIGNED};
use gaiter_flow::{DeliveryState, DeliveryStep, ScanId};
use gaiter_record::Patient;
use jiff::Timestamp;
use rusqlite::{Transaction, params};
use serde_json::json;

use super::delivery_row::{delivery_state, detail, step, update};
use super::row::{all, cell, first, patient_id, run, scan_id, time, value};
use super::scans::insert_delivery;
use super::{Due, Event, Journal, JournalError, history};

/// The code of a record that was to be withdrawn but was changed by hand, or has something in its way, so
/// that it stays.
pub const KEPT: &str = "record-kept";

/// SQL: [`UNASSIGNED`], [`SUPERSEDED`] and [`HANDED_OVER`], the codes of unwanted deliveries.
pub(super) const UNWANTED: &str = "('unassigned', 'superseded', 'result-handed-over')";

/// The names of the stores that are servers, see [`Journal::with_servers`], for this connection alone; nothing of
/// it is in the file.
pub(super) const SERVERS: &str = "CREATE TEMP TABLE servers (name TEXT)";

/// Marks what is to be withdrawn now from every store that has a scan: each unwanted record, and the
/// unassigned one if a patient has the record, once the store holds another record that is wanted; each
/// unwanted one of a server.
pub(super) fn apply(transaction: &Transaction<'_>, scan: &ScanId) -> Result<(), JournalError> {
    let withdrawing = DeliveryState::Delivered.after(DeliveryStep::Withdraw)?;
    run(
        transaction,
        &format!(
            "UPDATE deliveries SET state = ?2, code = NULL, attempts = 0, next_at = NULL,
                    changed_at = ?3
             WHERE sha256 = ?1 AND state = 'delivered'
                   AND (code IN (?4, ?5)
                        OR patient = '' AND coalesce(code, '') NOT IN {UNWANTED})
                   AND (store IN (SELECT name FROM servers)
                        OR EXISTS (SELECT 1 FROM deliveries AS keeper
                                   WHERE keeper.sha256 = deliveries.sha256
                                         AND keeper.store = deliveries.store
                                         AND keeper.patient <> deliveries.patient
                                         AND keeper.state = 'delivered'
                                         AND coalesce(keeper.code, '') NOT IN {UNWANTED}))"
        ),
        params![
            scan.as_str(),
            withdrawing.word(),
            Timestamp::now().to_string(),
            UNASSIGNED,
            SUPERSEDED
        ],
    )
}

/// What a receipt means for a delivery that may no longer be wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Overtaken {
    /// It is wanted: no decision has changed it.
    No,
    /// The scan was refused meanwhile at another store or for another patient, but this record is in its
    /// store.
    Refused,
    /// It is no longer wanted.
    Unwanted,
}

/// Whether a decision overtook a delivery while it was running.
pub(super) fn overtaken(
    transaction: &Transaction<'_>,
    due: &Due,
) -> Result<Overtaken, JournalError> {
    let found = first(
        transaction,
        &format!(
            "SELECT state, coalesce(code, '') IN {UNWANTED} FROM deliveries
             WHERE sha256 = ?1 AND patient = ?2 AND store = ?3"
        ),
        [due.scan.as_str(), due.patient_cell(), &due.store],
        |row| Ok((cell(row, 0, DeliveryState::of_word)?, row.get(1)?)),
    )?;
    let Some((state, is_unwanted)) = found else { return Ok(Overtaken::Unwanted) };
    Ok(match state {
        DeliveryState::Withdrawing | DeliveryState::Withdrawn => Overtaken::Unwanted,
        DeliveryState::Delivered if is_unwanted => Overtaken::Unwanted,
        DeliveryState::Refused => Overtaken::Refused,
        DeliveryState::Pending | DeliveryState::Delivered | DeliveryState::Held => Overtaken::No,
    })
}

/// Marks a record that is in a store but must not be there: it is to be withdrawn.
pub(super) fn made_in_vain(
    transaction: &Transaction<'_>,
    due: &Due,
    folder: &Path,
) -> Result<(), JournalError> {
    let (scan, patient, delivered) = (&due.scan, due.patient.as_ref(), DeliveryState::Delivered);
    insert_delivery(transaction, scan, patient, &due.store, delivered, Some(UNASSIGNED))?;
    let set = "state = ?4, code = ?5, next_at = NULL, folder = ?6";
    update(transaction, due, set, &[&delivered.word(), &UNASSIGNED, &folder.to_string_lossy()])
}

impl Journal {
    /// The same, with the names of the stores that are servers.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn with_servers(self, servers: &[&str]) -> Result<Journal, JournalError> {
        for name in servers {
            self.connection().execute("INSERT INTO servers (name) VALUES (?1)", [name])?;
        }
        Ok(self)
    }

    /// Enters that each server may have the record of a scan for a patient, where the journal does not know:
    /// after its loss, because servers are not searched. Nothing is sent for that; but a later revision is, and
    /// a record that is not wanted there is withdrawn.
    pub fn may_be_at_servers(
        &self,
        scan: &ScanId,
        patient: &Patient,
        is_wanted: bool,
    ) -> Result<(), JournalError> {
        let (delivered, code) = (DeliveryState::Delivered, (!is_wanted).then_some(UNASSIGNED));
        self.change(|transaction| {
            let unknown = "SELECT name FROM servers
                           WHERE NOT EXISTS (SELECT 1 FROM deliveries
                                             WHERE sha256 = ?1 AND patient = ?2 AND store = name)";
            let cells = [scan.as_str(), &patient.id];
            let servers: Vec<String> = all(transaction, unknown, cells, |row| Ok(row.get(0)?))?;
            for server in servers {
                insert_delivery(transaction, scan, Some(patient), &server, delivered, code)?;
            }
            apply(transaction, scan)
        })
    }

    /// Applies the rule to every scan that may have an unwanted record in a store: at a start no
    /// delivery is running.
    pub fn take_back_unwanted(&self) -> Result<(), JournalError> {
        self.change(|transaction| {
            let unwanted = "SELECT DISTINCT sha256 FROM deliveries
                            WHERE state = 'delivered' AND code IN (?1, ?2)";
            let scans =
                all(transaction, unwanted, [UNASSIGNED, SUPERSEDED], |row| scan_id(row, 0))?;
            scans.iter().try_for_each(|scan| apply(transaction, scan))
        })
    }

    /// Reports whether a delivery is still to be made: no decision has changed it since it began.
    pub fn is_to_be_made(&self, due: &Due) -> Result<bool, JournalError> {
        Ok(delivery_state(&self.connection(), due)? == Some(DeliveryState::Pending))
    }

    /// When it was decided that a record is to be withdrawn, of one that is.
    pub fn withdrawing_since(&self, due: &Due) -> Result<Option<Timestamp>, JournalError> {
        let since = "SELECT changed_at FROM deliveries
                     WHERE sha256 = ?1 AND patient = ?2 AND store = ?3 AND state = 'withdrawing'";
        let cells = [due.scan.as_str(), due.patient_cell(), &due.store];
        first(&self.connection(), since, cells, |row| time(row, 0))
    }

    /// Records that the record is gone from the store.
    pub fn withdrawn(&self, due: &Due) -> Result<(), JournalError> {
        self.left(due, DeliveryStep::Gone, None)
    }

    /// Records that the store gives nothing back: the record stays until the operator removes it.
    pub fn left_there(&self, due: &Due) -> Result<(), JournalError> {
        self.left(due, DeliveryStep::Keep, Some(HANDED_OVER))
    }

    fn left(&self, due: &Due, by: DeliveryStep, code: Option<&str>) -> Result<(), JournalError> {
        self.change(|transaction| {
            if delivery_state(transaction, due)? != Some(DeliveryState::Withdrawing) {
                // A decision made while this was running changed it: it is to be made again.
                return Ok(());
            }
            step(transaction, due, by, None)?;
            let mut detail = detail(due);
            if let Some(code) = code {
                update(transaction, due, "code = ?4", &[&code])?;
                detail["code"] = json!(code);
            }
            history::append(transaction, Some(&due.scan), Event::Withdrawn, &detail)
        })
    }

    /// The patient who keeps the record of a scan in a store when another record is withdrawn. Outer
    /// `None` while no one has it, inner `None` for the folder of unassigned scans.
    pub fn keeper(
        &self,
        scan: &ScanId,
        store: &str,
    ) -> Result<Option<Option<String>>, JournalError> {
        let keeper = format!(
            "SELECT patient FROM deliveries
             WHERE sha256 = ?1 AND store = ?2 AND state = ?3
                   AND coalesce(code, '') NOT IN {UNWANTED}
             ORDER BY patient = '', changed_at LIMIT 1"
        );
        let cells = [scan.as_str(), store, DeliveryState::Delivered.word()];
        first(&self.connection(), &keeper, cells, |row| patient_id(row, 0))
    }

    /// Reports whether a record that was to be withdrawn stays until a person has dealt with it.
    pub fn keeps_changed_records(&self) -> Result<bool, JournalError> {
        let kept = "SELECT EXISTS (SELECT 1 FROM deliveries WHERE state = ?1 AND code = ?2)";
        value(&self.connection(), kept, [DeliveryState::Withdrawing.word(), KEPT])
    }
}

#[cfg(test)]
mod tests;
