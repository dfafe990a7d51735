//! `[orders]`: the files of an order that each record gets.

use std::collections::BTreeSet;

use gaiter_record::order::{OrderChoice, OrderFile};
use gaiter_sizes::Mapping;
use gaiter_sizes::mapping;

use super::beside::{Beside, Files};
use super::{NamedFile, named_files, note};
use crate::config::fault::What;
use crate::config::parse;
use crate::config::reader::{Absent, Found, Reader};
use crate::config::words::ORDER_FILES;

/// Reads `orders.files` and `orders.mappings`.
pub(in crate::config) fn orders(
    reader: &mut Reader,
    files: Files<'_>,
    read: &mut Vec<Beside>,
) -> OrderChoice {
    OrderChoice { files: kinds(reader), mappings: mappings(reader, files, read) }
}

fn kinds(reader: &mut Reader) -> BTreeSet<OrderFile> {
    let usual = Absent::Default("csv\", \"spreadsheet\", \"json");
    let mut kinds = BTreeSet::new();
    for Found { value, at } in reader.list("orders.files", usual, parse::word(ORDER_FILES)) {
        if !kinds.insert(value) {
            let spelt = ORDER_FILES.iter().filter(|(_, known)| *known == value);
            let spelt = spelt.map(|(word, _)| *word).collect();
            reader.note(at, "orders.files", What::Twice(spelt));
        }
    }
    kinds
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
