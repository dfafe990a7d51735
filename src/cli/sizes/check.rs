//! `gaiter sizes check`: the faults of size tables and garments, and what a person should know of tables
//! without.

use std::fmt::Display;

use gaiter_language::Language;
use gaiter_record::rounding::limit_words;
use gaiter_record::shown::id;
use gaiter_sizes::check::{Neighbours, Remark, remarks};
use gaiter_sizes::table::Limits;
use gaiter_sizes::{DocumentFault, Garment, SizeTable, What, garment, parse};
use jiff::Zoned;
use jiff::civil::Date;
use serde_json::{Value, json};

use super::{files_at, of_paths};
use crate::cli::args::{GarmentArgs, SizesCheckArgs};
use crate::cli::terminal::screen::{self, indented};
use crate::cli::{Exit, exit_of_printing, print, terminal_safe};
use crate::config::sizes::beside::TextFile;

/// Name and number of the schema of the result as JSON.
const SCHEMA: &str = "gaiter.size-check/1";

/// Checks the tables and prints what was found.
pub fn check(args: &SizesCheckArgs) -> Result<Exit, Exit> {
    let own = GarmentArgs { garment_file: args.garment_file.clone(), garment: None };
    let garments = own.known(Garment::shipped())?;
    let (files, mut worst) = of_paths(&args.files, files_at);
    let checked = of_files(&files, &garments, Zoned::now().date());
    if checked.iter().any(|of| of.found.is_err()) {
        worst = worst.max(Exit::Unmeasurable);
    }
    let printed = match args.json {
        true => json(&checked, args.language),
        false => Ok(text(&checked, args.language, screen::columns())),
    };
    let printed = printed.map_err(std::io::Error::other).and_then(print);
    Ok(worst.max(exit_of_printing("the result", printed)))
}

/// A file, and what was found in it.
struct Checked {
    path: String,
    found: Result<Sound, Vec<DocumentFault>>,
    remarks: Vec<Remark>,
}

/// The content of a file without faults.
enum Sound {
    Table(Box<SizeTable>),
    Garment(Garment),
}

impl Sound {
    /// Reads a size table, or a garment if the file declares one.
    fn read(bytes: &[u8]) -> Result<Sound, Vec<DocumentFault>> {
        let is_garment = |fault: &DocumentFault| matches!(&fault.what, What::Format { found, .. } if found == garment::FORMAT);
        match parse(bytes) {
            Ok(table) => Ok(Sound::Table(Box::new(table))),
            Err(faults) if faults.iter().any(is_garment) => {
                Garment::read(bytes).map(Sound::Garment)
            }
            Err(faults) => Err(faults),
        }
    }
}

fn of_files(found: &[TextFile], garments: &[Garment], today: Date) -> Vec<Checked> {
    let names: Vec<&str> = garments.iter().map(Garment::name).collect();
    let files = found.iter().map(|file| {
        let found = Sound::read(file.text.as_bytes());
        let remarks = match &found {
            Ok(Sound::Table(table)) => remarks(table, today, &names),
            _ => Vec::new(),
        };
        Checked { path: file.path.display().to_string(), found, remarks }
    });
    files.collect()
}

fn text(checked: &[Checked], language: Language, columns: usize) -> String {
    let mut text = String::new();
    for Checked { path, found, remarks } in checked {
        let named = match found {
            Ok(Sound::Table(table)) => Some(named(table)),
            Ok(Sound::Garment(garment)) => {
                let name: [(&str, &dyn Display); 1] = [("name", &id(garment.name()))];
                Some(language.filled("sizes.check.garment", &name))
            }
            Err(_) => None,
        };
        let faults: &[DocumentFault] = found.as_ref().err().map_or(&[], Vec::as_slice);
        let summary = match (named, remarks.len()) {
            (None, _) => format!("{} {}", faults.len(), language.text("sizes.check.fault")),
            (Some(named), 0) => format!("{named}: {}", language.text("sizes.check.fine")),
            (Some(named), count) => {
                format!("{named}: {count} {}", language.text("sizes.check.remark"))
            }
        };
        text += &indented(&format!("{}: {summary}", terminal_safe(path)), "", columns);
        for fault in faults {
            text += &indented(&fault.to_string(), "  ", columns);
        }
        for remark in remarks {
            text += &indented(&remark_in_words(remark, language), "  ", columns);
        }
    }
    text
}

