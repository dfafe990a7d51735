//! The names that wait for a press, in the table of facts.

use gaiter_flow::round::{Names, Rounds};
use rusqlite::{Connection, OptionalExtension, Transaction};
use serde::{Deserialize, Serialize};

use super::cells::json_text;
use crate::station::journal::integrity::seal;
use crate::station::journal::{Journal, JournalError, json_cell};

/// The name of the fact.
const NEXT: &str = "next-patient";

/// The names that wait, with the machine start that their times refer to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamesOfBoot {
    /// Who may be next.
    #[serde(flatten)]
    pub names: Names,
    /// The machine start.
    pub boot: String,
}

/// The same with a seal that detects damage.
#[derive(Serialize, Deserialize)]
struct NamesCell {
    names: NamesOfBoot,
    seal: String,
}

impl Journal {
    /// The names that wait for a press.
    pub fn names(&self) -> Result<Option<NamesOfBoot>, JournalError> {
        let Some(text) = self.fact(NEXT)? else { return Ok(None) };
        let NamesCell { names, seal } = json_cell("value", text)?;
        if seal != seal::of_text(&json_text(&names)?) {
            return Err(JournalError::Seal { table: "meta" });
        }
        Ok(Some(names))
    }
}

/// Saves the names if they have changed.
pub(super) fn save(
    transaction: &Transaction<'_>,
    before: &Rounds,
    after: &Rounds,
    boot: &str,
) -> Result<(), JournalError> {
    if before.names() == after.names() {
        return Ok(());
    }
    let names = NamesOfBoot { names: after.names().clone(), boot: boot.to_owned() };
    let seal = seal::of_text(&json_text(&names)?);
    let text = json_text(&NamesCell { names, seal })?;
    transaction.execute(
        "INSERT INTO meta (name, value) VALUES (?1, ?2)
         ON CONFLICT (name) DO UPDATE SET value = excluded.value",
        [NEXT, &text],
    )?;
    Ok(())
}

/// Whether one of the names is this patient's.
pub fn names_patient(connection: &Connection, patient: &str) -> Result<bool, JournalError> {
    let text: Option<String> = connection
        .query_row("SELECT value FROM meta WHERE name = ?1", [NEXT], |row| row.get(0))
        .optional()?;
    let Some(text) = text else { return Ok(false) };
    let NamesCell { names, .. } = json_cell("value", text)?;
    let mut said = names.names.next.iter().flat_map(|next| &next.names);
    Ok(said.any(|said| said.named.id == patient))
}

/// Removes the names.
pub fn clear(transaction: &Transaction<'_>) -> Result<(), JournalError> {
    transaction.execute("DELETE FROM meta WHERE name = ?1", [NEXT])?;
    Ok(())
}
