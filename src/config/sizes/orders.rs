//! `[orders]`: the files of an order that each record gets.

use super::beside::{Beside, Files};
use super::{NamedFile, named_files, note};
use crate::config::fault::What;
use crate::config::parse;
use crate::config::reader::{Absent, Found, Reader};
use crate::config::words::ORDER_FILES;
use crate::record::order::OrderChoice;
use crate::sizes::Mapping;
use crate::sizes::mapping;

/// Reads `orders.files` and `orders.mappings`.
pub(in crate::config) fn orders(
    reader: &mut Reader,
    files: Files<'_>,
    read: &mut Vec<Beside>,
) -> OrderChoice {
    let usual = Absent::Default("csv\", \"json");
    let kinds = reader.list("orders.files", usual, parse::word(ORDER_FILES));
    let kinds = kinds.into_iter().map(|Found { value, .. }| value).collect();
    OrderChoice { files: kinds, mappings: mappings(reader, files, read) }
}

fn mappings(reader: &mut Reader, files: Files<'_>, read: &mut Vec<Beside>) -> Vec<Mapping> {
    let mut mappings: Vec<Mapping> = Vec::new();
    for NamedFile { key, at, path, text } in named_files(reader, "orders.mappings", files, read) {
        match mapping::parse(text.as_bytes()) {
            Err(faults) => note(reader, key, &at, &path, &faults),
            Ok(mapping) if mappings.iter().any(|of| of.id == mapping.id) => {
                reader.note(at, key, What::Twice(mapping.id));
            }
            Ok(mapping) => mappings.push(mapping),
        }
    }
    mappings
}
