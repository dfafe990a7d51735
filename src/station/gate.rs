//! The gate of the intake: whether a scan may be taken in at all. What stands before it is left
//! where it is, and looked at again.

use std::sync::{Mutex, PoisonError};

use tracing::{info, warn};

use super::assembly::Station;
use super::file_system;
use crate::flow::Space;
use crate::flow::facts::IntakeState;

/// The gate.
#[derive(Debug)]
pub struct Gate(Mutex<Space>);

impl Gate {
    /// A gate that shuts before less than `floor_bytes` are free.
    pub fn new(floor_bytes: u64) -> Gate {
        Gate(Mutex::new(Space::new(floor_bytes)))
    }
}

impl Station {
    /// Whether `size_bytes` may be taken in now; notes it on the board. Blocks.
    pub fn intake_gate(&self, size_bytes: u64) -> IntakeState {
        // A disk that cannot be asked says by a fault of its own what is wrong with it.
        let free = file_system::free_bytes(&self.config.station.state_dir).unwrap_or(u64::MAX);
        let mut space = self.gate.0.lock().unwrap_or_else(PoisonError::into_inner);
        let has_room = space.admits(free, size_bytes);
        let state = if self.is_paused() {
            IntakeState::Paused
        } else if has_room {
            IntakeState::Open
        } else {
            IntakeState::DiskLow { free, floor: space.floor_bytes() }
        };
        let mut before = state;
        self.board.note(|facts| before = std::mem::replace(&mut facts.intake, state));
        match (before, state) {
            (IntakeState::DiskLow { .. }, IntakeState::DiskLow { .. }) => {}
            (_, IntakeState::DiskLow { free, floor }) => {
                warn!(event = "disk-low", free_bytes = free, floor_bytes = floor);
            }
            (IntakeState::DiskLow { .. }, _) => info!(event = "disk-free-again", free_bytes = free),
            _ => {}
        }
        state
    }
}
