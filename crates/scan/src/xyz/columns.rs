//! The column separator of a list of points, and the columns with the coordinates.

use super::super::text;

/// The column separator of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Semicolon,
    WhiteSpace,
    Comma,
}

impl Separator {
    /// The column separator of a line, by the rule in the parent module.
    pub(super) fn detect(line: &[u8]) -> Separator {
        if line.contains(&b';') {
            Separator::Semicolon
        } else if text::words(line).nth(2).is_some() || !line.contains(&b',') {
            Separator::WhiteSpace
        } else {
            Separator::Comma
        }
    }

    /// The columns of a trimmed line. A separator at its end does not begin another column.
    pub(super) fn columns(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        // `None` after the last column.
        let mut rest = Some(line);
        std::iter::from_fn(move || {
            let line = rest.take().filter(|rest| !rest.is_empty())?;
            let is_end = |byte: &u8| match self {
                Separator::Semicolon => *byte == b';',
                Separator::WhiteSpace => byte.is_ascii_whitespace(),
                Separator::Comma => *byte == b',',
            };
            let Some(end) = line.iter().position(is_end) else {
                return Some(line);
            };
            rest = Some(line[end + 1..].trim_ascii_start());
            let column = line[..end].trim_ascii_end();
            match self {
                Separator::WhiteSpace => Some(column.strip_suffix(b",").unwrap_or(column)),
                _ => Some(column),
            }
        })
    }

    /// The columns of x, y and z: by their names if given, otherwise the first three.
    pub(super) fn coordinates(self, names: Option<&[u8]>, column_count: usize) -> [usize; 3] {
        let names = names.unwrap_or_default();
        let place = |axis: &str| {
            let separator = Separator::detect(names);
            // `X [mm]` is a name and its unit, not two names.
            let is_unit = |word: &&[u8]| {
                separator == Separator::WhiteSpace && matches!(word.first(), Some(b'[' | b'('))
            };
            let mut columns = separator.columns(names).filter(|word| !is_unit(word));
            let is_axis = |name: &[u8]| bare(name).eq_ignore_ascii_case(axis.as_bytes());
            columns.position(is_axis).filter(|place| *place < column_count)
        };
        match (place("x"), place("y"), place("z")) {
            (Some(x), Some(y), Some(z)) => [x, y, z],
            _ => [0, 1, 2],
        }
    }
}

/// A column's name without quotes and without the unit after it, as in `X[mm]` and `X (mm)`.
fn bare(name: &[u8]) -> &[u8] {
    let name = name.strip_prefix(b"\"").unwrap_or(name);
    let name = name.strip_suffix(b"\"").unwrap_or(name);
    name.split(|byte| matches!(byte, b'[' | b'(')).next().unwrap_or_default().trim_ascii_end()
}
