//! What the journal knows of one person.

use std::collections::{BTreeMap, BTreeSet};

use gaiter_flow::account::Happened;
use gaiter_flow::patient::erasure::{Owed, OwedStep};
use gaiter_flow::patient::naming::record_folder;
use gaiter_flow::patient::person::{PersonCapture, PersonDelivery, PersonEvent, WhoseScan};
use gaiter_flow::{DeliveryState, ScanId};
use gaiter_record::Source;
use jiff::Timestamp;
use rusqlite::Connection;
use serde_json::Value;

use crate::station::journal::acts::candidates;
use crate::station::journal::row::{all, if_any, json_cell, scan_id, time};
use crate::station::journal::withdrawal::UNWANTED;
use crate::station::journal::{Journal, JournalError, captures};

/// What stands for another patient's id where a person's data is disclosed.
const ANOTHER: &str = "(another patient)";

/// A scan that the journal connects with a person.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScanOfPerson {
    pub scan: ScanId,
    /// Whether it is theirs.
    pub whose: WhoseScan,
}

impl Journal {
    /// The scans that are or may be a person's, in the order in which they came.
    pub fn scans_of_person(&self, patient: &str) -> Result<Vec<ScanOfPerson>, JournalError> {
        let connection = self.connection();
        let theirs = "SELECT sha256 FROM scans
                      WHERE sha256 IN (SELECT sha256 FROM deliveries WHERE patient = ?1)
                            OR EXISTS (SELECT 1 FROM json_each(candidates) WHERE value = ?1)
                      ORDER BY first_seen, sha256";
        all(&connection, theirs, [patient], |row| {
            let scan = scan_id(row, 0)?;
            Ok(ScanOfPerson { whose: whose(&connection, &scan, patient)?, scan })
        })
    }

    /// The deliveries of a scan for a person.
    pub fn deliveries_of_person(
        &self,
        scan: &ScanId,
        patient: &str,
    ) -> Result<Vec<PersonDelivery>, JournalError> {
        let theirs = "SELECT store, state, changed_at, folder, sources, places FROM deliveries
                      WHERE sha256 = ?1 AND patient = ?2 ORDER BY store";
        all(&self.connection(), theirs, [scan.as_str(), patient], |row| {
            let sources: Vec<Source> = json_cell(row, 4)?;
            Ok(PersonDelivery {
                store: row.get(0)?,
                state: row.get(1)?,
                at: if_any(row, 2, time)?,
                folder: row.get(3)?,
                sources: sources.iter().map(|source| source.kind).collect(),
                places: json_cell(row, 5)?,
            })
        })
    }

    /// What servers are owed, each with the patient's id: what is to be taken back there, and what was amended since.
    /// A server that is no longer in the configuration is known by its places.
    pub fn owed_to_servers(&self) -> Result<Vec<(String, Owed)>, JournalError> {
        let owed = format!(
            "SELECT patient, sha256, store, state, folder, places FROM deliveries
             WHERE (state = ?1
                    OR amended <> '' AND state = ?2 AND coalesce(code, '') NOT IN {UNWANTED})
                   AND (store IN (SELECT name FROM servers) OR places <> '{{}}')
             ORDER BY sha256, patient, store"
        );
        let withdrawing = DeliveryState::Withdrawing.word();
        let states = [withdrawing, DeliveryState::Delivered.word()];
        let found = all(&self.connection(), &owed, states, |row| {
            let (patient, sha256, store): (String, String, String) =
                (row.get(0)?, row.get(1)?, row.get(2)?);
            let is_withdrawing = row.get::<_, String>(3)? == withdrawing;
            let step = if is_withdrawing { OwedStep::TakeBack } else { OwedStep::Correct };
            let owed = |place: Option<String>, reference: Option<String>| {
                let (sha256, store) = (sha256.clone(), store.clone());
                (patient.clone(), Owed { sha256, store, step, place, reference })
            };
            let places: BTreeMap<String, String> = json_cell(row, 5)?;
            if places.is_empty() {
                return Ok(vec![owed(None, row.get(4)?)]);
            }
            let receipt = |text: String| Some(text).filter(|text| !text.is_empty());
            let places = places.into_iter();
            Ok(places.map(|(place, text)| owed(Some(place), receipt(text))).collect())
        })?;
        Ok(found.into_iter().flatten().collect())
    }

    /// The names of the folders of the records that a store was given for a person and must still hold, oldest first.
    pub fn delivered_for_person(
        &self,
        patient: &str,
        store: &str,
    ) -> Result<Vec<String>, JournalError> {
        let delivered = format!(
            "SELECT sha256, first_seen FROM deliveries JOIN scans USING (sha256)
             WHERE patient = ?1 AND store = ?2 AND deliveries.state = ?3
                   AND coalesce(deliveries.code, '') NOT IN {UNWANTED}
             ORDER BY first_seen, sha256"
        );
        let cells = [patient, store, DeliveryState::Delivered.word()];
        all(&self.connection(), &delivered, cells, |row| {
            Ok(record_folder(time(row, 1)?, &scan_id(row, 0)?))
        })
    }

