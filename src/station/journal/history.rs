//! The history: what happened to each scan and by whose decision. It is append-only; each row's hash
//! covers the row and the hash before it. It holds ids, never names.
//!
//! Beside the journal, `history.head` repeats the newest row's number and hash. It is written after each
//! commit and not synced, so it is never ahead of the original journal: a journal behind its head is an
//! older copy that was put back. Each record folder keeps such a head too, in case the whole state folder
//! is an older copy.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;
use std::path::Path;

use gaiter_flow::ScanId;
use gaiter_flow::account::Happened;
use gaiter_record::sha256;
use jiff::Timestamp;
use rusqlite::{Connection, Transaction, params};
use serde_json::Value;

use super::row::{all, first, run};
use super::{Journal, JournalError, open_private};

gaiter_leg::word_enum! {
    /// The events of the history.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Event {
        /// The journal was created.
        Schema => "schema",
        /// A scan came in, with or without a patient.
        Entered => "entered",
        /// The same bytes came in for another patient.
        Held => "held",
        /// A record reached a store.
        Delivered => "delivered",
        /// A record was found in a store when a lost journal was rebuilt.
        Found => "found",
        /// A scan was refused.
        Refused => "refused",
        /// An operator retried it.
        Retried => "retried",
        /// An operator released a held scan to this patient.
        Released => "released",
        /// An operator assigned the scan to a patient.
        Assigned => "assigned",
        /// A record was withdrawn, because the scan's record is now where it belongs.
        Withdrawn => "withdrawn",
        /// An operator took a scan back from a patient.
        Unassigned => "unassigned",
        /// The button was pressed.
        Pressed => "pressed",
        /// The patient of the next scan was named.
        Named => "named",
        /// An export came for a press.
        Answered => "answered",
        /// No export came for a press, or no press came for a name.
        Expired => "expired",
        /// An operator cancelled what was waiting.
        CalledOff => "called-off",
        /// An operator paused the station.
        Paused => "paused",
        /// An operator resumed it.
        Resumed => "resumed",
        /// The journal was rebuilt from spool, quarantine and stores.
        Rebuilt => "rebuilt",
        /// Rows past their retention were removed; the chain continues from here.
        Pruned => "pruned",
        /// A person set measures of its record.
        Amended => "amended",
        /// A person named the affected leg of a patient, or took that back.
        AffectedNamed => "affected-named",
        /// An operator gave it up: it needs no further decision.
        GivenUp => "given-up",
        /// The same patient's next scan was delivered: it needs no further decision.
        Superseded => "superseded",
        /// Retention deleted the bytes of a refused scan.
        LetGo => "let-go",
        /// Lost bytes came in again.
        TakenAgain => "taken-again",
        /// An earlier decision was carried out by a journal that did not know it.
        CarriedOut => "carried-out",
        /// All that the station holds of a person was disclosed.
        Disclosed => "disclosed",
        /// All that the station holds of a person is to be erased.
        Erasing => "erasing",
        /// The station's own folder holds nothing of a person any more.
        Erased => "erased",
        /// Nothing is left to be erased of a person, in the stores neither.
        ErasureEnded => "erasure-ended",
    }
}

/// The newest row: its number and hash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Head {
    pub seq: i64,
    pub hash: String,
}

impl Head {
    /// As a line whose length never changes, so that it can be overwritten in place.
    fn line(&self) -> String {
        format!("{:>20} {}\n", self.seq, self.hash)
    }

    /// From the first line of a text; `None` if it is not a valid head.
    fn read(text: &str) -> Option<Head> {
        let (seq, hash) = text.lines().next()?.rsplit_once(' ')?;
        Some(Head { seq: seq.trim().parse().ok()?, hash: hash.to_owned() })
    }
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
    let hash = hash([&before, &seq.to_string(), &at, scan, event, &detail]);
    run(
        transaction,
        "INSERT INTO history (seq, at, scan, event, detail, hash) VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
        params![seq, at, scan, event, detail, hash],
    )
}

/// The newest row; `None` in a journal without history.
pub(super) fn newest(connection: &Connection) -> Result<Option<Head>, JournalError> {
    let newest = "SELECT seq, hash FROM history ORDER BY seq DESC LIMIT 1";
    first(connection, newest, [], |row| Ok(Head { seq: row.get(0)?, hash: row.get(1)? }))
}

