//! The coordinates of the points, read by tobj.
//!
//! tobj returns only points that a face uses, so each time it also gets a face of all the points wanted.

use std::io::Read;
use std::iter;

use nalgebra::Point3;
use rayon::prelude::*;

use super::lines::{each_geometry, keyword, point_only, with_decimal_points};

/// Number of points that tobj reads at once. Any number of pieces can be read side by side, and the
/// pieces are the same for any number of threads. This many numbers are the most that tobj's hash table
/// holds before it grows to more than 1024 places, and most of them have only three digits.
const POINTS_PER_PIECE: usize = 896;

/// Number of points requested from tobj at once, in one object, where it cannot read in pieces. It needs
/// some 100 bytes per point while reading, so this many need 7 MB.
const POINTS_PER_OBJECT: usize = 1 << 16;

/// Points in the usual form, to be read by tobj in pieces.
#[derive(Default)]
pub(super) struct Positions {
    /// `v` lines.
    text: Vec<u8>,
    /// Where each piece starts in `text`.
    starts: Vec<usize>,
    /// Number of `v` lines.
    count: usize,
}

impl Positions {
    /// None yet, with space for so many bytes of text.
    pub(super) fn with_capacity(bytes: usize) -> Positions {
        Positions { text: Vec::with_capacity(bytes), ..Positions::default() }
    }

    /// Adds a point: `v` and three words of the characters of a decimal number.
    pub(super) fn push(&mut self, statement: &[u8]) {
        if self.count.is_multiple_of(POINTS_PER_PIECE) {
            self.starts.push(self.text.len());
        }
        self.text.extend_from_slice(statement);
        self.text.push(b'\n');
        self.count += 1;
    }

    /// All points, in the order in which they were added.
    ///
    /// # Errors
    /// What tobj says about the first piece with a word that is not a number.
    pub(super) fn read(&self) -> Result<Vec<Point3<f64>>, String> {
        let ends = self.starts.iter().skip(1).copied().chain([self.text.len()]);
        let pieces: Vec<_> = iter::zip(&self.starts, ends).collect();
        let whole = face_of(0..POINTS_PER_PIECE as u32);
        let last = face_of(0..(self.count - POINTS_PER_PIECE * (pieces.len() - 1)) as u32);
        let read: Vec<Result<_, _>> = (1..=pieces.len())
            .into_par_iter()
            .map(|number| {
                let (&start, end) = pieces[number - 1];
                let face = if number == pieces.len() { &last } else { &whole };
                load(&self.text[start..end], face)
            })
            .collect();
        let read: Vec<Vec<_>> = read.into_iter().collect::<Result<_, _>>()?;
        Ok(read.concat())
    }
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
    load(&text, &face_of(order.iter().copied()))
}

/// The points of `text` in the order in which `face` uses them.
fn load(text: &[u8], face: &[u8]) -> Result<Vec<Point3<f64>>, String> {
    let options = tobj::LoadOptions::default();
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut text.chain(face), &options, no_materials)
        .map_err(|fault| fault.to_string())?;
    let coordinates = models.iter().flat_map(|model| model.mesh.positions.chunks_exact(3));
    Ok(coordinates.map(|c| Point3::new(c[0], c[1], c[2])).collect())
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
