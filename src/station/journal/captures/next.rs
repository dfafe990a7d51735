//! The names that wait for a press, in the table of facts.

use std::time::Duration;

use rusqlite::{OptionalExtension, Transaction};
use serde::{Deserialize, Serialize};

use super::cells::json_text;
use crate::flow::capture::{Captures, Doubt, Named, Next};
use crate::record::SourceKind;
use crate::station::journal::integrity::seal;
use crate::station::journal::{Journal, JournalError, cell};

/// The fact.
const NEXT: &str = "next-patient";

/// The names that wait.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Names {
    /// Who may be next.
    pub next: Option<Next>,
    /// When the button was pressed without a certain name, so shortly ago that an order may be for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unsure: Vec<Duration>,
    /// When somebody was named without a button and it could not be read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unread: Vec<Duration>,
    /// The start of the machine on whose clock the times are.
    pub boot: String,
}

/// The same with what shows that it was not damaged.
#[derive(Serialize, Deserialize)]
struct NamesCell {
    names: Names,
    seal: String,
}

/// What stood there before schema 4.
#[derive(Deserialize)]
struct OneName {
    id: String,
    by: SourceKind,
    boot: String,
    at_ms: u64,
    is_doubtful: bool,
}

impl Journal {
    /// The names that wait for a press.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn names(&self) -> Result<Option<Names>, JournalError> {
        let Some(text) = self.fact(NEXT)? else { return Ok(None) };
        let NamesCell { names, seal } =
            cell("value", text, |text| serde_json::from_str(text).ok())?;
        if seal != seal::of_text(&json_text(&names)?) {
            return Err(JournalError::Seal { table: "meta" });
        }
        Ok(Some(names))
    }
}

/// Writes the names down where they have changed.
pub(super) fn save(
    transaction: &Transaction<'_>,
    before: &Captures,
    after: &Captures,
    boot: &str,
) -> Result<(), JournalError> {
    let of = |captures: &Captures| {
        let unread = captures.unread_at().to_vec();
        (captures.next().cloned(), captures.unsure_at().to_vec(), unread)
    };
    if of(before) == of(after) {
        return Ok(());
    }
    let (next, unsure, unread) = of(after);
    put(transaction, Names { next, unsure, unread, boot: boot.to_owned() })
}

fn put(transaction: &Transaction<'_>, names: Names) -> Result<(), JournalError> {
    let seal = seal::of_text(&json_text(&names)?);
    let text = json_text(&NamesCell { names, seal })?;
    transaction.execute(
        "INSERT INTO meta (name, value) VALUES (?1, ?2)
         ON CONFLICT (name) DO UPDATE SET value = excluded.value",
        [NEXT, &text],
    )?;
    Ok(())
}

/// Nobody is named any more.
pub(super) fn clear(transaction: &Transaction<'_>) -> Result<(), JournalError> {
    transaction.execute("DELETE FROM meta WHERE name = ?1", [NEXT])?;
    Ok(())
}

/// Brings the one name of schema 3 to the names of schema 4.
pub fn upgrade(transaction: &Transaction<'_>) -> Result<(), JournalError> {
    let text: Option<String> = transaction
        .query_row("SELECT value FROM meta WHERE name = ?1", [NEXT], |row| row.get(0))
        .optional()?;
    let Some(text) = text else { return Ok(()) };
    let OneName { id, by, boot, at_ms, is_doubtful } =
        cell("value", text, |text| serde_json::from_str(text).ok())?;
    let doubt = is_doubtful.then_some(Doubt::Shared);
    let next = Next::one(Named { id, by }, Duration::from_millis(at_ms), doubt);
    put(transaction, Names { next: Some(next), unsure: Vec::new(), unread: Vec::new(), boot })
}
