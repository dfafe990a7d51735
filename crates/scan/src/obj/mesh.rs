//! The points and triangles of a file, by tobj.
//!
//! tobj gets the statements with geometry alone, because it refuses a whole file for a Latin-1 letter in a name, for
//! colours at some points, for line ends of old systems and for decimal commas, and does not know `fo` and `\`. Plain
//! lines, which are nearly all of a scan's, it gets as they are, the others rewritten. It gets the points first, since it
//! looks them up whenever an object ends. What it refuses is read a second time by what knows the lines.

use std::io::Read;
use std::path::Path;

use nalgebra::Point3;

use super::super::fault::{ScanFault, SourcePosition, malformed};
use super::super::text::{Decimals, Lines, excerpt, words};
use super::lines::{Geometry, WORDS_OF_POINT, each_geometry, keyword};
use super::plain::{plain_point, plain_triangle, whole_number};

/// Bytes of the shortest point, `v 0 0 0` and its line end: no file has more points than it has room for.
const POINT_BYTES_MIN: usize = 8;

/// Triangles that tobj gets as one object: it takes up to 330 bytes for each until the object ends.
const TRIANGLES_PER_OBJECT: usize = 1 << 14;

/// What the faces of a file span.
pub(super) struct Mesh {
    /// The points that a triangle uses, in the order in which the triangles use them first; some are there twice.
    pub points: Vec<Point3<f64>>,
    /// Polygons as fans around their first corner, without triangles that use a point twice.
    pub triangles: Vec<[u32; 3]>,
    /// Number of points of the file.
    pub point_count: usize,
    /// Number of those that no face uses.
    pub unused: usize,
}

/// Reads the mesh of a text without a byte order mark; one without triangles if it has no faces.
///
/// # Errors
/// The first fault, with its line.
pub(super) fn mesh(bytes: &[u8]) -> Result<Mesh, ScanFault> {
    let given = Given::new(bytes)?;
    if given.has_commas {
        all_points(bytes)?;
    }
    let options = tobj::LoadOptions::default();
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let placed = |message: &str| first_fault(bytes, given.point_count).unwrap_or(unplaced(message));
    let mut text = given.points.as_slice().chain(given.faces.as_slice());
    let (models, _) = tobj::load_obj_buf(&mut text, &options, no_materials)
        .map_err(|fault| placed(&fault.to_string()))?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for tobj::Model { mesh, .. } in models {
        let first = points.len() as u32;
        points.extend(mesh.positions.chunks_exact(3).map(|of| Point3::new(of[0], of[1], of[2])));
        let corners = |of: &[u32]| [of[0] + first, of[1] + first, of[2] + first];
        triangles.extend(mesh.indices.chunks_exact(3).map(corners));
    }
    match points.iter().flat_map(|point| point.iter()).all(|value| value.is_finite()) {
        true => Ok(Mesh {
            points,
            triangles,
            point_count: given.point_count,
            unused: given.point_count - given.used.iter().filter(|used| **used).count(),
        }),
        false => Err(placed("a coordinate is not finite")),
    }
}

/// All points, used by a face or not, in the order of the file.
///
/// # Errors
/// The first invalid coordinate, with its line.
pub(super) fn all_points(bytes: &[u8]) -> Result<Vec<Point3<f64>>, ScanFault> {
    let mut found = Vec::new();
    let mut decimals = Decimals::default();
    each_geometry(bytes, |line, statement| {
        if keyword(statement) == b"v" {
            found.push(decimals.point(words(statement).skip(1), line)?);
        }
        Ok(())
    })?;
    Ok(found)
}

/// What tobj gets of a file.
#[derive(Default)]
struct Given {
    /// `v` statements with three coordinates.
    points: Vec<u8>,
    /// `f` statements of triangles, which count from the first point, in objects.
    faces: Vec<u8>,
    point_count: usize,
    triangle_count: usize,
    has_commas: bool,
    /// By the points of the file, as many as may exist: whether a face uses it.
    used: Vec<bool>,
}

impl Given {
    fn new(bytes: &[u8]) -> Result<Given, ScanFault> {
        let used = vec![false; bytes.len() / POINT_BYTES_MIN + 1];
        let mut given = Given { used, ..Given::default() };
        let mut geometry = Geometry::new(bytes);
        while !geometry.lines.rest().is_empty() {
            given.add_plain(&mut geometry.lines);
            match geometry.statement()? {
                Some((line, point)) if keyword(point) == b"v" => given.add_point(point, line)?,
                Some((line, face)) => given.add_face(face, line)?,
                None => {}
            }
        }
        Ok(given)
    }

    /// Adds the plain lines up to the next other one.
    fn add_plain(&mut self, lines: &mut Lines<'_>) {
        let (mut rest, mut count) = (lines.rest(), 0);
        loop {
            let (text, after) = if let Some(after) = plain_point(rest) {
                self.point_count += 1;
                (&mut self.points, after)
            } else if let Some((points, after)) = plain_triangle(rest)
                && self.counts_plain(points)
            {
                (&mut self.faces, after)
            } else {
                break;
            };
            text.extend_from_slice(&rest[..rest.len() - after.len()]);
            rest = after;
            count += 1;
        }
        lines.pass(count, rest);
    }

