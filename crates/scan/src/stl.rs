//! Stereolithography, text or binary: triangles without shared points, which are welded.
//!
//! A binary file has an 80-byte header of any content, the number of triangles, and 50 bytes for
//! each. Headers often begin with `solid`, like text files, so the length decides first.

use nalgebra::Point3;

use super::Scan;
use super::fault::{CutSign, ScanFault, SourcePosition, cut_short, malformed};
use super::format::Format;
use super::text::{self, Decimals, excerpt, numbered, words};
use super::weld::welded;

/// Decodes a complete STL file.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line or triangle.
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    if is_text(bytes) { read_text(bytes) } else { read_binary(bytes) }
}

/// Whether the file contains everything it announces: text ends with `endsolid`, and the length of
/// a binary file matches its number of triangles.
///
/// # Errors
/// [`ScanFault::CutShort`] if something is missing.
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    if is_text(bytes) { text_completeness(bytes) } else { binary_completeness(bytes) }
}

/// Whether the file is text: it has no control characters, and its length is not that of a binary
/// file. The text reader refuses text of another kind.
fn is_text(bytes: &[u8]) -> bool {
    !is_binary_by_length(bytes) && text::refuse_binary(bytes).is_ok()
}

/// Whether the text ends with an `endsolid` line, with or without a line end.
///
/// # Errors
/// [`ScanFault::CutShort`] if it does not.
fn text_completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    let text = text::without_mark(bytes).trim_ascii();
    if !starts_with(text, b"solid") {
        return Ok(());
    }
    let last = text.rsplit(|&b| b == b'\n' || b == b'\r').next().unwrap_or_default().trim_ascii();
    if starts_with(last, b"endsolid") || keyword(&mut words(last)) == b"endsolid" {
        return Ok(());
    }
    Err(cut_short(CutSign::NoEnd { mark: "\"endsolid\"" }))
}

fn starts_with(text: &[u8], word: &[u8]) -> bool {
    text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
}

/// The statements of the format.
const KEYWORDS: [&[u8]; 7] =
    [b"vertex", b"facet", b"outer", b"endloop", b"endfacet", b"solid", b"endsolid"];

/// The keyword of a statement, given its words; empty if it has none. Some exporters write the last ones in
/// two words, such as `end loop`.
fn keyword<'a>(words: &mut impl Iterator<Item = &'a [u8]>) -> &'static [u8] {
    let first = words.next().unwrap_or_default();
    let (before, word) = match first.eq_ignore_ascii_case(b"end") {
        true => (b"end".as_slice(), words.next().unwrap_or_default()),
        false => (b"".as_slice(), first),
    };
    let is_it = |known: &&[u8]| {
        known.strip_prefix(before).is_some_and(|rest| rest.eq_ignore_ascii_case(word))
    };
    KEYWORDS.into_iter().find(is_it).unwrap_or_default()
}

/// The reader's position in the nested statements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Within {
    /// Before `solid` or after `endsolid`.
    File,
    /// Between facets.
    Solid,
    /// Before or after the loop of a facet.
    Facet,
    /// Between the vertices of a loop.
    Loop,
}

/// Decodes an STL text. Normals are not read: exporters write `nan` there.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line.
fn read_text(bytes: &[u8]) -> Result<Scan, ScanFault> {
    let mut within = Within::File;
    let mut decimals = Decimals::default();
    let mut points: Vec<Point3<f64>> = Vec::new();
    let mut triangles = Vec::new();
    for (line, statement) in numbered(text::without_mark(bytes)) {
        let mut rest = words(statement);
        within = match (within, keyword(&mut rest)) {
            (Within::File, b"solid") => Within::Solid,
            (Within::Solid, b"facet") => Within::Facet,
            (Within::Facet, b"outer") => Within::Loop,
            (Within::Loop, b"vertex") => {
                points.push(decimals.point(rest, line)?);
                Within::Loop
            }
            (Within::Loop, b"endloop") => {
                triangles.push(triangle(&points, triangles.len(), line)?);
                Within::Facet
            }
            (Within::Facet, b"endfacet") => Within::Solid,
            (Within::Solid, b"endsolid") => Within::File,
            (Within::File, _) if points.is_empty() => {
                let found = excerpt(statement);
                return Err(ScanFault::NotThisFormat { format: Format::Stl, line, found });
            }
            _ => return Err(misplaced(within, statement, line)),
        };
    }
    Ok(welded((points, triangles)))
}

