//! Presses, the patients who were named for them, and what became of them, in the journal.
//!
//! Times are on the machine's clock since its start, and only as good as that start: a capture of an
//! earlier one is over, whatever the clock on the wall says.

use std::time::Duration;

use jiff::Timestamp;
use rusqlite::{OptionalExtension, Transaction, params};
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{Event, Journal, JournalError, cell, history, seal};
use crate::flow::ScanId;
use crate::flow::capture::{CalledOff, Capture, CaptureState, Doubt, Judged, Named, Next, Opener};
use crate::record::SourceKind;

/// The patient's name that waits for a press, in the table of facts.
const NEXT: &str = "next-patient";

/// The states of a capture that is over.
const ANSWERED: &str = "answered";
const HELD: &str = "held";

/// So many captures that are over are kept for people to read; the history keeps each.
const KEPT: i64 = 1000;

/// A capture as it stands in the journal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaptureRow {
    /// The capture.
    pub capture: Capture,
    /// When it was opened, on the wall.
    pub at: Timestamp,
    /// The start of the machine on whose clock its times are.
    pub boot: String,
}

/// The waiting name as it stands in the journal.
#[derive(Serialize, Deserialize)]
struct NextCell {
    id: String,
    by: SourceKind,
    boot: String,
    at_ms: u64,
    is_doubtful: bool,
    seal: String,
}

impl Journal {
    /// The number of the next capture.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn next_capture(&self) -> Result<i64, JournalError> {
        let newest: Option<i64> =
            self.connection()
                .query_row("SELECT max(number) FROM captures", [], |row| row.get(0))?;
        Ok(newest.unwrap_or(0) + 1)
    }

    /// A capture was opened, or its window prolonged; the name that waited for it is used.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn captured(&self, row: &CaptureRow) -> Result<(), JournalError> {
        let CaptureRow { capture, at, boot } = row;
        self.change(|transaction| {
            let (id, source) = match &capture.patient {
                Some(named) => (named.id.as_str(), word_of(named.by)?),
                None => ("", String::new()),
            };
            transaction.execute(
                "INSERT INTO captures (number, at, boot, opened_ms, until_ms, opener, patient, source,
                                       state, seal, shared)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)
                 ON CONFLICT (number) DO UPDATE SET until_ms = ?5",
                params![
                    capture.number,
                    at.to_string(),
                    boot,
                    milliseconds(capture.opened),
                    milliseconds(capture.until),
                    opener_word(capture.by),
                    id,
                    source,
                    state_word(capture.state),
                    seal::of_capture(capture.number, id, &source),
                    capture.doubt == Some(Doubt::Shared),
                ],
            )?;
            let event = match capture.by {
                Opener::Press => Event::Pressed,
                Opener::Name => Event::Named,
            };
            if capture.by == Opener::Press {
                transaction.execute("DELETE FROM meta WHERE name = ?1", [NEXT])?;
            }
            transaction.execute(
                "DELETE FROM captures WHERE number < ?1 AND state NOT IN ('open', 'expired',
                 'called_off')",
                [capture.number - KEPT],
            )?;
            let detail = json!({ "capture": capture.number, "patient": id, "by": source });
            history::append(transaction, None, event, &detail)
        })
    }

    /// The patient of the next scan was named; the name waits for a press.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn named_next(&self, next: &Next, boot: &str) -> Result<(), JournalError> {
        let Next { named, at, is_doubtful } = next;
        self.change(|transaction| {
            let source = word_of(named.by)?;
            let text = json_text(&NextCell {
                id: named.id.clone(),
                by: named.by,
                boot: boot.to_owned(),
                at_ms: u64::try_from(at.as_millis()).unwrap_or(u64::MAX),
                is_doubtful: *is_doubtful,
                seal: seal::of_capture(0, &named.id, &source),
            })?;
            transaction.execute(
                "INSERT INTO meta (name, value) VALUES (?1, ?2)
                 ON CONFLICT (name) DO UPDATE SET value = excluded.value",
                [NEXT, &text],
            )?;
            let detail = json!({ "patient": named.id, "by": source });
            history::append(transaction, None, Event::Named, &detail)
        })
    }

    /// The name that waits for a press, and the machine's start it belongs to.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn next_named(&self) -> Result<Option<(Next, String)>, JournalError> {
        let Some(text) = self.fact(NEXT)? else { return Ok(None) };
        let next: NextCell = cell("value", text, |text| serde_json::from_str(text).ok())?;
        if next.seal != seal::of_capture(0, &next.id, &word_of(next.by)?) {
            return Err(JournalError::Seal { table: "meta" });
        }
        let NextCell { id, by, boot, at_ms, is_doubtful, .. } = next;
        let at = Duration::from_millis(at_ms);
        Ok(Some((Next { named: Named { id, by }, at, is_doubtful }, boot)))
    }

    /// The captures whose exports have not come, in the order in which they were opened.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn captures_waiting(&self) -> Result<Vec<CaptureRow>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT number, at, boot, opened_ms, until_ms, opener, patient, source, state, shared, seal
             FROM captures WHERE state IN ('open', 'expired', 'called_off') ORDER BY number",
        )?;
        let mut rows = query.query([])?;
        let mut found = Vec::new();
        while let Some(row) = rows.next()? {
            let text = |at| row.get::<_, String>(at);
            let (number, id, source): (i64, String, String) = (row.get(0)?, text(6)?, text(7)?);
            if text(10)? != seal::of_capture(number, &id, &source) {
                return Err(JournalError::Seal { table: "captures" });
            }
            let by = |word: &str| serde_json::from_value(json!(word)).ok();
            let patient = match id.is_empty() {
                true => None,
                false => Some(Named { id, by: cell("source", source, by)? }),
            };
            let time = |at| {
                Ok::<_, JournalError>(Duration::from_millis(row.get::<_, i64>(at)?.unsigned_abs()))
            };
            found.push(CaptureRow {
                capture: Capture {
                    number,
                    opened: time(3)?,
                    until: time(4)?,
                    by: cell("opener", text(5)?, opener_of)?,
                    patient,
                    state: cell("state", text(8)?, state_of)?,
                    doubt: row.get::<_, bool>(9)?.then_some(Doubt::Shared),
                },
                at: cell("at", text(1)?, |text| text.parse().ok())?,
                boot: text(2)?,
            });
        }
        Ok(found)
    }

    /// When a capture was opened, on the wall; none for one that is not kept.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn captured_at(&self, number: i64) -> Result<Option<Timestamp>, JournalError> {
        let text: Option<String> = self
            .connection()
            .query_row("SELECT at FROM captures WHERE number = ?1", [number], |row| row.get(0))
            .optional()?;
        text.map(|text| cell("at", text, |text| text.parse().ok())).transpose()
    }

    /// Windows are over without an export; so is the time of a name where `name` says so.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn expired(&self, captures: &[i64], name: bool) -> Result<(), JournalError> {
        self.change(|transaction| {
            end(transaction, captures, state_word(CaptureState::Expired))?;
            if name {
                transaction.execute("DELETE FROM meta WHERE name = ?1", [NEXT])?;
            }
            let detail = json!({ "captures": captures, "name": name });
            history::append(transaction, None, Event::Expired, &detail)
        })
    }

    /// A person called off what waited.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn called_off(&self, called_off: &CalledOff) -> Result<(), JournalError> {
        self.change(|transaction| {
            end(transaction, &called_off.captures, state_word(CaptureState::CalledOff))?;
            transaction.execute("DELETE FROM meta WHERE name = ?1", [NEXT])?;
            let detail = json!({ "captures": called_off.captures, "name": called_off.name });
            history::append(transaction, None, Event::CalledOff, &detail)
        })
    }

    /// Nobody waits for the exports of these any more.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn captures_over(&self, captures: &[i64]) -> Result<(), JournalError> {
        self.change(|transaction| end(transaction, captures, "over"))
    }
}

