//! `gaiter extract`: measures scan files now, without a station.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::args::ExtractArgs;
use super::{Exit, complain, explain_config, print, table};
use crate::config::{self, words};
use crate::leg::{Extraction, Method, Refusal, extract as measure};
use crate::record::{self, Provenance};
use crate::scan::Format;

/// Measures every file, prints a table or a JSON line for each, and ends as the worst of them.
pub fn extract(args: &ExtractArgs) -> Exit {
    let method = match method(args) {
        Ok(method) => method,
        Err(exit) => return exit,
    };
    let several = args.scans.len() > 1;
    let one = |path: &PathBuf| match Measured::of(path, &method) {
        Ok(measured) => match measured.deliver(args, &method, several) {
            Ok(()) => Exit::Done,
            Err(fault) => {
                complain(format_args!("gaiter: {}: {fault}", path.display()));
                Exit::Io
            }
        },
        Err(fault) => {
            complain(format_args!("gaiter: {}: {fault}", path.display()));
            fault.exit()
        }
    };
    args.scans.iter().map(one).max().unwrap_or(Exit::Done)
}

/// The configuration's method, or the default one, under what the command line says.
fn method(args: &ExtractArgs) -> Result<Method, Exit> {
    let mut method = match &args.config {
        Some(path) => config::read(path).map_err(|error| explain_config(&error))?.method,
        None => Method::default(),
    };
    method.unit = args.unit.unwrap_or(method.unit);
    method.up = args.up.unwrap_or(method.up);
    method.facing = args.facing.unwrap_or(method.facing);
    if words::faces_up_or_down(method.up, method.facing) {
        complain("gaiter: --facing points along the up axis; toes point square to it");
        return Err(Exit::Usage);
    }
    Ok(method)
}

/// Why a file gave no record.
#[derive(Debug, thiserror::Error)]
enum FileFault {
    /// It cannot be read.
    #[error("{0}")]
    Unreadable(#[source] io::Error),
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
            FileFault::Unreadable(_) => Exit::Io,
            FileFault::Refused { .. } => Exit::Unmeasurable,
        }
    }
}

/// A file that was measured.
struct Measured<'a> {
    path: &'a Path,
    bytes: Vec<u8>,
    format: Format,
    extraction: Extraction,
    provenance: Provenance,
}

impl<'a> Measured<'a> {
    fn of(path: &'a Path, method: &Method) -> Result<Measured<'a>, FileFault> {
        let bytes = fs::read(path).map_err(FileFault::Unreadable)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let format = Format::of_file_name(&name).map_err(Refusal::from)?;
        let extraction = measure(&bytes, format, method)?;
        let sha256 = record::sha256(&bytes);
        let provenance = Provenance { station: None, patient: None, acquired: None, sha256 };
        Ok(Measured { path, bytes, format, extraction, provenance })
    }

    fn deliver(&self, args: &ExtractArgs, method: &Method, several: bool) -> io::Result<()> {
        let record = record::record(&self.extraction, &self.provenance, method);
        if args.json {
            print(format_args!("{}\n", serde_json::to_string(&record)?))?;
        } else {
            if several {
                print(format_args!("{}\n", self.path.display()))?;
            }
            print(format_args!("{}\n", table::of(&record)))?;
        }
        args.out.as_ref().map_or(Ok(()), |out| self.write_folder(out, method))
    }

    /// Writes the record folder `OUT/<stem>/`, which must not hold another scan's record.
    fn write_folder(&self, out: &Path, method: &Method) -> io::Result<()> {
        let folder = out.join(self.path.file_stem().unwrap_or_default());
        let Measured { extraction, provenance, bytes, format, .. } = self;
        let files = record::record_files(extraction, provenance, method, bytes, *format)?;
        fs::create_dir_all(&folder)?;
        files.iter().try_for_each(|file| fs::write(folder.join(&file.name), &file.bytes))
    }
}
