//! `[[variant]]`, `[[length]]` and `[[size]]` of a size table.

use gaiter_toml::What::Empty;
use toml::de::DeValue;

use super::super::document::{Section, SectionKeys};
use super::super::fault::What;
use super::super::point::Point;
use super::super::table::{Code, LengthRow, Ranged, Size, Variant};
use super::{KEYS, Unit, own_name, points, range};

/// What stands in a variant of a size, and how it is written.
const VARIANT: (&str, &str) = ("ranges of a variant", "variant.\"wide thigh\".cG = [57, 64]");

/// The keys of a section, below those of the whole file.
fn known(words: &'static str, points: &'static str) -> SectionKeys {
    SectionKeys { words, points, above: KEYS }
}

/// The variants of a file.
pub(super) fn variants(whole: Section<'_, '_>) -> Vec<Variant> {
    let mut variants: Vec<Variant> = Vec::new();
    for section in whole.tables("variant") {
        known("name applies_to replaces", "").only(section);
        let name = own_name(section, variants.iter().map(|of| &of.name));
        let applies_to = section.list("applies_to");
        let replaces = match section.get("replaces") {
            Some(value) => points(section, value, "variant.replaces"),
            None => {
                section.must_have("replaces", "replaces = [\"cG\"]");
                Vec::new()
            }
        };
        variants.extend(name.map(|name| Variant { name, applies_to, replaces }));
    }
    variants
}

/// The lengths of a file.
pub(super) fn lengths(whole: Section<'_, '_>, unit: Unit) -> Vec<LengthRow> {
    let mut rows: Vec<LengthRow> = Vec::new();
    for section in whole.tables("length") {
        known("garment name", "and points such as lD").only(section);
        let garment = section.required_text("garment", "garment = \"AD\"");
        let same = rows.iter().filter(|of| Some(&of.garment) == garment.as_ref());
        let name = own_name(section, same.map(|of| &of.name));
        let ranges = ranges(section, unit);
        if !section.pairs().any(|(name, _)| Point::named(name.get_ref()).is_some()) {
            section.note(&section.at(), "length", Empty);
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
    variants: &[Variant],
    lengths: &[LengthRow],
) -> Vec<Size> {
    let mut sizes: Vec<Size> = Vec::new();
    whole.must_have("size", "[[size]] with name and ranges");
    for section in whole.tables("size") {
        let key = match section.get("name").and_then(|name| name.get_ref().as_str()) {
            Some(name) => format!("size.{name}"),
            None => "size".to_owned(),
        };
        let section = section.named(&key);
        known("name code variant", "and points such as cB").only(section);
        let name = own_name(section, sizes.iter().map(|of| &of.name));
        let ranges = ranges(section, unit);
        let mut codes = codes(section, None, lengths);
        let mut its = Vec::new();
        let key = section.key("variant");
        let all = section.section("variant", &key, VARIANT.0, VARIANT.1);
        for (variant, _) in all.into_iter().flat_map(Section::pairs) {
            let variant: &str = variant.get_ref();
            let key = format!("{key}.{variant}");
            let one = all.and_then(|all| all.section(variant, &key, VARIANT.0, VARIANT.1));
            let Some(section) = one else { continue };
            let found = variants.iter().find(|of| of.name == variant);
            its.extend(of_variant(section, variant, found, unit));
            codes.extend(self::codes(section, Some(variant), lengths));
        }
        sizes.extend(name.map(|name| Size { name, codes, ranges, variants: its }));
    }
    replaced_points_exist(whole, variants, &sizes);
    sizes
}

/// The ranges of a variant of a size.
fn of_variant(
    section: Section<'_, '_>,
    name: &str,
    variant: Option<&Variant>,
    unit: Unit,
) -> Option<(String, Vec<Ranged>)> {
    known("code", "and the points that the variant replaces").only(section);
    let Some(variant) = variant else {
        section.note(&section.at(), section.name(), What::NoVariant(name.to_owned()));
        return None;
    };
    let ranges = ranges(section, unit);
    for of in ranges.iter().filter(|of| !variant.replaces.contains(&of.point)) {
        let what = What::NotReplaced { variant: name.to_owned(), point: of.point.to_string() };
        section.note(&section.at(), section.key(&of.point.to_string()), what);
    }
    for point in &variant.replaces {
        if section.get(&point.to_string()).is_none() {
            let key = section.key(&point.to_string());
            section.note(&section.at(), key, What::VariantLacks(point.to_string()));
        }
    }
    Some((name.to_owned(), ranges))
}

/// Notes variants that replace a point which no size has.
fn replaced_points_exist(whole: Section<'_, '_>, variants: &[Variant], sizes: &[Size]) {
    let tables = whole.get("variant").map(|value| value.span());
    for (variant, point) in variants.iter().flat_map(|of| of.replaces.iter().map(move |p| (of, p)))
    {
        // A range that is wrong is reported as such.
        if whole.is_sound()
            && !sizes.is_empty()
            && sizes.iter().all(|size| size.range(*point).is_none())
        {
            let at = tables.clone().unwrap_or(0..0);
            let key = format!("variant.{}", variant.name);
            whole.note(&at, key, What::ReplacesNothing(point.to_string()));
        }
    }
}

/// The ranges of the points of a section, in its order.
fn ranges(section: Section<'_, '_>, unit: Unit) -> Vec<Ranged> {
    let mut ranges = Vec::new();
    for (name, value) in section.pairs() {
        if let Some(point) = Point::named(name.get_ref()) {
            ranges.extend(range(section, point, value, &section.key(name.get_ref()), unit));
        }
    }
    ranges
}

/// `code = "…"`, `code.AD = "…"` or `code.AD.short = "…"`.
fn codes(section: Section<'_, '_>, variant: Option<&str>, lengths: &[LengthRow]) -> Vec<Code> {
    let Some(value) = section.get("code") else { return Vec::new() };
    let key = section.key("code");
    let code = |garment: Option<&str>, length: Option<&str>, code: String| Code {
        variant: variant.map(str::to_owned),
        garment: garment.map(str::to_owned),
        length: length.map(str::to_owned),
        code,
    };
    let DeValue::Table(by_garment) = value.get_ref() else {
        return section.line(value, &key).map(|of| code(None, None, of)).into_iter().collect();
    };
    let mut codes = Vec::new();
    for (garment, value) in by_garment {
        let garment: &str = garment.get_ref();
        let key = format!("{key}.{garment}");
        let DeValue::Table(by_length) = value.get_ref() else {
            codes.extend(section.line(value, &key).map(|of| code(Some(garment), None, of)));
            continue;
        };
        for (length, value) in by_length {
            let length: &str = length.get_ref();
            if !lengths.iter().any(|of| of.garment == garment && of.name == length) {
                let (garment, name) = (garment.to_owned(), length.to_owned());
                section.note(&value.span(), key.clone(), What::NoLength { garment, name });
            }
            codes.extend(section.line(value, &key).map(|of| code(Some(garment), Some(length), of)));
        }
    }
    codes
}
