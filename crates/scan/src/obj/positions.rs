//! The coordinates of the points, read by tobj.
//!
//! tobj returns only points that a face uses, so each time it also gets a face of all the points wanted.

use std::io::Read;
use std::iter;

use nalgebra::Point3;
use rayon::prelude::*;

use super::lines::{each_geometry, keyword, point_only, with_decimal_points};

/// Number of lines that tobj reads at once, with two points each. Any number of pieces can be read side by
/// side, and the pieces are the same for any number of threads. This many numbers are the most that tobj's
/// hash table holds before it grows to more than 1024 places, and most of them have only three digits.
const LINES_PER_PIECE: usize = 896;

/// Number of points requested from tobj at once, in one object, where it cannot read in pieces. It needs
/// some 100 bytes per point while reading, so this many need 7 MB.
const POINTS_PER_OBJECT: usize = 1 << 16;

/// Points in the usual form, to be read by tobj in pieces.
///
/// In a `v` line tobj reads six numbers in the same way: a position and a colour. So two points share a
/// line, the second as the colour of the first. tobj then takes a quarter fewer instructions.
#[derive(Default)]
pub(super) struct Positions {
    /// `v` lines.
    text: Vec<u8>,
    /// Where each piece starts in `text`.
    starts: Vec<usize>,
    /// Number of points.
    count: usize,
}

impl Positions {
    /// None yet, with space for so many bytes of text.
    pub(super) fn with_capacity(bytes: usize) -> Positions {
        Positions { text: Vec::with_capacity(bytes), ..Positions::default() }
    }

    /// Adds a point: `v` and three words of printable ASCII without commas.
    pub(super) fn push(&mut self, statement: &[u8]) {
        if self.count.is_multiple_of(2 * LINES_PER_PIECE) {
            self.starts.push(self.text.len());
        }
        self.count += 1;
        if self.count.is_multiple_of(2) {
            self.text.extend_from_slice(statement.strip_prefix(b"v").unwrap_or(statement));
            self.text.push(b'\n');
        } else {
            self.text.extend_from_slice(statement);
        }
    }

    /// All points, in the order in which they were added.
    ///
    /// # Errors
    /// What is wrong with the first piece that has a word that is not a number.
    pub(super) fn read(mut self) -> Result<Vec<Point3<f64>>, String> {
        if !self.count.is_multiple_of(2) {
            self.text.extend_from_slice(b" 0 0 0\n");
        }
        let ends = self.starts.iter().skip(1).copied().chain([self.text.len()]);
        let pieces: Vec<_> = iter::zip(&self.starts, ends).collect();
        let lines_before_last = LINES_PER_PIECE * pieces.len().saturating_sub(1);
        let whole = face_of(0..LINES_PER_PIECE as u32);
        let last = face_of(0..(self.count.div_ceil(2) - lines_before_last) as u32);
        let read: Vec<Result<_, _>> = (1..=pieces.len())
            .into_par_iter()
            .map(|number| {
                let (&start, end) = pieces[number - 1];
                let face = if number == pieces.len() { &last } else { &whole };
                pairs(&self.text[start..end], face)
            })
            .collect();
        let read: Vec<Vec<_>> = read.into_iter().collect::<Result<_, _>>()?;
        let mut points = read.concat();
        points.truncate(self.count);
        Ok(points)
    }
}

/// The points of `text`, two in each line, of which `face` uses all lines.
fn pairs(text: &[u8], face: &[u8]) -> Result<Vec<Point3<f64>>, String> {
    let mut points = Vec::with_capacity(2 * LINES_PER_PIECE);
    for mesh in load(text, face)? {
        // A line of which tobj has not read all six numbers.
        if mesh.vertex_color.len() != mesh.positions.len() {
            return Err("a coordinate is not a number".to_owned());
        }
        let places = iter::zip(mesh.positions.chunks_exact(3), mesh.vertex_color.chunks_exact(3));
        points.extend(places.flat_map(|(first, second)| [first, second].map(place)));
    }
    Ok(points)
}

/// The points with these numbers, in this order, where some coordinate of the file has an unusual form.
/// Such a form may not be a number, or tobj may take it for several numbers, of which some are a colour.
/// Then what it makes of one point depends on all others.
///
/// # Errors
/// What tobj says about the first word that is not a number.
pub(super) fn unusual(bytes: &[u8], order: &[u32]) -> Result<Vec<Point3<f64>>, String> {
    let mut text = Vec::new();
    let found = each_geometry(bytes, |_, statement| {
        if keyword(statement) == b"v" {
            text.extend(with_decimal_points(point_only(statement)));
            text.push(b'\n');
        }
        Ok(())
    });
    found.map_err(|fault| fault.to_string())?;
    let meshes = load(&text, &face_of(order.iter().copied()))?;
    Ok(meshes.iter().flat_map(|mesh| mesh.positions.chunks_exact(3)).map(place).collect())
}

/// What tobj reads in the lines of `text` that `face` uses, in that order.
fn load(text: &[u8], face: &[u8]) -> Result<Vec<tobj::Mesh>, String> {
    let options = tobj::LoadOptions::default();
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut text.chain(face), &options, no_materials)
        .map_err(|fault| fault.to_string())?;
    Ok(models.into_iter().map(|model| model.mesh).collect())
}

/// Three coordinates as a point.
fn place(coordinates: &[f64]) -> Point3<f64> {
    Point3::new(coordinates[0], coordinates[1], coordinates[2])
}

/// `f` lines that use the points with these numbers, with up to `POINTS_PER_OBJECT` points per object.
fn face_of(numbers: impl Iterator<Item = u32>) -> Vec<u8> {
    let mut text = Vec::new();
    for (count, number) in numbers.enumerate() {
        let is_first = count.is_multiple_of(POINTS_PER_OBJECT);
        text.extend_from_slice(if is_first { b"\no\nf " } else { b" " });
        push_number(&mut text, u64::from(number) + 1);
    }
    text.push(b'\n');
    text
}

/// Writes a number in decimal digits, many times faster than the standard library's formatting.
fn push_number(text: &mut Vec<u8>, mut number: u64) {
    const DIGITS_MAX: usize = 20;
    let mut digits = [0; DIGITS_MAX];
    let mut start = DIGITS_MAX;
    while start == DIGITS_MAX || number > 0 {
        start -= 1;
        digits[start] = b'0' + (number % 10) as u8;
        number /= 10;
    }
    text.extend_from_slice(&digits[start..]);
}
