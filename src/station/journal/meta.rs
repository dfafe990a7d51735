//! What the station must remember about itself.

use gaiter_flow::views::ViewsSeries;
#[cfg(feature = "dicom")]
use gaiter_flow::worklist::AccessionNumbers;
use rusqlite::Connection;
use serde_json::json;

use super::row::{cell, first, json_text, of_json, run};
use super::{Event, Journal, JournalError, history};

/// Present while the station is paused by an operator.
const PAUSED: &str = "paused";

/// Prefix for stores that are still to be searched for records that a rebuilt journal does not know.
const TO_SEARCH: &str = "to-search:";

/// Present from the creation of a journal that replaces a lost one until it was filled from the spool and the
/// quarantine. The value states why it is new, '' if the start that created it ended before that was
/// recorded.
pub(super) const TO_FILL: &str = "to-fill";

/// Prefix for the place where each store was begun: from then on its mark must be found there.
pub(super) const BEGUN: &str = "begun:";

/// What the last scans showed about the scanner's cameras.
const VIEWS: &str = "views";

/// Prefix for what is known of a hospital's accession numbers, under each of the rules for ids.
#[cfg(feature = "dicom")]
const ACCESSION_NUMBERS: &str = "accession-numbers:";

/// A fact; `None` if it is not there.
pub(super) fn fact<T>(
    connection: &Connection,
    name: &str,
    read: impl FnOnce(&str) -> Option<T>,
) -> Result<Option<T>, JournalError> {
    let found = "SELECT value FROM meta WHERE name = ?1";
    first(connection, found, [name], |row| cell(row, 0, read))
}

/// Sets a fact, whatever it was.
pub(super) fn set_fact(
    connection: &Connection,
    name: &str,
    value: &str,
) -> Result<(), JournalError> {
    let set = "INSERT INTO meta (name, value) VALUES (?1, ?2)
               ON CONFLICT (name) DO UPDATE SET value = excluded.value";
    run(connection, set, [name, value])
}

/// Notes a fact without a value. Returns whether it is new.
pub(super) fn note_fact(connection: &Connection, name: &str) -> Result<bool, JournalError> {
    let noted = "INSERT INTO meta (name, value) VALUES (?1, '') ON CONFLICT DO NOTHING";
    Ok(connection.execute(noted, [name])? > 0)
}

/// Forgets a fact. Returns whether it was there.
pub(super) fn forget_fact(connection: &Connection, name: &str) -> Result<bool, JournalError> {
    Ok(connection.execute("DELETE FROM meta WHERE name = ?1", [name])? > 0)
}

impl Journal {
    /// Why this journal is new, as long as it does not know what the state folder and the stores hold.
    pub fn to_fill(&self) -> Result<Option<String>, JournalError> {
        self.fact(TO_FILL)
    }

    /// Records that the journal knows what the state folder holds; stores may still be searched.
    pub fn filled(&self) -> Result<(), JournalError> {
        forget_fact(&self.connection(), TO_FILL).map(drop)
    }

    /// What the last scans showed about the scanner's cameras.
    pub fn views(&self) -> Result<ViewsSeries, JournalError> {
        Ok(fact(&self.connection(), VIEWS, of_json)?.unwrap_or_default())
    }

    /// Saves what the last scans showed about the cameras.
    pub fn keep_views(&self, series: &ViewsSeries) -> Result<(), JournalError> {
        set_fact(&self.connection(), VIEWS, &json_text(series)?)
    }

    /// Reports whether an operator has paused the station.
    pub fn is_paused(&self) -> Result<bool, JournalError> {
        Ok(self.fact(PAUSED)?.is_some())
    }

    /// Pauses or resumes the station. Returns whether that changed anything.
    pub fn pause(&self, paused: bool) -> Result<bool, JournalError> {
        self.change(|transaction| {
            let (has_changed, event) = match paused {
                true => (note_fact(transaction, PAUSED)?, Event::Paused),
                false => (forget_fact(transaction, PAUSED)?, Event::Resumed),
            };
            if has_changed {
                history::append(transaction, None, event, &json!({}))?;
            }
            Ok(has_changed)
        })
    }

    /// Reports whether a store is still to be searched for records that the journal does not know.
    pub fn is_to_be_searched(&self, store: &str) -> Result<bool, JournalError> {
        Ok(self.fact(&format!("{TO_SEARCH}{store}"))?.is_some())
    }

    /// Records that this is a new journal, and why: it is to be filled, and every store searched.
    pub fn begin_anew(&self, stores: &[&str], why: &str) -> Result<(), JournalError> {
        self.change(|transaction| {
            set_fact(transaction, TO_FILL, why)?;
            for store in stores {
                note_fact(transaction, &format!("{TO_SEARCH}{store}"))?;
            }
            history::append(transaction, None, Event::Rebuilt, &json!({ "why": why }))
        })
    }

    /// Records that a store was searched completely.
    pub fn searched(&self, store: &str) -> Result<(), JournalError> {
        forget_fact(&self.connection(), &format!("{TO_SEARCH}{store}")).map(drop)
    }

    /// The place where a store was last begun; `None` if it never was.
    pub fn begun_at(&self, store: &str) -> Result<Option<String>, JournalError> {
        self.fact(&format!("{BEGUN}{store}"))
    }

    /// Records that a store was begun at this place.
    pub fn begun(&self, store: &str, place: &str) -> Result<(), JournalError> {
        set_fact(&self.connection(), &format!("{BEGUN}{store}"), place)
    }

    /// What the worklist has shown of the hospital's accession numbers under these rules for ids.
    #[cfg(feature = "dicom")]
    pub fn accession_numbers(&self, rules: &str) -> Result<AccessionNumbers, JournalError> {
        let name = format!("{ACCESSION_NUMBERS}{rules}");
        Ok(fact(&self.connection(), &name, of_json)?.unwrap_or_default())
    }

    /// Saves what the worklist has shown of them, if that is new.
    #[cfg(feature = "dicom")]
    pub fn keep_accession_numbers(
        &self,
        rules: &str,
        numbers: AccessionNumbers,
    ) -> Result<(), JournalError> {
        if self.accession_numbers(rules)? == numbers {
            return Ok(());
        }
        let name = format!("{ACCESSION_NUMBERS}{rules}");
        set_fact(&self.connection(), &name, &json_text(&numbers)?)
    }

    pub(super) fn fact(&self, name: &str) -> Result<Option<String>, JournalError> {
        fact(&self.connection(), name, |text| Some(text.to_owned()))
    }
}
