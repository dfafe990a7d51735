//! One file of a record folder.

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
