//! Seals. SQLite notices a page that makes no sense, but not a changed digit in a patient's id. So the cells
//! that hold whose a scan is and where its record goes have a checksum.

use gaiter_record::sha256;
use rusqlite::Connection;

use crate::station::journal::JournalError;
use crate::station::journal::row::all;

/// Hexadecimal digits of a seal: a damaged row passes with a probability of 2⁻⁶⁴.
const DIGITS: usize = 16;

/// The seal of a scan's fixed cells.
pub(in crate::station::journal) fn of_scan(
    scan: &str,
    format: &str,
    size: i64,
    first_seen: &str,
    file_time: Option<&str>,
) -> String {
    seal(&[scan, format, &size.to_string(), first_seen, file_time.unwrap_or("")])
}

/// The seal of a delivery's fixed cells.
pub(in crate::station::journal) fn of_delivery(
    scan: &str,
    patient: &str,
    store: &str,
    sources: &str,
) -> String {
    seal(&[scan, patient, store, sources])
}

/// The seal of the cells that hold whose scan a capture's export is. `others` is JSON.
pub(in crate::station::journal) fn of_capture(
    number: i64,
    patient: &str,
    source: &str,
    others: &str,
) -> String {
    seal(&["capture", &number.to_string(), patient, source, others])
}

/// The seal of a text.
pub(in crate::station::journal) fn of_text(text: &str) -> String {
    seal(&[text])
}

fn seal(cells: &[&str]) -> String {
    let mut digest = sha256(cells.join("\0").as_bytes());
    digest.truncate(DIGITS);
    digest
}

/// Checks every seal.
pub(in crate::station::journal) fn check_all(connection: &Connection) -> Result<(), JournalError> {
    for (table, rows) in [
        ("scans", scans(connection)?),
        ("deliveries", deliveries(connection)?),
        ("captures", captures(connection)?),
    ] {
        if rows.iter().any(|(due, found)| due != found) {
            return Err(JournalError::Seal { table });
        }
    }
    Ok(())
}

/// Every scan's expected and actual seal.
fn scans(connection: &Connection) -> Result<Vec<(String, String)>, JournalError> {
    let rows = "SELECT sha256, format, size, first_seen, file_time, seal FROM scans";
    all(connection, rows, [], |row| {
        let (scan, format): (String, String) = (row.get(0)?, row.get(1)?);
        let (first_seen, file_time): (String, Option<String>) = (row.get(3)?, row.get(4)?);
        let due = of_scan(&scan, &format, row.get(2)?, &first_seen, file_time.as_deref());
        Ok((due, row.get(5)?))
    })
}

/// The same for every delivery.
fn deliveries(connection: &Connection) -> Result<Vec<(String, String)>, JournalError> {
    let rows = "SELECT sha256, patient, store, sources, seal FROM deliveries";
    all(connection, rows, [], |row| {
        let cell = |at| row.get::<_, String>(at);
        Ok((of_delivery(&cell(0)?, &cell(1)?, &cell(2)?, &cell(3)?), row.get(4)?))
    })
}

/// The same for every capture.
fn captures(connection: &Connection) -> Result<Vec<(String, String)>, JournalError> {
    // Reads all columns, so that a damaged column name shows now and not at the first press.
    let rows =
        "SELECT number, patient, source, seal, candidates, at, boot, opened_ms, until_ms, opener,
                       state, scan, refused, doubt
                FROM captures";
    all(connection, rows, [], |row| {
        let (patient, source, others): (String, String, String) =
            (row.get(1)?, row.get(2)?, row.get(4)?);
        Ok((of_capture(row.get(0)?, &patient, &source, &others), row.get(3)?))
    })
}
