//! Rounds in the journal: presses, the patients named for them, and their outcomes.
//!
//! Times are on the machine's clock since its start and valid only for that start.

mod next;

use std::time::Duration;

use gaiter_flow::orders::ORDERS_MOST;
use gaiter_flow::round::{Capture, CaptureMatch, CaptureState, Named, Opener, Rounds};
use gaiter_flow::{ScanId, ScanState};
use jiff::Timestamp;
use rusqlite::{Row, Transaction, params};
use serde_json::{Value, json};

use super::integrity::seal;
use super::row::{all, cell, first, json_cell, json_text, run, time, value};
use super::{Event, Journal, JournalError, history};
pub(super) use next::{clear_names, names_patient};

/// The states of a capture that is over.
const ANSWERED: &str = CaptureState::Taken.word();
const HELD: &str = CaptureState::Held.word();

/// SQL: the states of captures whose exports were taken in.
const TAKEN: &str = "('answered', 'held')";

/// SQL: the states of captures that have not ended.
const NOT_ENDED: &str = "('open', 'expired', 'answered', 'held')";

/// SQL: the states of captures whose exports have not come.
const WAITING: &str = "('open', 'expired')";

/// The number of finished captures kept for operators to read; the history keeps all of them.
const KEPT: i64 = 1000;

/// A capture as the journal holds it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaptureRow {
    pub capture: Capture,
    /// The machine start that its times refer to.
    pub boot: String,
    /// When it was opened, by the wall clock.
    pub at: Timestamp,
}

/// A change at the booth. The journal records it before anything acts on it.
#[derive(Debug)]
pub struct BoothChange<'a> {
    /// The captures and names before the change.
    pub before: &'a Rounds,
    /// The captures and names after the change.
    pub after: &'a Rounds,
    /// The machine start that their times refer to.
    pub boot: &'a str,
    /// The state of a capture that no longer waits.
    pub ended_as: &'static str,
    /// The scan that by a person's decision answers the capture of this number, and none besides.
    pub answers: Option<(&'a ScanId, i64)>,
    /// The entry for the history, if any.
    pub event: Option<(Event, Value)>,
}

impl Journal {
    /// The number of the next capture.
    pub fn next_capture(&self) -> Result<i64, JournalError> {
        value(&self.connection(), "SELECT coalesce(max(number), 0) + 1 FROM captures", [])
    }

    /// Records a change at the booth: captures opened, changed or ended, names given or used.
    ///
    /// # Errors
    /// See [`JournalError`]; nothing is changed then.
    pub fn booth_changed(&self, change: &BoothChange<'_>) -> Result<(), JournalError> {
        let BoothChange { before, after, boot, ended_as, answers, event } = change;
        self.change(|transaction| {
            for capture in after.waiting() {
                if before.waiting().all(|known| known != capture) {
                    save(transaction, capture, boot)?;
                }
            }
            let still = |number: i64| after.open().iter().any(|known| known.number == number);
            for gone in before.open().iter().filter(|capture| !still(capture.number)) {
                end(transaction, &[gone.number], ended_as)?;
            }
            if let Some((scan, number)) = answers {
                let cells = params![scan.as_str(), number, ANSWERED];
                transaction.execute(
                    "UPDATE captures SET state = iif(number = ?2, ?3, state),
                                         scan = iif(number = ?2, ?1, '')
                     WHERE number = ?2 OR scan = ?1",
                    cells,
                )?;
            }
            next::save(transaction, before, after, boot)?;
            if let Some((event, detail)) = event {
                history::append(transaction, None, *event, detail)?;
            }
            Ok(())
        })
    }

    /// The captures whose exports have not come, in the order in which they were opened.
    pub fn captures_waiting(&self) -> Result<Vec<CaptureRow>, JournalError> {
        let waiting = select(&format!("state IN {WAITING} ORDER BY number"));
        all(&self.connection(), &waiting, [], read)
    }

    /// The capture that a scan answered, also where it was opened again because the scan was refused.
    pub fn capture_answered_by(&self, scan: &ScanId) -> Result<Option<Capture>, JournalError> {
        let answered = select(&format!("scan = ?1 AND state IN {NOT_ENDED}"));
        let found = first(&self.connection(), &answered, [scan.as_str()], read)?;
        Ok(found.map(|row| row.capture))
    }

    /// The captures whose scans are to be measured, are held, or were refused without the capture being
    /// opened again.
    pub fn captures_taken(&self) -> Result<Vec<CaptureRow>, JournalError> {
        let taken = select(&format!(
            "state IN {TAKEN}
             AND (state = '{HELD}' OR scan IN (SELECT sha256 FROM scans WHERE state IN (?1, ?2)))
             ORDER BY number"
        ));
        let states = [ScanState::Spooled.word(), ScanState::Refused.word()];
        all(&self.connection(), &taken, states, read)
    }

    /// Whether each of the last orders came after the press, newest last.
    pub fn orders_came_late(&self) -> Result<Vec<bool>, JournalError> {
        let came = "SELECT json_extract(detail, '$.after_press') = 1 FROM history
                    WHERE event = ?1 AND json_extract(detail, '$.by') = 'order'
                    ORDER BY seq DESC LIMIT ?2";
        let cells = params![Event::Named.word(), ORDERS_MOST as i64];
        let mut came = all(&self.connection(), came, cells, |row| {
            Ok(row.get::<_, Option<bool>>(0)? == Some(true))
        })?;
        came.reverse();
        Ok(came)
    }

