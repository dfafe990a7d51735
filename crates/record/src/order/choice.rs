//! The files of an order in the folder of a record.

use gaiter_language::Language;
use gaiter_sizes::Mapping;

use super::{Order, csv, mapped, mapped_name, spreadsheet};
use crate::file::{RecordFile, file, json};

/// How the names of all order files begin, and of no other file of a record.
const BEGIN: &str = "order";

gaiter_leg::word_enum! {
    /// An order as a file of gaiter's own, with the name of the file; each record has all of them.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum OrderFile {
        /// As the exact table for programs, `order.csv`.
        Csv => "order.csv",
        /// As the same table for a spreadsheet that is set to the language of the report, `order-spreadsheet.csv`.
        Spreadsheet => "order-spreadsheet.csv",
        /// As `order.json`, with everything that is known; a further order is made from it.
        Json => "order.json",
    }
}

impl OrderFile {
    /// The file of an order; the language is that of a spreadsheet.
    ///
    /// # Errors
    /// If a figure cannot be written as JSON.
    pub fn of(self, order: &Order, language: Language) -> Result<RecordFile, serde_json::Error> {
        let bytes = match self {
            OrderFile::Csv => csv(order).into_bytes(),
            OrderFile::Spreadsheet => spreadsheet(order, language).into_bytes(),
            OrderFile::Json => json(order)?,
        };
        Ok(file(self.word(), bytes))
    }
}

/// Whether a file of a record is one of its order.
pub fn is_order_file(name: &str) -> bool {
    name.starts_with(BEGIN)
}

/// The files of an order, each under a name of its own: gaiter's own, and those for makers and shop systems. The patient's id is only for a mapping that asks for it.
///
/// # Errors
/// If a figure cannot be written as JSON.
pub fn order_files(
    order: &Order,
    mappings: &[Mapping],
    language: Language,
    patient: Option<&str>,
) -> Result<Vec<RecordFile>, serde_json::Error> {
    let own = OrderFile::ALL.into_iter().map(|kind| kind.of(order, language));
    let mut files = own.collect::<Result<Vec<RecordFile>, _>>()?;
    for mapping in mappings {
        let name = own_name(mapped_name(order, mapping), &files);
        files.push(RecordFile { name, bytes: mapped(order, mapping, patient) });
    }
    Ok(files)
}

/// A name that no file has yet, even on file systems that ignore case: with a number before its ending where
/// the places of two mappings were filled alike.
fn own_name(name: String, files: &[RecordFile]) -> String {
    let is_free = |name: &str| !files.iter().any(|of| of.name.eq_ignore_ascii_case(name));
    if is_free(&name) {
        return name;
    }
    let (stem, ending) = name.rsplit_once('.').unwrap_or((&name, ""));
    let numbered = (2..).map(|number: u32| format!("{stem}-{number}.{ending}"));
    numbered.take(files.len() + 1).find(|name| is_free(name)).unwrap_or_default()
}
