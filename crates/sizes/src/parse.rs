//! The text of a size table → [`SizeTable`], or every fault of it.

mod sizes;

use std::ops::Range;

use jiff::civil::Date;
use sha2::{Digest, Sha256};
use toml::de::{DeTable, DeValue};

use self::sizes::{lengths, sizes, variants};
use super::document::{Faults, Known, Section, Value, line, lines, number};
use super::fault::{Fault, Form, What};
use super::point::Point;
use super::table::{Basis, FORMAT, Limits, Ranged, Required, SizeTable, Status};

/// The longest file that is read, bytes: hundreds of sizes with their codes have less.
pub const BYTES_MAX: usize = 256 * 1024;

/// Girths that a leg can have, mm: from a child's ankle to the largest thighs of severe lymphoedema.
const GIRTHS_MM: [f64; 2] = [50.0, 1500.0];

/// Lengths that a leg or foot can have, mm.
const LENGTHS_MM: [f64; 2] = [20.0, 1400.0];

/// Girths and lengths of hip and waist, mm.
const BEYOND_MM: [f64; 2] = [200.0, 2500.0];

/// The keys of the whole file. Notes may be added: any key that begins with `note_`.
const KEYS: &str = "format id maker product table_edition source sureness status entered_by checked_by \
                    valid_until unit limits decides match lengths_from skin_or_tension garments required \
                    variant length size note_…";

/// The unit of the limits of a table.
#[derive(Debug, Clone, Copy)]
struct Unit {
    name: &'static str,
    mm: f64,
}

/// The units of a table.
const UNITS: [(&str, Unit); 2] =
    [("cm", Unit { name: "cm", mm: 10.0 }), ("mm", Unit { name: "mm", mm: 1.0 })];

/// Reads a size table from the bytes of its file.
///
/// # Errors
/// Every fault of the file, in the order of its lines; at least one.
pub fn parse(bytes: &[u8]) -> Result<SizeTable, Vec<Fault>> {
    let text = readable(bytes)?;
    let (root, errors) = DeTable::parse_recoverable(text);
    let mut faults = Faults::new(text);
    if !errors.is_empty() {
        faults.note_notation(&errors);
        return Err(faults.in_order());
    }
    let at = 0..0;
    let whole = Section::whole(root.get_ref(), &at);
    match (table(whole, hex(&Sha256::digest(bytes)), &mut faults), faults.is_empty()) {
        (Some(table), true) => Ok(table),
        _ => Err(faults.in_order()),
    }
}

/// The text of a file that is not too long.
pub(super) fn readable(bytes: &[u8]) -> Result<&str, Vec<Fault>> {
    let at_first = |what| vec![Fault { line: 1, column: 1, key: String::new(), what }];
    if bytes.len() > BYTES_MAX {
        return Err(at_first(What::TooLong { found: bytes.len(), most: BYTES_MAX }));
    }
    str::from_utf8(bytes).map_err(|error| {
        let sound = &bytes[..error.valid_up_to()];
        let line = sound.iter().filter(|byte| **byte == b'\n').count() + 1;
        vec![Fault { line, column: 1, key: String::new(), what: What::NotUtf8 }]
    })
}

/// Whether a file is of a format, which the line `example` sets; notes it if not.
pub(super) fn is_of_format(
    whole: Section<'_, '_>,
    (expected, example): (&'static str, &'static str),
    faults: &mut Faults<'_>,
) -> bool {
    let found = whole.required_text("format", example, faults);
    match (found, whole.get("format")) {
        (Some(found), Some(value)) if found != expected => {
            faults.note(&value.span(), "format", What::Format { found, expected });
            false
        }
        (found, _) => found.is_some(),
    }
}

