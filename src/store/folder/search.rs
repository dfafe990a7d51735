//! Finds records that are already in the store, and withdraws them.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{self, ErrorKind};
use std::iter;
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use gaiter_flow::patient::naming::{self, RecordName};
use gaiter_record::{ORD, RECORD};

use super::FolderStore;
use crate::store::brief::Brief;
use crate::store::sums::{self, SUMS};
use crate::store::{
    FoundRecord, Rejection, StoreFault, StoredScan, TakeBack, durable, folders, records_in, tried,
};

/// The beginning of the name of a file with measures that people set in a record that was withdrawn.
const SET_BY_HAND: &str = "set-by-hand";

/// Errors that mean that one record cannot leave its place; the store itself works.
pub(super) const KEEPS_IT: [ErrorKind; 6] = [
    ErrorKind::AlreadyExists,
    ErrorKind::DirectoryNotEmpty,
    ErrorKind::InvalidFilename,
    ErrorKind::IsADirectory,
    ErrorKind::NotADirectory,
    ErrorKind::PermissionDenied,
];

/// The complete record of a scan in a patient's folder, with any time: the first complete one of several
/// revisions.
pub(super) fn find(patient: &Path, scan: &ScanId) -> Result<Option<PathBuf>, StoreFault> {
    for place in candidates(patient, scan)? {
        if tried("checking", &place, sums::check(&place, scan))?.is_ok() {
            return Ok(Some(place));
        }
    }
    Ok(None)
}

/// The record folders named as the scan's would be, first revision first.
fn candidates(patient: &Path, scan: &ScanId) -> Result<Vec<PathBuf>, StoreFault> {
    let named = records_in(patient)?.into_iter();
    Ok(named.filter(|(name, _)| name.scan == scan.short()).map(|(_, place)| place).collect())
}

impl FolderStore {
    /// Every record in the store; of a scan's revisions, the first. Folders that are not named like our
    /// records do not count.
    ///
    /// # Errors
    /// A transient fault if a folder cannot be listed or read.
    pub(super) fn all_records(&self) -> Result<Vec<FoundRecord>, StoreFault> {
        let mut found = Vec::new();
        for patient in folders(&self.root)? {
            let name = patient.file_name().and_then(OsStr::to_str);
            let Some(id) = name.and_then(naming::patient_of_folder) else { continue };
            let mut last = None;
            for (name, folder) in records_in(&patient)? {
                let scan = Some((name.first_seen, name.scan.clone()));
                if scan != last
                    && let Some(record) = record(&name, folder, id.as_deref())?
                {
                    found.push(record);
                    last = scan;
                }
            }
        }
        Ok(found)
    }

    /// A scan from its complete record for this patient; `None` if there is none.
    ///
    /// # Errors
    /// A transient fault if the store cannot be read.
    pub(super) fn scan_in_record(
        &self,
        scan: &ScanId,
        patient: Option<&str>,
    ) -> Result<Option<StoredScan>, StoreFault> {
        let Some(folder) = self.own_folder(patient)? else { return Ok(None) };
        let Some(place) = find(&folder, scan)? else { return Ok(None) };
        let Some(name) = tried("reading", &place, sums::scan_name(&place, scan))? else {
            return Ok(None);
        };
        let read = |name: &str| {
            let path = place.join(name);
            tried("reading", &path, fs::read(&path))
        };
        let has_ord =
            tried("reading", &place, sums::listed(&place))?.iter().any(|name| name == ORD);
        let ord = has_ord.then(|| read(ORD)).transpose()?;
        Ok(Some(StoredScan { bytes: read(&name)?, ord }))
    }

    /// Withdraws the record of a scan, with all its revisions, from one patient or from the folder of
    /// unassigned scans. The keeper's folder must hold a complete record. What people set goes into a file
    /// there, without effect.
    ///
    /// # Errors
    /// See [`StoreFault`]: a permanent one if a revision was changed by hand, then all stay.
    pub(super) fn withdraw_in_reach(&self, record: &TakeBack<'_>) -> Result<(), StoreFault> {
        let TakeBack { scan, from, keeper, .. } = *record;
        let Some(from) = self.own_folder(from)? else { return Ok(()) };
        let nowhere = StoreFault::Permanent(Rejection::Occupied(sums::SumsFault::NoSums));
        let theirs = self.own_folder(keeper)?;
        let gone = from.join(format!("{}withdrawn_{}", self.staging, scan.short()));
        tried("removing", &gone, durable::remove_folder(&gone))?;
        // Repeated until none is found: a re-extraction may add a revision meanwhile. A later one finds
        // the record gone and removes its revision itself.
        loop {
            let places = whole_records(&from, scan)?;
            if places.is_empty() {
                return Ok(());
            }
            let kept = theirs.as_ref().map(|theirs| find(theirs, scan)).transpose()?.flatten();
            let Some(kept) = kept else { return Err(nowhere) };
            if let Some(latest) = places.last() {
                tried("keeping what people set", latest, keep_amendments(latest, &kept))?;
            }
            for place in places {
                tried("moving notes", &place, move_unlisted(&place, &kept))?;
                tried("renaming", &place, durable::rename_new(&place, &gone))?;
                tried("syncing", &from, durable::sync_folder(&from))?;
                tried("removing", &gone, durable::remove_folder(&gone))?;
            }
        }
    }
}