/// Removes all rows before one; the chain continues from that row.
pub(super) fn cut(transaction: &Transaction<'_>, before: i64) -> Result<(), JournalError> {
    transaction.execute_batch("DROP TRIGGER history_is_not_cut")?;
    transaction.execute("DELETE FROM history WHERE seq < ?1", [before])?;
    Ok(transaction.execute_batch(NOT_CUT)?)
}

/// Prevents rows of the history from being removed except by [`cut`].
pub(super) const NOT_CUT: &str = "
CREATE TRIGGER history_is_not_cut BEFORE DELETE ON history
BEGIN SELECT RAISE(ABORT, 'the history is append-only'); END;
";

/// Prevents rows of the history from being changed except by an erasure.
pub(super) const NOT_CHANGED: &str = "
CREATE TRIGGER history_is_not_changed BEFORE UPDATE ON history
BEGIN SELECT RAISE(ABORT, 'the history is append-only'); END;
";

/// The hash of a row; `None` if there is no such row.
pub(super) fn hash_of(connection: &Connection, seq: i64) -> Result<Option<String>, JournalError> {
    first(connection, "SELECT hash FROM history WHERE seq = ?1", [seq], |row| Ok(row.get(0)?))
}

/// Checks the chain from its first row, which may have any number: older rows may have been pruned.
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
            && found != hash([before, &seq.to_string(), &cell(1)?, &cell(2)?, &cell(3)?, &cell(4)?])
        {
            return Err(JournalError::Chain { seq });
        }
        before = Some(Head { seq, hash: found });
    }
    Ok(())
}

/// The hash of a row: of the hash before it, its number, time, scan, event and details.
pub(super) fn hash(row: [&str; 6]) -> String {
    sha256(row.join("\n").as_bytes())
}

/// `history.head`.
#[derive(Debug)]
pub(super) struct HeadFile(File);

impl HeadFile {
    /// Opens the file beside a journal, or creates it.
    pub fn open(journal: &Path) -> io::Result<HeadFile> {
        Ok(HeadFile(open_private(&journal.with_file_name("history.head"))?))
    }

    /// The content; `None` if it is not a valid head.
    pub fn read(&self) -> io::Result<Option<Head>> {
        let mut text = [0; 128];
        let length = self.0.read_at(&mut text, 0)?;
        Ok(Head::read(&String::from_utf8_lossy(&text[..length])))
    }

    /// As [`HeadFile::write`]; durable on return.
    pub fn write_durably(&self, head: &Head) -> io::Result<()> {
        self.write(head)?;
        self.0.sync_all()
    }

    /// Overwrites the content with the newest row's number and hash.
    pub fn write(&self, head: &Head) -> io::Result<()> {
        self.0.write_all_at(head.line().as_bytes(), 0)
    }
}

/// Checks that the journal holds the row of a head, which was committed; without a head, nothing.
pub(super) fn holds(connection: &Connection, head: Option<Head>) -> Result<(), JournalError> {
    let Some(head) = head else { return Ok(()) };
    let found = hash_of(connection, head.seq)?;
    let newest = newest(connection)?.map_or(0, |newest| newest.seq);
    // A pruned row is older than the oldest one, not newer than the newest.
    let is_behind = found.map_or(newest < head.seq, |found| found != head.hash);
    if is_behind { Err(JournalError::Behind { head: head.seq }) } else { Ok(()) }
}

impl Journal {
    /// The newest row, as a line for the stores; `None` in a journal without history.
    pub fn head_line(&self) -> Result<Option<String>, JournalError> {
        Ok(newest(&self.connection())?.map(|head| head.line()))
    }

    /// Checks that the journal holds the row that a line from a store names. A text that is not such a line
    /// is ignored.
    ///
    /// # Errors
    /// [`JournalError::Behind`] if it does not.
    pub fn holds_head(&self, line: &str) -> Result<(), JournalError> {
        holds(&self.connection(), Head::read(line))
    }

    /// What happened to a scan, oldest first.
    pub fn history(&self, scan: &ScanId) -> Result<Vec<Happened>, JournalError> {
        let history = "SELECT at, event, detail FROM history WHERE scan = ?1 ORDER BY seq";
        all(&self.viewer(), history, [scan.as_str()], |row| {
            Ok(Happened { at: row.get(0)?, event: row.get(1)?, detail: row.get(2)? })
        })
    }
}
