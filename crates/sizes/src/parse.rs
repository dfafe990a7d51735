//! The text of a size table → [`SizeTable`], or every fault of it.

mod sizes;

use std::ops::Range;

use gaiter_toml::What::{Empty, Twice};
use jiff::civil::Date;
use sha2::{Digest, Sha256};
use toml::de::DeValue;

use self::sizes::{lengths, sizes, variants};
use super::document::{Section, SectionKeys, Value, number, read};
use super::fault::{DocumentFault, What};
use super::point::Point;
use super::table::{Basis, FORMAT, Limits, Ranged, Required, SizeTable, Status};

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
pub fn parse(bytes: &[u8]) -> Result<SizeTable, Vec<DocumentFault>> {
    let example = "format = \"gaiter-size-table/1\"";
    read(bytes, FORMAT, example, |whole| table(whole, format!("{:x}", Sha256::digest(bytes))))
}

/// The table of a file. What is wrong is noted, and the rest is read all the same.
fn table(whole: Section<'_, '_>, sha256: String) -> Option<SizeTable> {
    SectionKeys::here(KEYS).only(whole);
    let id = whole.required_text("id", "id = \"maker-product-2026\"");
    let maker = whole.required_text("maker", "maker = \"…\"");
    let product = whole.required_text("product", "product = \"…\"");
    let edition = whole.required_text("table_edition", "table_edition = \"2026-01\"");
    let source = whole.required_text("source", "source = \"where the figures stand\"");
    let status = whole.required_choice("status", &Status::WORDS);
    let unit = whole.required_choice("unit", &UNITS);
    let limits = [("closed", Limits::Closed), ("open", Limits::Open)];
    let limits = whole.required_choice("limits", &limits);
    whole.required_choice("match", &[("all", ())]);
    let from = whole.choice("lengths_from", &[("floor", ())]);
    let bases = [("skin", Basis::Skin), ("tension", Basis::Tension)];
    let basis = whole.choice("skin_or_tension", &bases);
    let decides = decides(whole);
    let signed = ["entered_by", "checked_by"].map(|name| whole.text(name));
    signatures(whole, status, &signed);
    if status == Some(Status::Released) {
        whole.must_have("skin_or_tension", "skin_or_tension = \"skin\"");
    }
    let variants = variants(whole);
    let unit = unit.unwrap_or(UNITS[0].1);
    let lengths = lengths(whole, unit);
    let sizes = sizes(whole, unit, &variants, &lengths);
    // A range that is wrong is reported as such, not as missing.
    let known = if whole.is_sound() { sizes.as_slice() } else { &[] };
    let required = required(whole, known);
    if let Some(Some((point, at))) = &decides {
        every_size_has(whole, *point, known, at, "decides");
    }
    let valid_until = day(whole, "valid_until");
    let [entered_by, checked_by] = signed;
    Some(SizeTable {
        id: id?,
        maker: maker?,
        product: product?,
        edition: edition?,
        source: source?,
        sureness: whole.text("sureness"),
        status: status?,
        entered_by,
        checked_by,
        valid_until,
        limits: limits?,
        decides: decides?.map(|(point, _)| point),
        basis,
        states_where_lengths_begin: from.is_some(),
        garments: whole.list("garments"),
        required,
        variants,
        lengths,
        sizes,
        sha256,
    })
}

/// The point by which the size is sought, with its place; `Some(None)` for `none`.
fn decides(whole: Section<'_, '_>) -> Option<Option<(Point, Range<usize>)>> {
    let found = whole.required_text("decides", "decides = \"cB\", or \"none\"")?;
    if found == "none" {
        return Some(None);
    }
    let at = whole.get("decides").map(Value::span)?;
    match Point::named(&found) {
        Some(point) => Some(Some((point, at))),
        None => {
            whole.note(&at, "decides", What::NoPoint(found));
            None
        }
    }
}

/// Notes a released table that two persons have not signed.
fn signatures(whole: Section<'_, '_>, status: Option<Status>, signed: &[Option<String>; 2]) {
    if status != Some(Status::Released) {
        return;
    }
    let at = whole.get("checked_by").or(whole.get("status")).map_or(0..0, Value::span);
    match signed {
        [Some(entered), Some(checked)] if is_same_person(entered, checked) => {
            whole.note(&at, "checked_by", What::SamePerson(checked.clone()));
        }
        [Some(_), Some(_)] => {}
        _ => whole.note(&at, "checked_by", What::Unsigned),
    }
}

