//! `gaiter demo`: a placeholder that the verb itself replaces.

use super::args::DemoArgs;
use super::{Exit, complain};

/// Ends as an internal error until the verb is there.
pub fn demo(_args: &DemoArgs) -> Exit {
    complain("gaiter demo is not built in yet");
    Exit::Internal
}
