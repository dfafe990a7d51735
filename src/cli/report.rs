//! `gaiter report`: writes the report of a record again, from `record.json` alone.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_record::report::Print;
use gaiter_record::schema::{FindingNote, NOT_VOUCHED, SCHEMA};
use gaiter_record::sizing::SizeChoice;
use gaiter_record::{
    FilesFault, RECORD, Record, RecordFault, RecordFile, ReportChoice, SUMS, report_files,
};
use gaiter_sizes::Garment;
use jiff::Zoned;
use serde_json::json;

use super::args::ReportArgs;
use super::sizes::tables;
use super::{Exit, complain, failed, print, terminal_safe};
use crate::station::runtime::chain;
use crate::store::revision::families;
use crate::store::sums::{self, SumsFault};
use crate::store::{StoreFault, durable};

/// Writes the report and prints its paths.
pub fn report(args: &ReportArgs) -> Result<Exit, Exit> {
    let garment = args.garment.chosen(Garment::shipped(), &Garment::default())?;
    let tables = tables(&args.tables)?;
    let sizes = SizeChoice { tables, today: Zoned::now().date(), ..SizeChoice::default() };
    let paths = made(args, sizes, garment).map_err(|fault| failed(&fault))?;
    print(written(&paths, args.json)).map(|()| Exit::Done).map_err(|error| {
        complain(format_args!("gaiter: the report is written, but: {error}"));
        Exit::Io
    })
}

/// The paths of the report, one line per file or as JSON.
pub fn written(paths: &[PathBuf], as_json: bool) -> String {
    if as_json {
        let files: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        return format!("{}\n", json!({ "files": files }));
    }
    paths.iter().map(|path| format!("{}\n", terminal_safe(path.display()))).collect()
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportFault {
    #[error(
        "{}: there is no such file or folder; name a record's folder, its record.json, or a \
         patient's folder", terminal_safe(.0.display())
    )]
    Nothing(PathBuf),
    /// It is a folder without a record.
    #[error(
        "{}: neither a record.json nor a record's folder is in this folder; name a record's folder, its \
         record.json, or a patient's folder", terminal_safe(.0.display())
    )]
    NoRecordIn(PathBuf),
    /// It is a folder that cannot be listed.
    #[error("{}: {}", terminal_safe(path.display()), terminal_safe(chain(source)))]
    Unlisted { path: PathBuf, source: StoreFault },
    /// The record cannot be looked at or read.
    #[error("{}: {}", terminal_safe(path.display()), terminal_safe(source))]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("{}: is not a gaiter record: {source}", terminal_safe(path.display()))]
    NoRecord {
        path: PathBuf,
        /// Why it cannot be parsed.
        source: serde_json::Error,
    },
    /// The record, or the sums next to it, changed after it was written.
    #[error(
        "{}: cannot be trusted, because something in its folder changed after it was written: {}: \
         restore the folder from a backup, or measure the scan again with gaiter extract",
        terminal_safe(path.display()), terminal_safe(source)
    )]
    Changed { path: PathBuf, source: SumsFault },
    /// Its figures are impossible for a leg.
    #[error("{}: is not a record of a leg: {source}", terminal_safe(path.display()))]
    Impossible {
        path: PathBuf,
        /// Which figure is impossible.
        source: RecordFault,
    },
    /// It has another schema.
    #[error("{}: has the schema {}, this program knows {SCHEMA}", terminal_safe(path.display()), terminal_safe(schema))]
    OtherSchema { path: PathBuf, schema: String },
    /// The destination is the folder of a record.
    #[error(
        "{} is the folder of a record, and {SUMS} covers every file in it; nothing was written: \
         choose another folder with --out DIR",
        terminal_safe(.0.display())
    )]
    RecordFolder(PathBuf),
    /// A file of the report's name is there.
    #[error("{} is there already; nothing was replaced: --force replaces it", terminal_safe(.0.display()))]
    There(PathBuf),
    /// The report cannot be created.
    #[error("the report cannot be made: {0}")]
    Files(#[from] FilesFault),
    /// It cannot be written.
    #[error("cannot write {}: {source}", terminal_safe(path.display()))]
    Write {
        /// The file or folder.
        path: PathBuf,
        source: io::Error,
    },
}

