//! Plain points, one per line: `.xyz`, `.asc`, `.txt`.
//!
//! Lines that begin with `#`, `//` or `;` are comments. Before the first point there may be one
//! line of column names and one line with the number of points. The first point determines the
//! column separator for the whole file:
//!
//! 1. a `;` if there is one; commas are then decimal marks;
//! 2. otherwise white space, if it separates three columns or more; a comma at the end of a column
//!    is then also a separator, and a comma within one is a decimal mark;
//! 3. otherwise the comma, so that `1,2,3,4,5,6` has six columns.
//!
//! Every point has as many columns as the first. If there are names `x`, `y` and `z`, perhaps with a unit
//! such as `X[mm]`, they select the coordinates; otherwise the first three columns do. The others, normals
//! and colours, are skipped.

mod columns;

use nalgebra::Point3;

use super::Scan;
use super::fault::{CutSign, ScanFault, cut_short, malformed};
use super::format::Format;
use super::text::{self, Decimals, excerpt, numbered, whole};
use columns::Separator;

/// Whether a trimmed line is a comment.
pub(super) fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"//") || line.starts_with(b";")
}

/// Whether a line begins with three numbers, as a point does.
pub(super) fn is_point(line: &[u8]) -> bool {
    let mut columns = Separator::detect(line).columns(line);
    (0..3).all(|_| columns.next().is_some_and(is_number))
}

/// Checks that the last line has a line end, and that as many points follow as declared.
///
/// # Errors
/// [`ScanFault::CutShort`], [`ScanFault::Binary`].
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    text::refuse_binary(bytes)?;
    let mut lines = statements(text::without_mark(bytes));
    let Ok(head) = Head::read(&mut lines) else { return text::refuse_open_line(bytes) };
    if let Some(of) = head.count {
        let has = lines.count() + usize::from(head.first.is_some());
        if has < of {
            return Err(cut_short(CutSign::Missing { what: "points", has, of }));
        }
    }
    text::refuse_open_line(bytes)
}

/// Decodes a complete list of points.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line.
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    let mut lines = statements(text::without_mark(bytes));
    let head = Head::read(&mut lines)?;
    let Some(first) = head.first else { return Err(ScanFault::NoPoints) };
    let separator = Separator::detect(first.1);
    let column_count = separator.columns(first.1).count();
    if column_count < 3 {
        return Err(malformed(first.0, format!("{column_count} columns; a point has three")));
    }
    let places = separator.coordinates(head.names, column_count);
    let mut decimals = Decimals::default();
    let mut points = Vec::new();
    for (line, statement) in std::iter::once(first).chain(lines) {
        let mut point = [None; 3];
        let mut count = 0;
        for column in separator.columns(statement) {
            if let Some(axis) = places.iter().position(|place| *place == count) {
                point[axis] = Some(decimals.number(column, line)?);
            }
            count += 1;
        }
        let ([Some(x), Some(y), Some(z)], true) = (point, count == column_count) else {
            let what = format!("{count} columns where the first point has {column_count}");
            return Err(malformed(line, what));
        };
        points.push(Point3::new(x, y, z));
    }
    match head.count {
        Some(says) if points.len() > says => {
            Err(ScanFault::TooLong { what: "points", has: points.len(), says })
        }
        _ => Ok(Scan { points, triangles: Vec::new() }),
    }
}

/// The lines that are neither blank nor comments.
fn statements(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    numbered(text).filter(|(_, line)| !is_comment(line))
}

/// Everything before the second point.
struct Head<'a> {
    /// The line of column names.
    names: Option<&'a [u8]>,
    /// The declared number of points.
    count: Option<usize>,
    /// The first point and its line.
    first: Option<(usize, &'a [u8])>,
}

impl<'a> Head<'a> {
    fn read(lines: &mut impl Iterator<Item = (usize, &'a [u8])>) -> Result<Head<'a>, ScanFault> {
        let mut head = Head { names: None, count: None, first: None };
        for (line, statement) in lines {
            let first_column = Separator::detect(statement).columns(statement).next();
            if head.count.is_none() && whole::<usize>(statement).is_some() {
                head.count = whole(statement);
            } else if first_column.is_some_and(is_number) {
                head.first = Some((line, statement));
                break;
            } else if head.names.is_none() {
                head.names = Some(statement);
            } else {
                let found = excerpt(statement);
                return Err(ScanFault::NotThisFormat { format: Format::Xyz, line, found });
            }
        }
        Ok(head)
    }
}

/// Whether a column is a number, or a substitute that exporters write for a missing one.
fn is_number(column: &[u8]) -> bool {
    !matches!(Decimals::default().number(column, 0), Err(ScanFault::Malformed { .. }))
}
