//! A pseudo-terminal as a serial port: the station has the slave, the test is the box.

#![allow(clippy::unwrap_used)]

use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serialport::{SerialPort, TTYPort};

/// The box at the end of a serial line.
pub struct Box {
    master: TTYPort,
    pub port: PathBuf,
}

impl Box {
    /// A box that is plugged in.
    pub fn new() -> Box {
        let (master, slave) = TTYPort::pair().unwrap();
        let port = PathBuf::from(slave.name().unwrap());
        Box { master, port }
    }

    /// A box whose port is found under a link, as udev makes them.
    pub fn behind(link: &Path) -> Box {
        let at = Box::new();
        // Replaced in one step, as udev does.
        let new = link.with_extension("new");
        symlink(&at.port, &new).unwrap();
        std::fs::rename(new, link).unwrap();
        at
    }

    pub fn sends(&mut self, bytes: &[u8]) {
        self.master.write_all(bytes).unwrap();
    }

    /// As [`Box::sends`], where the line may be full or dead.
    pub fn pours(&mut self, bytes: &[u8]) -> usize {
        self.master.set_timeout(Duration::from_millis(50)).unwrap();
        self.master.write(bytes).unwrap_or(0)
    }

    /// What the station has said by now.
    pub fn was_told(&mut self) -> Vec<u8> {
        let mut told = vec![0; 1024];
        self.master.set_timeout(Duration::from_millis(1)).unwrap();
        match self.master.read(&mut told) {
            Ok(count) => told.truncate(count),
            Err(error) => {
                assert!(
                    matches!(
                        error.kind(),
                        ErrorKind::TimedOut | ErrorKind::BrokenPipe | ErrorKind::Other
                    ),
                    "{error}"
                );
                told.clear();
            }
        }
        told
    }
}
