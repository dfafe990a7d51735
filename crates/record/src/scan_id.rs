//! A scan's identity: the SHA-256 of its bytes.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::files::{hex, sha256};

/// How many characters of an id are used in logs, lists and folder names.
pub const SHORT: usize = 8;

/// The SHA-256 of a scan's bytes, 64 lower-case hexadecimal digits; safe as a file name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub struct ScanId(String);

impl ScanId {
    /// The id of a scan's bytes.
    pub fn of_bytes(bytes: &[u8]) -> ScanId {
        ScanId(sha256(bytes))
    }

    /// The id of a finished digest.
    pub fn of_digest(digest: [u8; 32]) -> ScanId {
        ScanId(hex(&digest))
    }

    /// Parses an id as written in the journal and in folder names; `None` for anything but 64 lower-case
    /// hexadecimal digits.
    pub fn parse(text: &str) -> Option<ScanId> {
        let hexadecimal = text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        (text.len() == 64 && hexadecimal).then(|| ScanId(text.to_owned()))
    }

    /// All 64 digits.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The first eight digits: enough for logs and, with a time, for folder names.
    pub fn short(&self) -> &str {
        &self.0[..SHORT]
    }
}

/// A text that is no [`ScanId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a scan's hash has 64 lower-case hexadecimal digits; this text has not")]
pub struct NoScanId;

impl TryFrom<String> for ScanId {
    type Error = NoScanId;

    fn try_from(text: String) -> Result<ScanId, NoScanId> {
        ScanId::parse(&text).ok_or(NoScanId)
    }
}

impl fmt::Display for ScanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_digest_is_written_in_lower_case_hexadecimal() {
        let mut digest = [0; 32];
        digest[0] = 0xab;
        digest[31] = 0x07;
        let id = ScanId::of_digest(digest);
        assert_eq!(id.short(), "ab000000");
        assert!(id.as_str().ends_with("07"));
        assert_eq!(ScanId::parse(id.as_str()), Some(id));
    }

    #[test]
    fn a_text_that_could_leave_its_folder_is_no_scan_id() {
        for text in ["", "..", "../../etc/passwd", &"A".repeat(64), &"é".repeat(32)] {
            assert_eq!(ScanId::parse(text), None, "{text}");
        }
    }
}
