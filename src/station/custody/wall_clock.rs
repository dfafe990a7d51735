//! Follows the wall clock, by which old data is deleted. Jumps are detected as they happen: what is
//! noted while the clock is wrong must not look old once it is right.

use gaiter_flow::trusted_time::{Seen, TrustedTime};
use jiff::Timestamp;

use crate::station::journal::{Journal, JournalError};
use crate::station::runtime::clock::Clock;

/// What is known about the clock; nothing before the first reading.
#[derive(Debug, Default)]
pub struct Timekeeper(Option<TrustedTime>);

impl Timekeeper {
    /// Reads the clocks and returns the trusted time. Saves the state for the next run after a jump, or
    /// if `keeps` is set. Blocks.
    ///
    /// # Errors
    /// If the journal fails; the next call reads the clocks again.
    pub fn look(
        &mut self,
        journal: &Journal,
        clock: &Clock,
        keeps: bool,
    ) -> Result<Timestamp, JournalError> {
        let wall = Timestamp::now();
        let (since_boot, boot) = (clock.now(), clock.boot().to_owned());
        let now = Seen { wall, since_boot, boot };
        let (before, ran) = match &self.0 {
            Some(before) => (before.clone(), true),
            None => (journal.trusted_time()?, false),
        };
        let has_jumped = before.is_jump(&now);
        let time = before.at(now, ran);
        if keeps || has_jumped || !ran {
            journal.keep_time(&time)?;
        }
        let believed = time.now().unwrap_or(wall);
        self.0 = Some(time);
        Ok(believed)
    }
}
