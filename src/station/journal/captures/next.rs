//! The names that wait for a press, in the table of facts.

use gaiter_flow::round::{Names, Rounds};
use rusqlite::{Connection, Transaction};
use serde::{Deserialize, Serialize};

use crate::station::journal::integrity::seal;
use crate::station::journal::meta::{fact, forget_fact, set_fact};
use crate::station::journal::row::{json_text, of_json};
use crate::station::journal::{Journal, JournalError};

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
        let found = fact(&self.connection(), NEXT, of_json)?;
        let Some(NamesCell { names, seal }) = found else { return Ok(None) };
        if seal != seal::of_cells(&[json_text(&names)?]) {
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
    let seal = seal::of_cells(&[json_text(&names)?]);
    set_fact(transaction, NEXT, &json_text(&NamesCell { names, seal })?)
}

/// Whether one of the names is this patient's.
pub fn names_patient(connection: &Connection, patient: &str) -> Result<bool, JournalError> {
    let found = fact(connection, NEXT, of_json)?;
    let Some(NamesCell { names, .. }) = found else { return Ok(false) };
    let mut waiting = names.names.next.iter().flat_map(|next| &next.names);
    Ok(waiting.any(|name| name.named.id == patient))
}

/// Removes the names.
pub fn clear_names(transaction: &Transaction<'_>) -> Result<(), JournalError> {
    forget_fact(transaction, NEXT).map(drop)
}
