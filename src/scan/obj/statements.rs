//! The statements of an OBJ file with geometry, checked and simplified.

use super::super::fault::{CutSign, ScanFault, cut_short, malformed};
use super::super::format::Format;
use super::super::text::{excerpt, numbered, words};

/// Statements of the OBJ format (Wavefront specification, version 3.0) and the usual extensions. A
/// file whose first statement is not one of these is not an OBJ file.
const STATEMENTS: [&str; 30] = [
    "v",
    "vt",
    "vn",
    "vp",
    "f",
    "fo",
    "l",
    "p",
    "o",
    "g",
    "s",
    "mg",
    "mtllib",
    "usemtl",
    "usemap",
    "maplib",
    "lod",
    "deg",
    "bmat",
    "step",
    "cstype",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "end",
    "shadow_obj",
    "trace_obj",
];

/// The shortest statement of a point, `v 0 0 0` with its line end, bytes. It limits the number of
/// points by the file's length, so a larger index is invalid even before all points are known.
const SHORTEST_POINT_BYTES: usize = 8;

/// Number of points requested from tobj at once, in one object. It needs some 100 bytes per point
/// while reading, so this many need 7 MB.
const POINTS_PER_OBJECT: usize = 1 << 16;

/// The geometry of a file in its simplest form.
pub(super) struct Statements {
    /// `v` lines of three coordinates with decimal points.
    pub points: Vec<u8>,
    /// Three different existing points each, 0-based.
    pub triangles: Vec<[u32; 3]>,
    /// Number of `v` lines.
    pub point_count: usize,
    /// Whether a coordinate contains a comma.
    pub has_commas: bool,
    /// Whether a face uses the point.
    used: Vec<bool>,
    /// The largest index in a face so far, 0-based, and its line.
    largest: (usize, usize),
}

impl Statements {
    /// Drops comments, names, groups and materials, so that the encoding of names does not matter.
    /// Also drops colours after a point's coordinates, because tobj refuses a file where only some
    /// points have them, and normals and texture coordinates. Polygons become triangle fans;
    /// triangles that use a point twice are left out.
    ///
    /// # Errors
    /// [`ScanFault::Malformed`] for faces with points that do not exist.
    pub(super) fn of(bytes: &[u8]) -> Result<Statements, ScanFault> {
        let mut found = Statements {
            points: Vec::with_capacity(bytes.len() / 2),
            triangles: Vec::new(),
            point_count: 0,
            has_commas: false,
            used: Vec::new(),
            largest: (0, 0),
        };
        let points_max = bytes.len() / SHORTEST_POINT_BYTES + 1;
        let mut corners = Vec::new();
        each_geometry(bytes, |line, statement| match statement.starts_with(b"v") {
            true => {
                found.point(statement);
                Ok(())
            }
            false => {
                if found.plain_triangle(statement) {
                    return Ok(());
                }
                corners.clear();
                let is_comment = |word: &&[u8]| word.starts_with(b"#");
                for word in words(statement).skip(1).take_while(|word| !is_comment(word)) {
                    corners.push(found.corner(word, line, points_max)?);
                }
                found.fan(&corners);
                Ok(())
            }
        })?;
        let (index, line) = found.largest;
        if line > 0 && index >= found.point_count {
            let what = format!("\"{}\" is no corner of a face", index + 1);
            return Err(malformed(line, what));
        }
        Ok(found)
    }

    /// Number of points that no face uses.
    pub(super) fn unused(&self) -> usize {
        self.point_count - self.used.iter().filter(|used| **used).count()
    }

    /// The points in the order of their first use by the triangles, as `f` lines with up to
    /// `POINTS_PER_OBJECT` points per object, and the triangles with indices in that order.
    pub(super) fn in_order_of_use(&self) -> (Vec<u8>, Vec<[u32; 3]>) {
        const UNUSED: u32 = u32::MAX;
        let mut numbers = vec![UNUSED; self.point_count];
        let (mut faces, mut count) = (Vec::new(), 0);
        let mut numbered = |corner: u32| {
            let number = &mut numbers[corner as usize];
            if *number == UNUSED {
                *number = count;
                let is_first = (count as usize).is_multiple_of(POINTS_PER_OBJECT);
                faces.extend_from_slice(if is_first { b"\no\nf " } else { b" " });
                push_number(&mut faces, u64::from(corner) + 1);
                count += 1;
            }
            *number
        };
        let triangles = self.triangles.iter().map(|corners| corners.map(&mut numbered)).collect();
        faces.push(b'\n');
        (faces, triangles)
    }

    fn point(&mut self, statement: &[u8]) {
        self.point_count += 1;
        let coordinates = &statement[..end_of_word(statement, 4)];
        let start = self.points.len();
        self.points.extend_from_slice(coordinates);
        if coordinates.contains(&b',') {
            self.has_commas = true;
            let commas = self.points[start..].iter_mut().filter(|byte| **byte == b',');
            commas.for_each(|comma| *comma = b'.');
        }
        self.points.push(b'\n');
    }

