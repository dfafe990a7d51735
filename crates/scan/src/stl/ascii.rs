//! STL as text: `solid`, then facets of three `vertex` lines, then `endsolid`; possibly repeated.

use nalgebra::Point3;

use super::super::Scan;
use super::super::fault::{CutSign, ScanFault, cut_short, malformed};
use super::super::format::Format;
use super::super::text::{self, Decimals, excerpt, numbered, words};
use super::super::weld::welded;

/// Whether the text ends with an `endsolid` line, with or without a line end.
///
/// # Errors
/// [`ScanFault::CutShort`] if it does not.
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
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
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
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
