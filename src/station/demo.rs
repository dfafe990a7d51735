//! The simulated scanner and button of `gaiter demo`. The scanner writes recorded exports the way a scanner
//! does, in pieces over some seconds. The button is a box at the end of a pseudo-terminal, which the station
//! attends like any serial port.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Duration;

use serialport::{SerialPort, TTYPort};
use tokio::time::sleep;

/// The line that the box sends when it is pressed.
pub const PRESS: &str = "PRESS";

/// The box.
#[derive(Debug)]
pub struct SimulatedButton {
    box_end: TTYPort,
    port: PathBuf,
}

impl SimulatedButton {
    /// Creates a box and the port that it is connected to, for `trigger.serial.port`.
    ///
    /// # Errors
    /// If the system has no pseudo-terminals.
    pub fn new() -> io::Result<SimulatedButton> {
        let (box_end, port_end) = TTYPort::pair()?;
        // The station opens its end by name. That end is free as soon as `port_end` is dropped here.
        let port = port_end.name().map(PathBuf::from).unwrap_or_default();
        Ok(SimulatedButton { box_end, port })
    }

    pub fn port(&self) -> &PathBuf {
        &self.port
    }

    /// Presses the button.
    ///
    /// # Errors
    /// If nothing reads what it sends.
    pub fn press(&mut self) -> io::Result<()> {
        self.box_end.write_all(PRESS.as_bytes())?;
        self.box_end.write_all(b"\r\n")
    }
}

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

/// Writes an export piece by piece, straight under its final name. An existing file is an error.
pub async fn write(export: Export) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(&export.path)?;
    let piece_bytes = export.bytes.len().div_ceil(PIECES).max(1);
    for piece in export.bytes.chunks(piece_bytes) {
        file.write_all(piece)?;
        sleep(export.takes / PIECES as u32).await;
    }
    Ok(())
}
