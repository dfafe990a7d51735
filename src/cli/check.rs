//! `gaiter check`

use super::args::CheckArgs;
use super::{Exit, complain};

/// Checks the configuration, then the environment.
pub fn check(_args: &CheckArgs) -> Exit {
    complain("gaiter check is not built in yet");
    Exit::Internal
}
