//! Follows the clock on the wall, for what is let go by it. Its jumps are seen as they happen: what is
//! noted while it lies must not look old once it is right.

use jiff::Timestamp;

use crate::flow::trusted_time::{Seen, TrustedTime};
use crate::station::assembly::Station;
use crate::station::journal::JournalError;

/// What is known of the clock; nothing before the first look.
#[derive(Debug, Default)]
pub struct Timekeeper(Option<TrustedTime>);

impl Timekeeper {
    /// Looks at the clocks, and gives the time that is believed. A jump is kept for the next run, and where
    /// it is asked for the time as well. Blocks.
    ///
    /// # Errors
    /// Where the journal fails; then the clock is looked at again.
    pub fn look(&mut self, station: &Station, keeps: bool) -> Result<Timestamp, JournalError> {
        let journal = station.custody.journal();
        let wall = Timestamp::now();
        let (since_boot, boot) = (station.now(), station.booth.boot().to_owned());
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
