//! What became of each scan, kept beside it. Flow decides it from the scan and its deliveries, with every change.

use gaiter_flow::{DeliveryState, Disposition, ScanState};
use rusqlite::{Connection, Transaction};

use super::JournalError;
use super::row::{all, cell, first, run};
use super::withdrawal::UNWANTED;

/// Notes for [`decide_touched`], and for this connection alone, which scans its changes touch; nothing of it is in
/// the file. The table has no key: the conflict clause of the statement that fires a trigger would overrule the
/// trigger's own.
pub(super) const NOTED: &str = "
PRAGMA temp_store = MEMORY;
CREATE TEMP TABLE touched (sha256 TEXT);
CREATE TEMP TRIGGER scan_came AFTER INSERT ON main.scans
BEGIN INSERT INTO touched VALUES (NEW.sha256); END;
CREATE TEMP TRIGGER scan_changed AFTER UPDATE OF state, closed ON main.scans
BEGIN INSERT INTO touched VALUES (NEW.sha256); END;
CREATE TEMP TRIGGER delivery_came AFTER INSERT ON main.deliveries
BEGIN INSERT INTO touched VALUES (NEW.sha256); END;
CREATE TEMP TRIGGER delivery_changed AFTER UPDATE OF patient, state, code ON main.deliveries
BEGIN INSERT INTO touched VALUES (NEW.sha256); END;
CREATE TEMP TRIGGER delivery_went AFTER DELETE ON main.deliveries
BEGIN INSERT INTO touched VALUES (OLD.sha256); END;
";

/// Decides again about the scans that a change has touched.
pub(super) fn decide_touched(transaction: &Transaction<'_>) -> Result<(), JournalError> {
    if decide(transaction, "SELECT DISTINCT sha256 FROM touched")? {
        run(transaction, "DELETE FROM touched", [])?;
    }
    Ok(())
}

/// Decides about all scans: another version of gaiter may have decided otherwise.
pub(super) fn decide_all(transaction: &Transaction<'_>) -> Result<(), JournalError> {
    decide(transaction, "SELECT sha256 FROM scans").map(drop)
}

/// Decides about the scans of a query; whether there were any.
fn decide(transaction: &Transaction<'_>, which: &str) -> Result<bool, JournalError> {
    let scans: Vec<String> = all(transaction, which, [], |row| Ok(row.get(0)?))?;
    let keep = "UPDATE scans SET disposition = ?2 WHERE sha256 = ?1 AND disposition <> ?2";
    for scan in &scans {
        if let Some(found) = of_scan(transaction, scan)? {
            run(transaction, keep, [scan, found.word()])?;
        }
    }
    Ok(!scans.is_empty())
}

/// What became of a scan by the rows of it and its deliveries; `None` if it is not there any more.
pub(super) fn of_scan(
    connection: &Connection,
    scan: &str,
) -> Result<Option<Disposition>, JournalError> {
    let state = "SELECT state, closed IS NOT NULL FROM scans WHERE sha256 = ?1";
    let found = first(connection, state, [scan], |row| {
        Ok((cell(row, 0, ScanState::of_word)?, row.get(1)?))
    })?;
    let Some((state, is_closed)) = found else { return Ok(None) };
    let deliveries = format!(
        "SELECT state, patient <> '' AND state = 'delivered' AND coalesce(code, '') NOT IN {UNWANTED}
         FROM deliveries WHERE sha256 = ?1"
    );
    let deliveries = all(connection, &deliveries, [scan], |row| {
        Ok((cell(row, 0, DeliveryState::of_word)?, row.get(1)?))
    })?;
    Ok(Some(Disposition::from_states(state, is_closed, deliveries.into_iter())))
}

/// SQL: what became of a scan is one of these.
pub(super) fn is_one_of(wanted: impl Fn(Disposition) -> bool) -> String {
    let all = Disposition::ALL.into_iter().filter(|found| wanted(*found));
    let words: Vec<String> = all.map(|found| format!("'{}'", found.word())).collect();
    format!("disposition IN ({})", words.join(", "))
}