/// The folders that hold complete records of a scan.
fn whole_records(patient: &Path, scan: &ScanId) -> Result<Vec<PathBuf>, StoreFault> {
    let mut whole = Vec::new();
    for place in candidates(patient, scan)? {
        match tried("checking", &place, sums::check(&place, scan))? {
            Ok(()) => whole.push(place),
            Err(sums::SumsFault::OtherScan) => {}
            Err(fault) => return Err(StoreFault::Permanent(Rejection::Occupied(fault))),
        }
    }
    Ok(whole)
}

/// Writes what people set in a record into a file beside the keeper's record. It does not count there:
/// whose leg they measured is not certain.
fn keep_amendments(from: &Path, to: &Path) -> io::Result<()> {
    /// The part of a record that is kept.
    #[derive(serde::Serialize, serde::Deserialize)]
    struct SetByHand {
        #[serde(default)]
        amendments: Vec<serde_json::Value>,
    }
    let bytes = fs::read(from.join(RECORD))?;
    let Ok(set) = serde_json::from_slice::<SetByHand>(&bytes) else { return Ok(()) };
    if set.amendments.is_empty() {
        return Ok(());
    }
    let record = from.file_name().unwrap_or_default().to_string_lossy();
    let name = OsString::from(format!("{SET_BY_HAND}.{record}.json"));
    let text = serde_json::to_vec_pretty(&set)?;
    let is_it = |kept: &Path| -> io::Result<bool> {
        let is_file = fs::symlink_metadata(kept)?.is_file();
        Ok(is_file && fs::read(kept)? == text)
    };
    keep(&name, from, to, is_it, |place| durable::write_new(place, &text))
}

/// Moves files that `SHA256SUMS` does not list, such as a person's notes, to another record.
fn move_unlisted(from: &Path, to: &Path) -> io::Result<()> {
    let listed = sums::listed(from)?;
    for entry in fs::read_dir(from)? {
        let name = entry?.file_name();
        let ours = name == SUMS || listed.iter().any(|listed| name == OsStr::new(listed));
        if ours {
            continue;
        }
        let note = from.join(&name);
        let is_it = |kept: &Path| are_same(&note, kept);
        keep(&name, from, to, is_it, |place| durable::rename_new(&note, place))?;
    }
    durable::sync_folder(to)
}

/// Puts a note of one record into another's folder, under the first name that is free there. If one with
/// the same bytes is met under these names, that one stands for it.
fn keep(
    name: &OsStr,
    from: &Path,
    to: &Path,
    is_it: impl Fn(&Path) -> io::Result<bool>,
    put: impl Fn(&Path) -> io::Result<()>,
) -> io::Result<()> {
    let record = from.file_name().and_then(OsStr::to_str).unwrap_or_default();
    for name in names(name, record) {
        let place = to.join(name);
        match put(&place) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                if is_it(&place)? {
                    break;
                }
            }
            done => return done,
        }
    }
    Ok(())
}

/// The names that a note of a record may get elsewhere: its own, one that states where it is from, and
/// numbered ones. What an earlier move put before its own is left out, so that names do not grow.
fn names(name: &OsStr, record: &str) -> impl Iterator<Item = OsString> {
    let own = name.to_str().and_then(|name| own_name(name, record)).map_or(name, OsStr::new);
    let others = (1_u32..).map(move |number| {
        let number = if number == 1 { String::new() } else { format!(".{number}") };
        let mut other = OsString::from(format!("{record}{number}."));
        other.push(own);
        other
    });
    iter::once(own.to_owned()).chain(others)
}

/// The own name of a note that got one of [`names`].
fn own_name<'a>(name: &'a str, record: &str) -> Option<&'a str> {
    let rest = name.strip_prefix(record)?.strip_prefix('.')?;
    let numbered = rest.split_once('.').filter(|(number, _)| number.parse::<u32>().is_ok());
    Some(numbered.map_or(rest, |(_, own)| own)).filter(|own| !own.is_empty())
}

/// Whether both are files with the same bytes.
fn are_same(a: &Path, b: &Path) -> io::Result<bool> {
    let [of_a, of_b] = [fs::symlink_metadata(a)?, fs::symlink_metadata(b)?];
    let may_be = of_a.is_file() && of_b.is_file() && of_a.len() == of_b.len();
    Ok(may_be && fs::read(a)? == fs::read(b)?)
}

/// The record in a folder of this name; `None` if the folder lists no such scan.
fn record(
    name: &RecordName,
    folder: PathBuf,
    patient: Option<&str>,
) -> Result<Option<FoundRecord>, StoreFault> {
    let Some((scan, file)) = tried("reading", &folder, sums::scan_of(&folder))? else {
        return Ok(None);
    };
    if scan.short() != name.scan {
        return Ok(None);
    }
    let size = fs::metadata(folder.join(&file)).map_or(0, |metadata| metadata.len());
    let format = file.rsplit('.').next().unwrap_or_default().to_owned();
    let (patient, first_seen) = (patient.map(str::to_owned), name.first_seen);
    // Nothing if it was changed so that it cannot be read.
    let brief = Brief::read(&folder.join(RECORD))?;
    let (named, acquired) = brief.map(|brief| (brief.patient, brief.acquired)).unzip();
    let named = named.flatten().filter(|named| Some(&named.id) == patient.as_ref());
    let request = named.and_then(|named| named.request().cloned());
    let acquired = acquired.flatten();
    Ok(Some(FoundRecord { scan, patient, request, acquired, first_seen, format, size, folder }))
}
