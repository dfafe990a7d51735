//! `[sizes]`, `[orders]`, and the garments of `[report]`: what stands in files of its own.

pub mod beside;
mod orders;

use std::ops::Range;
use std::path::{Path, PathBuf};

use gaiter_sizes::{Fault, Garment, SizeTable};
use gaiter_toml::What::{NotAWord, Twice};

use self::beside::{Files, TextFile};
pub(super) use self::orders::orders;
use super::fault::What;
use super::parse;
use super::reader::{Absent, Found, Reader};

/// The most bytes of all files together: every measuring process gets what they say before its scan.
const BYTES_MOST: usize = 4 << 20;

/// The garments that can be ordered.
#[derive(Debug, Clone)]
pub(super) struct Garments {
    /// The shipped ones, and those of files in their place or after them.
    pub all: Vec<Garment>,
    /// The one that is usually ordered; `None` if its name is wrong.
    pub usual: Option<Garment>,
}

/// The files that a configuration names.
pub(super) struct FilesBeside {
    from: Files,
    /// The bytes of those that have been read.
    bytes: usize,
}

impl FilesBeside {
    /// Those that come from here; none has been read.
    pub(super) fn new(from: Files) -> FilesBeside {
        FilesBeside { from, bytes: 0 }
    }
}

/// Reads `report.garment` and the garments of files.
pub(super) fn garments(reader: &mut Reader, files: &mut FilesBeside) -> Garments {
    let name = reader.text("report.garment", Absent::Default("AD"), |name| Ok(name.to_owned()));
    let (mut all, mut own) = (Garment::shipped().to_vec(), Vec::<String>::new());
    for NamedFile { key, at, path, text } in named_files(reader, "report.garments", files) {
        match Garment::read(text.as_bytes()) {
            Err(faults) => note(reader, key, &at, &path, &faults),
            Ok(garment) if own.iter().any(|name| name == garment.name()) => {
                reader.note(at, key, Twice(garment.name().to_owned()));
            }
            Ok(garment) => {
                own.push(garment.name().to_owned());
                add(&mut all, garment);
            }
        }
    }
    let usual = name.and_then(|Found { value: name, at }| {
        let usual = all.iter().find(|of| of.name() == name).cloned();
        if usual.is_none() {
            let known: Vec<String> = all.iter().map(|of| of.name().to_owned()).collect();
            let similar = all.iter().map(Garment::name).find(|of| of.eq_ignore_ascii_case(&name));
            let similar = similar.map(str::to_owned);
            reader.note(at, "report.garment", NotAWord { text: name, words: known, similar });
        }
        usual
    });
    Garments { all, usual }
}

/// Reads `sizes.tables`: the size tables, in the order of the configuration.
pub(super) fn tables(reader: &mut Reader, files: &mut FilesBeside) -> Vec<SizeTable> {
    let mut tables: Vec<SizeTable> = Vec::new();
    for NamedFile { key, at, path, text } in named_files(reader, "sizes.tables", files) {
        match gaiter_sizes::parse(text.as_bytes()) {
            Err(faults) => note(reader, key, &at, &path, &faults),
            Ok(table) if tables.iter().any(|of| of.id == table.id) => {
                reader.note(at, key, Twice(table.id));
            }
            Ok(table) => tables.push(table),
        }
    }
    tables
}

/// Adds a garment: in the place of the shipped one of its name, or at the end.
pub fn add(garments: &mut Vec<Garment>, garment: Garment) {
    match garments.iter_mut().find(|of| of.name() == garment.name()) {
        Some(shipped) => *shipped = garment,
        None => garments.push(garment),
    }
}

/// A file that an entry of a key names, or that is in a folder which it names.
struct NamedFile {
    key: &'static str,
    at: Range<usize>,
    path: PathBuf,
    text: String,
}

/// The files of a key that lists paths.
fn named_files(reader: &mut Reader, key: &'static str, files: &mut FilesBeside) -> Vec<NamedFile> {
    let mut found = Vec::new();
    for Found { value: named, at } in reader.list(key, Absent::Default(""), parse::full_path) {
        let read = match files.from.at(&named) {
            Ok(read) => read,
            Err(why) => {
                reader.note(at, key, What::NamedFile(why.to_string()));
                continue;
            }
        };
        let bytes = files.bytes + read.iter().map(|file| file.text.len()).sum::<usize>();
        if bytes > BYTES_MOST {
            let said =
                format!("garments, size tables and mappings have more than {BYTES_MOST} bytes");
            reader.note(at, key, What::NamedFile(said));
            continue;
        }
        files.bytes = bytes;
        let named = |TextFile { path, text }| NamedFile { key, at: at.clone(), path, text };
        found.extend(read.into_iter().map(named));
    }
    found
}

/// Notes the faults of a file at the entry that names it.
fn note(reader: &mut Reader, key: &str, at: &Range<usize>, path: &Path, faults: &[Fault]) {
    for fault in faults {
        let said = format!("{}:{fault}", path.display());
        reader.note(at.clone(), key, What::NamedFile(said));
    }
}
