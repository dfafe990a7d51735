//! `gaiter gdt-order`: the practice software starts this program with the order's file.

use std::fs::File;
use std::io::{self, Read};

use gaiter_record::gdt::order::ORDER_MOST;

use crate::cli::args::GdtOrderArgs;
use crate::cli::{Exit, ask, complain, shown};
use crate::station::operator::control::protocol::Request;

/// Sends an order to the running station.
pub fn order(args: &GdtOrderArgs) -> Exit {
    let mut bytes = Vec::new();
    // Reads one byte more than an order can have, so that the station sees that it is too large.
    let read =
        File::open(&args.file).and_then(|file| file.take(ORDER_MOST + 1).read_to_end(&mut bytes));
    match read {
        Ok(_) => ask::sentence(&args.ask, &Request::Order { bytes }),
        Err(error) => {
            complain(format_args!("gaiter: {}: {error}", shown(args.file.display())));
            match error.kind() {
                io::ErrorKind::NotFound => Exit::NoFile,
                _ => Exit::Io,
            }
        }
    }
}
