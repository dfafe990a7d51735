//! `gaiter measure`: the station's measuring process.

use std::io;

use super::args::MeasureArgs;
use super::{Exit, complain};
use crate::station::measure::child;

/// Measures the scan on standard input and writes the record's files to standard output.
pub fn measure(args: &MeasureArgs) -> Exit {
    match child::serve(&args.hash, io::stdin().lock(), io::stdout().lock()) {
        Ok(()) => Exit::Done,
        Err(error) => {
            complain(format_args!("gaiter measure: {error}"));
            Exit::Internal
        }
    }
}
