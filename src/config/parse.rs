//! Parses the text of one value. The functions report what is wrong, not where.

use std::net::SocketAddr;
use std::ops::{Range, RangeInclusive};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

use regex::Regex;

use super::words::{self, HEIGHTS_CM};
pub(super) use gaiter_toml::{Absent, Found, What, or_none, word};

/// Reads the keys of `station.toml`.
pub(super) type Reader<'t> = gaiter_toml::Reader<'t, What>;

/// A number and one of the units; `None` for anything else, including a number that is too large.
fn quantity(text: &str, units: &[(&str, u64)]) -> Option<u64> {
    let digits = text.find(|c: char| !c.is_ascii_digit())?;
    let (number, unit) = text.split_at(digits);
    let (_, factor) = units.iter().find(|(name, _)| *name == unit)?;
    number.parse::<u64>().ok()?.checked_mul(*factor)
}

/// The smallest and the largest allowed value, as written in the file.
type Bounds = RangeInclusive<&'static str>;

/// A value within bounds.
fn within<T: PartialOrd>(
    bounds: Bounds,
    parse: impl Fn(&str) -> Result<T, What>,
) -> impl Fn(&str) -> Result<T, What> {
    let (least, most) = bounds.into_inner();
    move |text| {
        let value = parse(text)?;
        if value < parse(least)? || value > parse(most)? {
            let hint = format!("anything from \"{least}\" to \"{most}\"");
            return Err(What::own(format!("\"{text}\" is out of range"), hint));
        }
        Ok(value)
    }
}

