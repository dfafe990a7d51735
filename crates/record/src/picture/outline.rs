//! Outlines of glyphs: reads a simple `glyf` entry as lines and parabolas.
//! Source: OpenType 1.9.1, `glyf`, "Simple Glyph Description".

/// A piece of an outline. Each contour is closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// The start of a contour.
    Start([f64; 2]),
    /// A straight line to this point.
    Line([f64; 2]),
    /// A parabola with this control point, to the second point.
    Parabola([f64; 2], [f64; 2]),
}

/// Bits of a point's flag.
const ON_CURVE: u8 = 0x01;
const X_SHORT: u8 = 0x02;
const Y_SHORT: u8 = 0x04;
const REPEAT: u8 = 0x08;
const X_SAME_OR_POSITIVE: u8 = 0x10;
const Y_SAME_OR_POSITIVE: u8 = 0x20;

/// Count of contours and bounding box.
const HEADER_BYTES: usize = 10;

/// All contours of a glyph; `None` if the bytes are not a simple glyph.
pub(super) fn segments(glyph: &[u8]) -> Option<Vec<Segment>> {
    if glyph.is_empty() {
        return Some(Vec::new());
    }
    let mut bytes = Bytes { rest: glyph.get(HEADER_BYTES..)? };
    // A negative count would be a composite glyph.
    let contours = u16::from_be_bytes([glyph[0], glyph[1]]);
    let contours = if contours > i16::MAX as u16 { return None } else { contours };
    let ends = (0..contours).map(|_| bytes.word()).collect::<Option<Vec<_>>>()?;
    let hints = usize::from(bytes.word()?);
    bytes.rest = bytes.rest.get(hints..)?;
    let count = ends.last().map_or(0, |end| usize::from(*end) + 1);
    let flags = bytes.flags(count)?;
    let xs = bytes.places(&flags, X_SHORT, X_SAME_OR_POSITIVE)?;
    let ys = bytes.places(&flags, Y_SHORT, Y_SAME_OR_POSITIVE)?;
    let point = |index: usize| Point {
        at: [xs[index], ys[index]].map(f64::from),
        is_on: flags[index] & ON_CURVE != 0,
    };
    let mut drawn = Vec::new();
    let mut first = 0;
    for end in ends {
        let contour: Vec<Point> = (first..=usize::from(end)).map(point).collect();
        contour_of(&contour, &mut drawn);
        first = usize::from(end) + 1;
    }
    Some(drawn)
}

#[derive(Clone, Copy)]
struct Point {
    at: [f64; 2],
    is_on: bool,
}

/// Midway between two consecutive control points lies a point of the curve.
fn contour_of(points: &[Point], drawn: &mut Vec<Segment>) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    let middle = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|axis| f64::midpoint(a[axis], b[axis]));
    let start = match (first.is_on, last.is_on) {
        (true, _) => first.at,
        (false, true) => last.at,
        (false, false) => middle(first.at, last.at),
    };
    drawn.push(Segment::Start(start));
    let mut control = None;
    for point in points.iter().skip(usize::from(first.is_on)) {
        match (control, point.is_on) {
            (None, true) => drawn.push(Segment::Line(point.at)),
            (None, false) => control = Some(point.at),
            (Some(by), true) => {
                drawn.push(Segment::Parabola(by, point.at));
                control = None;
            }
            (Some(by), false) => {
                drawn.push(Segment::Parabola(by, middle(by, point.at)));
                control = Some(point.at);
            }
        }
    }
    drawn.extend(control.map(|by| Segment::Parabola(by, start)));
}

/// The unread bytes.
struct Bytes<'a> {
    rest: &'a [u8],
}

impl Bytes<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(*first)
    }

    fn word(&mut self) -> Option<u16> {
        Some(u16::from_be_bytes([self.byte()?, self.byte()?]))
    }

    fn flags(&mut self, count: usize) -> Option<Vec<u8>> {
        let mut flags = Vec::with_capacity(count);
        while flags.len() < count {
            let flag = self.byte()?;
            let again = if flag & REPEAT != 0 { self.byte()? } else { 0 };
            flags.extend((0..=again).map(|_| flag));
        }
        (flags.len() == count).then_some(flags)
    }

    /// One coordinate of all points, from the steps between them.
    fn places(&mut self, flags: &[u8], short: u8, same_or_positive: u8) -> Option<Vec<i16>> {
        let mut place = 0_i16;
        let mut next = |flag: &u8| {
            let is_set = |bit: u8| flag & bit != 0;
            let way = match (is_set(short), is_set(same_or_positive)) {
                (true, true) => i16::from(self.byte()?),
                (true, false) => -i16::from(self.byte()?),
                (false, true) => 0,
                (false, false) => self.word()?.cast_signed(),
            };
            place = place.wrapping_add(way);
            Some(place)
        };
        flags.iter().map(&mut next).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_three_lines_and_control_points_in_a_row_meet_in_their_middle() {
        let header = [0, 1, 0, 0, 0, 0, 0, 0, 0, 0];
        // Three points on the curve: (0, 0), (10, 0), (10, 20).
        let triangle = [[0, 2, 0, 0].as_slice(), &[0x31, 0x33, 0x35], &[10], &[20]].concat();
        let drawn = segments(&[header.as_slice(), &triangle].concat()).unwrap();
        let [a, b, c] = [[0.0, 0.0], [10.0, 0.0], [10.0, 20.0]];
        assert_eq!(drawn, [Segment::Start(a), Segment::Line(b), Segment::Line(c)]);
        // The same with the second and the third as control points.
        let bent = [[0, 2, 0, 0].as_slice(), &[0x31, 0x32, 0x34], &[10], &[20]].concat();
        let drawn = segments(&[header.as_slice(), &bent].concat()).unwrap();
        let curves = [Segment::Parabola(b, [10.0, 10.0]), Segment::Parabola(c, a)];
        assert_eq!(drawn, [vec![Segment::Start(a)], curves.to_vec()].concat());
    }

    #[test]
    fn bytes_that_end_too_early_or_are_of_parts_are_no_outline() {
        assert_eq!(segments(&[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0x31]), None);
        assert_eq!(segments(&[0xFF, 0xFF, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]), None);
    }
}