    /// When a capture was opened, by the wall clock; `None` if the capture is not kept.
    pub fn captured_at(&self, number: i64) -> Result<Option<Timestamp>, JournalError> {
        let at = "SELECT at FROM captures WHERE number = ?1";
        first(&self.connection(), at, [number], |row| time(row, 0))
    }

    /// Ends captures of refused scans because a good scan of the same patient was measured.
    pub fn captures_closed(&self, captures: &[i64]) -> Result<(), JournalError> {
        self.change(|transaction| end(transaction, captures, "over"))
    }

    /// Expires captures of an earlier machine start, and their names. Rounds that are carried over
    /// stay, with times of this start.
    pub fn captures_of_before(
        &self,
        captures: &[i64],
        carried_over: &[Capture],
        boot: &str,
        name: bool,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            end(transaction, captures, "over")?;
            for capture in carried_over {
                save(transaction, capture, boot)?;
            }
            if name {
                next::clear_names(transaction)?;
            }
            let detail = json!({ "captures": captures, "name": name });
            history::append(transaction, None, Event::Expired, &detail)
        })
    }
}

/// Records what an export means for captures, within the change that enters it.
pub(super) fn answer(
    transaction: &Transaction<'_>,
    scan: &ScanId,
    judged: &CaptureMatch,
) -> Result<(), JournalError> {
    let (answered, state, doubtful, candidates) = match judged {
        CaptureMatch::Unpressed | CaptureMatch::Known => return Ok(()),
        CaptureMatch::Of(capture) => (Some(capture.number), ANSWERED, &[][..], &[][..]),
        CaptureMatch::Held { answered, doubtful, candidates, .. } => {
            (*answered, HELD, doubtful.as_slice(), candidates.as_slice())
        }
    };
    for number in doubtful {
        doubt(transaction, *number, candidates)?;
    }
    let Some(number) = answered else { return Ok(()) };
    doubt(transaction, number, candidates)?;
    let taken = "UPDATE captures SET state = ?2, scan = ?3 WHERE number = ?1";
    transaction.execute(taken, params![number, state, scan.as_str()])?;
    let detail = json!({ "capture": number, "as": state });
    history::append(transaction, Some(scan), Event::Answered, &detail)
}

/// Records that a capture's export may belong to any of these patients.
fn doubt(
    transaction: &Transaction<'_>,
    number: i64,
    candidates: &[Named],
) -> Result<(), JournalError> {
    let row = select(&format!("number = ?1 AND state IN {NOT_ENDED}"));
    let row = first(transaction, &row, [number], read)?;
    let Some(CaptureRow { mut capture, boot, .. }) = row else { return Ok(()) };
    candidates.iter().for_each(|named| capture.may_also_be(named));
    save(transaction, &capture, &boot)
}

/// SQL: the captures of a condition, as [`read`] takes them.
fn select(which: &str) -> String {
    format!(
        "SELECT {}, boot, opened_ms, until_ms, opener, state, refused, doubt, at
         FROM captures WHERE {which}",
        seal::CAPTURES.cells
    )
}

fn read(row: &Row<'_>) -> Result<CaptureRow, JournalError> {
    seal::CAPTURES.check(row)?;
    let since_start =
        |at| Ok::<_, JournalError>(Duration::from_millis(row.get::<_, i64>(at)?.unsigned_abs()));
    let capture = Capture {
        number: row.get(1)?,
        opened: since_start(7)?,
        until: since_start(8)?,
        by: cell(row, 9, Opener::of_word)?,
        patient: json_cell(row, 3)?,
        others: json_cell(row, 4)?,
        state: cell(row, 10, CaptureState::of_word)?,
        is_refused: row.get(11)?,
        doubt: json_cell(row, 12)?,
    };
    Ok(CaptureRow { capture, boot: row.get(6)?, at: time(row, 13)? })
}

fn save(transaction: &Transaction<'_>, capture: &Capture, boot: &str) -> Result<(), JournalError> {
    let id = capture.patient.as_ref().map_or("", |named| &named.id);
    let (source, others) = (json_text(&capture.patient)?, json_text(&capture.others)?);
    let number = capture.number.to_string();
    let milliseconds = |time: Duration| i64::try_from(time.as_millis()).unwrap_or(i64::MAX);
    transaction.execute(
        "INSERT INTO captures (number, at, boot, opened_ms, until_ms, opener, patient, source, state,
                               candidates, refused, doubt, seal)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)
         ON CONFLICT (number) DO UPDATE
         SET boot = ?3, opened_ms = ?4, until_ms = ?5, patient = ?7, source = ?8, state = ?9,
             candidates = ?10, refused = ?11, doubt = ?12, seal = ?13",
        params![
            capture.number,
            Timestamp::now().to_string(),
            boot,
            milliseconds(capture.opened),
            milliseconds(capture.until),
            capture.by.word(),
            id,
            source,
            capture.state.word(),
            others,
            capture.is_refused,
            json_text(&capture.doubt)?,
            seal::of_cells(&["capture", &number, id, &source, &others]),
        ],
    )?;
    let old = format!("DELETE FROM captures WHERE number < ?1 AND state NOT IN {WAITING}");
    run(transaction, &old, [capture.number - KEPT])
}

fn end(transaction: &Transaction<'_>, captures: &[i64], state: &str) -> Result<(), JournalError> {
    for number in captures {
        let ended = "UPDATE captures SET state = ?2 WHERE number = ?1";
        run(transaction, ended, params![number, state])?;
    }
    Ok(())
}
