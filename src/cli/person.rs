//! `gaiter patient disclose` and `gaiter patient erase`: all that a station holds of one person.

mod disclose;
mod erase;
mod files;
mod overview;
mod preview;
mod reach;
mod watch;

use super::args::{DiscloseArgs, EraseArgs};
use super::{Exit, complain, failed};
use reach::PersonFault;

/// Writes all that the station holds of a person into a folder.
pub fn disclose(args: &DiscloseArgs) -> Exit {
    ended(disclose::disclosed(args))
}

/// Erases all that the station holds of a person, once the id was given twice.
pub fn erase(args: &EraseArgs) -> Exit {
    ended(erase::erased(args))
}

fn ended(done: Result<Exit, PersonFault>) -> Exit {
    done.unwrap_or_else(|fault| {
        let exit = failed(&fault);
        if let Some(hint) = fault.hint() {
            complain(format_args!("  hint: {hint}"));
        }
        exit
    })
}
