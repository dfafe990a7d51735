//! `[[variant]]`, `[[length]]` and `[[size]]` of a size table.

use toml::de::{DeTable, DeValue};

use super::super::document::{Faults, Known, Section, Value, line};
use super::super::fault::{Form, What};
use super::super::point::Point;
use super::super::table::{Code, LengthRow, Ranged, Size, Variant};
use super::{KEYS, Unit, own_name, points, range};

/// The keys of a section, below those of the whole file.
fn known(here: &'static str) -> Known {
    Known { here, above: KEYS }
}

/// The variants of a file.
pub(super) fn variants(whole: Section<'_, '_>, faults: &mut Faults<'_>) -> Vec<Variant> {
    let mut variants: Vec<Variant> = Vec::new();
    for (table, at) in whole.tables("variant", faults) {
        let section = Section::within(table, &at, "variant");
        let is_known = |name: &str| ["name", "applies_to", "replaces"].contains(&name);
        section.only(known("name applies_to replaces"), is_known, faults);
        let taken: Vec<String> = variants.iter().map(|of| of.name.clone()).collect();
        let name = own_name(section, &taken, faults);
        let applies_to = section.list("applies_to", faults);
        let replaces = match section.get("replaces") {
            Some(value) => points(value, "variant.replaces", faults),
            None => {
                section.miss("replaces", "replaces = [\"cG\"]", faults);
                Vec::new()
            }
        };
        variants.extend(name.map(|name| Variant { name, applies_to, replaces }));
    }
    variants
}

/// The lengths of a file.
pub(super) fn lengths(
    whole: Section<'_, '_>,
    unit: Unit,
    faults: &mut Faults<'_>,
) -> Vec<LengthRow> {
    let mut rows: Vec<LengthRow> = Vec::new();
    for (table, at) in whole.tables("length", faults) {
        let section = Section::within(table, &at, "length");
        let is_known =
            |name: &str| ["garment", "name"].contains(&name) || Point::of(name).is_some();
        section.only(known("garment name and points such as lD"), is_known, faults);
        let garment = section.required_text("garment", "garment = \"AD\"", faults);
        let same = rows.iter().filter(|of| Some(&of.garment) == garment.as_ref());
        let taken: Vec<String> = same.map(|of| of.name.clone()).collect();
        let name = own_name(section, &taken, faults);
        let ranges = ranges(section, unit, faults);
        if !section.pairs().any(|(name, _)| Point::of(name.get_ref()).is_some()) {
            faults.note(&at, "length", What::Empty);
        }
        if let (Some(garment), Some(name)) = (garment, name) {
            rows.push(LengthRow { garment, name, ranges });
        }
    }
    rows
}

/// The sizes of a file, at least one.
pub(super) fn sizes(
    whole: Section<'_, '_>,
    unit: Unit,
    (variants, lengths): (&[Variant], &[LengthRow]),
    faults: &mut Faults<'_>,
) -> Vec<Size> {
    let mut sizes: Vec<Size> = Vec::new();
    let tables = whole.tables("size", faults);
    if whole.get("size").is_none() {
        whole.miss("size", "[[size]] with name and ranges", faults);
    }
    for (table, at) in tables {
        let key = match table.get("name").and_then(|name| name.get_ref().as_str()) {
            Some(name) => format!("size.{name}"),
            None => "size".to_owned(),
        };
        let section = Section::within(table, &at, &key);
        let is_known =
            |name: &str| ["name", "code", "variant"].contains(&name) || Point::of(name).is_some();
        section.only(known("name code variant and points such as cB"), is_known, faults);
        let taken: Vec<String> = sizes.iter().map(|of| of.name.clone()).collect();
        let name = own_name(section, &taken, faults);
        let ranges = ranges(section, unit, faults);
        let mut codes = codes(section, None, lengths, faults);
        let mut its = Vec::new();
        if let Some(value) = section.get("variant") {
            for (variant, table, at) in named_tables(value, &section.key("variant"), faults) {
                let key = format!("{key}.variant.{variant}");
                let section = Section::within(table, &at, &key);
                let found = variants.iter().find(|of| of.name == variant);
                its.extend(of_variant(section, (variant, found), unit, faults));
                codes.extend(self::codes(section, Some(variant), lengths, faults));
            }
        }
        sizes.extend(name.map(|name| Size { name, codes, ranges, variants: its }));
    }
    replaced_points_exist(whole, variants, &sizes, faults);
    sizes
}

