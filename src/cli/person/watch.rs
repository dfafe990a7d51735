//! Watches an erasure at a running station, which may end at any moment, begin again, or not come back. Answers
//! before a silence do not count: the station is asked again until the outcome of the erasure is known.

use std::time::{Duration, Instant};

use gaiter_flow::patient::erasure::Erasure;
use jiff::Timestamp;

use super::reach::{PersonFault, Reached};
use crate::store::polling::poll;

/// How long the station may take to begin again and to clear its folder and the stores.
const PATIENCE: Duration = Duration::from_secs(60);

/// How long after its own folder, without a break, the stores that are in reach are cleared; and how long servers that
/// are in reach may take for what they are owed.
const STORES_PATIENCE: Duration = Duration::from_secs(10);

/// How long a station may be away before its state folder is taken. The service manager starts it again after
/// two seconds.
const AWAY_PATIENCE: Duration = Duration::from_secs(10);

/// An erasure that is watched.
pub(super) struct Watch<'a> {
    reached: &'a Reached<'a>,
    patient: &'a str,
    /// Whether what servers are owed is left undone.
    leaves_owed: bool,
    /// When it was asked for: an erasure from before is another one.
    asked: Timestamp,
    /// Whether a station reported that it noted the request.
    is_noted: bool,
    answers: Answers,
}

impl<'a> Watch<'a> {
    /// The watch of an erasure that is asked for next.
    pub(super) fn new(reached: &'a Reached<'a>, patient: &'a str, leaves_owed: bool) -> Watch<'a> {
        let (asked, answers) = (Timestamp::now(), Answers::default());
        Watch { reached, patient, leaves_owed, asked, is_noted: false, answers }
    }

    /// The station reported that it noted the request.
    pub(super) fn noted(self) -> Watch<'a> {
        Watch { is_noted: true, ..self }
    }

    /// Asks again until nothing is left to do, or only at a store or server that is out of reach. Returns the station's
    /// last answer; `None` if there is none.
    ///
    /// # Errors
    /// If a station that had not noted the request refuses it.
    pub(super) fn until_known(mut self) -> Result<Option<Erasure>, PersonFault> {
        match poll(PATIENCE, || self.look().transpose()) {
            Some(known) => known.map(Some),
            None => Ok(self.answers.last),
        }
    }

    fn look(&mut self) -> Result<Option<Erasure>, PersonFault> {
        match self.reached.erasure(self.patient) {
            Ok(Some(erasure)) if self.is_noted || erasure.at >= self.asked => {
                self.is_noted = true;
                Ok(self.answers.answer(erasure, Instant::now()))
            }
            // The station that was asked ended before it noted the wish, and another one runs.
            Ok(_) => match self.reached.erase(self.patient, self.leaves_owed) {
                Err(fault) if !fault.is_silence() => Err(fault),
                asked => {
                    self.is_noted = asked.is_ok();
                    Ok(None)
                }
            },
            Err(fault) => {
                let away = self.answers.silence(Instant::now());
                if !fault.is_silence() || away <= AWAY_PATIENCE {
                    return Ok(None);
                }
                let Watch { reached, patient, leaves_owed, asked, is_noted, .. } = *self;
                let erased = reached.erase_without_station(patient, asked, is_noted, leaves_owed);
                // It fails while a station is about to start, which is then asked again.
                Ok(erased.ok().flatten())
            }
        }
    }
}

/// The answers of a station since its last silence.
#[derive(Debug, Default)]
struct Answers {
    last: Option<Erasure>,
    /// Since when it has reported, without a break, that its own folder is cleared, or is not because of
    /// servers.
    waits_since: Option<(bool, Instant)>,
    /// Since when it has been silent.
    silent_since: Option<Instant>,
}

impl Answers {
    /// Takes in an answer, and returns it if there is nothing left to wait for.
    fn answer(&mut self, erasure: Erasure, now: Instant) -> Option<Erasure> {
        self.silent_since = None;
        let is_cleared = erasure.cleared.is_some();
        let waits = is_cleared || !erasure.owed.is_empty();
        let before = self.waits_since.filter(|(was_cleared, _)| *was_cleared == is_cleared);
        self.waits_since = waits.then_some(before.unwrap_or((is_cleared, now)));
        let is_long = |(_, since)| now.duration_since(since) > STORES_PATIENCE;
        let is_over = erasure.ended.is_some() || self.waits_since.is_some_and(is_long);
        self.last = Some(erasure.clone());
        is_over.then_some(erasure)
    }

    /// There was no answer: earlier answers no longer count. Returns how long there has been none.
    fn silence(&mut self, now: Instant) -> Duration {
        (self.last, self.waits_since) = (None, None);
        now.duration_since(*self.silent_since.get_or_insert(now))
    }
}

#[cfg(test)]
mod tests {
    use gaiter_flow::patient::erasure::{Owed, OwedStep};

    use super::*;

    /// An erasure of which the station's own folder is cleared, and no store.
    fn cleared() -> Erasure {
        let at = Timestamp::from_second(1_800_000_000).unwrap();
        let stores = vec!["folder".to_owned(), "copy".to_owned()];
        let mut erasure = Erasure::asked(None, "4711", at, "uid 0".to_owned(), stores);
        erasure.own_cleared(at, &["folder", "copy"]);
        erasure
    }

    #[test]
    fn what_a_station_said_before_it_fell_silent_counts_no_more() {
        let (mut answers, began) = (Answers::default(), Instant::now());
        assert_eq!(answers.answer(cleared(), began), None);
        assert!(answers.last.is_some());
        let second = Duration::from_secs(1);
        assert_eq!(answers.silence(began + second), Duration::ZERO);
        assert_eq!(answers.last, None, "nobody knows what the station did before it ended");
        assert_eq!(answers.silence(began + 3 * second), 2 * second);
    }

    #[test]
    fn a_station_that_begins_anew_has_the_whole_time_for_its_stores_again() {
        let (mut answers, began) = (Answers::default(), Instant::now());
        let at = |seconds| began + Duration::from_secs(seconds);
        answers.answer(cleared(), at(0));
        answers.silence(at(1));
        // Its own folder was cleared long ago, and it is about to clear the stores.
        assert_eq!(answers.answer(cleared(), at(15)), None);
        assert_eq!(answers.answer(cleared(), at(24)), None);
        assert_eq!(answers.answer(cleared(), at(26)), Some(cleared()), "a store is out of reach");
    }

    #[test]
    fn a_server_that_does_not_do_what_it_is_owed_is_not_waited_for_without_end() {
        let mut waiting = cleared();
        waiting.cleared = None;
        waiting.owed = vec![Owed {
            sha256: "0".repeat(64),
            store: "hl7".to_owned(),
            step: OwedStep::TakeBack,
            place: None,
            reference: None,
        }];
        let (mut answers, began) = (Answers::default(), Instant::now());
        let at = |seconds| began + Duration::from_secs(seconds);
        assert_eq!(answers.answer(waiting.clone(), at(0)), None);
        assert_eq!(answers.answer(waiting.clone(), at(11)), Some(waiting));
        // It came after all: the stores have the whole time.
        assert_eq!(answers.answer(cleared(), at(12)), None);
        assert_eq!(answers.answer(cleared(), at(23)), Some(cleared()));
    }

    #[test]
    fn an_erasure_that_has_ended_is_known_at_once() {
        let mut erasure = cleared();
        let at = erasure.at;
        erasure.store_cleared("folder", at);
        erasure.store_cleared("copy", at);
        let (mut answers, now) = (Answers::default(), Instant::now());
        assert_eq!(answers.answer(erasure.clone(), now), Some(erasure));
    }
}
