//! What lies in a file of the folder of orders.

use std::io;
use std::path::Path;

use crate::flow::{OrderState, Stamp};
use crate::record::gdt::order::ORDER_MOST;
use crate::station::intake::stable_read;
use crate::station::stall::Pulse;
use crate::store::sums;

/// A file that was read.
#[derive(Debug)]
pub struct Read {
    /// What tells it from the one that was heard.
    pub state: OrderState,
    /// Its bytes; empty where it is too large to be an order.
    pub bytes: Vec<u8>,
    /// Device and inode.
    pub file: (u64, u64),
}

impl Read {
    /// Whether it is too large to be an order; it is not read then.
    pub fn is_too_large(&self) -> bool {
        self.state.size > ORDER_MOST
    }
}

/// Reads a file, if it is in this state before and after; else none.
///
/// # Errors
/// Any other I/O error.
pub fn read(path: &Path, stamp: Stamp, pulse: &Pulse) -> io::Result<Option<Read>> {
    let Stamp { dev, ino, size, mtime_ns, .. } = stamp;
    let of = |bytes: Vec<u8>, digest| {
        let state = OrderState { size, mtime_ns, digest };
        Read { state, bytes, file: (dev, ino) }
    };
    if size > ORDER_MOST {
        return Ok(Some(of(Vec::new(), String::new())));
    }
    let Some(bytes) = stable_read::bytes(path, stamp, pulse)? else { return Ok(None) };
    let digest = sums::scan_id(&bytes).as_str().to_owned();
    Ok(Some(of(bytes, digest)))
}
