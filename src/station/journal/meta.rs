//! What the station must remember about itself.

use gaiter_flow::views::ViewsSeries;
use rusqlite::{OptionalExtension, Transaction};
use serde_json::json;

use super::{Event, Journal, JournalError, history, json_cell};

/// Present while the station is paused by an operator.
const PAUSED: &str = "paused";

/// Prefix for stores that are still to be searched for records that a rebuilt journal does not know.
const TO_SEARCH: &str = "to-search:";

/// Present from the creation of a journal that replaces a lost one until it was filled from the spool and
/// the quarantine. The value says why it is new, '' if the start that created it ended before that was
/// recorded.
const TO_FILL: &str = "to-fill";

/// Prefix for the place where each store was begun: from then on its mark must be found there.
pub(super) const BEGUN: &str = "begun:";

/// What the last scans said of the scanner's cameras.
const VIEWS: &str = "views";

/// Records that a journal was just created.
pub(super) fn is_new(transaction: &Transaction<'_>) -> Result<(), JournalError> {
    transaction.execute("INSERT INTO meta (name, value) VALUES (?1, '')", [TO_FILL])?;
    Ok(())
}

impl Journal {
    /// Why this journal is new, as long as it does not know what the state folder and the stores hold.
    pub fn to_fill(&self) -> Result<Option<String>, JournalError> {
        self.fact(TO_FILL)
    }

    /// Records that the journal knows what the state folder holds; stores may still be searched.
    pub fn filled(&self) -> Result<(), JournalError> {
        self.connection().execute("DELETE FROM meta WHERE name = ?1", [TO_FILL])?;
        Ok(())
    }

    /// What the last scans said of the scanner's cameras.
    pub fn views(&self) -> Result<ViewsSeries, JournalError> {
        match self.fact(VIEWS)? {
            Some(text) => json_cell("value", text),
            None => Ok(ViewsSeries::default()),
        }
    }

    /// Saves what the last scans said of the cameras.
    pub fn keep_views(&self, series: &ViewsSeries) -> Result<(), JournalError> {
        self.set_fact(VIEWS, &json!(series).to_string())
    }

    /// Reports whether an operator has paused the station.
    pub fn is_paused(&self) -> Result<bool, JournalError> {
        Ok(self.fact(PAUSED)?.is_some())
    }

    /// Pauses or resumes the station. Returns whether that changed anything.
    pub fn pause(&self, paused: bool) -> Result<bool, JournalError> {
        self.change(|transaction| {
            let changed = match paused {
                true => transaction.execute(
                    "INSERT INTO meta (name, value) VALUES (?1, '') ON CONFLICT DO NOTHING",
                    [PAUSED],
                )?,
                false => transaction.execute("DELETE FROM meta WHERE name = ?1", [PAUSED])?,
            };
            if changed > 0 {
                let event = if paused { Event::Paused } else { Event::Resumed };
                history::append(transaction, None, event, &json!({}))?;
            }
            Ok(changed > 0)
        })
    }

    /// Reports whether a store is still to be searched for records that the journal does not know.
    pub fn is_to_be_searched(&self, store: &str) -> Result<bool, JournalError> {
        Ok(self.fact(&format!("{TO_SEARCH}{store}"))?.is_some())
    }

    /// Records that this is a new journal, and why: it is to be filled, and every store searched.
    pub fn begin_anew(&self, stores: &[&str], why: &str) -> Result<(), JournalError> {
        self.change(|transaction| {
            transaction.execute(
                "INSERT INTO meta (name, value) VALUES (?1, ?2)
                 ON CONFLICT (name) DO UPDATE SET value = excluded.value",
                [TO_FILL, why],
            )?;
            for store in stores {
                transaction.execute(
                    "INSERT INTO meta (name, value) VALUES (?1, '') ON CONFLICT DO NOTHING",
                    [format!("{TO_SEARCH}{store}")],
                )?;
            }
            history::append(transaction, None, Event::Rebuilt, &json!({ "why": why }))
        })
    }

    /// Records that a store was searched completely.
    pub fn searched(&self, store: &str) -> Result<(), JournalError> {
        let name = format!("{TO_SEARCH}{store}");
        self.connection().execute("DELETE FROM meta WHERE name = ?1", [name])?;
        Ok(())
    }

    /// The place where a store was last begun; `None` if it never was.
    pub fn begun_at(&self, store: &str) -> Result<Option<String>, JournalError> {
        self.fact(&format!("{BEGUN}{store}"))
    }

    /// Records that a store was begun at this place.
    pub fn begun(&self, store: &str, place: &str) -> Result<(), JournalError> {
        self.set_fact(&format!("{BEGUN}{store}"), place)
    }

    fn set_fact(&self, name: &str, value: &str) -> Result<(), JournalError> {
        self.connection().execute(
            "INSERT INTO meta (name, value) VALUES (?1, ?2)
             ON CONFLICT (name) DO UPDATE SET value = excluded.value",
            [name, value],
        )?;
        Ok(())
    }

    pub(super) fn fact(&self, name: &str) -> Result<Option<String>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached("SELECT value FROM meta WHERE name = ?1")?;
        Ok(query.query_row([name], |row| row.get(0)).optional()?)
    }
}
