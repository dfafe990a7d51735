//! `[sizes]`, `[orders]`, and the garments of `[report]`: what is in files of its own.

pub mod beside;

use gaiter_sizes::{DocumentFault, Garment, Mapping, SizeTable, mapping};
use gaiter_toml::What::{self, NotAWord, Twice};

use self::beside::{TextFile, on_disk};
use super::parse::{self, Absent, Found, Reader};

/// The most bytes of all files together: every measuring process gets their content before its scan.
const BYTES_MOST: usize = 4 << 20;

/// The garments that can be ordered.
#[derive(Debug, Clone)]
pub(super) struct Garments {
    /// The shipped ones, and those of files in their place or after them.
    pub all: Vec<Garment>,
    /// The one that is usually ordered; `None` if its name is wrong.
    pub usual: Option<Garment>,
}

/// Reads `report.garment` and the garments of files. `read_bytes`: the bytes of all files that have been read.
pub(super) fn garments(reader: &mut Reader, read_bytes: &mut usize) -> Garments {
    let name = reader.text("report.garment", Absent::Default("AD"), |name| Ok(name.to_owned()));
    let mut all = Garment::shipped().to_vec();
    let own = read_files(reader, "report.garments", read_bytes, Garment::read, Garment::name);
    own.into_iter().for_each(|garment| add(&mut all, garment));
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
pub(super) fn tables(reader: &mut Reader, read_bytes: &mut usize) -> Vec<SizeTable> {
    read_files(reader, "sizes.tables", read_bytes, gaiter_sizes::parse, |table| table.id.as_str())
}

/// Reads `orders.mappings`: the mappings by which each record gets its order.
pub(super) fn orders(reader: &mut Reader, read_bytes: &mut usize) -> Vec<Mapping> {
    read_files(reader, "orders.mappings", read_bytes, mapping::parse, |of| of.id.as_str())
}

/// Adds a garment: in the place of the shipped one of its name, or at the end.
pub fn add(garments: &mut Vec<Garment>, garment: Garment) {
    match garments.iter_mut().find(|of| of.name() == garment.name()) {
        Some(shipped) => *shipped = garment,
        None => garments.push(garment),
    }
}

/// Reads the files that a key lists, by their paths or by those of their folders. Each fault is noted at the entry
/// that names the file, and so is what has the name of an earlier one.
fn read_files<T>(
    reader: &mut Reader,
    key: &'static str,
    read_bytes: &mut usize,
    read: fn(&[u8]) -> Result<T, Vec<DocumentFault>>,
    name: fn(&T) -> &str,
) -> Vec<T> {
    let mut all: Vec<T> = Vec::new();
    for Found { value: named, at } in reader.list(key, Absent::Default(""), parse::full_path) {
        let mut note = |what: What| reader.note(at.clone(), key, what);
        let of_file =
            |message| What::own(message, "gaiter sizes check FILE names every fault of a file");
        let found = match on_disk(&named) {
            Ok(found) => found,
            Err(why) => {
                note(of_file(why.to_string()));
                continue;
            }
        };
        let bytes = *read_bytes + found.iter().map(|file| file.text.len()).sum::<usize>();
        if bytes > BYTES_MOST {
            let message =
                format!("garments, size tables and mappings have more than {BYTES_MOST} bytes");
            note(of_file(message));
            continue;
        }
        *read_bytes = bytes;
        for TextFile { path, text } in found {
            match read(text.as_bytes()) {
                Err(faults) => {
                    for fault in faults {
                        note(of_file(format!("{}:{fault}", path.display())));
                    }
                }
                Ok(one) if all.iter().any(|of| name(of) == name(&one)) => {
                    note(Twice(name(&one).to_owned()));
                }
                Ok(one) => all.push(one),
            }
        }
    }
    all
}