/// The table of a file. What is wrong is noted, and the rest is read all the same.
fn table(whole: Section<'_, '_>, sha256: String, faults: &mut Faults<'_>) -> Option<SizeTable> {
    if !is_of_format(whole, (FORMAT, "format = \"gaiter-size-table/1\""), faults) {
        return None;
    }
    let is_known = |name: &str| {
        name.starts_with("note_") || KEYS.split_whitespace().any(|known| known == name)
    };
    whole.only(Known::here(KEYS), is_known, faults);
    let id = whole.required_text("id", "id = \"maker-product-2026\"", faults);
    let maker = whole.required_text("maker", "maker = \"…\"", faults);
    let product = whole.required_text("product", "product = \"…\"", faults);
    let edition = whole.required_text("table_edition", "table_edition = \"2026-01\"", faults);
    let source = whole.required_text("source", "source = \"where the figures stand\"", faults);
    let statuses =
        [("test-only", Status::TestOnly), ("draft", Status::Draft), ("released", Status::Released)];
    let status = required_choice(whole, "status", &statuses, "test-only, draft, released", faults);
    let unit = required_choice(whole, "unit", &UNITS, "cm, mm", faults);
    let limits = [("closed", Limits::Closed), ("open", Limits::Open)];
    let limits = required_choice(whole, "limits", &limits, "closed, open", faults);
    required_choice(whole, "match", &[("all", ())], "all", faults);
    let from = whole.choice("lengths_from", &[("floor", ())], "floor", faults);
    let bases = [("skin", Basis::Skin), ("tension", Basis::Tension)];
    let basis = whole.choice("skin_or_tension", &bases, "skin, tension", faults);
    let decides = decides(whole, faults);
    let signed = ["entered_by", "checked_by"].map(|name| whole.text(name, faults));
    signatures(whole, status, &signed, faults);
    if status == Some(Status::Released) && whole.get("skin_or_tension").is_none() {
        whole.miss("skin_or_tension", "skin_or_tension = \"skin\"", faults);
    }
    let variants = variants(whole, faults);
    let unit = unit.unwrap_or(UNITS[0].1);
    let lengths = lengths(whole, unit, faults);
    let sizes = sizes(whole, unit, (&variants, &lengths), faults);
    // A range that is wrong is told as such, not as missing.
    let known = if faults.is_empty() { sizes.as_slice() } else { &[] };
    let required = required(whole, known, faults);
    if let Some(Some((point, at))) = &decides {
        every_size_has(*point, known, at, "decides", faults);
    }
    let valid_until = day(whole, "valid_until", faults);
    let [entered_by, checked_by] = signed;
    Some(SizeTable {
        id: id?,
        maker: maker?,
        product: product?,
        edition: edition?,
        source: source?,
        sureness: whole.text("sureness", faults),
        status: status?,
        entered_by,
        checked_by,
        valid_until,
        limits: limits?,
        decides: decides?.map(|(point, _)| point),
        basis,
        says_where_lengths_begin: from.is_some(),
        garments: whole.list("garments", faults),
        required,
        variants,
        lengths,
        sizes,
        sha256,
    })
}

/// One of the words of a choice that must be made.
fn required_choice<T: Copy>(
    whole: Section<'_, '_>,
    name: &'static str,
    words: &[(&str, T)],
    shown: &'static str,
    faults: &mut Faults<'_>,
) -> Option<T> {
    if whole.get(name).is_none() {
        let example = match name {
            "status" => "status = \"draft\"",
            "unit" => "unit = \"cm\", or \"mm\"",
            "limits" => "limits = \"closed\"",
            _ => "match = \"all\"",
        };
        whole.miss(name, example, faults);
    }
    whole.choice(name, words, shown, faults)
}

/// The point by which the size is sought, with its place; `Some(None)` for `none`.
fn decides(
    whole: Section<'_, '_>,
    faults: &mut Faults<'_>,
) -> Option<Option<(Point, Range<usize>)>> {
    let found = whole.required_text("decides", "decides = \"cB\", or \"none\"", faults)?;
    if found == "none" {
        return Some(None);
    }
    let at = whole.get("decides").map(Value::span)?;
    match Point::of(&found) {
        Some(point) => Some(Some((point, at))),
        None => {
            faults.note(&at, "decides", What::NoPoint(found));
            None
        }
    }
}

/// Notes a released table that two persons have not signed.
fn signatures(
    whole: Section<'_, '_>,
    status: Option<Status>,
    signed: &[Option<String>; 2],
    faults: &mut Faults<'_>,
) {
    if status != Some(Status::Released) {
        return;
    }
    let at = whole.get("checked_by").or(whole.get("status")).map_or(0..0, Value::span);
    match signed {
        [Some(entered), Some(checked)] if is_same_person(entered, checked) => {
            faults.note(&at, "checked_by", What::SamePerson(checked.clone()));
        }
        [Some(_), Some(_)] => {}
        _ => faults.note(&at, "checked_by", What::Unsigned),
    }
}