impl From<&ReportFault> for Exit {
    fn from(fault: &ReportFault) -> Exit {
        match fault {
            ReportFault::Nothing(_) | ReportFault::NoRecordIn(_) => Exit::NoFile,
            ReportFault::NoRecord { .. }
            | ReportFault::OtherSchema { .. }
            | ReportFault::Changed { .. }
            | ReportFault::Impossible { .. } => Exit::Unmeasurable,
            ReportFault::RecordFolder(_) | ReportFault::There(_) => Exit::Usage,
            ReportFault::Files(_) => Exit::Internal,
            ReportFault::Unreadable { .. }
            | ReportFault::Unlisted { .. }
            | ReportFault::Write { .. } => Exit::Io,
        }
    }
}

/// The record at a path; prints which of several it is.
///
/// # Errors
/// See [`ReportFault`].
pub fn record_at(path: &Path) -> Result<Record, ReportFault> {
    let found = found(path)?;
    if let Some(remark) = found.remark {
        complain(format_args!("gaiter: {}: {remark}", terminal_safe(path.display())));
    }
    record_of_file(found.path)
}

/// A record's file, and a remark on how it was found.
#[derive(Debug, PartialEq, Eq)]
struct Found {
    /// The path of its `record.json`.
    path: PathBuf,
    /// Which of several records was taken.
    remark: Option<String>,
}

/// Finds the record at a path.
///
/// # Errors
/// See [`ReportFault`]. A file whose content cannot be read is found all the same.
fn found(path: &Path) -> Result<Found, ReportFault> {
    let whole = path.to_owned();
    let is_folder = match fs::metadata(path) {
        Ok(metadata) => metadata.is_dir(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(ReportFault::Nothing(whole));
        }
        Err(source) => return Err(ReportFault::Unreadable { path: whole, source }),
    };
    if !is_folder {
        return Ok(Found { path: whole, remark: None });
    }
    let own = path.join(RECORD);
    if own.exists() {
        return Ok(Found { path: own, remark: None });
    }
    // A store's folder holds patients: none of them is taken unasked.
    let unlisted = |source| ReportFault::Unlisted { path: path.to_owned(), source };
    let mut records = families(path).map_err(unlisted)?;
    records.retain(|record| record.patient_folder == path);
    let newest = records.last().ok_or_else(|| ReportFault::NoRecordIn(path.to_owned()))?;
    let folder = &newest.latest().1;
    let shown = terminal_safe(folder.display());
    let remark = match records.len() {
        1 => format!("its only record is reported: {shown}"),
        count => format!("the newest of its {count} records is reported: {shown}"),
    };
    Ok(Found { path: folder.join(RECORD), remark: Some(remark) })
}

/// As [`record_at`]; also prints that nothing vouches for its figures.
///
/// # Errors
/// See [`ReportFault`].
pub fn checked_record_at(path: &Path) -> Result<Record, ReportFault> {
    let record = record_at(path)?;
    if record.has_finding(NOT_VOUCHED) {
        complain(format_args!(
            "gaiter: {}: nothing vouches for its figures, because no {SUMS} is beside it",
            terminal_safe(path.display())
        ));
    }
    Ok(record)
}

/// Writes the report's files and returns their paths.
fn made(
    args: &ReportArgs,
    sizes: SizeChoice,
    garment: Garment,
) -> Result<Vec<PathBuf>, ReportFault> {
    let record = checked_record_at(&args.record)?;
    let print = Print { paper: args.paper, has_appendix: args.appendix };
    let choice =
        ReportChoice { language: args.language, garment, print, sizes, ..ReportChoice::default() };
    placed(&report_files(&record, &choice)?, &args.out, args.force)
}

