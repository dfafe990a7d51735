//! Wavefront OBJ, decoded by tobj after our own checks.
//!
//! tobj never panics, but it accepts NaN and infinity, a cut face line, and a file without faces,
//! and it refuses a whole file because of one Latin-1 letter in an object's name. So it receives
//! only the statements with geometry. The checks have already read every corner of every face, so
//! tobj does not get the faces again: it returns the points, which are then put in the order in which
//! the faces use them. A file without faces is read without tobj, which drops points that no face uses.

mod lines;
mod plain;
mod positions;
mod statements;
mod unmeshed;

use nalgebra::Point3;

use super::Scan;
use super::fault::{self, CutSign, Place, ScanFault, cut_short};
use super::text::{self, Decimals, numbered};
use super::weld::welded;
use lines::{each_geometry, is_face, keyword, refuse_others};
use statements::{Statements, Use};
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
    let mut statements = Statements::of(bytes)?;
    if statements.has_commas {
        points(bytes)?;
    }
    if statements.triangles.is_empty() {
        return Ok(Scan { points: points(bytes)?, triangles: Vec::new() });
    }
    let Use { order, unused } = statements.number_by_use();
    let of = statements.point_count;
    let is_more = |count: usize, share: f64| count as f64 > share * of as f64;
    if is_more(unused, UNMESHED_MAX_SHARE) {
        let missing = match is_more(unused, UNUSED_POINTS_MAX_SHARE) {
            true => unused,
            false => unmeshed_skin(&points(bytes)?, &statements.triangles, &order),
        };
        if is_more(missing, UNMESHED_MAX_SHARE) {
            return Err(cut_short(CutSign::UnusedPoints { unused: missing, points: of }));
        }
    }
    let Statements { positions, triangles, has_unusual, .. } = statements;
    let read = match has_unusual {
        false => positions.read().map(|all| order.iter().map(|&at| all[at as usize]).collect()),
        true => positions::unusual(bytes, &order),
    };
    let are_finite = |found: &[Point3<f64>]| found.iter().all(|p| p.iter().all(|c| c.is_finite()));
    match read {
        Ok(found) if are_finite(&found) => Ok(welded((found, triangles))),
        // tobj does not report a line, so a reader that does reads the points again.
        Ok(_) => Err(points(bytes).err().unwrap_or(unplaced("a coordinate is not finite"))),
        Err(said) => Err(points(bytes).err().unwrap_or(unplaced(&said))),
    }
}

/// Whether the text has a proper end.
///
/// # Errors
/// [`ScanFault::CutShort`] if the last line has no line end, [`ScanFault::Binary`].
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    text::refuse_binary(bytes)?;
    text::refuse_open_line(bytes)
}

/// Whether only the line end is missing after the last face. If its last number was cut short, it names
/// another point, which hardly shares an edge of another face with the corners before it.
pub(super) fn lacks_line_end_only(bytes: &[u8]) -> bool {
    if text::refuse_open_line(bytes).is_ok() || text::refuse_binary(bytes).is_err() {
        return false;
    }
    let has_three = |last: &[u8]| is_face(keyword(last)) && text::words(last).count() > 3;
    if !numbered(bytes).last().is_some_and(|(_, last)| has_three(last)) {
        return false;
    }
    let Ok(mut statements) = Statements::of(text::without_mark(bytes)) else { return false };
    let unused = statements.number_by_use().unused;
    let Some((&[first, second, last], others)) = statements.triangles.split_last() else {
        return false;
    };
    let shares_edge = |other: &[u32; 3]| {
        other.contains(&last) && (other.contains(&first) || other.contains(&second))
    };
    unused == 0 && others.iter().any(shares_edge)
}

fn unplaced(what: &str) -> ScanFault {
    ScanFault::Malformed { place: Place::Unknown, what: what.to_owned() }
}

/// All points, used by a face or not, in the order of the file.
///
/// # Errors
/// The first invalid coordinate, with its line.
fn points(bytes: &[u8]) -> Result<Vec<Point3<f64>>, ScanFault> {
    let mut found = Vec::new();
    let mut decimals = Decimals::default();
    each_geometry(bytes, |line, statement| {
        if keyword(statement) == b"v" {
            let mut words = text::words(statement).skip(1);
            let mut next = || match words.next() {
                Some(word) => decimals.number(word, line),
                None => Err(fault::malformed(line, "fewer than three coordinates")),
            };
            found.push(Point3::new(next()?, next()?, next()?));
        }
        Ok(())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests;
