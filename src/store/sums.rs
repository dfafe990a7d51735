//! `SHA256SUMS`: shows whether a record folder is complete.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, BufReader, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

use gaiter_flow::ScanId;

/// The file that lists all others of a record folder; written last.
pub const SUMS: &str = "SHA256SUMS";

/// The name, without its ending, of the scan's own bytes in a record folder.
pub const SCAN: &str = "scan.";

/// How much of a file is hashed at a time, bytes: large enough that the calls cost nothing.
const PIECE_BYTES: usize = 64 * 1024;

/// Why a folder is not the complete record of a scan.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SumsFault {
    /// There is no `SHA256SUMS`, or it is not text.
    #[error("it has no readable SHA256SUMS")]
    NoSums,
    /// A line of `SHA256SUMS` is not a sum and a name.
    #[error("line {line} of its SHA256SUMS is not a checksum and a name")]
    Line {
        /// 1-based.
        line: usize,
    },
    #[error("its file {name:?} is missing")]
    Missing {
        /// The listed name.
        name: String,
    },
    /// A listed file has different bytes.
    #[error("its file {name:?} does not match SHA256SUMS")]
    Differs {
        /// The listed name.
        name: String,
    },
    /// It is the record of another scan, or of none.
    #[error("it holds another scan")]
    OtherScan,
}

/// The SHA-256 of bytes as a scan id.
pub fn scan_id(bytes: &[u8]) -> ScanId {
    ScanId::of_bytes(bytes)
}

/// The ids of the beginnings with these lengths, in bytes, in one pass; lengths past the end are
/// skipped.
pub fn of_beginnings(bytes: &[u8], lengths: &BTreeSet<usize>) -> BTreeMap<usize, ScanId> {
    let (mut digest, mut done) = (Sha256::new(), 0);
    let mut found = BTreeMap::new();
    for &length in lengths.range(..=bytes.len()) {
        digest.update(&bytes[done..length]);
        done = length;
        found.insert(length, ScanId::of_digest(digest.clone().finalize().into()));
    }
    found
}

/// Checks that a folder holds every file that its `SHA256SUMS` lists, with the right bytes, and that its
/// scan is the given one. Files that are not listed, such as a person's notes, do not matter.
///
/// # Errors
/// Outer: the folder cannot be read now. Inner: it is not the complete record of this scan.
pub fn check(folder: &Path, scan: &ScanId) -> io::Result<Result<(), SumsFault>> {
    let listed = match read(folder)? {
        Ok(listed) => listed,
        Err(fault) => return Ok(Err(fault)),
    };
    for (sum, name) in &listed {
        let Some(bytes) = readable(fs::read(folder.join(name)))? else {
            return Ok(Err(SumsFault::Missing { name: name.clone() }));
        };
        if scan_id(&bytes) != *sum {
            return Ok(Err(SumsFault::Differs { name: name.clone() }));
        }
    }
    let holds_scan = listed.iter().any(|(sum, name)| name.starts_with(SCAN) && sum == scan);
    Ok(if holds_scan { Ok(()) } else { Err(SumsFault::OtherScan) })
}

/// The scan that a folder lists, and the name of its file; `None` if it lists none. Reads only
/// `SHA256SUMS`.
///
/// # Errors
/// If the folder cannot be read now.
pub fn scan_of(folder: &Path) -> io::Result<Option<(ScanId, String)>> {
    let listed = read(folder)?.unwrap_or_default();
    Ok(listed.into_iter().find(|(_, name)| name.starts_with(SCAN)))
}

/// The name of the file that holds a scan's own bytes; `None` if the folder lists no such file.
///
/// # Errors
/// If the folder cannot be read now.
pub fn scan_name(folder: &Path, scan: &ScanId) -> io::Result<Option<String>> {
    Ok(scan_of(folder)?.filter(|(found, _)| found == scan).map(|(_, name)| name))
}

