//! The gate of the intake: decides whether a scan may be taken in at all. A file that is not admitted
//! stays where it is and is tried again.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use gaiter_flow::Space;
use gaiter_flow::facts::IntakeState;
use tracing::{info, warn};

use crate::station::board::Board;
use crate::station::share::file_system;

/// The gate.
#[derive(Debug)]
pub struct Gate {
    state_dir: PathBuf,
    space: Mutex<Space>,
}

impl Gate {
    /// A gate that closes before less than `floor_bytes` are free on the disk of the state folder.
    pub fn new(state_dir: PathBuf, floor_bytes: u64) -> Gate {
        Gate { state_dir, space: Mutex::new(Space::new(floor_bytes)) }
    }

    /// Decides whether `size_bytes` may be taken in now, and notes it on the board. Blocks.
    pub fn judge(&self, size_bytes: u64, is_paused: bool, board: &Board) -> IntakeState {
        // A disk that cannot be queried reports its fault elsewhere.
        let free = file_system::free_bytes(&self.state_dir).unwrap_or(u64::MAX);
        let mut space = self.space.lock().unwrap_or_else(PoisonError::into_inner);
        let has_room = space.admits(free, size_bytes);
        let state = if is_paused {
            IntakeState::Paused
        } else if has_room {
            IntakeState::Open
        } else {
            IntakeState::DiskLow { free, floor: space.floor_bytes() }
        };
        let mut before = state;
        board.note(|facts| before = std::mem::replace(&mut facts.intake, state));
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