/// `"2s"`, `"500ms"`, `"10m"`, `"1h"`.
pub(super) fn duration(text: &str) -> Result<Duration, What> {
    quantity(text, &[("ms", 1), ("s", 1000), ("m", 60_000), ("h", 3_600_000)])
        .map(Duration::from_millis)
        .ok_or_else(|| {
            What::not_a(text, "a duration", r#"write a number and a unit: "2s", "500ms", "10m""#)
        })
}

/// A duration within bounds.
pub(super) fn duration_in(bounds: Bounds) -> impl Fn(&str) -> Result<Duration, What> {
    within(bounds, duration)
}

/// A duration within bounds, or "off".
pub(super) fn duration_or_off(bounds: Bounds) -> impl Fn(&str) -> Result<Option<Duration>, What> {
    let within = duration_in(bounds);
    move |text| if text == "off" { Ok(None) } else { within(text).map(Some) }
}

/// `"200MB"` in bytes; decimal units, as disks and file managers count.
pub(super) fn size(text: &str) -> Result<u64, What> {
    let units = [("B", 1), ("kB", 1000), ("KB", 1000), ("MB", 1_000_000), ("GB", 1_000_000_000)];
    let hint = r#"write a number and a unit: "200MB", "1GB""#;
    quantity(text, &units).ok_or_else(|| What::not_a(text, "a size", hint))
}

/// A size within bounds, in bytes.
pub(super) fn size_in(bounds: Bounds) -> impl Fn(&str) -> Result<u64, What> {
    within(bounds, size)
}

/// `"5cm"`, `"80mm"`, in millimetres.
pub(super) fn length(text: &str) -> Result<u32, What> {
    let millimetres = quantity(text, &[("mm", 1), ("cm", 10)]);
    millimetres
        .and_then(|length| length.try_into().ok())
        .ok_or_else(|| What::not_a(text, "a length", r#"write a number and a unit: "5cm", "80mm""#))
}

/// A length within bounds, in millimetres.
pub(super) fn length_in(bounds: Bounds) -> impl Fn(&str) -> Result<u32, What> {
    within(bounds, length)
}

/// `"0.05mm"`, in millimetres: a length that may be a fraction of one.
pub(super) fn distance(text: &str) -> Result<f64, What> {
    let hint = r#"write a number and mm: "0.05mm", "1mm""#;
    decimal(text, "mm").ok_or_else(|| What::not_a(text, "a distance", hint))
}

/// A number in digits, with a decimal point or without, and this unit.
pub(super) fn decimal(text: &str, unit: &str) -> Option<f64> {
    let number = text.strip_suffix(unit)?;
    let is_plain = number.starts_with(|c: char| c.is_ascii_digit())
        && number.chars().all(|c| c.is_ascii_digit() || c == '.');
    number.parse::<f64>().ok().filter(|_| is_plain)
}

/// A distance within bounds, in millimetres.
pub(super) fn distance_in(bounds: Bounds) -> impl Fn(&str) -> Result<f64, What> {
    within(bounds, distance)
}

/// A height above the floor in cm, in mm.
pub(super) fn height_mm(text: &str) -> Result<f64, What> {
    words::height_mm(text).ok_or_else(|| {
        let Range { start, end } = HEIGHTS_CM;
        let hint = format!("a height above the floor in cm, more than {start} and less than {end}");
        What::own(format!("{text} is not a height on a leg"), hint)
    })
}

/// Whether a name is bare: letters, digits, `-`, `_` and `.`, and not hidden.
pub(super) fn is_bare(name: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    !name.is_empty() && !name.starts_with('.') && name.bytes().all(is_plain)
}

/// A station's name: only the plainest characters, because it is part of file names.
pub(super) fn station_id(text: &str) -> Result<String, What> {
    let plain = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if plain && (1..=32).contains(&text.len()) {
        Ok(text.into())
    } else {
        Err(not_a_station_id(text))
    }
}

/// The fault of a text that is no station's name.
pub(super) fn not_a_station_id(text: &str) -> What {
    let message = format!("\"{text}\" cannot be the name of a station");
    What::own(message, "1 to 32 letters (a-z, A-Z), digits, - and _")
}

/// A full path. A relative one is refused: a daemon has no obvious working folder, and the folder of the
/// configuration is not the place for state or records.
pub(super) fn full_path(text: &str) -> Result<PathBuf, What> {
    let path = Path::new(text);
    if text.contains(char::is_control) {
        return Err(control_in_path(text));
    }
    if !path.is_absolute() {
        let hint = match text.starts_with('~') {
            true => "write the home folder in full; ~ is only known to a shell",
            false => "write the path from the root on, beginning with /",
        };
        return Err(What::own(format!("\"{text}\" is not a full path"), hint));
    }
    // The target is not obvious.
    if path.components().any(|part| part == Component::ParentDir) {
        let hint = "write where the path really leads, without ..";
        return Err(What::own(format!("\"{text}\" contains \"..\""), hint));
    }
    // Collecting the components drops doubled and trailing slashes, so that equal folders compare equal.
    Ok(path.components().collect())
}

/// The fault of a path with a control character, usually a `\r` or `\t` that was meant as part of a folder's name.
pub(super) fn control_in_path(text: &str) -> What {
    let hint = "in double quotes a \\ begins a special character; use single quotes";
    What::own(format!("\"{text}\" contains a control character"), hint)
}

fn regex(text: &str) -> Result<Regex, What> {
    Regex::new(text).map_err(|error| {
        let message = error.to_string();
        let last = message.lines().last().unwrap_or_default();
        let why = last.trim_start_matches("error: ");
        let hint = "in single quotes a \\ needs no doubling: '^P?[0-9]+_'";
        What::own(format!("is not a regular expression: {why}"), hint)
    })
}

/// The value of a key that may be left out, with its place; `None` if it was.
pub(super) fn if_set<T>(found: Found<Option<T>>) -> Option<Found<T>> {
    Some(Found { value: found.value?, at: found.at })
}

/// `"off"`, or an address and a port.
pub(super) fn address_or_off(text: &str, hint: &'static str) -> Result<Option<SocketAddr>, What> {
    if text == "off" {
        return Ok(None);
    }
    text.parse::<SocketAddr>().map(Some).map_err(|_| What::not_a(text, "an address and port", hint))
}

/// A regular expression for file names that marks the part that is the patient's id.
pub(super) fn file_name(text: &str) -> Result<Regex, What> {
    let expression = regex(text)?;
    if expression.capture_names().flatten().any(|name| name == "patient") {
        return Ok(expression);
    }
    let hint = "mark the part that is the patient's id: '^(?<patient>P?[0-9]+)_'";
    Err(What::own("has no group named \"patient\"", hint))
}

/// Ids that no clinic assigns and no expression may accept: patient ids become folder names.
const UNSAFE_IDS: [&str; 7] = ["", ".", "..", "/", "../x", "a/b", "a\nb"];

/// An expression that must match the whole patient id, even if it has no anchors.
pub(super) fn patient_pattern(text: &str) -> Result<Regex, What> {
    // Compiled alone first: `a)|(b` is invalid, but would be valid inside the group.
    regex(text)?;
    let whole = regex(&format!(r"\A(?:{text})\z"))?;
    match UNSAFE_IDS.iter().find(|id| whole.is_match(id)) {
        Some(id) => {
            let hint = "name the characters an id may hold and how many: '[A-Z]?[0-9]{1,12}'";
            Err(What::own(format!("would accept {id:?} as a patient's id"), hint))
        }
        None => Ok(whole),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault<T: std::fmt::Debug>(parsed: Result<T, What>) -> String {
        parsed.unwrap_err().to_string()
    }

    #[test]
    fn durations_are_a_number_and_a_unit_and_nothing_else() {
        assert_eq!(duration("2s"), Ok(Duration::from_secs(2)));
        assert_eq!(duration("500ms"), Ok(Duration::from_millis(500)));
        assert_eq!(duration("10m"), Ok(Duration::from_secs(600)));
        for text in ["", "2", "s", "2 s", "-2s", "1.5s", "2sec", "99999999999999999999s", "²s"] {
            assert_eq!(fault(duration(text)), format!("\"{text}\" is not a duration"));
        }
        assert!(duration("18446744073709551615h").is_err(), "the product overflows");
    }

    #[test]
    fn sizes_are_decimal() {
        assert_eq!(size("200MB"), Ok(200_000_000));
        assert_eq!(size("1kB"), size("1000B"));
        assert!(size("200 MB").is_err() && size("200").is_err() && size("200M").is_err());
    }

    #[test]
    fn lengths_are_in_millimetres() {
        assert_eq!(length("5cm"), length("50mm"));
        assert_eq!(length("80mm"), Ok(80));
        for text in ["5", "5 cm", "0.5cm", "-5cm", "5m", "2in", "99999999999mm"] {
            assert_eq!(fault(length(text)), format!("\"{text}\" is not a length"));
        }
    }

    #[test]
    fn distances_are_millimetres_with_or_without_decimals() {
        assert_eq!(distance("0.05mm"), Ok(0.05));
        assert_eq!(distance("2mm"), Ok(2.0));
        for text in ["", "mm", "0.05", "0.05 mm", "-1mm", "+1mm", ".5mm", "1e3mm", "1.2.3mm", "5cm"]
        {
            assert_eq!(fault(distance(text)), format!("\"{text}\" is not a distance"));
        }
        let within = distance_in("0.005mm"..="5mm");
        assert!(within("0.005mm").is_ok() && within("5mm").is_ok());
        assert!(within("0.004mm").is_err() && within("5.1mm").is_err() && within("0mm").is_err());
    }

    #[test]
    fn bounds_include_their_ends() {
        let quiet = duration_in("50ms"..="10m");
        assert!(quiet("50ms").is_ok() && quiet("10m").is_ok() && quiet("600s").is_ok());
        assert!(quiet("49ms").is_err() && quiet("11m").is_err());
    }

    #[test]
    fn equal_folders_are_equal_paths() {
        assert_eq!(full_path("/srv//scans/./a/"), full_path("/srv/scans/a"));
        assert_eq!(fault(full_path("/a/../b")), "\"/a/../b\" contains \"..\"");
        assert_eq!(fault(full_path("")), "\"\" is not a full path");
    }

    #[test]
    fn a_patient_pattern_speaks_of_the_whole_id() {
        let pattern = patient_pattern("P?[0-9]{1,12}|X[0-9]").unwrap();
        assert!(pattern.is_match("P4711") && pattern.is_match("X1"));
        for id in ["4711b", "b4711", "X1 ", "X12", "4711\n", ""] {
            assert!(!pattern.is_match(id), "{id:?}");
        }
    }

    #[test]
    fn a_patient_pattern_that_lets_paths_through_is_refused() {
        for text in [".+", "[^ ]{2,5}", "[0-9]*", "(?s).{3}"] {
            let fault = fault(patient_pattern(text));
            assert!(fault.starts_with("would accept "), "{text}: {fault}");
        }
        let fault = fault(patient_pattern("a)|(?:b"));
        assert!(fault.starts_with("is not a regular expression: "), "{fault}");
    }
}