    /// The waits for a person's scans. A name that waits for a press has the number 0.
    pub fn captures_of_person(&self, patient: &str) -> Result<Vec<PersonCapture>, JournalError> {
        let connection = self.connection();
        let theirs = "SELECT number, at, state FROM captures
                      WHERE patient = ?1 OR EXISTS (SELECT 1 FROM json_each(candidates)
                                                    WHERE json_extract(value, '$.id') = ?1)
                      ORDER BY number";
        let mut found = all(&connection, theirs, [patient], |row| {
            Ok(PersonCapture { number: row.get(0)?, at: time(row, 1)?, state: row.get(2)? })
        })?;
        if captures::names_patient(&connection, patient)? {
            let at = Timestamp::now();
            found.push(PersonCapture { number: 0, at, state: "named".to_owned() });
        }
        Ok(found)
    }

    /// The history of a person and of these scans, which are theirs alone, oldest first. It names no other
    /// patient.
    pub fn history_of_person(
        &self,
        patient: &str,
        scans: &[ScanId],
    ) -> Result<Vec<PersonEvent>, JournalError> {
        let scans: BTreeSet<&str> = scans.iter().map(ScanId::as_str).collect();
        let written = Value::from(patient).to_string();
        let history =
            "SELECT scan, at, event, detail, instr(detail, ?1) > 0 FROM history ORDER BY seq";
        let found = all(&self.connection(), history, [&written], |row| {
            let (scan, is_named): (String, bool) = (row.get(0)?, row.get(4)?);
            if !is_named && !scans.contains(scan.as_str()) {
                return Ok(None);
            }
            let mut detail: Value = json_cell(row, 3)?;
            hide_others(&mut detail, patient);
            let detail = detail.to_string();
            let happened = Happened { at: row.get(1)?, event: row.get(2)?, detail };
            Ok(Some(PersonEvent { scan, happened }))
        })?;
        Ok(found.into_iter().flatten().collect())
    }

    /// The paths under which scans were seen.
    pub fn paths_of(&self, scan: &ScanId) -> Result<Vec<Vec<u8>>, JournalError> {
        let paths = "SELECT path FROM sightings WHERE sha256 = ?1 ORDER BY 1";
        all(&self.connection(), paths, [scan.as_str()], |row| Ok(row.get(0)?))
    }
}

/// Whether a scan is a person's.
fn whose(connection: &Connection, scan: &ScanId, patient: &str) -> Result<WhoseScan, JournalError> {
    let deliveries = format!(
        "SELECT patient, state = 'held' FROM deliveries
         WHERE sha256 = ?1 AND state NOT IN ('withdrawing', 'withdrawn')
               AND coalesce(code, '') NOT IN {UNWANTED}"
    );
    let deliveries: Vec<(String, bool)> =
        all(connection, &deliveries, [scan.as_str()], |row| Ok((row.get(0)?, row.get(1)?)))?;
    let (held, made): (Vec<_>, Vec<_>) = deliveries.into_iter().partition(|(_, held)| *held);
    let is_other = |id: &str| !id.is_empty() && id != patient;
    let has = made.iter().any(|(id, _)| id == patient);
    let others_have = made.iter().any(|(id, _)| is_other(id));
    let is_held = !held.is_empty();
    let mut candidates = candidates(connection, scan)?;
    candidates.extend(held.into_iter().map(|(id, _)| id));
    let may_be_others = candidates.iter().any(|id| is_other(id));
    let is_candidate = is_held && candidates.iter().any(|id| id == patient);
    let is_open = is_held && may_be_others;
    Ok(match (has, is_candidate) {
        (true, _) if others_have || is_open => WhoseScan::Shared,
        (true, _) => WhoseScan::Theirs,
        (false, true) if others_have || may_be_others => WhoseScan::Uncertain,
        (false, true) => WhoseScan::Theirs,
        (false, false) => WhoseScan::TakenBack,
    })
}

/// The keys of the history's details whose values are patients' ids.
const IDS: [&str; 4] = ["patient", "patients", "claims", "id"];

/// Puts a word in the place of every other patient's id.
fn hide_others(value: &mut Value, patient: &str) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                if IDS.contains(&key.as_str()) {
                    hide(value, patient);
                }
                hide_others(value, patient);
            }
        }
        Value::Array(values) => values.iter_mut().for_each(|value| hide_others(value, patient)),
        _ => {}
    }
}

fn hide(value: &mut Value, patient: &str) {
    match value {
        Value::String(id) if !id.is_empty() && id != patient => ANOTHER.clone_into(id),
        Value::Array(values) => values.iter_mut().for_each(|value| hide(value, patient)),
        _ => {}
    }
}
