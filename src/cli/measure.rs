//! `gaiter measure`: the station's measuring process.

use std::io;

use super::args::MeasureArgs;
use super::{Exit, complain};
use crate::station::measure::child;

/// Reads the scan on standard input and writes the answer to standard output.
pub fn measure(args: &MeasureArgs) -> Exit {
    match child::serve(args.hash.as_deref(), io::stdin().lock(), io::stdout().lock()) {
        Ok(()) => Exit::Done,
        Err(error) => {
            complain(format_args!("gaiter measure: {error}"));
            Exit::Internal
        }
    }
}
