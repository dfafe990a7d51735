//! The text of a mapping file → [`Mapping`], or every fault of it.

use std::collections::BTreeMap;

use gaiter_toml::What::{NotAWord, Twice};
use toml::de::DeValue;

use super::date::DateFormat;
use super::fault::MappingWhat;
use super::file_name::FileName;
use super::value::Cell;
use super::{
    Column, Csv, Encoding, FORMAT, Instead, Layout, LineEnd, Mapping, NumberFormat, Rounding, Rows,
};
use crate::document::{Section, SectionKeys, Value, number, read};
use crate::fault::DocumentFault;
use crate::parse::points;

/// The keys of a file. Notes may be added: any key that begins with `note_`.
const KEYS: &str = "format id name source file_name layout rows points unit decimal step round decimals \
                    also_write separator quote line_end encoding header spreadsheet instead words column \
                    note_…";

/// The keys of `layout = "csv"`.
const CSV_KEYS: [&str; 6] = ["separator", "quote", "line_end", "encoding", "header", "spreadsheet"];

/// The steps to which figures are rounded, mm: a hundredth of a millimetre to five centimetres.
const STEPS_MM: [f64; 2] = [0.01, 50.0];

/// The most decimals of a figure: a sixteenth of an inch has four.
const DECIMALS_MAX: usize = 4;

/// The most columns: every point of both legs with all that belongs to it are fewer.
const COLUMNS_MAX: usize = 400;

/// The units with their length, mm.
const UNITS: [(&str, (&str, f64)); 3] =
    [("cm", ("cm", 10.0)), ("mm", ("mm", 1.0)), ("inch", ("inch", 25.4))];

/// Reads a mapping from the bytes of its file.
///
/// # Errors
/// Every fault of the file, in the order of its lines; at least one.
pub fn parse(bytes: &[u8]) -> Result<Mapping, Vec<DocumentFault>> {
    read(bytes, FORMAT, "format = \"gaiter-order-mapping/1\"", mapping)
}

/// The mapping of a file. What is wrong is noted, and the rest is read all the same.
fn mapping(whole: Section<'_, '_>) -> Option<Mapping> {
    SectionKeys::here(KEYS).only(whole);
    let id = whole.required_text("id", "id = \"shop-2026\"");
    let name = whole.required_text("name", "name = \"…\"");
    let source = whole.required_text("source", "source = \"where the form was read\"");
    let file_name = file_name(whole);
    let layout = layout(whole);
    let rows = whole.required_choice("rows", &Rows::WORDS);
    let points = own_points(whole, rows);
    let figures = figures(whole);
    let instead = instead(whole);
    let sides = sides(whole);
    let columns = columns(whole, rows);
    Some(Mapping {
        id: id?,
        name: name?,
        source: source?,
        file_name: file_name?,
        layout: layout?,
        rows: rows?,
        points,
        columns,
        figures: figures?,
        instead,
        sides,
    })
}

fn file_name(whole: Section<'_, '_>) -> Option<FileName> {
    let text = whole.required_text("file_name", "file_name = \"order-{id}.csv\"")?;
    let name = FileName::new(&text);
    if let (None, Some(value)) = (&name, whole.get("file_name")) {
        whole.note(&value.span(), "file_name", MappingWhat::FileName(text));
    }
    name
}

/// The kind of file. The keys of a table are faults in a mapping that makes none.
fn layout(whole: Section<'_, '_>) -> Option<Layout> {
    let is_csv = whole.required_choice("layout", &[("csv", true), ("json", false)])?;
    if !is_csv {
        for key in CSV_KEYS {
            if let Some(value) = whole.get(key) {
                whole.note(&value.span(), key, MappingWhat::OnlyCsv);
            }
        }
        return Some(Layout::Json);
    }
    let separators = [(";", ';'), (",", ','), ("|", '|'), ("tab", '\t')];
    let separator = whole.choice("separator", &separators);
    let quotes = [("needed", false), ("always", true)];
    let quotes_all = whole.choice("quote", &quotes);
    let line_end = whole.choice("line_end", &LineEnd::WORDS);
    let sets =
        [("utf-8", Encoding::Utf8), ("utf-8-bom", Encoding::Utf8Bom), ("cp1252", Encoding::Cp1252)];
    let encoding = whole.choice("encoding", &sets);
    Some(Layout::Csv(Csv {
        separator: separator.unwrap_or(';'),
        quotes_all: quotes_all.unwrap_or(false),
        line_end: line_end.unwrap_or(LineEnd::CrLf),
        encoding: encoding.unwrap_or(Encoding::Utf8),
        has_header: flag(whole, "header").unwrap_or(true),
        is_spreadsheet: flag(whole, "spreadsheet").unwrap_or(false),
    }))
}