/// The triangle of the last three points, if the loop has exactly three.
fn triangle(
    points: &[Point3<f64>],
    triangle_count: usize,
    line: usize,
) -> Result<[u32; 3], ScanFault> {
    let first = 3 * triangle_count;
    let vertices = points.len() - first;
    if vertices != 3 {
        return Err(malformed(line, format!("a facet of {vertices} vertices; STL has 3")));
    }
    Ok([0, 1, 2].map(|corner| (first + corner) as u32))
}

fn misplaced(within: Within, statement: &[u8], line: usize) -> ScanFault {
    let awaited = match within {
        Within::File => "solid",
        Within::Solid => "facet or endsolid",
        Within::Facet => "outer loop or endfacet",
        Within::Loop => "vertex or endloop",
    };
    malformed(line, format!("\"{}\" where {awaited} should stand", excerpt(statement)))
}

/// Bytes before the first triangle: the header and the triangle count.
const HEAD_BYTES: usize = 84;

/// Bytes per triangle: its normal, its corners, and an attribute.
const TRIANGLE_BYTES: usize = 50;

/// Whether the length is exactly that of a binary file with its triangle count, which must be at least
/// one. This never holds for text, because four characters as a triangle count mean gigabytes.
pub(super) fn is_binary_by_length(bytes: &[u8]) -> bool {
    announced(bytes).is_some_and(|count| count > 0 && length_for(count) == bytes.len())
}

/// The triangle count in the header.
fn announced(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEAD_BYTES - 4..HEAD_BYTES)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

fn length_for(count: usize) -> usize {
    HEAD_BYTES + TRIANGLE_BYTES * count
}

/// Whether all announced triangles are present and written.
///
/// # Errors
/// [`ScanFault::CutShort`] with details.
fn binary_completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    let Some(count) = announced(bytes) else {
        let what = "bytes of the header";
        return Err(cut_short(CutSign::Missing { what, has: bytes.len(), of: HEAD_BYTES }));
    };
    if bytes.len() < length_for(count) {
        let has = (bytes.len() - HEAD_BYTES) / TRIANGLE_BYTES;
        return Err(cut_short(CutSign::Missing { what: "triangles", has, of: count }));
    }
    // Windows and network shares reserve space for a file before they fill it.
    let unwritten = bytes.iter().rev().take_while(|&&byte| byte == 0).count();
    if unwritten >= TRIANGLE_BYTES && bytes.len() > HEAD_BYTES {
        return Err(cut_short(CutSign::Unwritten { bytes: unwritten }));
    }
    Ok(())
}

/// Decodes a binary STL. A file that is longer than its triangle count allows is refused: either the count or
/// the rest is wrong, and a body without a leg must not pass.
///
/// # Errors
/// [`ScanFault::CutShort`], [`ScanFault::TooLong`], [`ScanFault::NotFinite`].
fn read_binary(bytes: &[u8]) -> Result<Scan, ScanFault> {
    binary_completeness(bytes)?;
    let says = length_for(announced(bytes).unwrap_or_default());
    if bytes.len() != says {
        return Err(ScanFault::TooLong { what: "bytes", has: bytes.len(), says });
    }
    let records = bytes[HEAD_BYTES..].chunks_exact(TRIANGLE_BYTES);
    let mut points = Vec::with_capacity(3 * records.len());
    let mut triangles = Vec::with_capacity(records.len());
    for (index, record) in records.enumerate() {
        let (reals, _) = record.as_chunks::<4>();
        let real = |place: usize| {
            let value = f32::from_le_bytes(reals[place]);
            if value.is_finite() {
                return Ok(f64::from(value));
            }
            let byte = HEAD_BYTES + TRIANGLE_BYTES * index + 4 * place;
            let place = SourcePosition::Record { name: "triangle", number: index + 1, byte };
            Err(ScanFault::NotFinite { place, found: text::spelled(f64::from(value)) })
        };
        let first = points.len() as u32;
        // Three numbers for each corner, after those of the normal.
        for x in [3, 6, 9] {
            points.push(Point3::new(real(x)?, real(x + 1)?, real(x + 2)?));
        }
        triangles.push([first, first + 1, first + 2]);
    }
    Ok(welded((points, triangles)))
}
