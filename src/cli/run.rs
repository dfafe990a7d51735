//! `gaiter run`: a placeholder that the verb itself replaces.

use super::args::RunArgs;
use super::{Exit, complain};

/// Ends as an internal error until the verb is there.
pub fn run(_args: &RunArgs) -> Exit {
    complain("gaiter run is not built in yet");
    Exit::Internal
}
