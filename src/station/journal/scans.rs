//! Scans in the journal, and whose they are said to be.

use jiff::Timestamp;
use rusqlite::{OptionalExtension, Transaction, params};

use super::{Journal, JournalError, cell};
use crate::flow::{DeliveryState, DeliveryStep, ScanId, ScanState, ScanStep};
use crate::record::Patient;

/// What the journal knows of a scan itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScanRow {
    /// The scan.
    pub scan: ScanId,
    /// Its format's file-name ending.
    pub format: String,
    /// Size, bytes.
    pub size: u64,
    /// When the station first saw it; fixed once.
    pub first_seen: Timestamp,
    /// Its file's own time.
    pub file_time: Option<Timestamp>,
    /// Where it is.
    pub state: ScanState,
}

impl Journal {
    /// What is known of a scan; none for one never seen.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn scan(&self, scan: &ScanId) -> Result<Option<ScanRow>, JournalError> {
        type Cells = (String, i64, String, Option<String>, String);
        let found: Option<Cells> = self
            .connection()
            .query_row(
                "SELECT format, size, first_seen, file_time, state FROM scans WHERE sha256 = ?1",
                [scan.as_str()],
                |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?)),
            )
            .optional()?;
        let Some((format, size, first_seen, file_time, state)) = found else { return Ok(None) };
        let time = |text: &str| text.parse().ok();
        Ok(Some(ScanRow {
            scan: scan.clone(),
            format,
            size: size.cast_unsigned(),
            first_seen: cell("first_seen", first_seen, time)?,
            file_time: file_time.map(|text| cell("file_time", text, time)).transpose()?,
            state: cell("state", state, ScanState::of_word)?,
        }))
    }

    /// All scans in a state.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn scans_in(&self, state: ScanState) -> Result<Vec<ScanId>, JournalError> {
        let connection = self.connection();
        let mut query =
            connection.prepare_cached("SELECT sha256 FROM scans WHERE state = ?1 ORDER BY 1")?;
        let rows = query.query_map([state.word()], |row| row.get(0))?;
        rows.map(|row| cell("sha256", row?, |text| ScanId::parse(text).ok())).collect()
    }

    /// The patients for whom a scan is known, held ones included; none stands for nobody named.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn patients(&self, scan: &ScanId) -> Result<Vec<Option<String>>, JournalError> {
        let connection = self.connection();
        let mut query =
            connection.prepare_cached("SELECT patient FROM deliveries WHERE sha256 = ?1")?;
        let rows = query.query_map([scan.as_str()], |row| row.get(0))?;
        rows.map(|row| Ok(Some(row?).filter(|id: &String| !id.is_empty()))).collect()
    }

    /// Enters a new scan and its delivery. A scan that comes in as spooled has its delivery
    /// pending; one that comes in as delivered is known by its spooled bytes only, and held.
    ///
    /// # Errors
    /// See [`JournalError`]; nothing is entered then.
    pub fn enter(
        &self,
        row: &ScanRow,
        patient: Option<&Patient>,
        store: &str,
        delivery: DeliveryState,
        code: Option<&str>,
    ) -> Result<(), JournalError> {
        let mut connection = self.connection();
        let transaction = connection.transaction()?;
        transaction.execute(
            "INSERT INTO scans (sha256, format, size, first_seen, file_time, state)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6)
             ON CONFLICT (sha256) DO NOTHING",
            params![
                row.scan.as_str(),
                row.format,
                row.size.cast_signed(),
                row.first_seen.to_string(),
                row.file_time.map(|time| time.to_string()),
                row.state.word(),
            ],
        )?;
        let sources = patient.map_or(&[][..], |patient| &patient.sources);
        let sources = serde_json::to_string(sources)
            .map_err(|error| rusqlite::Error::ToSqlConversionFailure(error.into()))?;
        transaction.execute(
            "INSERT INTO deliveries (sha256, patient, store, sources, state, code)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            params![
                row.scan.as_str(),
                patient.map_or("", |patient| &patient.id),
                store,
                sources,
                delivery.word(),
                code,
            ],
        )?;
        Ok(transaction.commit()?)
    }

    /// A scan was refused for good, and with it every delivery still to be made.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn refused(&self, scan: &ScanId, code: &str, message: &str) -> Result<(), JournalError> {
        let mut connection = self.connection();
        let transaction = connection.transaction()?;
        let state = state_of(&transaction, scan)?.after(ScanStep::Refuse)?;
        transaction.execute(
            "UPDATE scans SET state = ?2, code = ?3, message = ?4 WHERE sha256 = ?1",
            params![scan.as_str(), state.word(), code, message],
        )?;
        let pending = DeliveryState::Pending;
        transaction.execute(
            "UPDATE deliveries SET state = ?2, code = ?3, next_at = NULL
             WHERE sha256 = ?1 AND state = ?4",
            params![
                scan.as_str(),
                pending.after(DeliveryStep::Refuse)?.word(),
                code,
                pending.word()
            ],
        )?;
        Ok(transaction.commit()?)
    }
}

/// The state of a scan that must be known.
pub(super) fn state_of(
    transaction: &Transaction<'_>,
    scan: &ScanId,
) -> Result<ScanState, JournalError> {
    let word: Option<String> = transaction
        .query_row("SELECT state FROM scans WHERE sha256 = ?1", [scan.as_str()], |row| row.get(0))
        .optional()?;
    cell("state", word.ok_or(JournalError::Unknown { what: "scan" })?, ScanState::of_word)
}
