//! `gaiter extract`: measures scan files now, without a station.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rustix::fs::{CWD, RenameFlags, renameat_with};
use rustix::io::Errno;

use super::args::ExtractArgs;
use super::{Exit, complain, explain_config, ord, print, shown, table};
use crate::cad::Output;
use crate::config::{self, words};
use crate::leg::{Extraction, Method, Refusal, extract as measure};
use crate::record::{self, Provenance, RecordFile, ScanFile};
use crate::scan::Format;
use crate::store::durable;
use crate::store::sums::SUMS;

/// Measures every file, prints a table or a JSON line for each, and ends as the worst of them.
pub fn extract(args: &ExtractArgs) -> Exit {
    let choices = match Choices::of(args) {
        Ok(choices) => choices,
        Err(exit) => return exit,
    };
    if let Some(out) = &args.out
        && let Some([one, other]) = same_folder(&args.scans)
    {
        let stem = one.file_stem().unwrap_or_default();
        complain(format_args!(
            "gaiter: {} and {} would both go to {}; rename one, or measure them with different --out",
            shown(one.display()),
            shown(other.display()),
            shown(out.join(stem).display()),
        ));
        return Exit::Usage;
    }
    let several = args.scans.len() > 1;
    let one = |path: &PathBuf| match Measured::of(path, &choices.method) {
        Ok(measured) => match measured.deliver(args, &choices, several) {
            Ok(()) => Exit::Done,
            Err(fault) => {
                complain(format_args!("gaiter: {}: {fault}", shown(path.display())));
                Exit::Io
            }
        },
        Err(fault) => {
            complain(format_args!("gaiter: {}: {fault}", shown(path.display())));
            fault.exit()
        }
    };
    args.scans.iter().map(one).max().unwrap_or(Exit::Done)
}

/// How to measure and what to make of it.
struct Choices {
    method: Method,
    output: Output,
}

impl Choices {
    /// The configuration's, or the default ones, under what the command line says.
    fn of(args: &ExtractArgs) -> Result<Choices, Exit> {
        let (mut method, mut output) = match &args.config {
            Some(path) => {
                let config = config::read(path).map_err(|error| explain_config(&error))?;
                (config.method, config.output)
            }
            None => (Method::default(), Output::default()),
        };
        method.scope = args.scope.unwrap_or(method.scope);
        method.unit = args.unit.unwrap_or(method.unit);
        method.up = args.up.unwrap_or(method.up);
        method.facing = args.facing.unwrap_or(method.facing);
        method.at_heights_mm = args.at.clone().unwrap_or(method.at_heights_mm);
        if let Some(files) = &args.files {
            output.files = files.iter().copied().collect();
        }
        if words::faces_up_or_down(method.up, method.facing) {
            complain("gaiter: --facing points along the up axis; toes point square to it");
            return Err(Exit::Usage);
        }
        Ok(Choices { method, output })
    }
}

/// Two scans whose records would lie in the same folder.
fn same_folder(scans: &[PathBuf]) -> Option<[&Path; 2]> {
    let mut seen = BTreeMap::new();
    scans.iter().find_map(|scan| {
        let earlier = seen.insert(scan.file_stem()?, scan)?;
        Some([earlier.as_path(), scan.as_path()])
    })
}

/// Why a file gave no record.
#[derive(Debug, thiserror::Error)]
enum FileFault {
    /// It cannot be read.
    #[error("{0}")]
    Unreadable(#[source] io::Error),
    /// A read of it might never end, or give no file's content.
    #[error("is no regular file (a folder, a pipe or a device)")]
    NotAFile,
    /// It cannot be measured.
    #[error("cannot be measured [{}]: {refusal}", refusal.code())]
    Refused {
        /// Why not.
        #[from]
        refusal: Refusal,
    },
}

impl FileFault {
    fn exit(&self) -> Exit {
        match self {
            FileFault::Unreadable(error) if error.kind() == io::ErrorKind::NotFound => Exit::NoFile,
            FileFault::Unreadable(_) | FileFault::NotAFile => Exit::Io,
            FileFault::Refused { .. } => Exit::Unmeasurable,
        }
    }
}

/// A file that was measured.
struct Measured<'a> {
    path: &'a Path,
    bytes: Vec<u8>,
    format: Format,
    ord: Option<Vec<u8>>,
    extraction: Extraction,
    provenance: Provenance,
}

