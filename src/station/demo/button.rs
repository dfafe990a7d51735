//! The simulated button of `gaiter demo`: a box at the end of a pseudo-terminal, which the station
//! attends like any serial port.

use std::io::{self, Write};
use std::path::PathBuf;

use serialport::{SerialPort, TTYPort};

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

    /// The port's path.
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
