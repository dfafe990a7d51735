//! Asks for the worklist, and gives the booth what the server answers.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_flow::facts::WorklistFacts;
use gaiter_flow::worklist::{AccessionNumbers, Worklist, WorklistEntry};
use gaiter_record::SourceKind;
use jiff::Timestamp;
use jiff::civil::Date;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use super::{WorklistAnswer, ask, id_rules, today};
use crate::config::WorklistConfig;
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::runtime::{Heartbeat, Stop};
use crate::station::share::stall::{DEADLINE, patiently};

/// How soon after an answer the server is asked again because a page was opened, or a day has begun.
const AGAIN: Duration = Duration::from_secs(5);

/// How often the worker looks whether a page asks, and whether the day is over.
const LOOK: Duration = Duration::from_secs(1);

/// Asks for the worklist until asked to stop.
///
/// # Errors
/// If the question panicked.
pub async fn worker(
    booth: Arc<Booth>,
    config: WorklistConfig,
    beat: Heartbeat,
    mut stop: Stop,
) -> Result<(), JoinError> {
    let config = Arc::new(config);
    let numbers = booth.numbers_told();
    let unasked = WorklistFacts { numbers, ..WorklistFacts::new(Timestamp::now()) };
    booth.core().board.note(|facts| facts.worklist = Some(unasked));
    let alive = || {
        beat.beat();
        booth.end_worklist(today());
    };
    while !stop.is_requested() {
        let (theirs, day) = (Arc::clone(&config), today());
        let hangs = || note_fault(booth.core(), Cause::known("no-answer", []));
        let answered =
            patiently(DEADLINE, &mut stop, move |_| ask(&theirs, day), alive, hangs).await?;
        match answered {
            Some(Ok(answer)) => {
                let (booth, config) = (Arc::clone(&booth), Arc::clone(&config));
                spawn_blocking(move || booth.note_worklist(answer, &config, day)).await?;
            }
            Some(Err(fault)) => note_fault(booth.core(), fault.cause()),
            None => break,
        }
        let since = booth.core().now();
        let waited = || booth.core().now().saturating_sub(since);
        // Of a new day nothing is known.
        let is_wanted =
            || today() != day || booth.worklist.is_wanted.swap(false, Ordering::Relaxed);
        let is_due = || waited() >= config.every || (waited() >= AGAIN && is_wanted());
        while !is_due() {
            alive();
            tokio::select! {
                () = stop.requested() => return Ok(()),
                () = sleep(LOOK) => {}
            }
        }
    }
    Ok(())
}

/// Notes that there was no answer. Logged once for each outage.
pub(super) fn note_fault(core: &Core, why: Cause) {
    let was_sound = core.board.note(|facts| {
        let worklist = facts.worklist.as_mut()?;
        let was_sound = worklist.fault.is_none();
        worklist.note(Some(why.clone()), Timestamp::now());
        Some(was_sound)
    });
    if was_sound == Some(true) {
        warn!(event = "worklist-out-of-reach", error = why.to_string());
    }
}

impl Booth {
    /// Takes an answer of the server for a day. Blocks.
    pub(super) fn note_worklist(&self, answer: WorklistAnswer, config: &WorklistConfig, day: Date) {
        let core = self.core();
        let is_id = |text: &str| core.identity.patient(text, SourceKind::Operator).is_some();
        // First: the numbers of the new list may be like ids.
        self.note_numbers(&answer.entries, is_id);
        let numbers = self.numbers_told();
        let list = Worklist::new(answer.entries, &config.filter, day, is_id)
            .with_unreadable(answer.unreadable);
        let (entries, left_out) = (list.entries(day).len(), list.left_out());
        let has_changed = self.replace_worklist(Some(list));
        let was_sound = core.board.note(|facts| {
            let worklist = facts.worklist.as_mut()?;
            let was_sound = worklist.fault.is_none() && worklist.answered.is_some();
            worklist.note(None, Timestamp::now());
            (worklist.entries, worklist.left_out) = (entries, left_out);
            worklist.edition += u64::from(has_changed);
            worklist.numbers = numbers;
            Some(was_sound)
        });
        if was_sound == Some(false) {
            info!(event = "worklist-in-reach", count = entries);
        }
    }

    /// Notes what an answer shows of the hospital's accession numbers. If the journal fails, it holds for this run, and
    /// the next answer tries again.
    fn note_numbers(&self, answer: &[WorklistEntry], is_id: impl Fn(&str) -> bool) {
        let mut known = self.worklist.numbers();
        let seen = known.unwrap_or_default().seen_with(answer, is_id);
        *known = Some(seen);
        drop(known);
        let core = self.core();
        core.logged(core.custody.journal().keep_accession_numbers(&id_rules(core), seen));
    }

    /// What is known of the numbers, where somebody reads codes.
    fn numbers_told(&self) -> Option<AccessionNumbers> {
        let has_reader = self.core().config.trigger.reader.is_some();
        self.worklist.numbers().filter(|_| has_reader)
    }

    /// Forgets the list once its day is over.
    pub(super) fn end_worklist(&self, today: Date) {
        if self.worklist.list().as_ref().is_none_or(|list| !list.is_over(today)) {
            return;
        }
        self.replace_worklist(None);
        self.core().board.note(|facts| {
            if let Some(worklist) = &mut facts.worklist {
                (worklist.entries, worklist.left_out) = (0, 0);
                worklist.edition += 1;
            }
        });
    }

    /// Returns whether it is another list than before.
    fn replace_worklist(&self, new: Option<Worklist>) -> bool {
        let mut list = self.worklist.list();
        let has_changed = *list != new;
        *list = new;
        has_changed
    }
}
