//! `[orders]`: the mappings by which each record gets its order.

use gaiter_sizes::Mapping;
use gaiter_sizes::mapping;
use gaiter_toml::What::Twice;

use super::{FilesBeside, NamedFile, named_files, note};
use crate::config::reader::Reader;

/// Reads `orders.mappings`.
pub(in crate::config) fn orders(reader: &mut Reader, files: &mut FilesBeside) -> Vec<Mapping> {
    let mut mappings: Vec<Mapping> = Vec::new();
    for NamedFile { key, at, path, text } in named_files(reader, "orders.mappings", files) {
        match mapping::parse(text.as_bytes()) {
            Err(faults) => note(reader, key, &at, &path, &faults),
            Ok(mapping) if mappings.iter().any(|of| of.id == mapping.id) => {
                reader.note(at, key, Twice(mapping.id));
            }
            Ok(mapping) => mappings.push(mapping),
        }
    }
    mappings
}
