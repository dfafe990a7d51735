//! The record of a scan that the first store has. What other stores are given is made of it, where it is there and
//! whole: after a restart, or a change of the method or the language, a new measurement may have other figures.

use std::io;
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use gaiter_record::{RecordFile, SUMS};

use crate::station::core::Core;
use crate::station::journal::{Due, JournalError};
use crate::store::revision::families;
use crate::store::revision::stored::{Stored, StoredFault};

/// A share that does not answer for so long is not waited for: the scan is measured.
const READ_LIMIT: Duration = Duration::from_secs(10);

/// The latest revision of the record in a folder, and its files except the scan, `SHA256SUMS` last.
pub(super) fn latest(folder: &Path) -> Result<(Stored, Vec<RecordFile>), StoredFault> {
    let family = families(folder).map_err(io::Error::other)?.pop();
    let stored = match &family {
        Some(family) => Stored::read(family)?,
        None => Stored::in_folder(folder)?,
    };
    let files = files_of(&stored)?;
    Ok((stored, files))
}

/// The files of the record of a scan for a patient as it was first stored, except the scan; `None` if the first store
/// has none that is whole, or does not answer. Blocks.
pub(super) fn first(core: &Core, due: &Due) -> Result<Option<Vec<RecordFile>>, JournalError> {
    let Some(folder) = core.custody.journal().record_folder(&due.scan, due.patient_cell())? else {
        return Ok(None);
    };
    let scan = due.scan.to_string();
    let (found, read) = mpsc::channel();
    let thread = thread::Builder::new().name("stored-record".to_owned()).spawn(move || {
        let stored = Stored::in_folder(Path::new(&folder)).ok();
        let stored = stored.filter(|stored| stored.record.scan.sha256 == scan);
        // Fails if nobody waits for it any more.
        let _ = found.send(stored.and_then(|stored| files_of(&stored).ok()));
    });
    Ok(thread.ok().and_then(|_| read.recv_timeout(READ_LIMIT).ok()).flatten())
}

fn files_of(stored: &Stored) -> io::Result<Vec<RecordFile>> {
    let names = stored.listed.iter().filter(|name| **name != stored.scan_file);
    let names = names.map(String::as_str).chain([SUMS]);
    names
        .map(|name| Ok(RecordFile { name: name.to_owned(), bytes: stored.listed_file(name)? }))
        .collect()
}
