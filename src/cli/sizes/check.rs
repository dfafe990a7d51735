//! `gaiter sizes check`: the faults of size tables, and what a person should know of those without.

use std::fmt::Display;

use jiff::Zoned;
use jiff::civil::Date;
use serde::Serialize;

use crate::cli::args::{GarmentArgs, SizesCheckArgs};
use crate::cli::terminal::screen::{self, indented};
use crate::cli::{Exit, complain, print, shown};
use crate::config::sizes::beside::{Beside, on_disk};
use crate::language::Language;
use crate::record::rounding::limit_words;
use crate::record::shown::id;
use crate::sizes::check::{Neighbours, Remark, remarks};
use crate::sizes::table::Limits;
use crate::sizes::{Fault, Garment, SizeTable, parse};

/// Name and number of the schema of the result as JSON.
const SCHEMA: &str = "gaiter.size-check/1";

/// Checks the tables and prints what was found.
pub fn check(args: &SizesCheckArgs) -> Exit {
    let own = GarmentArgs { garment_file: args.garment_file.clone(), garment: None };
    let garments = match own.known(Garment::shipped()) {
        Ok(garments) => garments,
        Err(exit) => return exit,
    };
    let (today, mut worst) = (Zoned::now().date(), Exit::Done);
    let mut checked = Vec::new();
    for path in &args.files {
        match on_disk(path) {
            Ok(found) => checked.extend(of_files(&found, &garments, today)),
            Err(why) => {
                complain(format_args!("gaiter: {}", shown(&why)));
                worst = worst.max(if why.is_not_found() { Exit::NoFile } else { Exit::Io });
            }
        }
    }
    if checked.iter().any(|of| !of.faults.is_empty()) {
        worst = worst.max(Exit::Unmeasurable);
    }
    let printed = match args.json {
        true => json(&checked, args.language),
        false => Ok(text(&checked, args.language, screen::columns())),
    };
    match printed.map_err(std::io::Error::other).and_then(print) {
        Ok(()) => worst,
        Err(error) => {
            complain(format_args!("gaiter: cannot print the result: {error}"));
            worst.max(Exit::Io)
        }
    }
}

/// A file, and what was found in it.
struct Checked {
    path: String,
    table: Option<SizeTable>,
    faults: Vec<Fault>,
    remarks: Vec<Remark>,
}

fn of_files(found: &Beside, garments: &[Garment], today: Date) -> Vec<Checked> {
    let names: Vec<&str> = garments.iter().map(Garment::name).collect();
    let files = found.files.iter().map(|file| {
        let path = file.path.display().to_string();
        match parse(file.text.as_bytes()) {
            Ok(table) => {
                let remarks = remarks(&table, today, &names);
                Checked { path, table: Some(table), faults: Vec::new(), remarks }
            }
            Err(faults) => Checked { path, table: None, faults, remarks: Vec::new() },
        }
    });
    files.collect()
}

fn text(checked: &[Checked], language: Language, columns: usize) -> String {
    let mut text = String::new();
    for Checked { path, table, faults, remarks } in checked {
        let said = match (table, remarks.len()) {
            (None, _) => {
                format!("{} {}", faults.len(), language.text("sizes.check.fault"))
            }
            (Some(table), 0) => {
                format!("{}: {}", named(table), language.text("sizes.check.fine"))
            }
            (Some(table), count) => {
                format!("{}: {count} {}", named(table), language.text("sizes.check.remark"))
            }
        };
        text += &indented(&format!("{}: {said}", shown(path)), "", columns);
        for fault in faults {
            text += &indented(&fault.to_string(), "  ", columns);
        }
        for remark in remarks {
            text += &indented(&in_words(remark, language), "  ", columns);
        }
    }
    text
}

/// What tells a table from others.
fn named(table: &SizeTable) -> String {
    format!("{}, {}", id(&table.id), id(&table.edition))
}

/// A remark in words.
pub fn in_words(remark: &Remark, language: Language) -> String {
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

/// What `--json` prints.
#[derive(Serialize)]
struct Json<'a> {
    schema: &'static str,
    files: Vec<JsonFile<'a>>,
}

#[derive(Serialize)]
struct JsonFile<'a> {
    path: &'a str,
    /// Null for a table with faults, as edition and hash are.
    id: Option<&'a str>,
    edition: Option<&'a str>,
    sha256: Option<&'a str>,
    faults: Vec<JsonFault<'a>>,
    remarks: Vec<JsonRemark<'a>>,
}

#[derive(Serialize)]
struct JsonFault<'a> {
    line: usize,
    column: usize,
    key: &'a str,
    message: String,
    hint: String,
}

#[derive(Serialize)]
struct JsonRemark<'a> {
    #[serde(flatten)]
    remark: &'a Remark,
    message: String,
}

fn json(checked: &[Checked], language: Language) -> Result<String, serde_json::Error> {
    let files = checked.iter().map(|of| {
        let faults = of.faults.iter().map(|fault| JsonFault {
            line: fault.line,
            column: fault.column,
            key: &fault.key,
            message: fault.what.to_string(),
            hint: fault.what.hint(),
        });
        let remarks = of
            .remarks
            .iter()
            .map(|remark| JsonRemark { remark, message: in_words(remark, language) });
        JsonFile {
            path: &of.path,
            id: of.table.as_ref().map(|table| table.id.as_str()),
            edition: of.table.as_ref().map(|table| table.edition.as_str()),
            sha256: of.table.as_ref().map(|table| table.sha256.as_str()),
            faults: faults.collect(),
            remarks: remarks.collect(),
        }
    });
    let json = Json { schema: SCHEMA, files: files.collect() };
    serde_json::to_string_pretty(&json).map(|json| json + "\n")
}
