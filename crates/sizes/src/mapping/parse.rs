//! The text of a mapping file → [`Mapping`], or every fault of it.

use toml::de::{DeTable, DeValue};

use super::date::DateFormat;
use super::fault::MappingWhat;
use super::file_name::FileName;
use super::value::Cell;
use super::{Column, Csv, Encoding, FORMAT, Figures, Instead, Layout, Mapping, Rounding, Rows};
use crate::document::{Faults, Known, Section, Value, kind, lines, number};
use crate::fault::{Fault, What};
use crate::parse::{is_of_format, points, readable};

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
    [("mm", ("mm", 1.0)), ("cm", ("cm", 10.0)), ("inch", ("inch", 25.4))];

/// Reads a mapping from the bytes of its file.
///
/// # Errors
/// Every fault of the file, in the order of its lines; at least one.
pub fn parse(bytes: &[u8]) -> Result<Mapping, Vec<Fault>> {
    let text = readable(bytes).map_err(in_own_words)?;
    let (root, errors) = DeTable::parse_recoverable(text);
    let mut faults = Faults::new(text);
    if !errors.is_empty() {
        faults.note_notation(&errors);
        return Err(in_own_words(faults.in_order()));
    }
    let at = 0..0;
    let whole = Section::whole(root.get_ref(), &at);
    match (mapping(whole, &mut faults), faults.is_empty()) {
        (Some(mapping), true) => Ok(mapping),
        _ => Err(in_own_words(faults.in_order())),
    }
}

/// The faults with hints on mappings, where those of size tables would be told.
fn in_own_words(faults: Vec<Fault>) -> Vec<Fault> {
    let own = |fault: Fault| {
        let what = match fault.what {
            What::Notation { slip, written } => {
                MappingWhat::Notation(format!("{slip}: {written}")).into()
            }
            What::Kind { form, found, .. } => {
                MappingWhat::Kind { expected: form.words, found }.into()
            }
            What::TooLong { found, most } => MappingWhat::TooLong { found, most }.into(),
            other => other,
        };
        Fault { what, ..fault }
    };
    faults.into_iter().map(own).collect()
}