    /// Reads a face such as `f 1 2 3` with three different points that already exist, as nearly all
    /// faces have. Returns whether the statement is such a face.
    fn plain_triangle(&mut self, statement: &[u8]) -> bool {
        let Some(corners) = plain_corners(statement) else { return false };
        let [a, b, c] = corners;
        let are_there = corners.iter().all(|corner| (1..=self.point_count).contains(corner));
        if !are_there || a == b || b == c || c == a {
            return false;
        }
        self.used.resize(self.used.len().max(self.point_count), false);
        corners.iter().for_each(|corner| self.used[corner - 1] = true);
        self.triangles.push(corners.map(|corner| (corner - 1) as u32));
        true
    }

    /// The 0-based point of a word such as `3`, `-1`, `3/1` or `3//2`.
    fn corner(&mut self, word: &[u8], line: usize, points_max: usize) -> Result<u32, ScanFault> {
        let position = word.split(|&b| b == b'/').next().unwrap_or_default();
        let index = match position.strip_prefix(b"-") {
            None => digits(position).and_then(|index| index.checked_sub(1)),
            Some(back) => digits(back)
                .filter(|back| *back > 0)
                .and_then(|back| self.point_count.checked_sub(back)),
        };
        let within = index.filter(|index| *index < points_max);
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
        for &corner in corners {
            let index = corner as usize;
            if self.used.len() <= index {
                self.used.resize(index + 1, false);
            }
            self.used[index] = true;
        }
        for pair in rest.windows(2).filter(|pair| pair[0] != pair[1] && !pair.contains(first)) {
            self.triangles.push([*first, pair[0], pair[1]]);
        }
    }
}

/// The numbers of a face such as `f 1 2 3`: three, digits only, separated by blanks.
fn plain_corners(statement: &[u8]) -> Option<[usize; 3]> {
    /// Numbers with so few digits cannot overflow.
    const DIGITS_MAX: usize = 9;
    let mut rest = &statement[1..];
    let mut corners = [0; 3];
    for corner in &mut corners {
        let blanks = rest.iter().take_while(|byte| **byte == b' ').count();
        rest = &rest[blanks..];
        let digits =
            rest.iter().map(|byte| byte.wrapping_sub(b'0')).take_while(|digit| *digit < 10);
        let mut length = 0;
        for digit in digits.take(DIGITS_MAX + 1) {
            *corner = 10 * *corner + usize::from(digit);
            length += 1;
        }
        if blanks == 0 || !(1..=DIGITS_MAX).contains(&length) {
            return None;
        }
        rest = &rest[length..];
    }
    rest.is_empty().then_some(corners)
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

/// The first word of a trimmed statement.
pub(super) fn keyword(statement: &[u8]) -> &[u8] {
    statement.split(u8::is_ascii_whitespace).next().unwrap_or_default()
}

/// Whether a trimmed statement is a point or a face.
fn is_geometry(statement: &[u8]) -> bool {
    match statement {
        [b'v' | b'f', next, ..] => next.is_ascii_whitespace(),
        [b'v' | b'f'] => true,
        _ => false,
    }
}

/// Refuses a text whose first statement is not an OBJ statement.
///
/// # Errors
/// [`ScanFault::NotThisFormat`] with that statement.
pub(super) fn refuse_others(bytes: &[u8]) -> Result<(), ScanFault> {
    let mut statements = numbered(bytes).filter(|(_, line)| !line.starts_with(b"#"));
    match statements.next() {
        Some((line, found)) if !STATEMENTS.iter().any(|s| s.as_bytes() == keyword(found)) => {
            Err(ScanFault::NotThisFormat { format: Format::Obj, line, found: excerpt(found) })
        }
        _ => Ok(()),
    }
}

/// Calls `each` with every `v` and `f` statement, trimmed, and its first line. A `\` at the end of such
/// a line continues it on the next one; in names it is an ordinary character, as in Windows paths.
///
/// # Errors
/// The fault of `each`; [`ScanFault::CutShort`] if the last line expects a continuation.
pub(super) fn each_geometry(
    bytes: &[u8],
    mut each: impl FnMut(usize, &[u8]) -> Result<(), ScanFault>,
) -> Result<(), ScanFault> {
    let mut joined = Vec::new();
    let mut start = 0;
    for (number, line) in numbered(bytes) {
        if joined.is_empty() && !is_geometry(line) {
            continue;
        }
        if joined.is_empty() {
            start = number;
        }
        if let Some(part) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(part);
            joined.push(b' ');
        } else if joined.is_empty() {
            each(start, line)?;
        } else {
            joined.extend_from_slice(line);
            each(start, joined.trim_ascii())?;
            joined.clear();
        }
    }
    if joined.is_empty() {
        return Ok(());
    }
    Err(cut_short(CutSign::NoLineEnd { line: start }))
}

/// The end of the `count`-th word of a trimmed statement.
fn end_of_word(statement: &[u8], count: usize) -> usize {
    let mut seen = 0;
    let mut within = false;
    for (at, byte) in statement.iter().enumerate() {
        if byte.is_ascii_whitespace() {
            within = false;
            if seen == count {
                return at;
            }
        } else if !within {
            within = true;
            seen += 1;
        }
    }
    statement.len()
}
