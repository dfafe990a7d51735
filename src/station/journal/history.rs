//! The history: what happened to each scan and by whose word, append-only, each row's hash over
//! the row and the hash before it. It holds ids, never names.
//!
//! Beside the journal, `history.head` repeats the newest row's number and hash. It is written after
//! each commit and not synced, so it is never ahead of a journal that was not exchanged: a journal
//! behind its head is an older copy that somebody put back.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::{FileExt, OpenOptionsExt};
use std::path::Path;

use jiff::Timestamp;
use rusqlite::{Connection, OptionalExtension, Transaction, params};
use serde_json::Value;

use super::{Journal, JournalError};
use crate::flow::ScanId;
use crate::record::sha256;

/// What may happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// The journal was made, or brought to another schema.
    Schema,
    /// A scan came in for a patient or for nobody.
    Entered,
    /// The same bytes came in for another patient.
    Held,
    /// A record reached a store.
    Delivered,
    /// A record was found in a store when a lost journal was rebuilt.
    Found,
    /// A scan was refused.
    Refused,
    /// A person wanted it tried again.
    Retried,
    /// A person said that a held scan is this patient's.
    Released,
    /// A person said whose scan it is.
    Assigned,
    /// A record was taken back, for another one has it whose scan it is.
    Withdrawn,
    /// A person took a record back from a patient.
    Unassigned,
    /// The button was pressed.
    Pressed,
    /// Somebody named the patient of the next scan.
    Named,
    /// An export came for a press.
    Answered,
    /// No export came for a press, or nobody pressed for a name.
    Expired,
    /// A person called off what waited.
    CalledOff,
    /// A person paused the station.
    Paused,
    /// A person resumed it.
    Resumed,
    /// The journal was rebuilt from spool, quarantine and stores.
    Rebuilt,
    /// Rows that the configuration lets go were removed; the chain goes on from here.
    Pruned,
    /// A person said that it needs no decision any more.
    GivenUp,
    /// The same patient's next scan was delivered: it needs no decision any more.
    Superseded,
    /// The bytes of a refused scan were let go, as the configuration says.
    LetGo,
    /// Bytes that were lost came in again.
    TakenAgain,
    /// What was decided before was carried out by a journal that did not know it.
    CarriedOut,
}

impl Event {
    /// The word in the journal.
    pub fn word(self) -> &'static str {
        match self {
            Event::Schema => "schema",
            Event::Entered => "entered",
            Event::Held => "held",
            Event::Delivered => "delivered",
            Event::Found => "found",
            Event::Refused => "refused",
            Event::Retried => "retried",
            Event::Released => "released",
            Event::Assigned => "assigned",
            Event::Withdrawn => "withdrawn",
            Event::Unassigned => "unassigned",
            Event::Pressed => "pressed",
            Event::Named => "named",
            Event::Answered => "answered",
            Event::Expired => "expired",
            Event::CalledOff => "called-off",
            Event::Paused => "paused",
            Event::Resumed => "resumed",
            Event::Rebuilt => "rebuilt",
            Event::Pruned => "pruned",
            Event::GivenUp => "given-up",
            Event::Superseded => "superseded",
            Event::LetGo => "let-go",
            Event::TakenAgain => "taken-again",
            Event::CarriedOut => "carried-out",
        }
    }
}

/// One row of a scan's history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryRow {
    /// When, UTC.
    pub at: String,
    /// What happened.
    pub event: String,
    /// Its details, JSON.
    pub detail: String,
}

/// The newest row: its number and hash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Head {
    pub seq: i64,
    pub hash: String,
}

/// Appends a row within a transaction.
pub(super) fn append(
    transaction: &Transaction<'_>,
    scan: Option<&ScanId>,
    event: Event,
    detail: &Value,
) -> Result<(), JournalError> {
    let head = newest(transaction)?;
    let (before, seq) = head.map_or((String::new(), 1), |head| (head.hash, head.seq + 1));
    let (at, scan) = (Timestamp::now().to_string(), scan.map_or("", ScanId::as_str));
    let (event, detail) = (event.word(), detail.to_string());
    let hash = hash(&before, seq, &at, scan, event, &detail);
    transaction
        .prepare_cached(
            "INSERT INTO history (seq, at, scan, event, detail, hash)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
        )?
        .execute(params![seq, at, scan, event, detail, hash])?;
    Ok(())
}