/// The points of the rows.
fn own_points(whole: Section<'_, '_>, rows: Option<Rows>) -> Option<Vec<crate::Point>> {
    let value = whole.get("points")?;
    if matches!(rows, Some(Rows::Order | Rows::Leg)) {
        whole.note(&value.span(), "points", MappingWhat::OnlyPoints);
    }
    Some(points(whole, value, "points"))
}

/// How figures are written.
fn figures(whole: Section<'_, '_>) -> Option<NumberFormat> {
    let (unit, unit_mm) = whole.required_choice("unit", &UNITS)?;
    whole.must_have("step", "step = 0.1");
    let (step, least) = step(whole, unit, unit_mm)?;
    let roundings =
        [("nearest", Rounding::Nearest), ("up", Rounding::Up), ("down", Rounding::Down)];
    let rounding = whole.choice("round", &roundings);
    let sign = whole.choice("decimal", &[(".", '.'), (",", ',')]);
    let decimals = decimals(whole, least)?;
    let rounding = rounding.unwrap_or(Rounding::Nearest);
    Some(NumberFormat { unit_mm, step, rounding, decimals, sign: sign.unwrap_or('.') })
}

/// The step and the decimals that its multiples have.
fn step(whole: Section<'_, '_>, unit: &'static str, unit_mm: f64) -> Option<(f64, usize)> {
    let value = whole.get("step")?;
    let Some((found, step)) = number(value.get_ref()) else {
        whole.note_kind(value, "step", "a number", "step = 0.1");
        return None;
    };
    let is_whole = |decimals: &usize| {
        let scaled = step * 10_f64.powi(i32::try_from(*decimals).unwrap_or_default());
        scaled >= 1.0 && (scaled - scaled.round()).abs() < 1e-9
    };
    let decimals = (0..=DECIMALS_MAX).find(is_whole);
    let [least_mm, most_mm] = STEPS_MM;
    match decimals {
        Some(decimals) if (least_mm..=most_mm).contains(&(step * unit_mm)) => {
            Some((step, decimals))
        }
        _ => {
            whole.note(&value.span(), "step", MappingWhat::Step { found, unit });
            None
        }
    }
}

fn decimals(whole: Section<'_, '_>, least: usize) -> Option<usize> {
    let Some(value) = whole.get("decimals") else { return Some(least) };
    let Some((found, _)) = number(value.get_ref()) else {
        whole.note_kind(value, "decimals", "a number", "decimals = 1");
        return None;
    };
    let decimals = found.parse().ok().filter(|of| (least..=DECIMALS_MAX).contains(of));
    if decimals.is_none() {
        let what = MappingWhat::Decimals { found, least, most: DECIMALS_MAX };
        whole.note(&value.span(), "decimals", what);
    }
    decimals
}

/// `[instead]` and `also_write`.
fn instead(whole: Section<'_, '_>) -> Instead {
    let mut found = texts(whole, "instead", "missing estimated doubtful");
    let mut text = |key: &str| found.remove(key).unwrap_or_default();
    let mut instead = Instead {
        missing: text("missing"),
        estimated: text("estimated"),
        doubtful: text("doubtful"),
        ..Instead::default()
    };
    let Some(value) = whole.get("also_write") else { return instead };
    for word in whole.lines(value, "also_write") {
        match word.as_str() {
            "estimated" => instead.writes_estimated = true,
            "doubtful" => instead.writes_doubtful = true,
            _ => {
                let what = NotAWord {
                    text: word,
                    words: ["estimated", "doubtful"].map(str::to_owned).to_vec(),
                    similar: None,
                };
                whole.note(&value.span(), "also_write", what);
            }
        }
    }
    instead
}

