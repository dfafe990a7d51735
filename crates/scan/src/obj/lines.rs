//! The lines of an OBJ file: which statements there are, and those with geometry.

use super::super::fault::{CutSign, ScanFault, cut_short, malformed};
use super::super::format::Format;
use super::super::text::{self, Lines, excerpt, numbered, words};

/// Statements of the OBJ format (Wavefront specification, version 3.0), those of its older versions
/// included. A file whose first statement is not one of these is not an OBJ file.
const STATEMENTS: &str = "v vt vn vp f fo l p o g s mg mtllib usemtl usemap maplib lod bevel c_interp d_interp \
    shadow_obj trace_obj ctech stech cstype deg bmat step curv curv2 surf parm trim hole scrv sp end con call \
    csh res bsp bzp cdc cdp";

/// Number of words of a point: `v` and three coordinates.
pub(super) const WORDS_OF_POINT: usize = 4;

/// The first word of a trimmed statement, which may continue in the next line right after it.
pub(super) fn keyword(statement: &[u8]) -> &[u8] {
    let statement = statement.strip_suffix(b"\\").unwrap_or(statement);
    statement.split(u8::is_ascii_whitespace).next().unwrap_or_default()
}

/// Whether a statement with this keyword is a face; `fo` is its old name.
pub(super) fn is_face(keyword: &[u8]) -> bool {
    matches!(keyword, b"f" | b"fo")
}

/// Whether a keyword is that of a point or a face in capitals, which OBJ does not have.
fn are_capitals(keyword: &[u8]) -> bool {
    matches!(keyword, b"V" | b"F" | b"FO")
}

/// Refuses a text whose first statement is not an OBJ statement.
///
/// # Errors
/// [`ScanFault::NotThisFormat`] with that statement, [`ScanFault::Malformed`] if it is one in capitals.
pub(super) fn refuse_others(bytes: &[u8]) -> Result<(), ScanFault> {
    let mut statements = numbered(bytes).filter(|(_, line)| !line.starts_with(b"#"));
    match statements.next() {
        Some((line, found)) if are_capitals(keyword(found)) => Err(in_capitals(found, line)),
        Some((line, found)) if !words(STATEMENTS.as_bytes()).any(|s| s == keyword(found)) => {
            Err(ScanFault::NotThisFormat { format: Format::Obj, line, found: excerpt(found) })
        }
        _ => Ok(()),
    }
}

/// Reads the `v`, `f` and `fo` statements of a text, one after the other.
pub(super) struct Geometry<'a> {
    pub lines: Lines<'a>,
    /// A statement that continues over several lines, joined.
    joined: Vec<u8>,
}

impl<'a> Geometry<'a> {
    /// The statements of a text without a byte order mark.
    pub(super) fn new(bytes: &'a [u8]) -> Geometry<'a> {
        Geometry { lines: text::lines(bytes), joined: Vec::new() }
    }

    /// Reads the next line, and the ones that it continues with. If it is a `v`, `f` or `fo` statement,
    /// returns that, trimmed, and its first line. A `\` at the end of such a line continues it on the next
    /// one; in names it is an ordinary character, as in Windows paths.
    ///
    /// # Errors
    /// [`ScanFault::CutShort`] if the last line expects a continuation; [`ScanFault::Malformed`] for these
    /// statements in capitals, without which a mesh would be read as bare points, or in part.
    pub(super) fn statement(&mut self) -> Result<Option<(usize, &[u8])>, ScanFault> {
        let first = self.lines.next().unwrap_or_default().trim_ascii();
        let number = self.lines.passed();
        match keyword(first) {
            b"v" => {}
            face if is_face(face) => {}
            capitals if are_capitals(capitals) => return Err(in_capitals(first, number)),
            _ => return Ok(None),
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

fn in_capitals(statement: &[u8], line: usize) -> ScanFault {
    let found = excerpt(statement);
    malformed(
        line,
        format!("\"{found}\": OBJ has small letters in \"v\" and \"f\"; mend the exporter"),
    )
}

/// Calls `each` with every `v`, `f` and `fo` statement, trimmed, and its first line.
///
/// # Errors
/// The fault of `each`, and those of [`Geometry::statement`].
pub(super) fn each_geometry(
    bytes: &[u8],
    mut each: impl FnMut(usize, &[u8]) -> Result<(), ScanFault>,
) -> Result<(), ScanFault> {
    let mut geometry = Geometry::new(bytes);
    while !geometry.lines.rest().is_empty() {
        if let Some((line, statement)) = geometry.statement()? {
            each(line, statement)?;
        }
    }
    Ok(())
}
