//! Seals. SQLite notices a page that makes no sense, but not a changed digit in a patient's id. So the cells
//! that hold whose a scan is and where its record goes have a checksum.

use gaiter_record::sha256;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, Row};

use crate::station::journal::JournalError;
use crate::station::journal::row::all;

/// Hexadecimal digits of a seal: a damaged row passes with a probability of 2⁻⁶⁴.
const DIGITS: usize = 16;

/// What the seals of a table cover.
pub(in crate::station::journal) struct Sealed {
    table: &'static str,
    /// SQL: the cells that a seal covers, in its order, and the seal itself.
    pub cells: &'static str,
    /// How many cells it covers.
    count: usize,
}

/// A scan's fixed cells.
pub(in crate::station::journal) const SCANS: Sealed = Sealed {
    table: "scans",
    cells: "sha256, format, size, first_seen, file_time, scans.seal",
    count: 5,
};

/// A delivery's fixed cells.
pub(in crate::station::journal) const DELIVERIES: Sealed = Sealed {
    table: "deliveries",
    cells: "sha256, patient, store, sources, deliveries.seal",
    count: 4,
};

/// The cells that hold whose scan a capture's export is.
pub(in crate::station::journal) const CAPTURES: Sealed = Sealed {
    table: "captures",
    cells: "'capture', number, patient, source, candidates, captures.seal",
    count: 5,
};

impl Sealed {
    /// Checks the seal of a row that begins with [`Sealed::cells`].
    pub fn check(&self, row: &Row<'_>) -> Result<(), JournalError> {
        let text = |column: usize| match row.get_ref(column)? {
            ValueRef::Null => Ok(String::new()),
            ValueRef::Integer(number) => Ok(number.to_string()),
            _ => row.get(column),
        };
        let cells: Vec<String> = (0..self.count).map(text).collect::<rusqlite::Result<_>>()?;
        let is_whole = row.get::<_, String>(self.count)? == of_cells(&cells);
        if is_whole { Ok(()) } else { Err(JournalError::Seal { table: self.table }) }
    }
}

/// The seal of these cells, '' for one without a value.
pub(in crate::station::journal) fn of_cells(cells: &[impl AsRef<str>]) -> String {
    let cells: Vec<&str> = cells.iter().map(AsRef::as_ref).collect();
    let mut digest = sha256(cells.join("\0").as_bytes());
    digest.truncate(DIGITS);
    digest
}

/// Checks every seal.
pub(in crate::station::journal) fn check_all(connection: &Connection) -> Result<(), JournalError> {
    for sealed in [SCANS, DELIVERIES, CAPTURES] {
        let rows = format!("SELECT {} FROM {}", sealed.cells, sealed.table);
        all(connection, &rows, [], |row| sealed.check(row))?;
    }
    Ok(())
}