    /// Counts a triangle, unless an object begins with it, it has a point twice, or one that cannot exist.
    fn counts_plain(&mut self, points: [usize; 3]) -> bool {
        if self.triangle_count.is_multiple_of(TRIANGLES_PER_OBJECT) {
            return false;
        }
        let Ok(used) = self.used.get_disjoint_mut(points) else { return false };
        used.into_iter().for_each(|used| *used = true);
        self.triangle_count += 1;
        true
    }

    fn add_point(&mut self, statement: &[u8], line: usize) -> Result<(), ScanFault> {
        self.point_count += 1;
        let start = self.points.len();
        let mut count = 0;
        for word in words(statement).take(WORDS_OF_POINT) {
            self.points.extend_from_slice(word);
            self.points.push(b' ');
            count += 1;
        }
        self.points.push(b'\n');
        let written = &mut self.points[start..];
        // tobj also parts words at white space that is not ASCII.
        let is_usual = |byte: &u8| byte.is_ascii_graphic() || matches!(byte, b' ' | b'\n');
        if count < WORDS_OF_POINT || !written.iter().all(is_usual) {
            Decimals::default().point(words(statement).skip(1), line)?;
        }
        for byte in written.iter_mut().filter(|byte| **byte == b',') {
            *byte = b'.';
            self.has_commas = true;
        }
        Ok(())
    }

    /// Adds the triangles of a polygon around its first corner. Faces with one or two corners are points and lines,
    /// which have their own statements in OBJ.
    fn add_face(&mut self, statement: &[u8], line: usize) -> Result<(), ScanFault> {
        let mut words = corners(statement);
        let mut next =
            |given: &Given| words.next().map(|word| given.corner(word, line)).transpose();
        let (first, mut last) = (next(self)?, next(self)?);
        while let Some(corner) = next(self)? {
            let (Some(first), Some(previous)) = (first, last.replace(corner)) else { break };
            let triangle = [first, previous, corner];
            triangle.into_iter().for_each(|point| self.used[point] = true);
            let [a, b, c] = triangle;
            if a != b && b != c && c != a {
                self.add_triangle(triangle);
            }
        }
        Ok(())
    }

    fn add_triangle(&mut self, triangle: [usize; 3]) {
        if self.triangle_count.is_multiple_of(TRIANGLES_PER_OBJECT) {
            self.faces.extend_from_slice(b"o\n");
        }
        self.triangle_count += 1;
        let [a, b, c] = triangle.map(|point| point + 1);
        self.faces.extend_from_slice(format!("f {a} {b} {c}\n").as_bytes());
    }

    /// The 0-based point of a word such as `3`, `-1`, `3/1` or `3//2`.
    fn corner(&self, word: &[u8], line: usize) -> Result<usize, ScanFault> {
        let written = word.split(|&byte| byte == b'/').next().unwrap_or_default();
        let index = match written.strip_prefix(b"-") {
            None => digits(written).and_then(|number| number.checked_sub(1)),
            Some(back) => digits(back)
                .filter(|back| *back > 0)
                .and_then(|back| self.point_count.checked_sub(back)),
        };
        let index = index.filter(|index| *index < self.used.len());
        index.ok_or_else(|| no_corner(word, line))
    }
}

/// A whole number of digits only.
fn digits(word: &[u8]) -> Option<usize> {
    whole_number(word).filter(|(_, rest)| rest.is_empty()).map(|(number, _)| number)
}

/// The words of the corners of a face, up to a comment.
fn corners(statement: &[u8]) -> impl Iterator<Item = &[u8]> {
    words(statement).skip(1).take_while(|word| !word.starts_with(b"#"))
}

/// The first fault of a file of this many points, with its line; `None` if there is none that is known here.
fn first_fault(bytes: &[u8], point_count: usize) -> Option<ScanFault> {
    let mut decimals = Decimals::default();
    let found = each_geometry(bytes, |line, statement| {
        if keyword(statement) == b"v" {
            return decimals.point(words(statement).skip(1), line).map(drop);
        }
        // Those that count back are known to be there.
        let is_there = |word: &[u8]| {
            let number = word.split(|&byte| byte == b'/').next().and_then(digits);
            number.is_none_or(|number| number <= point_count)
        };
        match corners(statement).find(|word| !is_there(word)) {
            Some(word) => Err(no_corner(word, line)),
            None => Ok(()),
        }
    });
    found.err()
}

fn no_corner(word: &[u8], line: usize) -> ScanFault {
    malformed(line, format!("\"{}\" is no corner of a face", excerpt(word)))
}

fn unplaced(what: &str) -> ScanFault {
    ScanFault::Malformed { place: SourcePosition::Unknown, what: what.to_owned() }
}
