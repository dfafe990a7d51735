//! Whether what lies in the store, the spool or the quarantine is whole.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sha2::{Digest, Sha256};

/// How entries of the quarantine begin that stand for files too large to be read.
pub const UNREAD: &str = "unread-";

/// `sha256sum -c SHA256SUMS`, that it lists every file, and that the folder is named after its
/// scan; the sum of the scan.
pub fn whole_record(record: &Path) -> Result<String, String> {
    let sums = fs::read_to_string(record.join("SHA256SUMS")).map_err(|e| format!("sums: {e}"))?;
    let mut listed = BTreeSet::from(["SHA256SUMS".to_owned()]);
    let mut scan = None;
    for line in sums.lines() {
        let (sum, name) = line.split_once("  ").ok_or("a line is no sum and name")?;
        let bytes = fs::read(record.join(name)).map_err(|error| format!("{name}: {error}"))?;
        if sha256(&bytes) != sum {
            return Err(format!("{name} is not what its sum says"));
        }
        if !listed.insert(name.to_owned()) {
            return Err(format!("{name} is listed twice"));
        }
        if name.starts_with("scan.") {
            scan = Some(sum.to_owned());
        }
    }
    if names(record).into_iter().collect::<BTreeSet<_>>() != listed {
        return Err(format!("holds {:?}, lists {listed:?}", names(record)));
    }
    let scan = scan.ok_or("the scan's own bytes are not there")?;
    let name = record.file_name().unwrap_or_default().to_string_lossy().into_owned();
    // A later revision bears its number behind.
    let first = name.split("_r").next().unwrap_or_default();
    match first.split_once('_') {
        Some((time, digits))
            if time.len() == 16 && digits.len() == 8 && scan.starts_with(digits) =>
        {
            Ok(scan)
        }
        _ => Err(format!("holds {scan}")),
    }
}

/// Whether a folder of the spool or the quarantine is whole: its document is one, and the bytes
/// are those of its name.
pub fn whole_entry(folder: &Path, name: &str, document: &str) -> Result<(), String> {
    let text = fs::read(folder.join(document)).map_err(|error| error.to_string())?;
    let text: Value = serde_json::from_slice(&text).map_err(|error| error.to_string())?;
    if !text["schema"].as_str().is_some_and(|schema| schema.starts_with("gaiter.")) {
        return Err("it has no schema".to_owned());
    }
    if name.starts_with(UNREAD) {
        return Ok(());
    }
    let scan = names(folder).into_iter().find(|name| name.starts_with("scan."));
    let scan = scan.ok_or("the scan's bytes are not there")?;
    let sum = sha256(&fs::read(folder.join(scan)).map_err(|error| error.to_string())?);
    if sum == name { Ok(()) } else { Err(format!("holds {sum}")) }
}

/// SHA-256, lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The names in a folder, sorted; none where there is no folder.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<String> = entries
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name != "lost+found")
        .collect();
    names.sort();
    names
}

/// Those that are not hidden.
pub fn final_names(folder: &Path) -> Vec<String> {
    names(folder).into_iter().filter(|name| !name.starts_with('.')).collect()
}

/// The folders in a folder.
pub fn folders(within: &Path) -> Vec<String> {
    names(within).into_iter().filter(|name| within.join(name).is_dir()).collect()
}