/// The mapping of a file. What is wrong is noted, and the rest is read all the same.
fn mapping(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> Option<Mapping> {
    if !is_of_format(whole, (FORMAT, "format = \"gaiter-order-mapping/1\""), faults) {
        return None;
    }
    let is_known = |name: &str| {
        name.starts_with("note_") || KEYS.split_whitespace().any(|known| known == name)
    };
    whole.only(Known::here(KEYS), is_known, faults);
    let id = whole.required_text("id", "id = \"shop-2026\"", faults);
    let name = whole.required_text("name", "name = \"…\"", faults);
    let source = whole.required_text("source", "source = \"where the form was read\"", faults);
    let file_name = file_name(whole, faults);
    let layout = layout(whole, faults);
    let rows = rows(whole, faults);
    let points = own_points(whole, rows, faults);
    let figures = figures(whole, faults);
    let instead = instead(whole, faults);
    let sides = sides(whole, faults);
    let columns = columns(whole, rows, faults);
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

fn file_name(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> Option<FileName> {
    let text = whole.required_text("file_name", "file_name = \"order-{id}.csv\"", faults)?;
    let name = FileName::new(&text);
    if let (None, Some(value)) = (&name, whole.get("file_name")) {
        faults.note(&value.span(), "file_name", MappingWhat::FileName(text).into());
    }
    name
}

/// The kind of file. The keys of a table are faults in a mapping that makes none.
fn layout(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> Option<Layout> {
    if whole.get("layout").is_none() {
        whole.miss("layout", "layout = \"csv\"", faults);
    }
    let is_csv = whole.choice("layout", &[("csv", true), ("json", false)], "csv, json", faults)?;
    if !is_csv {
        for key in CSV_KEYS {
            if let Some(value) = whole.get(key) {
                faults.note(&value.span(), key, MappingWhat::OnlyCsv.into());
            }
        }
        return Some(Layout::Json);
    }
    let separators = [(";", ';'), (",", ','), ("|", '|'), ("tab", '\t')];
    let separator = whole.choice("separator", &separators, "; , | tab", faults);
    let quotes = [("needed", false), ("always", true)];
    let quotes_all = whole.choice("quote", &quotes, "needed, always", faults);
    let ends = [("crlf", "\r\n"), ("lf", "\n")];
    let line_end = whole.choice("line_end", &ends, "crlf, lf", faults);
    let sets =
        [("utf-8", Encoding::Utf8), ("utf-8-bom", Encoding::Utf8Bom), ("cp1252", Encoding::Cp1252)];
    let encoding = whole.choice("encoding", &sets, "utf-8, utf-8-bom, cp1252", faults);
    Some(Layout::Csv(Csv {
        separator: separator.unwrap_or(';'),
        quotes_all: quotes_all.unwrap_or(false),
        line_end: line_end.unwrap_or("\r\n"),
        encoding: encoding.unwrap_or(Encoding::Utf8),
        has_header: flag(whole, "header", faults).unwrap_or(true),
        is_spreadsheet: flag(whole, "spreadsheet", faults).unwrap_or(false),
    }))
}

fn rows(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> Option<Rows> {
    if whole.get("rows").is_none() {
        whole.miss("rows", "rows = \"order\"", faults);
    }
    let all = [Rows::Order, Rows::Leg, Rows::Level, Rows::Point].map(|rows| (rows.word(), rows));
    whole.choice("rows", &all, "order, leg, level, point", faults)
}

/// The points of the rows.
fn own_points(
    whole: Section<'_, '_>,
    rows: Option<Rows>,
    faults: &mut Faults<'_>,
) -> Option<Vec<crate::Point>> {
    let value = whole.get("points")?;
    if matches!(rows, Some(Rows::Order | Rows::Leg)) {
        faults.note(&value.span(), "points", MappingWhat::OnlyPoints.into());
    }
    Some(points(value, "points", faults))
}

/// How figures are written.
fn figures(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> Option<Figures> {
    if whole.get("unit").is_none() {
        whole.miss("unit", "unit = \"cm\"", faults);
    }
    let (unit, unit_mm) = whole.choice("unit", &UNITS, "mm, cm, inch", faults)?;
    if whole.get("step").is_none() {
        whole.miss("step", "step = 0.1", faults);
    }
    let (step, least) = step(whole, unit, unit_mm, faults)?;
    let roundings =
        [("nearest", Rounding::Nearest), ("up", Rounding::Up), ("down", Rounding::Down)];
    let rounding = whole.choice("round", &roundings, "nearest, up, down", faults);
    let sign = whole.choice("decimal", &[(".", '.'), (",", ',')], ". or ,", faults);
    let decimals = decimals(whole, least, faults)?;
    let rounding = rounding.unwrap_or(Rounding::Nearest);
    Some(Figures { unit_mm, unit, step, rounding, decimals, sign: sign.unwrap_or('.') })
}

/// The step and the decimals that its multiples have.
fn step(
    whole: Section<'_, '_>,
    unit: &'static str,
    unit_mm: f64,
    faults: &mut Faults<'_>,
) -> Option<(f64, usize)> {
    let value = whole.get("step")?;
    let Some((found, step)) = number(value.get_ref()) else {
        faults.note(&value.span(), "step", not_a("a number", value));
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
            faults.note(&value.span(), "step", MappingWhat::Step { found, unit }.into());
            None
        }
    }
}

fn decimals(whole: Section<'_, '_>, least: usize, faults: &mut Faults<'_>) -> Option<usize> {
    let Some(value) = whole.get("decimals") else { return Some(least) };
    let Some((found, _)) = number(value.get_ref()) else {
        faults.note(&value.span(), "decimals", not_a("a number", value));
        return None;
    };
    let decimals = found.parse().ok().filter(|of| (least..=DECIMALS_MAX).contains(of));
    if decimals.is_none() {
        let what = MappingWhat::Decimals { found, least, most: DECIMALS_MAX };
        faults.note(&value.span(), "decimals", what.into());
    }
    decimals
}

/// `[instead]` and `also_write`.
fn instead(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> Instead {
    let known = "missing estimated doubtful";
    let found = texts(whole, "instead", known, faults);
    let text = |key: &str| found.iter().find(|(name, _)| name == key).map(|(_, text)| text.clone());
    let mut instead = Instead {
        missing: text("missing").unwrap_or_default(),
        estimated: text("estimated").unwrap_or_default(),
        doubtful: text("doubtful").unwrap_or_default(),
        ..Instead::default()
    };
    let Some(value) = whole.get("also_write") else { return instead };
    for word in lines(value, "also_write", faults) {
        match word.as_str() {
            "estimated" => instead.writes_estimated = true,
            "doubtful" => instead.writes_doubtful = true,
            _ => {
                let what = What::Word { found: word, words: "estimated, doubtful" };
                faults.note(&value.span(), "also_write", what);
            }
        }
    }
    instead
}

/// `[words]`: the words for the legs, and for neither.
fn sides(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> [String; 3] {
    let usual = ["right", "left", "body"];
    let found = texts(whole, "words", "right left body", faults);
    usual.map(|key| {
        let own = found.iter().find(|(name, _)| name == key).map(|(_, text)| text.clone());
        own.unwrap_or_else(|| key.to_owned())
    })
}

/// The texts of a section, which may be empty.
fn texts(
    whole: Section<'_, '_>,
    name: &'static str,
    known: &'static str,
    faults: &mut Faults<'_>,
) -> Vec<(String, String)> {
    let Some(value) = whole.get(name) else { return Vec::new() };
    let DeValue::Table(table) = value.get_ref() else {
        faults.note(&value.span(), name, not_a("a section", value));
        return Vec::new();
    };
    let at = value.span();
    let section = Section::within(table, &at, name);
    section.only(Known::here(known), |key| known.split(' ').any(|word| word == key), faults);
    let mut texts = Vec::new();
    for (key, value) in section.pairs() {
        let key = key.get_ref().as_ref();
        let text = match value.get_ref().as_str() {
            Some("") => Some(String::new()),
            _ => section.text(key, faults),
        };
        texts.extend(text.map(|text| {
            no_formula(&text, &section.key(key), value, faults);
            (key.to_owned(), text)
        }));
    }
    texts
}

/// The columns.
fn columns(whole: Section<'_, '_>, rows: Option<Rows>, faults: &mut Faults<'_>) -> Vec<Column> {
    if whole.get("column").is_none() {
        whole.miss("column", "[[column]] with name and value", faults);
    }
    let tables = whole.tables("column", faults);
    if let (true, Some(value)) = (tables.len() > COLUMNS_MAX, whole.get("column")) {
        let what = MappingWhat::Columns { found: tables.len(), most: COLUMNS_MAX };
        faults.note(&value.span(), "column", what.into());
        return Vec::new();
    }
    let mut columns: Vec<Column> = Vec::new();
    for (table, at) in &tables {
        let section = Section::within(table, at, "column");
        section.only(
            Known::here("name value text format"),
            |key| ["name", "value", "text", "format"].contains(&key),
            faults,
        );
        let name = section.required_text("name", "name = \"…\"", faults);
        let cell = cell(section, rows, faults);
        let Some((name, value)) = name.zip(section.get("name")) else { continue };
        no_formula(&name, "column.name", value, faults);
        if columns.iter().any(|before| before.name == name) {
            faults.note(&value.span(), "column.name", What::Twice(name.clone()));
        }
        columns.extend(cell.map(|cell| Column { name, cell }));
    }
    columns
}

/// What stands in a column.
fn cell(section: Section<'_, '_>, rows: Option<Rows>, faults: &mut Faults<'_>) -> Option<Cell> {
    let cell = match (section.get("value"), section.get("text")) {
        (None, Some(value)) => {
            let text = section.text("text", faults)?;
            no_formula(&text, "column.text", value, faults);
            Cell::Text(text)
        }
        (Some(value), None) => {
            let text = section.text("value", faults)?;
            // Without the kind of rows nothing can be said about their values.
            match Cell::of_value(&text, rows?) {
                Ok(cell) => cell,
                Err(what) => {
                    faults.note(&value.span(), "column.value", what.into());
                    return None;
                }
            }
        }
        _ => {
            faults.note(section.at(), "column", MappingWhat::NeitherOrBoth.into());
            return None;
        }
    };
    let Some(value) = section.get("format") else { return Some(cell) };
    let text = section.text("format", faults)?;
    match cell {
        Cell::Date(dated, _) => {
            let format = DateFormat::new(&text);
            if format.is_none() {
                let what = MappingWhat::DateFormat(text);
                faults.note(&value.span(), "column.format", what.into());
            }
            Some(Cell::Date(dated, format?))
        }
        _ => {
            let of = section.text("value", faults).or(section.text("text", faults));
            let what = MappingWhat::NoDate(of.unwrap_or_default());
            faults.note(&value.span(), "column.format", what.into());
            None
        }
    }
}

/// Notes a text that a spreadsheet would take for a formula. A lone sign is none.
fn no_formula(text: &str, key: &str, value: &Value<'_>, faults: &mut Faults<'_>) {
    if text.starts_with(['=', '+', '-', '@']) && text.chars().count() > 1 {
        faults.note(&value.span(), key, MappingWhat::Formula(text.to_owned()).into());
    }
}

fn flag(whole: Section<'_, '_>, name: &str, faults: &mut Faults<'_>) -> Option<bool> {
    let value = whole.get(name)?;
    let DeValue::Boolean(flag) = value.get_ref() else {
        faults.note(&value.span(), name, not_a("true or false", value));
        return None;
    };
    Some(*flag)
}

fn not_a(expected: &'static str, value: &Value<'_>) -> What {
    MappingWhat::Kind { expected, found: kind(value.get_ref()) }.into()
}