/// `[words]`: the words for the legs, and for neither.
fn sides(whole: Section<'_, '_>) -> [String; 3] {
    let mut found = texts(whole, "words", "right left body");
    ["right", "left", "body"].map(|key| found.remove(key).unwrap_or_else(|| key.to_owned()))
}

/// The texts of a section, which may be empty.
fn texts(
    whole: Section<'_, '_>,
    name: &'static str,
    known: &'static str,
) -> BTreeMap<String, String> {
    let mut texts = BTreeMap::new();
    let example = format!("[{name}] and the keys below it");
    let Some(section) = whole.section(name, name, "a section", &example) else { return texts };
    SectionKeys::here(known).only(section);
    for (key, value) in section.pairs() {
        let key = key.get_ref().as_ref();
        let text = match value.get_ref().as_str() {
            Some("") => Some(String::new()),
            _ => section.text(key),
        };
        texts.extend(text.map(|text| {
            no_formula(section, &text, &section.key(key), value);
            (key.to_owned(), text)
        }));
    }
    texts
}

fn columns(whole: Section<'_, '_>, rows: Option<Rows>) -> Vec<Column> {
    whole.must_have("column", "[[column]] with name and value");
    let tables = whole.tables("column");
    if let (true, Some(value)) = (tables.len() > COLUMNS_MAX, whole.get("column")) {
        let what = MappingWhat::Columns { found: tables.len(), most: COLUMNS_MAX };
        whole.note(&value.span(), "column", what);
        return Vec::new();
    }
    let mut columns: Vec<Column> = Vec::new();
    for section in tables {
        SectionKeys::here("name value text format").only(section);
        let name = section.required_text("name", "name = \"…\"");
        let cell = cell(section, rows);
        let Some((name, value)) = name.zip(section.get("name")) else { continue };
        no_formula(section, &name, "column.name", value);
        if columns.iter().any(|before| before.name == name) {
            whole.note(&value.span(), "column.name", Twice(name.clone()));
        }
        columns.extend(cell.map(|cell| Column { name, cell }));
    }
    columns
}

/// What stands in a column.
fn cell(section: Section<'_, '_>, rows: Option<Rows>) -> Option<Cell> {
    let cell = match (section.get("value"), section.get("text")) {
        (None, Some(value)) => {
            let text = section.text("text")?;
            no_formula(section, &text, "column.text", value);
            Cell::Text(text)
        }
        (Some(value), None) => {
            let text = section.text("value")?;
            // Without the kind of rows their values cannot be checked.
            match Cell::of_value(&text, rows?) {
                Ok(cell) => cell,
                Err(what) => {
                    section.note(&value.span(), "column.value", what);
                    return None;
                }
            }
        }
        _ => {
            section.note(&section.at(), "column", MappingWhat::NeitherOrBoth);
            return None;
        }
    };
    let Some(value) = section.get("format") else { return Some(cell) };
    let text = section.text("format")?;
    match cell {
        Cell::Date(dated, _) => {
            let format = DateFormat::new(&text);
            if format.is_none() {
                let what = MappingWhat::DateFormat(text);
                section.note(&value.span(), "column.format", what);
            }
            Some(Cell::Date(dated, format?))
        }
        _ => {
            let of = section.text("value").or(section.text("text"));
            let what = MappingWhat::NoDate(of.unwrap_or_default());
            section.note(&value.span(), "column.format", what);
            None
        }
    }
}

/// Notes a text that a spreadsheet would take for a formula. A lone sign is none.
fn no_formula(section: Section<'_, '_>, text: &str, key: &str, value: &Value<'_>) {
    if text.starts_with(['=', '+', '-', '@']) && text.chars().count() > 1 {
        section.note(&value.span(), key, MappingWhat::Formula(text.to_owned()));
    }
}

fn flag(whole: Section<'_, '_>, name: &str) -> Option<bool> {
    let value = whole.get(name)?;
    let DeValue::Boolean(flag) = value.get_ref() else {
        whole.note_kind(value, name, "true or false", format!("{name} = true"));
        return None;
    };
    Some(*flag)
}
