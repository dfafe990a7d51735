//! How scans and records are packed: Zstandard, whose packed bytes are checked by the hash of what comes out.

use std::io::{self, Read};

use ruzstd::decoding::StreamingDecoder;
use ruzstd::decoding::errors::FrameDecoderError;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

/// Why bytes cannot be unpacked.
#[derive(Debug, thiserror::Error)]
pub enum PackingFault {
    /// They are not packed, or want more memory than any of ours.
    #[error("they are not packed by Zstandard as gaiter does it: {0}")]
    NotPacked(#[from] FrameDecoderError),
    /// They are damaged.
    #[error("they are damaged: {0}")]
    Damaged(#[from] io::Error),
    /// What comes out is longer than it may be.
    #[error("they hold more than {most} bytes")]
    TooLong {
        /// The most that was expected, bytes.
        most: u64,
    },
}

/// Packs bytes. The same bytes give the same.
pub fn packed(bytes: &[u8]) -> Vec<u8> {
    compress_to_vec(bytes, CompressionLevel::Fastest)
}

/// Unpacks bytes that hold no more than `most`.
///
/// # Errors
/// See [`PackingFault`].
pub fn unpacked(bytes: &[u8], most: u64) -> Result<Vec<u8>, PackingFault> {
    let mut found = Vec::new();
    StreamingDecoder::new(bytes)?.take(most.saturating_add(1)).read_to_end(&mut found)?;
    match found.len() as u64 > most {
        true => Err(PackingFault::TooLong { most }),
        false => Ok(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_packed_comes_out_and_no_more_than_expected() {
        let text = "v 1.0 2.0 3.0\n".repeat(10_000);
        let small = packed(text.as_bytes());
        assert!(small.len() * 4 < text.len(), "{} bytes", small.len());
        let length = text.len() as u64;
        assert_eq!(unpacked(&small, length).unwrap(), text.as_bytes());
        assert!(matches!(unpacked(&small, length - 1), Err(PackingFault::TooLong { .. })));
        assert_eq!(unpacked(&packed(b""), 0).unwrap(), b"");
    }

    #[test]
    fn what_is_cut_or_no_package_is_told() {
        let whole = packed(&(0..=255).collect::<Vec<u8>>());
        for end in 0..whole.len() {
            let short = unpacked(&whole[..end], 1000);
            assert!(!short.is_ok_and(|found| found.len() == 256), "{end}");
        }
        assert!(unpacked(b"v 0 0 0\n", 1000).is_err());
    }
}
