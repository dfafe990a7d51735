//! Lines as nearly every exporter writes them, read in one pass over their bytes: `v 1.5 2 -3` and `f 1 2 3`, with
//! spaces only and LF or CR LF. All others are for what knows the whole format.

use super::lines::WORDS_OF_POINT;

/// What comes after the line of a point without colours that a text begins with; `None` for another line, also for a
/// number with an exponent or a comma.
pub(super) fn plain_point(text: &[u8]) -> Option<&[u8]> {
    // In ASCII these are `-`, `.`, `/` and the digits; tobj refuses a number with a `/`.
    let is_of_number = |byte: &u8| (b'-'..=b'9').contains(byte);
    let mut rest = text.strip_prefix(b"v")?;
    for _ in 1..WORDS_OF_POINT {
        let word = after_spaces(rest)?;
        let length = word.iter().position(|byte| !is_of_number(byte))?;
        rest = (length > 0).then(|| &word[length..])?;
    }
    after_line_end(rest)
}

/// The 0-based points of the triangle whose line a text begins with, and what comes after it; `None` for another
/// line, also for corners that count back or have a `/`.
pub(super) fn plain_triangle(text: &[u8]) -> Option<([usize; 3], &[u8])> {
    let mut rest = text.strip_prefix(b"f")?;
    let mut points = [0; 3];
    for point in &mut points {
        let (number, after) = whole_number(after_spaces(rest)?)?;
        *point = number.checked_sub(1)?;
        rest = after;
    }
    Some((points, after_line_end(rest)?))
}

/// The number in digits that a text begins with, and what comes after it: a third of the instructions of the
/// standard library's, for each corner of a scan.
pub(super) fn whole_number(text: &[u8]) -> Option<(usize, &[u8])> {
    let (mut number, mut rest) = (0_usize, text);
    while let [digit @ b'0'..=b'9', after @ ..] = rest {
        number = number.checked_mul(10)?.checked_add(usize::from(digit - b'0'))?;
        rest = after;
    }
    (rest.len() < text.len()).then_some((number, rest))
}

/// What comes after at least one space.
fn after_spaces(text: &[u8]) -> Option<&[u8]> {
    let mut rest = text.strip_prefix(b" ")?;
    while let [b' ', after @ ..] = rest {
        rest = after;
    }
    Some(rest)
}

fn after_line_end(text: &[u8]) -> Option<&[u8]> {
    let text = after_spaces(text).unwrap_or(text);
    text.strip_prefix(b"\n").or_else(|| text.strip_prefix(b"\r\n"))
}
