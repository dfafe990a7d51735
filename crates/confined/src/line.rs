//! What a confined process and the one that started it say to each other: a value as JSON in a line.

use std::io::{self, BufRead, Read, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Writes a line.
///
/// # Errors
/// Any I/O error.
pub fn write_line(to: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    let mut line = serde_json::to_vec(value)?;
    line.push(b'\n');
    to.write_all(&line)
}

/// Reads a line of at most so many bytes.
///
/// # Errors
/// Any I/O error; `UnexpectedEof` if no line ends there; `InvalidData` if it is no such value.
pub fn read_line<T: DeserializeOwned>(from: &mut impl BufRead, most: u64) -> io::Result<T> {
    let mut line = Vec::new();
    from.take(most).read_until(b'\n', &mut line)?;
    if line.last() != Some(&b'\n') {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    serde_json::from_slice(&line).map_err(|why| io::Error::new(io::ErrorKind::InvalidData, why))
}
