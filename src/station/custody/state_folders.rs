//! The folders that hold what the station keeps: whether they still stand. Somebody may have removed one
//! while the station ran.

use jiff::Timestamp;
use tracing::{error, warn};

use crate::flow::facts::Alarm;
use crate::station::assembly::Station;

/// The alarm of folders that were removed while the station ran. It stays until the next start: what lay
/// in them is gone.
const MADE_ANEW: &str = "custody-made-anew";

/// The alarm of folders that cannot be made again.
const MISSING: &str = "custody-missing";

/// Makes folders anew that somebody has removed, and says so. Blocks, on the local disk only.
pub fn look_after(station: &Station) {
    let missing = station.custody.missing_folders();
    if missing.is_empty() {
        return;
    }
    let names = missing.join(", ");
    let (code, message) = match station.custody.make_folders_anew() {
        Ok(()) => {
            error!(event = "custody-made-anew", folders = names);
            let lost = "scans that lay there and were not delivered must be exported again";
            (MADE_ANEW, format!("somebody removed {names} from the state folder; {lost}"))
        }
        Err(error) => {
            warn!(event = "custody-missing", folders = names, %error);
            (MISSING, format!("{names} of the state folder cannot be made again: {error}"))
        }
    };
    station.board.note(|facts| {
        if code == MADE_ANEW {
            facts.alarms.remove(MISSING);
        }
        facts.alarms.entry(code).or_insert(Alarm { message, since: Timestamp::now() });
    });
}
