//! Checks that the folders in which the station keeps its data still exist. Another process may have
//! removed one while the station ran.

use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::ComplaintFigures;
use tracing::{error, warn};

use super::Custody;
use crate::station::board::Board;
use crate::station::runtime::locked;

/// Alarm: folders were removed while the station ran. It stays until the next start, because the files
/// that were in them are lost.
const MADE_ANEW: &str = "custody-made-anew";

/// Alarm: folders cannot be created again.
const MISSING: &str = "custody-missing";

/// Raises an alarm for removed folders and creates them again. Blocks, on the local disk only.
pub fn look_after(custody: &Custody, board: &Board) {
    let missing = custody.missing_folders();
    if missing.is_empty() {
        return;
    }
    let names = missing.join(", ");
    let removed = {
        let mut removed = locked(&custody.removed);
        removed.extend(missing);
        removed.iter().copied().collect::<Vec<_>>().join(", ")
    };
    // First, so that nobody finds the folders there and the alarm not yet.
    board.raise(MADE_ANEW, ComplaintFigures::default().words("folders", removed));
    match custody.make_folders_anew() {
        Ok(()) => {
            error!(event = "custody-made-anew", folders = names);
            board.clear(MISSING);
        }
        Err(error) => {
            warn!(event = "custody-missing", folders = names, %error);
            let why = ComplaintFigures::why(&Cause::of_system(&error));
            board.raise(MISSING, why.words("folders", &names));
        }
    }
}