/// Whether two names are of one person: the same letters, however they are written.
pub(super) fn is_same_person(one: &str, other: &str) -> bool {
    let letters = |name: &str| -> String {
        name.chars().filter(|of| of.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    };
    letters(one) == letters(other)
}

/// A date without a time.
fn day(whole: Section<'_, '_>, name: &str, faults: &mut Faults<'_>) -> Option<Date> {
    let value = whole.get(name)?;
    let found = match value.get_ref() {
        DeValue::Datetime(found) if found.time.is_none() => found.date,
        _ => None,
    };
    let date = found.and_then(|of| {
        let [month, day] = [of.month, of.day].map(|part| i8::try_from(part).ok());
        Date::new(i16::try_from(of.year).ok()?, month?, day?).ok()
    });
    if date.is_none() {
        faults.note_form(value, name, Form::DAY);
    }
    date
}

/// `required = ["cB", "cC"]`, or a list for each garment.
fn required(
    whole: Section<'_, '_>,
    sizes: &[super::table::Size],
    faults: &mut Faults<'_>,
) -> Vec<Required> {
    let Some(value) = whole.get("required") else { return Vec::new() };
    let mut all = Vec::new();
    let mut add = |garment: Option<&str>, value: &Value<'_>, faults: &mut Faults<'_>| {
        let key = garment.map_or("required".to_owned(), |name| format!("required.{name}"));
        let points = points(value, &key, faults);
        for point in &points {
            every_size_has(*point, sizes, &value.span(), &key, faults);
        }
        all.push(Required { garment: garment.map(str::to_owned), points });
    };
    match value.get_ref() {
        DeValue::Table(table) => {
            for (name, value) in table {
                add(Some(name.get_ref()), value, faults);
            }
        }
        _ => add(None, value, faults),
    }
    all
}

/// Notes each size that has no range of a point.
fn every_size_has(
    point: Point,
    sizes: &[super::table::Size],
    at: &Range<usize>,
    key: &str,
    faults: &mut Faults<'_>,
) {
    for size in sizes.iter().filter(|size| size.range(point).is_none()) {
        let what = What::NoRange { size: size.name.clone(), point: point.to_string() };
        faults.note(at, key, what);
    }
}

/// The points of a list, each once; at least one.
pub(super) fn points(value: &Value<'_>, key: &str, faults: &mut Faults<'_>) -> Vec<Point> {
    let names = lines(value, key, faults);
    if names.is_empty() && matches!(value.get_ref(), DeValue::Array(list) if list.is_empty()) {
        faults.note(&value.span(), key, What::Empty);
    }
    let mut points = Vec::new();
    for name in names {
        match Point::of(&name) {
            None => faults.note(&value.span(), key, What::NoPoint(name)),
            Some(point) if points.contains(&point) => {
                faults.note(&value.span(), key, What::Twice(name));
            }
            Some(point) => points.push(point),
        }
    }
    points
}

/// The range of a point: two limits, the lower one first.
fn range(
    point: Point,
    value: &Value<'_>,
    key: &str,
    unit: Unit,
    faults: &mut Faults<'_>,
) -> Option<Ranged> {
    let limits: &[Value<'_>] = match value.get_ref() {
        DeValue::Array(limits) => limits,
        _ => &[],
    };
    let [low, high] = limits else {
        let written = faults.written(value);
        faults.note(&value.span(), key, What::Limits { written });
        return None;
    };
    let limit = |value: &Value<'_>, faults: &mut Faults<'_>| {
        let Some((written, found)) = number(value.get_ref()) else {
            faults.note_form(value, key, Form::LIMIT);
            return None;
        };
        // To a millionth of a millimetre: 38.9 cm is 389 mm and not a hair less.
        let mm = (found * unit.mm * 1e6).round() / 1e6;
        let reach_mm = match point {
            Point::Girth(_) => GIRTHS_MM,
            Point::Beyond(_) => BEYOND_MM,
            _ => LENGTHS_MM,
        };
        if !(reach_mm[0]..=reach_mm[1]).contains(&mm) {
            let [least, most] = reach_mm.map(|mm| (mm / unit.mm).to_string());
            let (point, unit) = (point.to_string(), unit.name);
            faults.note(
                &value.span(),
                key,
                What::Reach { found: written, unit, point, least, most },
            );
            return None;
        }
        Some((written, mm))
    };
    let (low, high) = (limit(low, faults), limit(high, faults));
    let ((low, low_mm), (high, high_mm)) = (low?, high?);
    if low_mm >= high_mm {
        faults.note(&value.span(), key, What::Order { low, high });
        return None;
    }
    Some(Ranged { point, mm: [low_mm, high_mm] })
}

/// A name that no earlier entry of the file has.
fn own_name(section: Section<'_, '_>, taken: &[String], faults: &mut Faults<'_>) -> Option<String> {
    if section.get("name").is_none() {
        section.miss("name", "name = \"II\"", faults);
    }
    let value = section.get("name")?;
    let name = line(value, &section.key("name"), faults)?;
    if taken.contains(&name) {
        faults.note(&value.span(), section.key("name"), What::Twice(name.clone()));
    }
    Some(name)
}

/// Bytes as lower-case hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
