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

/// Creates removed folders again and raises an alarm. Blocks, on the local disk only.
pub fn look_after(custody: &Custody, board: &Board) {
    let missing = custody.missing_folders();
    if missing.is_empty() {
        return;
    }
    let names = missing.join(", ");
    // In one step with the alarm, so that no answer finds the folders there and the alarm not yet.
    board.note(|facts| {
        let (code, message) = match custody.make_folders_anew() {
            Ok(()) => {
                error!(event = "custody-made-anew", folders = names);
                facts.alarms.remove(MISSING);
                let lost = "scans in them that were not delivered must be exported again";
                (MADE_ANEW, format!("{names} removed from the state folder; {lost}"))
            }
            Err(error) => {
                warn!(event = "custody-missing", folders = names, %error);
                (MISSING, format!("{names} in the state folder cannot be created again: {error}"))
            }
        };
        facts.alarms.entry(code).or_insert(Alarm { message, since: Timestamp::now() });
    });
}