/// What identifies a table.
fn named(table: &SizeTable) -> String {
    format!("{}, {}", id(&table.id), id(&table.edition))
}

pub fn remark_in_words(remark: &Remark, language: Language) -> String {
    let at = |key: &'static str, at: &Neighbours| {
        let [low, high] = at.names.each_ref().map(|name| id(name));
        let names: [(&str, &dyn Display); 3] = [
            ("low", &low),
            ("high", &high),
            ("garment", &at.garment.as_deref().map(id).unwrap_or_default()),
        ];
        let place = match at.garment {
            None => language.filled("sizes.check.sizes", &names),
            Some(_) => language.filled("sizes.check.lengths", &names),
        };
        let [upper, lower] = [at.upper_mm, at.lower_mm].map(|mm| limit_words(mm, language));
        let words: [(&str, &dyn Display); 4] =
            [("point", &at.point), ("where", &place), ("upper", &upper), ("lower", &lower)];
        language.filled(key, &words)
    };
    let with =
        |key: &'static str, name: &str, word: &dyn Display| language.filled(key, &[(name, word)]);
    match remark {
        Remark::Gap(of) => at("sizes.check.what.gap", of),
        Remark::Overlap(of) => at("sizes.check.what.overlap", of),
        Remark::Touch { at: of, limits: Limits::Closed } => at("sizes.check.what.touch-closed", of),
        Remark::Touch { at: of, limits: Limits::Open } => at("sizes.check.what.touch-open", of),
        Remark::OutOfOrder { point, names: [smaller, larger], smaller_mm, larger_mm } => {
            let range = |mm: &[f64; 2]| mm.map(|mm| limit_words(mm, language)).join("–");
            let words: [(&str, &dyn Display); 5] = [
                ("point", point),
                ("smaller", &id(smaller)),
                ("larger", &id(larger)),
                ("below", &range(smaller_mm)),
                ("above", &range(larger_mm)),
            ];
            language.filled("sizes.check.what.out-of-order", &words)
        }
        Remark::Lacks { size, point } => {
            let words: [(&str, &dyn Display); 2] = [("size", &id(size)), ("point", point)];
            language.filled("sizes.check.what.lacks", &words)
        }
        Remark::Expired { last } => with("sizes.check.what.expired", "date", last),
        Remark::SamePerson { name } => with("sizes.check.what.same-person", "name", &id(name)),
        Remark::UnknownGarment { garment } => {
            with("sizes.check.what.unknown-garment", "garment", &id(garment))
        }
        Remark::Unsigned { entered, checked } => {
            let names = [(*entered, "entered_by"), (*checked, "checked_by")];
            let names: Vec<&str> =
                names.iter().filter(|(is_missing, _)| *is_missing).map(|(_, name)| *name).collect();
            with("sizes.check.what.unsigned", "names", &names.join(", "))
        }
        Remark::NoEnd
        | Remark::TestOnly
        | Remark::Draft
        | Remark::Tension
        | Remark::NoBasis
        | Remark::NoLengthsFrom => language.word("sizes.check.what", remark.code()).to_owned(),
    }
}

/// What `--json` prints. Of a table, the garment is null; of a file with faults, also id, edition and hash.
fn json(checked: &[Checked], language: Language) -> Result<String, serde_json::Error> {
    let with_message = |remark: &Remark| -> Result<Value, serde_json::Error> {
        let mut value = serde_json::to_value(remark)?;
        value["message"] = remark_in_words(remark, language).into();
        Ok(value)
    };
    let mut files = Vec::new();
    for Checked { path, found, remarks } in checked {
        let (table, garment, faults): (_, _, &[DocumentFault]) = match found {
            Ok(Sound::Table(table)) => (Some(table), None, &[]),
            Ok(Sound::Garment(garment)) => (None, Some(garment.name()), &[]),
            Err(faults) => (None, None, faults.as_slice()),
        };
        let remarks = remarks.iter().map(with_message);
        let remarks = remarks.collect::<Result<Vec<Value>, _>>()?;
        files.push(json!({
            "path": path,
            "garment": garment,
            "id": table.map(|table| &table.id),
            "edition": table.map(|table| &table.edition),
            "sha256": table.map(|table| &table.sha256),
            "faults": faults,
            "remarks": remarks,
        }));
    }
    Ok(format!("{:#}\n", json!({ "schema": SCHEMA, "files": files })))
}