/// Checks bytes against the entry for this file in a folder's `SHA256SUMS`. Returns whether there is such
/// an entry: without one, nothing is known about the bytes.
///
/// # Errors
/// Outer: the sums cannot be read now. Inner: the bytes differ, or the sums cannot be parsed.
pub fn check_file(folder: &Path, name: &str, bytes: &[u8]) -> io::Result<Result<bool, SumsFault>> {
    let Some(sums) = readable(fs::read(folder.join(SUMS)))? else { return Ok(Ok(false)) };
    Ok(parse(&sums).and_then(|listed| {
        let mut own = listed.iter().filter(|(_, listed)| listed == name).peekable();
        let is_listed = own.peek().is_some();
        match own.all(|(sum, _)| *sum == scan_id(bytes)) {
            true => Ok(is_listed),
            false => Err(SumsFault::Differs { name: name.to_owned() }),
        }
    }))
}

/// A line of `SHA256SUMS`, in the format of `sha256sum`.
pub fn line(sum: &ScanId, name: &str) -> String {
    format!("{sum}  {name}\n")
}

/// The sum that a folder lists for a file; `None` if it lists no such file, or none that can be parsed.
///
/// # Errors
/// If the folder cannot be read now.
pub fn sum_of(folder: &Path, name: &str) -> io::Result<Option<ScanId>> {
    let listed = read(folder)?.unwrap_or_default();
    Ok(listed.into_iter().find(|(_, listed)| listed == name).map(|(sum, _)| sum))
}

/// The SHA-256 of what is left of a file, read to its end in pieces.
///
/// # Errors
/// If it cannot be read.
pub fn read_to_end(file: &mut impl Read) -> io::Result<ScanId> {
    let mut digest = Sha256::new();
    io::copy(&mut BufReader::with_capacity(PIECE_BYTES, file), &mut digest)?;
    Ok(ScanId::of_digest(digest.finalize().into()))
}

/// The names that `SHA256SUMS` lists; empty if it cannot be parsed.
///
/// # Errors
/// If the folder cannot be read now.
pub fn listed(folder: &Path) -> io::Result<Vec<String>> {
    let listed = read(folder)?.unwrap_or_default();
    Ok(listed.into_iter().map(|(_, name)| name).collect())
}

/// The lines of a folder's `SHA256SUMS`.
fn read(folder: &Path) -> io::Result<Result<Vec<(ScanId, String)>, SumsFault>> {
    Ok(match readable(fs::read(folder.join(SUMS)))? {
        Some(bytes) => parse(&bytes),
        None => Err(SumsFault::NoSums),
    })
}

/// `None` for a missing file, or a folder in its place, which is a finding about the record; any other error
/// is not.
pub fn readable<T>(read: io::Result<T>) -> io::Result<Option<T>> {
    use io::ErrorKind::{IsADirectory, NotADirectory, NotFound};
    match read {
        Ok(read) => Ok(Some(read)),
        Err(error) if matches!(error.kind(), NotFound | IsADirectory | NotADirectory) => Ok(None),
        Err(error) => Err(error),
    }
}

fn parse(bytes: &[u8]) -> Result<Vec<(ScanId, String)>, SumsFault> {
    let text = std::str::from_utf8(bytes).map_err(|_| SumsFault::NoSums)?;
    let entry = |(at, line): (usize, &str)| {
        let fault = SumsFault::Line { line: at + 1 };
        let (sum, name) = line.split_once(' ').ok_or(fault.clone())?;
        // The second character marks text or binary and means nothing on Linux.
        let name = name.strip_prefix([' ', '*']).ok_or(fault.clone())?;
        if !plain(name) {
            return Err(fault);
        }
        Ok((ScanId::parse(sum).ok_or(fault)?, name.to_owned()))
    };
    text.lines().enumerate().map(entry).collect()
}

/// Reports whether a name stays in its folder and is not hidden.
pub fn plain(name: &str) -> bool {
    !name.is_empty()
        && !name.starts_with('.')
        && name.bytes().all(|b| b.is_ascii_graphic() && b != b'/' && b != b'\\')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beginning_has_the_id_that_it_has_by_itself_and_one_that_is_too_long_has_none() {
        let bytes = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let found = of_beginnings(bytes, &BTreeSet::from([0, 8, 23, bytes.len(), 999]));
        let lengths = [0, 8, 23, bytes.len()];
        let expected = lengths.map(|length| (length, scan_id(&bytes[..length])));
        assert_eq!(found, BTreeMap::from(expected));
    }
}
