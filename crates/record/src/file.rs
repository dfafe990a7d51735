//! One file of a record folder.

use serde::Serialize;

/// One file of a record folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordFile {
    /// File name within the folder, ASCII, no separators.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

pub(super) fn file(name: &str, bytes: Vec<u8>) -> RecordFile {
    RecordFile { name: name.to_owned(), bytes }
}

/// A record or an order as the bytes of its file.
///
/// # Errors
/// If a figure cannot be written as JSON.
pub fn json(of: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    let mut json = serde_json::to_vec_pretty(of)?;
    json.push(b'\n');
    Ok(json)
}
