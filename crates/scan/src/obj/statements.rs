//! The statements of an OBJ file with geometry, checked and simplified.

use super::super::fault::{ScanFault, malformed};
use super::super::text::{excerpt, words};
use super::lines::{Geometry, WORDS_OF_POINT, point_only, with_decimal_points};
use super::plain;
use super::positions::Positions;

/// The shortest statement of a point, `v 0 0 0` with its line end, bytes. It limits the number of
/// points by the file's length, so a larger index is invalid even before all points are known.
const SHORTEST_POINT_BYTES: usize = 8;

/// The geometry of a file in its simplest form.
#[derive(Default)]
pub(super) struct Statements {
    /// Coordinates of the points, if all have the usual form.
    pub positions: Positions,
    /// Three different existing points each, 0-based.
    pub triangles: Vec<[u32; 3]>,
    /// Number of `v` lines.
    pub point_count: usize,
    /// Whether a coordinate contains a comma.
    pub has_commas: bool,
    /// Whether a point has fewer than three coordinates, or characters that are neither printable ASCII nor
    /// blanks.
    pub has_unusual: bool,
    /// Whether a triangle that was left out uses the point.
    used: Vec<bool>,
    /// The largest index in a face so far, 0-based, and its line.
    largest: (usize, usize),
    /// More points than the file can have.
    points_max: usize,
    /// The corners of the latest face.
    corners: Vec<u32>,
}

/// How the triangles use the points.
pub(super) struct Use {
    /// The points that they use, 0-based, in the order of their first use.
    pub order: Vec<u32>,
    /// Number of points that no face uses.
    pub unused: usize,
}

impl Statements {
    /// Drops comments, names, groups and materials, so that the encoding of names does not matter.
    /// Also drops colours after a point's coordinates, normals and texture coordinates. Polygons become
    /// triangle fans; triangles that use a point twice are left out.
    ///
    /// # Errors
    /// [`ScanFault::Malformed`] for faces with points that do not exist, and those of
    /// [`Geometry::statement`].
    pub(super) fn of(bytes: &[u8]) -> Result<Statements, ScanFault> {
        let points_max = bytes.len() / SHORTEST_POINT_BYTES + 1;
        let positions = Positions::with_capacity(bytes.len() / 2);
        let mut found = Statements { positions, points_max, ..Statements::default() };
        let mut geometry = Geometry::of(bytes);
        while !geometry.rest().is_empty() {
            if let Some(length) = found.plain_line(geometry.rest()) {
                geometry.pass(length);
            } else if let Some((line, statement)) = geometry.statement()? {
                found.statement(statement, line)?;
            }
        }
        let (index, line) = found.largest;
        if line > 0 && index >= found.point_count {
            let what = format!("\"{}\" is no corner of a face", index + 1);
            return Err(malformed(line, what));
        }
        Ok(found)
    }

    /// Numbers the points anew in the order in which the triangles use them first.
    pub(super) fn number_by_use(&mut self) -> Use {
        const UNUSED: u32 = u32::MAX;
        let mut numbers = vec![UNUSED; self.point_count];
        // Grows as it is filled: a file may have many points and hardly any face.
        let mut order = Vec::new();
        // Two loops: a flattened iterator costs twice as much.
        for triangle in &mut self.triangles {
            for corner in triangle {
                let number = &mut numbers[*corner as usize];
                if *number == UNUSED {
                    *number = order.len() as u32;
                    order.push(*corner);
                }
                *corner = *number;
            }
        }
        let others = self.used.iter().zip(&numbers).filter(|(used, n)| **used && **n == UNUSED);
        let unused = self.point_count - order.len() - others.count();
        Use { order, unused }
    }

    /// Reads the line at the start of a text if it is a plain one, as nearly all are: a point, or a
    /// triangle of three different points that already exist. Returns the length of the line.
    fn plain_line(&mut self, text: &[u8]) -> Option<usize> {
        if text.starts_with(b"v") {
            let found = plain::point(text)?;
            self.point_count += 1;
            self.positions.push(&text[..found.statement]);
            return Some(found.line);
        }
        let found = plain::face(text)?;
        let [a, b, c] = found.corners;
        let are_there = found.corners.iter().all(|at| (1..=self.point_count).contains(at));
        if !are_there || a == b || b == c || c == a {
            return None;
        }
        self.triangles.push(found.corners.map(|corner| (corner - 1) as u32));
        Some(found.line)
    }

    /// Reads any `v`, `f` or `fo` statement.
    fn statement(&mut self, statement: &[u8], line: usize) -> Result<(), ScanFault> {
        if statement.starts_with(b"v") {
            self.point(statement);
            return Ok(());
        }
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        let is_comment = |word: &&[u8]| word.starts_with(b"#");
        for word in words(statement).skip(1).take_while(|word| !is_comment(word)) {
            corners.push(self.corner(word, line)?);
        }
        self.fan(&corners);
        self.corners = corners;
        Ok(())
    }

    fn point(&mut self, statement: &[u8]) {
        self.point_count += 1;
        let point = point_only(statement);
        self.has_commas |= point.contains(&b',');
        let is_usual = |byte: &u8| byte.is_ascii_graphic() || *byte == b' ' || *byte == b'\t';
        if words(point).count() == WORDS_OF_POINT && point.iter().all(is_usual) {
            self.positions.push(&with_decimal_points(point));
        } else {
            self.has_unusual = true;
        }
    }

    /// The 0-based point of a word such as `3`, `-1`, `3/1` or `3//2`.
    fn corner(&mut self, word: &[u8], line: usize) -> Result<u32, ScanFault> {
        let position = word.split(|&b| b == b'/').next().unwrap_or_default();
        let index = match position.strip_prefix(b"-") {
            None => digits(position).and_then(|index| index.checked_sub(1)),
            Some(back) => digits(back)
                .filter(|back| *back > 0)
                .and_then(|back| self.point_count.checked_sub(back)),
        };
        let within = index.filter(|index| *index < self.points_max);
        let Some((index, number)) = within.and_then(|i| Some((i, u32::try_from(i).ok()?))) else {
            return Err(malformed(line, format!("\"{}\" is no corner of a face", excerpt(word))));
        };
        if index > self.largest.0 || self.largest.1 == 0 {
            self.largest = (index, line);
        }
        Ok(number)
    }

    /// Adds the triangles of a polygon around its first corner. Faces with one or two corners are
    /// points and lines, which have their own statements in OBJ.
    fn fan(&mut self, corners: &[u32]) {
        let [first, rest @ ..] = corners else { return };
        if rest.len() < 2 {
            return;
        }
        for pair in rest.windows(2) {
            if pair[0] != pair[1] && !pair.contains(first) {
                self.triangles.push([*first, pair[0], pair[1]]);
            } else {
                [*first, pair[0], pair[1]]
                    .iter()
                    .for_each(|&corner| self.mark_used(corner as usize));
            }
        }
    }

    fn mark_used(&mut self, point: usize) {
        if self.used.len() <= point {
            self.used.resize(point + 1, false);
        }
        self.used[point] = true;
    }
}

/// Parses a whole number of digits only, many times faster than the standard library.
fn digits(word: &[u8]) -> Option<usize> {
    if word.is_empty() {
        return None;
    }
    word.iter().try_fold(0usize, |number, byte| {
        let digit = usize::from(byte.wrapping_sub(b'0'));
        if digit < 10 { number.checked_mul(10)?.checked_add(digit) } else { None }
    })
}