/// The ranges of a variant of a size.
fn of_variant(
    section: Section<'_, '_>,
    (name, variant): (&str, Option<&Variant>),
    unit: Unit,
    faults: &mut Faults<'_>,
) -> Option<(String, Vec<Ranged>)> {
    let is_known = |name: &str| name == "code" || Point::of(name).is_some();
    section.only(known("code and the points that the variant replaces"), is_known, faults);
    let Some(variant) = variant else {
        faults.note(section.at(), section.name(), What::NoVariant(name.to_owned()));
        return None;
    };
    let ranges = ranges(section, unit, faults);
    for of in ranges.iter().filter(|of| !variant.replaces.contains(&of.point)) {
        let what = What::NotReplaced { variant: name.to_owned(), point: of.point.to_string() };
        faults.note(section.at(), section.key(&of.point.to_string()), what);
    }
    for point in &variant.replaces {
        if section.get(&point.to_string()).is_none() {
            let key = section.key(&point.to_string());
            faults.note(section.at(), key, What::VariantLacks(point.to_string()));
        }
    }
    Some((name.to_owned(), ranges))
}

/// Notes variants that replace a point which no size has.
fn replaced_points_exist(
    whole: Section<'_, '_>,
    variants: &[Variant],
    sizes: &[Size],
    faults: &mut Faults<'_>,
) {
    let tables = whole.get("variant").map(|value| value.span());
    for (variant, point) in variants.iter().flat_map(|of| of.replaces.iter().map(move |p| (of, p)))
    {
        // A range that is wrong is told as such.
        if faults.is_empty()
            && !sizes.is_empty()
            && sizes.iter().all(|size| size.range(*point).is_none())
        {
            let at = tables.clone().unwrap_or(0..0);
            let key = format!("variant.{}", variant.name);
            faults.note(&at, key, What::ReplacesNothing(point.to_string()));
        }
    }
}

/// The ranges of the points of a section, in its order.
fn ranges(section: Section<'_, '_>, unit: Unit, faults: &mut Faults<'_>) -> Vec<Ranged> {
    let mut ranges = Vec::new();
    for (name, value) in section.pairs() {
        if let Some(point) = Point::of(name.get_ref()) {
            ranges.extend(range(point, value, &section.key(name.get_ref()), unit, faults));
        }
    }
    ranges
}

/// `code = "…"`, `code.AD = "…"` or `code.AD.short = "…"`.
fn codes(
    section: Section<'_, '_>,
    variant: Option<&str>,
    lengths: &[LengthRow],
    faults: &mut Faults<'_>,
) -> Vec<Code> {
    let Some(value) = section.get("code") else { return Vec::new() };
    let key = section.key("code");
    let code = |garment: Option<&str>, length: Option<&str>, code: String| Code {
        variant: variant.map(str::to_owned),
        garment: garment.map(str::to_owned),
        length: length.map(str::to_owned),
        code,
    };
    let DeValue::Table(by_garment) = value.get_ref() else {
        return line(value, &key, faults).map(|of| code(None, None, of)).into_iter().collect();
    };
    let mut codes = Vec::new();
    for (garment, value) in by_garment {
        let garment: &str = garment.get_ref();
        let key = format!("{key}.{garment}");
        let DeValue::Table(by_length) = value.get_ref() else {
            codes.extend(line(value, &key, faults).map(|of| code(Some(garment), None, of)));
            continue;
        };
        for (length, value) in by_length {
            let length: &str = length.get_ref();
            if !lengths.iter().any(|of| of.garment == garment && of.name == length) {
                let (garment, name) = (garment.to_owned(), length.to_owned());
                faults.note(&value.span(), key.clone(), What::NoLength { garment, name });
            }
            codes.extend(line(value, &key, faults).map(|of| code(Some(garment), Some(length), of)));
        }
    }
    codes
}

/// The tables within a table, by their names.
fn named_tables<'s, 't>(
    value: &'s Value<'t>,
    key: &str,
    faults: &mut Faults<'_>,
) -> Vec<(&'s str, &'s DeTable<'t>, std::ops::Range<usize>)> {
    let DeValue::Table(tables) = value.get_ref() else {
        faults.note_form(value, key, Form::VARIANT);
        return Vec::new();
    };
    let mut found = Vec::new();
    for (name, value) in tables {
        match value.get_ref() {
            DeValue::Table(table) => found.push((name.get_ref().as_ref(), table, value.span())),
            _ => faults.note_form(value, format!("{key}.{}", name.get_ref()), Form::VARIANT),
        }
    }
    found
}
