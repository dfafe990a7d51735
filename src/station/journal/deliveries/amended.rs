//! Records that were amended after they were handed over: a store that keeps its own copy, such as practice
//! software, is given the latest revision again.
//!
//! `amended` of a delivery is [`BEGUN`] before the revision is written and [`DUE`] afterwards. A crash in
//! between leaves [`BEGUN`], and the next start makes it [`DUE`]: handing over a revision twice does nothing.

use std::path::Path;

use gaiter_flow::lifecycle::REVISION_REFUSED;
use gaiter_flow::{DeliveryState, ScanId};
use rusqlite::params;
use serde_json::json;

use super::super::delivery_row::detail;
use super::super::row::{first, run, value};
use super::super::withdrawal::UNWANTED;
use super::super::{Due, Event, Journal, JournalError, history};
use crate::store::FolderStore;

/// The revision is being written: a crash may leave it unwritten.
const BEGUN: &str = "begun";

/// The latest revision is to be handed over.
pub(super) const DUE: &str = "due";

/// A revision that a store was given.
#[derive(Debug, Clone, Copy)]
pub struct GivenRevision<'a> {
    /// Its number.
    pub revision: u32,
    /// Where it is there, from the store's receipt.
    pub place: &'a Path,
}

impl Journal {
    /// Notes, before the revision is written, that these stores will have to be given it: also those that
    /// have not been given the record yet, because that delivery has only what was measured.
    pub fn amend_begun(
        &self,
        scan: &ScanId,
        patient: &str,
        stores: &[&str],
    ) -> Result<(), JournalError> {
        let noted = "UPDATE deliveries SET amended = ?4
                     WHERE sha256 = ?1 AND patient = ?2 AND store IN (SELECT value FROM json_each(?3))
                           AND state IN ('delivered', 'pending')";
        let stores = json!(stores).to_string();
        run(&self.connection(), noted, [scan.as_str(), patient, &stores, BEGUN])
    }

    /// Notes that the revision is written, or that it could not be. `measures` are those that a person set.
    pub fn amend_ended(
        &self,
        scan: &ScanId,
        patient: &str,
        measures: &[String],
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            transaction.execute(
                "UPDATE deliveries SET amended = ?3, attempts = 0, next_at = NULL, code = nullif(code, ?5)
                 WHERE sha256 = ?1 AND patient = ?2 AND amended = ?4",
                [scan.as_str(), patient, DUE, BEGUN, REVISION_REFUSED],
            )?;
            if measures.is_empty() {
                return Ok(());
            }
            let detail = json!({ "patient": patient, "by": "operator", "measures": measures });
            history::append(transaction, Some(scan), Event::Amended, &detail)
        })
    }

    /// Notes that the record of a scan of this patient was found to have been amended: every store that keeps
    /// its own copy is to be given the latest revision.
    pub fn found_amended(&self, scan: &ScanId, patient: &str) -> Result<(), JournalError> {
        let noted = "UPDATE deliveries SET amended = ?3
                     WHERE sha256 = ?1 AND patient = ?2 AND store <> ?4 AND state = 'delivered'";
        run(&self.connection(), noted, [scan.as_str(), patient, DUE, FolderStore::FIRST])
    }

    /// The folder of a patient's record in the folder store; `None` if it is not there.
    pub fn record_folder(
        &self,
        scan: &ScanId,
        patient: &str,
    ) -> Result<Option<String>, JournalError> {
        let found = "SELECT folder FROM deliveries
                     WHERE sha256 = ?1 AND patient = ?2 AND store = ?3 AND state = 'delivered'";
        let cells = [scan.as_str(), patient, FolderStore::FIRST];
        let found: Option<Option<String>> =
            first(&self.connection(), found, cells, |row| Ok(row.get(0)?))?;
        Ok(found.flatten())
    }

    /// Notes whether the record of a scan of one patient still lacks measures.
    pub fn still_lacks_measures(&self, scan: &ScanId, lacks: bool) -> Result<(), JournalError> {
        let noted = format!(
            "UPDATE scans SET incomplete = ?2 WHERE sha256 = ?1
             AND (SELECT count(DISTINCT patient) FROM deliveries
                  WHERE sha256 = ?1 AND state = ?3 AND coalesce(code, '') NOT IN {UNWANTED}) = 1"
        );
        let cells = params![scan.as_str(), lacks, DeliveryState::Delivered.word()];
        run(&self.connection(), &noted, cells)
    }

    /// Makes due what a crash left begun.
    pub fn resume_amending(&self) -> Result<(), JournalError> {
        let resumed = "UPDATE deliveries SET amended = ?1 WHERE amended = ?2";
        run(&self.connection(), resumed, [DUE, BEGUN])
    }

    /// Notes that a store does not take the latest revision, for this reason: a person must know that it has an
    /// earlier one. It is offered again until it is taken.
    pub fn revision_refused(&self, due: &Due, code: &str) -> Result<(), JournalError> {
        self.change(|transaction| {
            let is_new = transaction.execute(
                "UPDATE deliveries SET code = ?5
                 WHERE sha256 = ?1 AND patient = ?2 AND store = ?3 AND amended = ?4
                       AND state = 'delivered' AND code IS NULL",
                [due.scan.as_str(), due.patient_cell(), &due.store, DUE, REVISION_REFUSED],
            )? > 0;
            if !is_new {
                return Ok(());
            }
            let mut detail = detail(due);
            detail["code"] = code.into();
            history::append(transaction, Some(&due.scan), Event::Refused, &detail)
        })
    }

    /// Reports whether a store is still to be given the latest revision of the record of a scan.
    pub fn owes_revision(&self, scan: &ScanId) -> Result<bool, JournalError> {
        let owes = format!(
            "SELECT EXISTS (SELECT 1 FROM deliveries WHERE sha256 = ?1 AND amended = ?2
                            AND state = 'delivered' AND coalesce(code, '') NOT IN {UNWANTED})"
        );
        value(&self.connection(), &owes, [scan.as_str(), DUE])
    }

    /// Notes that a store has the latest revision, and its receipt; `None` if there is none to hand over.
    pub fn handed_over(
        &self,
        due: &Due,
        given: Option<GivenRevision<'_>>,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            // A revision that was begun meanwhile stays noted.
            transaction.execute(
                "UPDATE deliveries SET amended = '', attempts = 0, next_at = NULL, code = nullif(code, ?5)
                 WHERE sha256 = ?1 AND patient = ?2 AND store = ?3 AND amended = ?4",
                [due.scan.as_str(), due.patient_cell(), &due.store, DUE, REVISION_REFUSED],
            )?;
            let Some(GivenRevision { revision, place }) = given else { return Ok(()) };
            transaction.execute(
                "UPDATE deliveries SET folder = ?4
                 WHERE sha256 = ?1 AND patient = ?2 AND store = ?3
                       AND store IN (SELECT name FROM servers)",
                [due.scan.as_str(), due.patient_cell(), &due.store, &place.to_string_lossy()],
            )?;
            let mut detail = detail(due);
            detail["revision"] = revision.into();
            history::append(transaction, Some(&due.scan), Event::Delivered, &detail)
        })
    }
}