/// Writes files to a folder and returns their paths.
///
/// # Errors
/// See [`ReportFault`].
pub fn placed(files: &[RecordFile], out: &Path, force: bool) -> Result<Vec<PathBuf>, ReportFault> {
    if out.join(SUMS).symlink_metadata().is_ok() {
        return Err(ReportFault::RecordFolder(out.to_owned()));
    }
    let tried = |path: &Path, result: io::Result<()>| {
        result.map_err(|source| ReportFault::Write { path: path.to_owned(), source })
    };
    tried(out, fs::create_dir_all(out))?;
    let place = |file: &RecordFile| {
        let path = out.join(&file.name);
        match put(&path, file, force) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                Err(ReportFault::There(path))
            }
            put => tried(&path, put).map(|()| path),
        }
    };
    files.iter().map(place).collect()
}

/// Writes a file, in place of an earlier one only with `replace`. There is never half a file at that
/// path.
fn put(path: &Path, file: &RecordFile, replace: bool) -> io::Result<()> {
    let beside = path.with_file_name(format!(".{}-{}", file.name, std::process::id()));
    let rename = || match replace {
        true => fs::rename(&beside, path),
        false => durable::rename_new(&beside, path),
    };
    let put = durable::write_new(&beside, &file.bytes).and_then(|()| rename());
    if put.is_err() {
        // A failure to remove the leftover adds nothing to the error above.
        let _ = fs::remove_file(&beside);
    }
    put
}

fn record_of_file(path: PathBuf) -> Result<Record, ReportFault> {
    let bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(ReportFault::Unreadable { path, source }),
    };
    let schema = |source| ReportFault::NoRecord { path: path.clone(), source };
    let record: Record = serde_json::from_slice(&bytes).map_err(schema)?;
    if record.schema != SCHEMA {
        return Err(ReportFault::OtherSchema { path, schema: record.schema });
    }
    let (folder, name) = (path.parent(), path.file_name().and_then(OsStr::to_str));
    let is_vouched = match (folder, name) {
        (Some(folder), Some(name)) => {
            let vouched = sums::check_file(folder, name, &bytes);
            let vouched = vouched
                .map_err(|source| ReportFault::Unreadable { path: folder.join(SUMS), source })?;
            vouched.map_err(|source| ReportFault::Changed { path: path.clone(), source })?
        }
        _ => false,
    };
    let mut record = record.checked().map_err(|source| ReportFault::Impossible { path, source })?;
    if !is_vouched {
        record.findings.insert(0, FindingNote::not_vouched());
    }
    Ok(record)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_revision_of_a_patient_is_taken_and_said_and_of_a_store_none() {
        let store = tempfile::tempdir().unwrap();
        let patient = store.path().join("4711");
        let folder = |name: &str| patient.join(name);
        let names = [
            "20261121T091500Z_aaaaaaaa",
            "20261122T091500Z_bbbbbbbb",
            "20261122T091500Z_bbbbbbbb_r2",
        ];
        for name in names {
            fs::create_dir_all(folder(name)).unwrap();
            fs::write(folder(name).join(RECORD), "{}").unwrap();
        }
        let newest = folder(names[2]);
        let of_patient = found(&patient).unwrap();
        assert_eq!(of_patient.path, newest.join(RECORD));
        let remark = of_patient.remark.unwrap();
        assert!(remark.starts_with("the newest of its 2 records"), "{remark}");
        assert!(remark.ends_with(&newest.display().to_string()), "{remark}");
        let of_record = Found { path: folder(names[0]).join(RECORD), remark: None };
        assert_eq!(found(&folder(names[0])).unwrap(), of_record);
        let store = store.path();
        assert!(matches!(found(store), Err(ReportFault::NoRecordIn(path)) if path == store));
        let missing = store.join("4712");
        assert!(matches!(found(&missing), Err(ReportFault::Nothing(path)) if path == missing));
        let of_a_file = folder(names[0]).join(RECORD).join("4711");
        assert!(
            matches!(found(&of_a_file), Err(ReportFault::Unreadable { path, .. }) if path == of_a_file)
        );
    }
}
