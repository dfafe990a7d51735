//! `gaiter report`: the report of a record, made anew from `record.json` alone.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::args::ReportArgs;
use super::{Exit, complain, print, shown};
use crate::record::schema::SCHEMA;
use crate::record::{FilesFault, Record, RecordFault, RecordFile, SUMS, report_files};
use crate::store::durable;
use crate::store::sums::{self, SumsFault};

/// The record within its folder.
const RECORD: &str = "record.json";

/// Writes the report and prints where it lies.
pub fn report(args: &ReportArgs) -> Exit {
    match made(args) {
        Ok(paths) => match print(told(&paths, args.json)) {
            Ok(()) => Exit::Done,
            Err(error) => {
                complain(format_args!("gaiter: the report is written, but: {error}"));
                Exit::Io
            }
        },
        Err(fault) => {
            complain(format_args!("gaiter: {fault}"));
            fault.exit()
        }
    }
}

/// Where the report lies, a line for each file or as JSON.
fn told(paths: &[PathBuf], as_json: bool) -> String {
    if as_json {
        let files: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        return format!("{}\n", json!({ "files": files }));
    }
    paths.iter().map(|path| format!("{}\n", shown(path.display()))).collect()
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
enum Fault {
    /// The record cannot be read.
    #[error("{}: {source}", shown(path.display()))]
    Unreadable {
        /// Which file.
        path: PathBuf,
        /// How it failed.
        source: io::Error,
    },
    /// It is no record.
    #[error("{}: is no record of gaiter: {source}", shown(path.display()))]
    NoRecord {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// It, or the sums beside it, was changed after it was written.
    #[error(
        "{}: cannot be trusted, for something in its folder was changed after it was written: {}: take \
         it from a copy, or measure the scan again with gaiter extract",
        shown(path.display()), shown(source)
    )]
    Changed {
        /// Which file.
        path: PathBuf,
        /// What is not as it was.
        source: SumsFault,
    },
    /// No leg can have its figures.
    #[error("{}: is no record of a leg: {source}", shown(path.display()))]
    Impossible {
        /// Which file.
        path: PathBuf,
        /// What cannot be.
        source: RecordFault,
    },
    /// It is a record of another schema.
    #[error("{}: has the schema {}, this program knows {SCHEMA}", shown(path.display()), shown(schema))]
    OtherSchema {
        /// Which file.
        path: PathBuf,
        /// Its schema.
        schema: String,
    },
    /// The place is a record's own folder.
    #[error(
        "{} is a record's own folder, whose {SUMS} vouches for every file in it; nothing was written: \
         choose another place with --out DIR",
        shown(.0.display())
    )]
    RecordFolder(PathBuf),
    /// The report cannot be made.
    #[error("the report cannot be made: {0}")]
    Files(#[from] FilesFault),
    /// It cannot be written.
    #[error("cannot write {}: {source}", shown(path.display()))]
    Write {
        /// Which file or folder.
        path: PathBuf,
        /// How it failed.
        source: io::Error,
    },
}

impl Fault {
    fn exit(&self) -> Exit {
        match self {
            Fault::Unreadable { source, .. } if source.kind() == io::ErrorKind::NotFound => {
                Exit::NoFile
            }
            Fault::NoRecord { .. }
            | Fault::OtherSchema { .. }
            | Fault::Changed { .. }
            | Fault::Impossible { .. } => Exit::Unmeasurable,
            Fault::RecordFolder(_) => Exit::Usage,
            Fault::Files(_) => Exit::Internal,
            Fault::Unreadable { .. } | Fault::Write { .. } => Exit::Io,
        }
    }
}

/// The paths of the report's files, which are then there whole.
fn made(args: &ReportArgs) -> Result<Vec<PathBuf>, Fault> {
    let record = read(&args.record)?;
    let files = report_files(&record, args.language)?;
    if args.out.join(SUMS).symlink_metadata().is_ok() {
        return Err(Fault::RecordFolder(args.out.clone()));
    }
    let tried = |path: &Path, result: io::Result<()>| {
        result.map_err(|source| Fault::Write { path: path.to_owned(), source })
    };
    tried(&args.out, fs::create_dir_all(&args.out))?;
    let place = |file: &RecordFile| {
        let path = args.out.join(&file.name);
        tried(&path, put(&path, file)).map(|()| path)
    };
    files.iter().map(place).collect()
}

/// Puts a file in the place of an earlier one of its name: at no time is half a report there.
fn put(path: &Path, file: &RecordFile) -> io::Result<()> {
    let beside = path.with_file_name(format!(".{}-{}", file.name, std::process::id()));
    let put = durable::write_new(&beside, &file.bytes).and_then(|()| fs::rename(&beside, path));
    if put.is_err() {
        // What is left of it says nothing that the error does not.
        let _ = fs::remove_file(&beside);
    }
    put
}

fn read(path: &Path) -> Result<Record, Fault> {
    let path = if path.is_dir() { path.join(RECORD) } else { path.to_owned() };
    let bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(source) => return Err(Fault::Unreadable { path, source }),
    };
    let schema = |source| Fault::NoRecord { path: path.clone(), source };
    let record: Record = serde_json::from_slice(&bytes).map_err(schema)?;
    if record.schema != SCHEMA {
        return Err(Fault::OtherSchema { path, schema: record.schema });
    }
    let (folder, name) = (path.parent(), path.file_name().and_then(OsStr::to_str));
    if let (Some(folder), Some(name)) = (folder, name) {
        let vouched = sums::check_file(folder, name, &bytes);
        let vouched =
            vouched.map_err(|source| Fault::Unreadable { path: folder.join(SUMS), source })?;
        vouched.map_err(|source| Fault::Changed { path: path.clone(), source })?;
    }
    record.checked().map_err(|source| Fault::Impossible { path, source })
}
