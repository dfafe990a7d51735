//! The measurement file that a \[TC\]2 scanner writes next to a scan (`.ord`): one measure per
//! line, `MEASURE Name=value`, in the unit of the line `OPTION UNITS=cm`.
//!
//! No public description of the format was found. This reader accepts what other programs expect of
//! such files; lines of any other kind are skipped.

/// Maximum size of a measurement file, bytes; real ones have some hundred lines.
pub const BYTES_MAX: usize = 1 << 20;

/// Maximum number of characters of a line shown in a fault.
const EXCERPT_CHARS: usize = 40;

/// The measures taken by the scanner's own program.
#[derive(Debug, Clone, PartialEq)]
pub struct Ord {
    /// Names as written and values in mm, in the order of the file. The file does not mark angles
    /// and counts, so they are converted too and are meaningless.
    pub measures: Vec<(String, f64)>,
}

/// The units of measurement files: their words, of which messages use the first, and the millimetres in one. Upper and
/// lower case are equal.
const UNITS: [([&str; 3], f64); 3] = [
    (["mm", "millimeter", "millimeters"], 1.0),
    (["cm", "centimeter", "centimeters"], 10.0),
    (["in", "inch", "inches"], 25.4),
];

/// Why bytes are not a measurement file. Lines count from 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OrdFault {
    /// The file is too large.
    #[error("more than {BYTES_MAX} bytes: not a measurement file")]
    TooLarge,
    /// The file is not text.
    #[error("line {line}: the file is binary, not text")]
    Binary {
        /// The line of the first byte that cannot occur in a text.
        line: usize,
    },
    /// A value begins like a number but is not one.
    #[error("line {line}: \"{found}\" is not a number")]
    NotANumber {
        /// Its line.
        line: usize,
        /// The value's beginning, printable ASCII only.
        found: String,
    },
    /// A measure without a name, or a line without `=`.
    #[error("line {line}: \"{found}\" is not NAME=VALUE")]
    NoName {
        /// Its line.
        line: usize,
        /// The line's beginning, printable ASCII only.
        found: String,
    },
    /// An unknown unit.
    #[error("line {line}: the unit \"{found}\" is not mm, cm or in")]
    UnknownUnit {
        /// Its line.
        line: usize,
        /// The word's beginning, printable ASCII only.
        found: String,
    },
    /// A different unit than declared before.
    #[error("line {line}: the unit is {now}, but was {before} before")]
    TwoUnits {
        /// The line of the second.
        line: usize,
        /// The first.
        before: &'static str,
        /// The second.
        now: &'static str,
    },
    /// No line declares the unit.
    #[error("none of its {lines} lines states the unit (OPTION UNITS=cm)")]
    NoUnit {
        /// Number of lines.
        lines: usize,
    },
    /// No line contains a measure.
    #[error("none of its {lines} lines holds a measure (MEASURE Name=value)")]
    NoMeasures {
        /// Number of lines.
        lines: usize,
    },
}

/// Reads a measurement file. A value that does not begin like a number is not a measure and is skipped.
///
/// # Errors
/// The first [`OrdFault`], with its line.
pub fn read(bytes: &[u8]) -> Result<Ord, OrdFault> {
    if bytes.len() > BYTES_MAX {
        return Err(OrdFault::TooLarge);
    }
    if let Some(at) = bytes.iter().position(|&byte| is_binary(byte)) {
        let line = 1 + bytes[..at].iter().filter(|&&byte| byte == b'\n').count();
        return Err(OrdFault::Binary { line });
    }
    let text = decoded(bytes);
    let mut unit: Option<(&'static str, f64)> = None;
    let mut written: Vec<(String, f64)> = Vec::new();
    let mut lines = 0;
    for (line, text) in (1..).zip(text.lines()) {
        lines = line;
        let (keyword, rest) = text.trim().split_once([' ', '\t']).unwrap_or_default();
        match keyword.to_ascii_uppercase().as_str() {
            "OPTION" => {
                let Some(found) = units(rest) else { continue };
                let is_it = |(words, _): &([&str; 3], f64)| {
                    words.iter().any(|word| word.eq_ignore_ascii_case(found))
                };
                let unknown = || OrdFault::UnknownUnit { line, found: excerpt(found) };
                let ([now, ..], mm) = UNITS.into_iter().find(is_it).ok_or_else(unknown)?;
                match unit {
                    Some((before, _)) if before != now => {
                        return Err(OrdFault::TwoUnits { line, before, now });
                    }
                    _ => unit = Some((now, mm)),
                }
            }
            "MEASURE" => written.extend(measure(rest.trim(), line)?),
            _ => {}
        }
    }
    if written.is_empty() {
        return Err(OrdFault::NoMeasures { lines });
    }
    let (_, unit_mm) = unit.ok_or(OrdFault::NoUnit { lines })?;
    let in_mm = |(name, value): (String, f64)| (name, value * unit_mm);
    Ok(Ord { measures: written.into_iter().map(in_mm).collect() })
}

/// Whether a file of this name is the measurement file of a scan of that name: the ending is `.ord`
/// in upper or lower case, and the stems are equal if space, `+` and `_` count as the same. Names
/// are bytes, so that their encoding does not matter.
pub fn belongs(name: &[u8], scan_name: &[u8]) -> bool {
    let (Some((stem, ending)), Some((scan_stem, _))) = (parted(name), parted(scan_name)) else {
        return false;
    };
    ending == b"ord" && stem == scan_stem
}

/// The normalised stem of a file name, which all files of one scan share, and its ending in lower case.
pub fn parted(name: &[u8]) -> Option<(Vec<u8>, Vec<u8>)> {
    let dot = name.iter().rposition(|&byte| byte == b'.')?;
    let alike = |&byte: &u8| if matches!(byte, b' ' | b'+') { b'_' } else { byte };
    Some((name[..dot].iter().map(alike).collect(), name[dot + 1..].to_ascii_lowercase()))
}

/// Whether a byte cannot occur in such a text: control characters except tab and line ends.
fn is_binary(byte: u8) -> bool {
    (byte < b' ' && !matches!(byte, b'\t' | b'\n' | b'\r')) || byte == 0x7f
}

/// The text: UTF-8 if valid, otherwise Latin-1, in which every byte is a character.
fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// The word of `UNITS=word`; `None` for other options.
fn units(rest: &str) -> Option<&str> {
    let (name, word) = rest.split_once('=')?;
    name.trim().eq_ignore_ascii_case("units").then_some(word.trim())
}

/// Name and value of `Name=value`; `None` if the value does not begin like a number.
fn measure(rest: &str, line: usize) -> Result<Option<(String, f64)>, OrdFault> {
    let parts = rest.split_once('=').map(|(name, value)| (name.trim(), value.trim()));
    let Some((name, value)) = parts.filter(|(name, _)| !name.is_empty()) else {
        return Err(OrdFault::NoName { line, found: excerpt(rest) });
    };
    if !value.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c)) {
        return Ok(None);
    }
    // Half of Europe uses a decimal comma; if both occur, one of them separates thousands.
    let number = value.replace(',', ".").parse::<f64>().ok().filter(|number| number.is_finite());
    let number = number.ok_or_else(|| OrdFault::NotANumber { line, found: excerpt(value) })?;
    Ok(Some((name.to_owned(), number)))
}

/// The beginning of a text, printable ASCII only, so that it cannot inject anything into a log.
fn excerpt(text: &str) -> String {
    let printable = |c: char| if c.is_ascii_graphic() || c == ' ' { c } else { '?' };
    text.chars().take(EXCERPT_CHARS).map(printable).collect()
}

#[cfg(test)]
mod tests;
