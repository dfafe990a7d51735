//! `gaiter extract`: a placeholder that the verb itself replaces.

use super::args::ExtractArgs;
use super::{Exit, complain};

/// Ends as an internal error until the verb is there.
pub fn extract(_args: &ExtractArgs) -> Exit {
    complain("gaiter extract is not built in yet");
    Exit::Internal
}