impl<'a> Measured<'a> {
    fn of(path: &'a Path, method: &Method) -> Result<Measured<'a>, FileFault> {
        // Before it is opened: opening a pipe waits for a writer.
        if !fs::metadata(path).map_err(FileFault::Unreadable)?.is_file() {
            return Err(FileFault::NotAFile);
        }
        let bytes = fs::read(path).map_err(FileFault::Unreadable)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let format = Format::of_file_name(&name).map_err(Refusal::from)?;
        let mut extraction = measure(&bytes, format, method)?;
        let (ord, opinions) = ord::opinions(path, &extraction);
        extraction.findings.extend(opinions);
        let sha256 = record::sha256(&bytes);
        let provenance = Provenance::of_scan(sha256);
        Ok(Measured { path, bytes, format, ord, extraction, provenance })
    }

    /// Prints the record and, where `--out` says so, writes its folder.
    fn deliver(
        &self,
        args: &ExtractArgs,
        choices: &Choices,
        several: bool,
    ) -> Result<(), Undelivered> {
        let Measured { path, bytes, format, ord, extraction, provenance } = self;
        let Choices { method, output } = choices;
        let (record, folder) = match &args.out {
            None => (record::record(extraction, provenance, method), None),
            Some(out) => {
                let scan = ScanFile { bytes, format: *format, ord: ord.as_deref() };
                let made = record::record_files(extraction, provenance, method, output, scan)?;
                (made.0, Some((out, made.1)))
            }
        };
        if args.json {
            print(format_args!("{}\n", serde_json::to_string(&record)?))?;
        } else {
            if several {
                print(format_args!("{}\n", shown(path.display())))?;
            }
            print(format_args!("{}\n", table::of(&record)))?;
        }
        // Beside its place first, then there whole. An earlier record of the same scan makes way;
        // anything else stays and is a fault.
        folder.map_or(Ok(()), |(out, files)| {
            let folder = out.join(path.file_stem().unwrap_or_default());
            put_folder(out, &folder, &files, &provenance.sha256)
        })
    }
}

/// Why a measured scan was not printed or written.
#[derive(Debug, thiserror::Error)]
enum Undelivered {
    /// Standard output or the figures themselves.
    #[error("the record cannot be printed: {0}")]
    Print(#[from] io::Error),
    /// The record cannot be written as JSON.
    #[error("the record cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A file or folder of the record.
    #[error("cannot write {}: {source}", shown(path.display()))]
    Write {
        /// Which.
        path: PathBuf,
        /// How it failed.
        source: io::Error,
    },
    /// The record's place is taken.
    #[error(
        "{} is not an untouched record of this scan: {what}; nothing was written there; move it \
         away or choose another --out",
        shown(folder.display())
    )]
    Occupied {
        /// The record's place.
        folder: PathBuf,
        /// What is wrong with it.
        what: Foreign,
    },
}

/// What stands in a record's place and is not an earlier record of the same scan.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
enum Foreign {
    #[error("it is no folder")]
    NoFolder,
    #[error("it has no readable SHA256SUMS")]
    NoSums,
    #[error("it holds the record of another scan")]
    OtherScan,
    #[error("its {} is no file of the record", shown(.0))]
    Stranger(String),
    #[error("its {} was changed", shown(.0))]
    Changed(String),
}

/// Puts the files into `folder`, which lies in `out`. Until they are all written and synced nothing
/// changes under that name, and then all at once.
fn put_folder(
    out: &Path,
    folder: &Path,
    files: &[RecordFile],
    scan_sha256: &str,
) -> Result<(), Undelivered> {
    let tried = |path: &Path, result: io::Result<()>| {
        result.map_err(|source| Undelivered::Write { path: path.to_owned(), source })
    };
    tried(out, fs::create_dir_all(out))?;
    match foreign(folder, scan_sha256) {
        Err(source) => return tried(folder, Err(source)),
        Ok(Some(what)) => return Err(Undelivered::Occupied { folder: folder.to_owned(), what }),
        Ok(None) => {}
    }
    let staged = out.join(format!(".gaiter-extract-{}", std::process::id()));
    // What a process of the same number left when it was killed.
    tried(&staged, durable::remove_folder(&staged))?;
    let put = tried(&staged, stage(&staged, files))
        .and_then(|()| tried(folder, replace(&staged, folder)))
        .and_then(|()| tried(out, durable::sync_folder(out)));
    // The earlier record, or the beginning of one that could not be written.
    put.and(tried(&staged, durable::remove_folder(&staged)))
}

