//! The content of a file in the folder of orders.

use std::io;
use std::path::Path;

use gaiter_flow::{OrderState, Stamp};
use gaiter_record::gdt::order::ORDER_MOST;

use crate::station::share::stall::StepCounter;
use crate::station::share::stamped_file;
use crate::store::sums;

/// A file that was read.
#[derive(Debug)]
pub struct Read {
    /// Distinguishes it from the order that was applied.
    pub state: OrderState,
    /// Its bytes; empty if it is too large to be an order.
    pub bytes: Vec<u8>,
    /// Device and inode.
    pub file: (u64, u64),
}

impl Read {
    /// Whether it is too large to be an order; then it is not read.
    pub fn is_too_large(&self) -> bool {
        self.state.size > ORDER_MOST
    }
}

/// Reads a file if it is in this state before and after; otherwise returns `None`.
///
/// # Errors
/// Any other I/O error.
pub fn read(path: &Path, stamp: Stamp, counter: &StepCounter) -> io::Result<Option<Read>> {
    let Stamp { dev, ino, size, mtime_ns, .. } = stamp;
    let of = |bytes: Vec<u8>, digest| {
        let state = OrderState { size, mtime_ns, digest };
        Read { state, bytes, file: (dev, ino) }
    };
    if size > ORDER_MOST {
        return Ok(Some(of(Vec::new(), String::new())));
    }
    let Some(bytes) = stamped_file::bytes(path, stamp, counter)? else { return Ok(None) };
    let digest = sums::scan_id(&bytes).as_str().to_owned();
    Ok(Some(of(bytes, digest)))
}
