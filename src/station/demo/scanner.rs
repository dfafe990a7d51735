//! The simulated scanner of `gaiter demo`: writes recorded exports the way a scanner does, in
//! pieces over some seconds, straight under the final name.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Duration;

use tokio::time::sleep;

/// An export is written in this many pieces.
const PIECES: usize = 12;

/// One export to be written.
#[derive(Debug, Clone)]
pub struct Export {
    /// The path to write to.
    pub path: PathBuf,
    /// The bytes to write; only the first half if the scanner is switched off half-way.
    pub bytes: Vec<u8>,
    /// How long the scanner takes.
    pub takes: Duration,
}

/// Writes an export piece by piece. An existing file is an error.
pub async fn write(export: Export) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(&export.path)?;
    let piece_bytes = export.bytes.len().div_ceil(PIECES).max(1);
    for piece in export.bytes.chunks(piece_bytes) {
        file.write_all(piece)?;
        sleep(export.takes / PIECES as u32).await;
    }
    Ok(())
}