/// Writes a whole folder, synced.
fn stage(staged: &Path, files: &[RecordFile]) -> io::Result<()> {
    durable::make_folder(staged)?;
    files.iter().try_for_each(|file| durable::write_new(&staged.join(&file.name), &file.bytes))?;
    durable::sync_folder(staged)
}

/// Puts the staged folder in its place; what was there before is then under the staged name.
fn replace(staged: &Path, folder: &Path) -> io::Result<()> {
    match durable::rename_new(staged, folder) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        other => return other,
    }
    match renameat_with(CWD, staged, CWD, folder, RenameFlags::EXCHANGE) {
        // Some network file systems cannot exchange two names.
        Err(Errno::INVAL | Errno::NOSYS | Errno::OPNOTSUPP) => replace_in_steps(staged, folder),
        other => other.map_err(io::Error::from),
    }
}

/// As [`replace`]: for a moment there is nothing under the final name, never half a record.
fn replace_in_steps(staged: &Path, folder: &Path) -> io::Result<()> {
    let aside = staged.with_extension("earlier");
    fs::rename(folder, &aside)?;
    if let Err(error) = fs::rename(staged, folder) {
        fs::rename(&aside, folder)?;
        return Err(error);
    }
    fs::rename(&aside, staged)
}

/// What stands at `folder` and is not the record of this scan, as far as it is whole. Nothing at
/// all, or an empty folder, is in nobody's way.
fn foreign(folder: &Path, scan_sha256: &str) -> io::Result<Option<Foreign>> {
    match folder.symlink_metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Ok(found) if !found.is_dir() => return Ok(Some(Foreign::NoFolder)),
        found => found.map(drop)?,
    }
    let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    if entries.is_empty() {
        return Ok(None);
    }
    entries.sort_by_key(fs::DirEntry::file_name);
    let sums_path = folder.join(SUMS);
    if !sums_path.symlink_metadata().is_ok_and(|found| found.is_file()) {
        return Ok(Some(Foreign::NoSums));
    }
    let sums = String::from_utf8_lossy(&fs::read(sums_path)?).into_owned();
    let listed: BTreeMap<&str, &str> = sums
        .lines()
        .filter_map(|line| line.split_once("  ").map(|(sum, name)| (name, sum)))
        .collect();
    let of_this_scan =
        |(name, sum): (&&str, &&str)| name.starts_with("scan.") && *sum == scan_sha256;
    if !listed.iter().any(of_this_scan) {
        return Ok(Some(Foreign::OtherScan));
    }
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name == SUMS {
            continue;
        }
        match listed.get(name.as_str()) {
            Some(sum) if entry.file_type()?.is_file() => {
                if record::sha256(&fs::read(entry.path())?) != *sum {
                    return Ok(Some(Foreign::Changed(name)));
                }
            }
            _ => return Ok(Some(Foreign::Stranger(name))),
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_replaced_also_where_names_cannot_be_exchanged() {
        for replace in [replace, replace_in_steps] {
            let out = tempfile::tempdir().unwrap();
            let [staged, folder] = ["staged", "folder"].map(|name| out.path().join(name));
            for (place, name) in [(&staged, "new"), (&folder, "old")] {
                fs::create_dir(place).unwrap();
                fs::write(place.join(name), name).unwrap();
            }
            replace(&staged, &folder).unwrap();
            assert!(folder.join("new").is_file() && staged.join("old").is_file());
            assert_eq!(fs::read_dir(out.path()).unwrap().count(), 2);
            assert!(replace(&out.path().join("missing"), &folder).is_err());
            assert!(folder.join("new").is_file(), "a failure leaves the earlier record in place");
        }
    }
}
