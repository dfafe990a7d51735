//! The lines of an OBJ file: which statements there are, and those with geometry.

use super::super::fault::{CutSign, ScanFault, cut_short};
use super::super::format::Format;
use super::super::text::{self, Lines, excerpt, numbered};

/// Statements of the OBJ format (Wavefront specification, version 3.0) and the usual extensions. A
/// file whose first statement is not one of these is not an OBJ file.
const STATEMENTS: [&str; 30] = [
    "v",
    "vt",
    "vn",
    "vp",
    "f",
    "fo",
    "l",
    "p",
    "o",
    "g",
    "s",
    "mg",
    "mtllib",
    "usemtl",
    "usemap",
    "maplib",
    "lod",
    "deg",
    "bmat",
    "step",
    "cstype",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "end",
    "shadow_obj",
    "trace_obj",
];

/// Number of words of a point: `v` and three coordinates.
pub(super) const WORDS_OF_POINT: usize = 4;

/// The first word of a trimmed statement.
pub(super) fn keyword(statement: &[u8]) -> &[u8] {
    statement.split(u8::is_ascii_whitespace).next().unwrap_or_default()
}

/// Whether a trimmed statement is a point or a face.
fn is_geometry(statement: &[u8]) -> bool {
    match statement {
        [b'v' | b'f', next, ..] => next.is_ascii_whitespace(),
        [b'v' | b'f'] => true,
        _ => false,
    }
}

/// Refuses a text whose first statement is not an OBJ statement.
///
/// # Errors
/// [`ScanFault::NotThisFormat`] with that statement.
pub(super) fn refuse_others(bytes: &[u8]) -> Result<(), ScanFault> {
    let mut statements = numbered(bytes).filter(|(_, line)| !line.starts_with(b"#"));
    match statements.next() {
        Some((line, found)) if !STATEMENTS.iter().any(|s| s.as_bytes() == keyword(found)) => {
            Err(ScanFault::NotThisFormat { format: Format::Obj, line, found: excerpt(found) })
        }
        _ => Ok(()),
    }
}

/// Reads the `v` and `f` statements of a text, one after the other.
pub(super) struct Geometry<'a> {
    lines: Lines<'a>,
    /// A statement that goes on over several lines, joined.
    joined: Vec<u8>,
}

impl<'a> Geometry<'a> {
    /// The statements of a text without a byte order mark.
    pub(super) fn of(bytes: &'a [u8]) -> Geometry<'a> {
        Geometry { lines: text::lines(bytes), joined: Vec::new() }
    }

    /// What has not been read yet; it begins with a line.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.lines.rest()
    }

    /// Passes the next line, whose length with its line end the caller has found already.
    pub(super) fn pass(&mut self, length: usize) {
        self.lines.pass(length);
    }

    /// Reads the next line, and the ones that it goes on with. If it is a `v` or `f` statement, returns
    /// that, trimmed, and its first line. A `\` at the end of such a line continues it on the next one;
    /// in names it is an ordinary character, as in Windows paths.
    ///
    /// # Errors
    /// [`ScanFault::CutShort`] if the last line expects a continuation.
    pub(super) fn statement(&mut self) -> Result<Option<(usize, &[u8])>, ScanFault> {
        let first = self.lines.next().unwrap_or_default().trim_ascii();
        let number = self.lines.passed();
        if !is_geometry(first) {
            return Ok(None);
        }
        let Some(part) = first.strip_suffix(b"\\") else { return Ok(Some((number, first))) };
        self.joined.clear();
        self.joined.extend_from_slice(part);
        for line in self.lines.by_ref().map(<[u8]>::trim_ascii).filter(|line| !line.is_empty()) {
            self.joined.push(b' ');
            self.joined.extend_from_slice(line.strip_suffix(b"\\").unwrap_or(line));
            if !line.ends_with(b"\\") {
                return Ok(Some((number, self.joined.trim_ascii())));
            }
        }
        Err(cut_short(CutSign::NoLineEnd { line: number }))
    }
}

/// Calls `each` with every `v` and `f` statement, trimmed, and its first line.
///
/// # Errors
/// The fault of `each`; [`ScanFault::CutShort`] if the last line expects a continuation.
pub(super) fn each_geometry(
    bytes: &[u8],
    mut each: impl FnMut(usize, &[u8]) -> Result<(), ScanFault>,
) -> Result<(), ScanFault> {
    let mut geometry = Geometry::of(bytes);
    while !geometry.rest().is_empty() {
        if let Some((line, statement)) = geometry.statement()? {
            each(line, statement)?;
        }
    }
    Ok(())
}

/// Only `v` and the three coordinates of a point: tobj refuses a file where some points have colours.
pub(super) fn point_only(statement: &[u8]) -> &[u8] {
    &statement[..end_of_word(statement, WORDS_OF_POINT)]
}

/// Coordinates with decimal points instead of decimal commas.
pub(super) fn with_decimal_points(coordinates: &[u8]) -> Vec<u8> {
    coordinates.iter().map(|&byte| if byte == b',' { b'.' } else { byte }).collect()
}

/// The end of the `count`-th word of a trimmed statement.
fn end_of_word(statement: &[u8], count: usize) -> usize {
    let mut seen = 0;
    let mut within = false;
    for (at, byte) in statement.iter().enumerate() {
        if byte.is_ascii_whitespace() {
            within = false;
            if seen == count {
                return at;
            }
        } else if !within {
            within = true;
            seen += 1;
        }
    }
    statement.len()
}