/// What an export means for captures, within the change that enters it.
pub(super) fn answer(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    judged: &Judged,
) -> Result<(), JournalError> {
    let (answered, state, doubtful) = match judged {
        Judged::Unpressed => return Ok(()),
        Judged::Of(capture) => (Some(capture.number), ANSWERED, &[][..]),
        Judged::Held { answered, doubtful, .. } => (*answered, HELD, doubtful.as_slice()),
    };
    for number in doubtful {
        transaction.execute("UPDATE captures SET shared = 1 WHERE number = ?1", [number])?;
    }
    let Some(number) = answered else { return Ok(()) };
    transaction.execute(
        "UPDATE captures SET state = ?2, scan = ?3 WHERE number = ?1",
        params![number, state, scan.as_str()],
    )?;
    let detail = json!({ "capture": number, "as": state });
    history::append(transaction, Some(scan), Event::Answered, &detail)
}

fn end(transaction: &Transaction<'_>, captures: &[i64], state: &str) -> Result<(), JournalError> {
    for number in captures {
        transaction
            .execute("UPDATE captures SET state = ?2 WHERE number = ?1", params![number, state])?;
    }
    Ok(())
}

fn milliseconds(time: Duration) -> i64 {
    i64::try_from(time.as_millis()).unwrap_or(i64::MAX)
}

const STATES: [(&str, CaptureState); 3] = [
    ("open", CaptureState::Open),
    ("expired", CaptureState::Expired),
    ("called_off", CaptureState::CalledOff),
];

fn state_word(state: CaptureState) -> &'static str {
    STATES.iter().find(|(_, known)| *known == state).map_or("open", |(word, _)| word)
}

fn state_of(word: &str) -> Option<CaptureState> {
    STATES.iter().find(|(known, _)| *known == word).map(|(_, state)| *state)
}

fn opener_word(opener: Opener) -> &'static str {
    match opener {
        Opener::Press => "press",
        Opener::Name => "name",
    }
}

fn opener_of(word: &str) -> Option<Opener> {
    [Opener::Press, Opener::Name].into_iter().find(|opener| opener_word(*opener) == word)
}

/// The word of a source, as records have it.
fn word_of(kind: SourceKind) -> Result<String, JournalError> {
    Ok(json_text(&kind)?.trim_matches('"').to_owned())
}

fn json_text(value: &impl Serialize) -> Result<String, JournalError> {
    serde_json::to_string(value)
        .map_err(|error| rusqlite::Error::ToSqlConversionFailure(error.into()).into())
}