/// Whether two names belong to one person: the same letters, however they are written.
pub(super) fn is_same_person(one: &str, other: &str) -> bool {
    let letters = |name: &str| -> String {
        name.chars().filter(|of| of.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    };
    letters(one) == letters(other)
}

/// A date without a time.
fn day(whole: Section<'_, '_>, name: &str) -> Option<Date> {
    let value = whole.get(name)?;
    let found = match value.get_ref() {
        DeValue::Datetime(found) if found.time.is_none() => found.date,
        _ => None,
    };
    let date = found.and_then(|of| of.to_string().parse::<Date>().ok());
    if date.is_none() {
        whole.note_kind(value, name, "a date", "year-month-day without quotes: 2027-01-31");
    }
    date
}

/// `required = ["cB", "cC"]`, or a list for each garment.
fn required(whole: Section<'_, '_>, sizes: &[super::table::Size]) -> Vec<Required> {
    let Some(value) = whole.get("required") else { return Vec::new() };
    let mut all = Vec::new();
    let mut add = |garment: Option<&str>, value: &Value<'_>| {
        let key = garment.map_or("required".to_owned(), |name| format!("required.{name}"));
        let points = points(whole, value, &key);
        for point in &points {
            every_size_has(whole, *point, sizes, &value.span(), &key);
        }
        all.push(Required { garment: garment.map(str::to_owned), points });
    };
    match value.get_ref() {
        DeValue::Table(table) => {
            for (name, value) in table {
                add(Some(name.get_ref()), value);
            }
        }
        _ => add(None, value),
    }
    all
}

/// Notes each size that has no range of a point.
fn every_size_has(
    section: Section<'_, '_>,
    point: Point,
    sizes: &[super::table::Size],
    at: &Range<usize>,
    key: &str,
) {
    for size in sizes.iter().filter(|size| size.range(point).is_none()) {
        let what = What::NoRange { size: size.name.clone(), point: point.to_string() };
        section.note(at, key, what);
    }
}

/// The points of a list, each once; at least one.
pub(super) fn points(section: Section<'_, '_>, value: &Value<'_>, key: &str) -> Vec<Point> {
    let names = section.lines(value, key);
    if names.is_empty() && matches!(value.get_ref(), DeValue::Array(list) if list.is_empty()) {
        section.note(&value.span(), key, Empty);
    }
    let mut points = Vec::new();
    for name in names {
        match Point::named(&name) {
            None => section.note(&value.span(), key, What::NoPoint(name)),
            Some(point) if points.contains(&point) => {
                section.note(&value.span(), key, Twice(name));
            }
            Some(point) => points.push(point),
        }
    }
    points
}

/// The range of a point: two limits, the lower one first.
fn range(
    section: Section<'_, '_>,
    point: Point,
    value: &Value<'_>,
    key: &str,
    unit: Unit,
) -> Option<Ranged> {
    let limits: &[Value<'_>] = match value.get_ref() {
        DeValue::Array(limits) => limits,
        _ => &[],
    };
    let [low, high] = limits else {
        let written = section.written(value);
        section.note(&value.span(), key, What::Limits { written });
        return None;
    };
    let limit = |value: &Value<'_>| {
        let Some((written, found)) = number(value.get_ref()) else {
            section.note_kind(value, key, "a number", "it without quotes: [18, 20.5]");
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
            section.note(
                &value.span(),
                key,
                What::Reach { found: written, unit, point, least, most },
            );
            return None;
        }
        Some((written, mm))
    };
    let (low, high) = (limit(low), limit(high));
    let ((low, low_mm), (high, high_mm)) = (low?, high?);
    if low_mm >= high_mm {
        section.note(&value.span(), key, What::Order { low, high });
        return None;
    }
    Some(Ranged { point, mm: [low_mm, high_mm] })
}

/// A name that no earlier entry of the file has.
fn own_name<'a>(
    section: Section<'_, '_>,
    mut taken: impl Iterator<Item = &'a String>,
) -> Option<String> {
    section.must_have("name", "name = \"II\"");
    let value = section.get("name")?;
    let name = section.line(value, &section.key("name"))?;
    if taken.any(|of| *of == name) {
        section.note(&value.span(), section.key("name"), Twice(name.clone()));
    }
    Some(name)
}
