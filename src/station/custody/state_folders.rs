//! Checks that the folders in which the station keeps its data still exist. Another process may have
//! removed one while the station ran.

use gaiter_flow::facts::Alarm;
use jiff::Timestamp;
use tracing::{error, warn};

use super::Custody;
use crate::station::board::Board;

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
    let raise = |code, message| {
        let alarm = Alarm { message, since: Timestamp::now() };
        board.note(|facts| {
            facts.alarms.entry(code).or_insert(alarm);
        });
    };
    // First, so that nobody finds the folders there and the alarm not yet.
    let lost = "scans in them that were not delivered must be exported again";
    raise(MADE_ANEW, format!("{names} removed from the state folder; {lost}"));
    match custody.make_folders_anew() {
        Ok(()) => {
            error!(event = "custody-made-anew", folders = names);
            board.note(|facts| {
                facts.alarms.remove(MISSING);
            });
        }
        Err(error) => {
            warn!(event = "custody-missing", folders = names, %error);
            raise(MISSING, format!("{names} in the state folder cannot be created again: {error}"));
        }
    }
}