/// The newest row; none in a journal without history.
pub(super) fn newest(connection: &Connection) -> Result<Option<Head>, JournalError> {
    Ok(connection
        .prepare_cached("SELECT seq, hash FROM history ORDER BY seq DESC LIMIT 1")?
        .query_row([], |row| Ok(Head { seq: row.get(0)?, hash: row.get(1)? }))
        .optional()?)
}

/// Removes all rows before one; the chain goes on from it.
pub(super) fn cut(transaction: &Transaction<'_>, before: i64) -> Result<(), JournalError> {
    transaction.execute_batch("DROP TRIGGER history_is_not_cut")?;
    transaction.execute("DELETE FROM history WHERE seq < ?1", [before])?;
    Ok(transaction.execute_batch(NOT_CUT)?)
}

/// Keeps rows of the history from being removed but by [`cut`].
pub(super) const NOT_CUT: &str = "
CREATE TRIGGER history_is_not_cut BEFORE DELETE ON history
BEGIN SELECT RAISE(ABORT, 'the history is append-only'); END;
";

/// Checks the chain from its first row, which may be any: older ones may have been pruned.
pub(super) fn check(connection: &Connection) -> Result<(), JournalError> {
    let mut query = connection
        .prepare("SELECT seq, at, scan, event, detail, hash FROM history ORDER BY seq")?;
    let mut rows = query.query([])?;
    let mut before: Option<Head> = None;
    while let Some(row) = rows.next()? {
        let (seq, found): (i64, String) = (row.get(0)?, row.get(5)?);
        let cell = |at| row.get::<_, String>(at);
        let link = match &before {
            Some(before) if seq != before.seq + 1 => return Err(JournalError::Chain { seq }),
            Some(before) => Some(before.hash.as_str()),
            None => (seq == 1).then_some(""),
        };
        if let Some(before) = link
            && found != hash(before, seq, &cell(1)?, &cell(2)?, &cell(3)?, &cell(4)?)
        {
            return Err(JournalError::Chain { seq });
        }
        before = Some(Head { seq, hash: found });
    }
    Ok(())
}

fn hash(before: &str, seq: i64, at: &str, scan: &str, event: &str, detail: &str) -> String {
    sha256(format!("{before}\n{seq}\n{at}\n{scan}\n{event}\n{detail}").as_bytes())
}

/// `history.head`.
#[derive(Debug)]
pub(super) struct HeadFile(File);

impl HeadFile {
    /// Opens the file beside a journal, made if there is none.
    pub fn open(journal: &Path) -> io::Result<HeadFile> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false).mode(0o600);
        Ok(HeadFile(options.open(journal.with_file_name("history.head"))?))
    }

    /// What it says; none where it says nothing that can be read.
    pub fn read(&self) -> io::Result<Option<Head>> {
        let mut text = [0; 128];
        let length = self.0.read_at(&mut text, 0)?;
        let text = String::from_utf8_lossy(&text[..length]).into_owned();
        let head = text.lines().next().and_then(|line| line.rsplit_once(' '));
        Ok(head.and_then(|(seq, hash)| {
            Some(Head { seq: seq.trim().parse().ok()?, hash: hash.to_owned() })
        }))
    }

    /// Writes the newest row's number and hash over the old ones, always as many bytes.
    pub fn write(&self, head: &Head) -> io::Result<()> {
        self.0.write_all_at(format!("{:>20} {}\n", head.seq, head.hash).as_bytes(), 0)
    }
}

/// Whether the journal lacks what its head says was committed.
pub(super) fn is_behind(connection: &Connection, head: &Head) -> Result<bool, JournalError> {
    let found: Option<String> = connection
        .query_row("SELECT hash FROM history WHERE seq = ?1", [head.seq], |row| row.get(0))
        .optional()?;
    let newest = newest(connection)?.map_or(0, |newest| newest.seq);
    // A row that was pruned is older than the oldest, not newer than the newest.
    Ok(found.map_or(newest < head.seq, |found| found != head.hash))
}

impl Journal {
    /// What happened to a scan, oldest first.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn history(&self, scan: &ScanId) -> Result<Vec<HistoryRow>, JournalError> {
        let connection = self.connection();
        let mut query = connection
            .prepare_cached("SELECT at, event, detail FROM history WHERE scan = ?1 ORDER BY seq")?;
        let rows = query.query_map([scan.as_str()], |row| {
            Ok(HistoryRow { at: row.get(0)?, event: row.get(1)?, detail: row.get(2)? })
        })?;
        Ok(rows.collect::<rusqlite::Result<_>>()?)
    }
}
