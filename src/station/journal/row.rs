//! How the journal's statements are asked, and how the cells of their rows are read.

use gaiter_flow::ScanId;
use jiff::Timestamp;
use rusqlite::types::{FromSql, ValueRef};
use rusqlite::{Connection, Params, Row, Statement};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::JournalError;

/// Executes a statement that finds no rows.
pub(super) fn run(
    connection: &Connection,
    sql: &str,
    cells: impl Params,
) -> Result<(), JournalError> {
    connection.prepare_cached(sql)?.execute(cells)?;
    Ok(())
}

/// All rows that a statement finds.
pub(super) fn all<T>(
    connection: &Connection,
    sql: &str,
    cells: impl Params,
    read: impl FnMut(&Row<'_>) -> Result<T, JournalError>,
) -> Result<Vec<T>, JournalError> {
    let mut query = connection.prepare_cached(sql)?;
    query.query_and_then(cells, read)?.collect()
}

/// The first row that a statement finds; `None` if it finds none.
pub(super) fn first<T>(
    connection: &Connection,
    sql: &str,
    cells: impl Params,
    read: impl FnOnce(&Row<'_>) -> Result<T, JournalError>,
) -> Result<Option<T>, JournalError> {
    let mut query = connection.prepare_cached(sql)?;
    let mut rows = query.query(cells)?;
    rows.next()?.map(read).transpose()
}

/// The one value that a statement finds.
pub(super) fn value<T: FromSql>(
    connection: &Connection,
    sql: &str,
    cells: impl Params,
) -> Result<T, JournalError> {
    let mut query = connection.prepare_cached(sql)?;
    Ok(query.query_row(cells, |row| row.get(0))?)
}

/// A cell's text, which must be what gaiter wrote there.
pub(super) fn cell<T>(
    row: &Row<'_>,
    column: usize,
    read: impl FnOnce(&str) -> Option<T>,
) -> Result<T, JournalError> {
    let found: String = row.get(column)?;
    read(&found).ok_or_else(|| {
        let statement: &Statement<'_> = row.as_ref();
        let column = statement.column_name(column).unwrap_or_default().to_owned();
        JournalError::Cell { column, found }
    })
}

/// A cell that may be empty.
pub(super) fn if_any<T>(
    row: &Row<'_>,
    column: usize,
    read: impl FnOnce(&Row<'_>, usize) -> Result<T, JournalError>,
) -> Result<Option<T>, JournalError> {
    match row.get_ref(column)? {
        ValueRef::Null => Ok(None),
        _ => read(row, column).map(Some),
    }
}

/// A cell that holds a scan's id.
pub(super) fn scan_id(row: &Row<'_>, column: usize) -> Result<ScanId, JournalError> {
    cell(row, column, ScanId::parse)
}

/// A cell that holds a patient's id, '' for none.
pub(super) fn patient_id(row: &Row<'_>, column: usize) -> Result<Option<String>, JournalError> {
    Ok(Some(row.get(column)?).filter(|id: &String| !id.is_empty()))
}

/// A cell that holds a time.
pub(super) fn time(row: &Row<'_>, column: usize) -> Result<Timestamp, JournalError> {
    cell(row, column, |text| text.parse().ok())
}

/// A cell that counts.
pub(super) fn count(row: &Row<'_>, column: usize) -> Result<u64, JournalError> {
    Ok(row.get::<_, i64>(column)?.cast_unsigned())
}

/// A cell that holds JSON.
pub(super) fn json_cell<T: DeserializeOwned>(
    row: &Row<'_>,
    column: usize,
) -> Result<T, JournalError> {
    cell(row, column, of_json)
}

/// The value of a JSON text; `None` if gaiter did not write it.
pub(super) fn of_json<T: DeserializeOwned>(text: &str) -> Option<T> {
    // As bytes, like all other JSON of the station: a second kind of reader is a second copy of each type's.
    serde_json::from_slice(text.as_bytes()).ok()
}

/// The text of a cell that holds JSON.
pub(super) fn json_text(value: &(impl Serialize + ?Sized)) -> Result<String, JournalError> {
    serde_json::to_string(value)
        .map_err(|error| rusqlite::Error::ToSqlConversionFailure(error.into()).into())
}
