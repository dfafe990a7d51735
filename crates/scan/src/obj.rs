//! Wavefront OBJ, decoded by tobj after our own checks.
//!
//! tobj never panics, but it accepts NaN and infinity, a file whose faces were cut off, and one without faces, of
//! which it returns nothing.

mod lines;
mod mesh;
mod plain;
mod unmeshed;

use super::Scan;
use super::fault::{CutSign, ScanFault, cut_short};
use super::text::{self, numbered};
use super::weld::welded;
use lines::{is_face, keyword, refuse_others};
use mesh::{Mesh, all_points, mesh};
use unmeshed::unmeshed_skin;

/// A larger share of points of the skin without faces means that the face list was cut off. Some exporters leave
/// points of a cleaned mesh in the file, which lie about. A test body cut at 90 % of its bytes leaves 1.6 % unused,
/// all of them in the leg that it lacks.
const UNMESHED_MAX_SHARE: f64 = 0.001;

/// A larger share of unused points than this means the same wherever they lie.
const UNUSED_POINTS_MAX_SHARE: f64 = 0.2;

/// Decodes a complete OBJ file.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line.
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    let bytes = text::without_mark(bytes);
    refuse_others(bytes)?;
    if !numbered(bytes).any(|(_, statement)| keyword(statement).eq_ignore_ascii_case(b"v")) {
        return Err(ScanFault::NoPoints);
    }
    skin(bytes, mesh(bytes)?)
}

/// The scan of a mesh that was read from these bytes, unless the faces of its skin were cut off.
fn skin(bytes: &[u8], mesh: Mesh) -> Result<Scan, ScanFault> {
    let Mesh { points, triangles, point_count: of, unused } = mesh;
    if triangles.is_empty() {
        return Ok(Scan { points: all_points(bytes)?, triangles: Vec::new() });
    }
    let is_more = |count: usize, share: f64| count as f64 > share * of as f64;
    if is_more(unused, UNMESHED_MAX_SHARE) {
        let missing = match is_more(unused, UNUSED_POINTS_MAX_SHARE) {
            true => unused,
            false => unmeshed_skin(&points, &triangles, &all_points(bytes)?),
        };
        if is_more(missing, UNMESHED_MAX_SHARE) {
            return Err(cut_short(CutSign::UnusedPoints { unused: missing, points: of }));
        }
    }
    Ok(welded((points, triangles)))
}

/// Whether the text has a proper end.
///
/// # Errors
/// [`ScanFault::CutShort`] if the last line has no line end, [`ScanFault::Binary`].
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    text::refuse_binary(bytes)?;
    text::refuse_open_line(bytes)
}

/// Decodes a file whose last line has no line end; `None` if more than that is missing after the last face. If its
/// last number was cut short, it names another point, which hardly shares an edge of another face with the corners
/// before it.
pub(super) fn read_unended(bytes: &[u8]) -> Option<Result<Scan, ScanFault>> {
    let bytes = text::without_mark(bytes);
    let has_three = |last: &[u8]| is_face(keyword(last)) && text::words(last).count() > 3;
    numbered(bytes).last().filter(|(_, last)| has_three(last))?;
    let mesh = mesh(bytes).ok()?;
    let (&[first, second, last], others) = mesh.triangles.split_last()?;
    let shares_edge = |other: &[u32; 3]| {
        other.contains(&last) && (other.contains(&first) || other.contains(&second))
    };
    let is_whole = mesh.unused == 0 && others.iter().any(shares_edge);
    is_whole.then(|| refuse_others(bytes).and_then(|()| skin(bytes, mesh)))
}

#[cfg(test)]
mod tests;
