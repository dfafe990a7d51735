//! The lines of a GDT message: written with their lengths, and read with a fault for every mistake.

use super::charset::{Charset, Unwritable};

/// Bytes of a line besides its content: length, field and end.
const FRAME: usize = 9;

/// The end of a line.
const END: &[u8] = b"\r\n";

/// The longest line, bytes: its length has three digits.
const LINE_MOST: usize = 999;

/// The longest message, bytes: its length has five digits.
const MESSAGE_MOST: usize = 99_999;

/// The field of the first line: the kind of message.
pub(super) const KIND: u16 = 8000;

/// The field of the second line: the length of the whole message.
pub(super) const TOTAL: u16 = 8100;

/// The end mark of DOS files, which may follow the last line.
const DOS_END: u8 = 0x1a;

/// The byte order mark of UTF-8, with which some programs begin a message.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Why a message cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum WriteFault {
    /// A character cannot be written.
    #[error("field {field:04}: {why}")]
    Unwritable {
        /// The field.
        field: u16,
        /// The character and the set.
        why: Unwritable,
    },
    /// A line is too long.
    #[error("field {field:04} would make a line of {bytes} bytes, GDT allows {LINE_MOST}")]
    Line {
        /// The field.
        field: u16,
        /// Length of the line, bytes.
        bytes: usize,
    },
    /// The whole message is too long.
    #[error("the message would have {bytes} bytes, GDT allows {MESSAGE_MOST}")]
    Message {
        /// Length of the message, bytes.
        bytes: usize,
    },
}

/// Writes a message of this kind, such as `6310`, with these fields after its kind and length.
///
/// # Errors
/// See [`WriteFault`].
pub fn message(
    kind: u16,
    charset: Charset,
    fields: &[(u16, String)],
) -> Result<Vec<u8>, WriteFault> {
    let mut rest = Vec::new();
    for (field, content) in fields {
        push(&mut rest, *field, content, charset)?;
    }
    let mut whole = Vec::with_capacity(rest.len() + 64);
    push(&mut whole, KIND, &format!("{kind:04}"), charset)?;
    let bytes = whole.len() + FRAME + 5 + rest.len();
    if bytes > MESSAGE_MOST {
        return Err(WriteFault::Message { bytes });
    }
    push(&mut whole, TOTAL, &format!("{bytes:05}"), charset)?;
    whole.extend(rest);
    Ok(whole)
}

fn push(out: &mut Vec<u8>, field: u16, content: &str, charset: Charset) -> Result<(), WriteFault> {
    let content = charset.encode(content).map_err(|why| WriteFault::Unwritable { field, why })?;
    let bytes = content.len() + FRAME;
    if bytes > LINE_MOST {
        return Err(WriteFault::Line { field, bytes });
    }
    out.extend(format!("{bytes:03}{field:04}").bytes());
    out.extend(content);
    out.extend(END);
    Ok(())
}

/// One line of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line<'a> {
    /// Number of the line, from 1.
    pub number: usize,
    /// The field, as a number of four digits.
    pub field: u16,
    /// The content.
    pub content: &'a [u8],
}

/// A mistake in the lines of a message. No text quotes their content, because it may be a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineFault {
    /// There is no line.
    Empty,
    /// A line does not begin with a length and a field.
    Frame {
        /// Number of the line.
        line: usize,
    },
    /// The length of a line differs from its length field.
    Length {
        /// Number of the line.
        line: usize,
        /// Length according to the field, bytes.
        said: usize,
        /// Actual length with the line end, bytes.
        found: usize,
    },
}

/// The length of the byte order mark of a message, and what follows it.
pub(super) fn unmarked(bytes: &[u8]) -> (usize, &[u8]) {
    bytes.strip_prefix(MARK).map_or((0, bytes), |rest| (MARK.len(), rest))
}

/// Reads the lines of a message. If strict, every line must have the length in its length field. If not,
/// lengths are ignored, and a line feed alone also ends a line. The last line may lack its end. The
/// first line may have a byte order mark, which its length may count or not.
///
/// # Errors
/// The first [`LineFault`].
pub fn read(bytes: &[u8], strict: bool) -> Result<Vec<Line<'_>>, LineFault> {
    let (mut mark, bytes) = unmarked(bytes);
    let mut rest = bytes.strip_suffix(&[DOS_END]).unwrap_or(bytes);
    if !strict {
        while let Some(shorter) = rest.strip_suffix(b"\n").or(rest.strip_suffix(b"\r")) {
            rest = shorter;
        }
    }
    let mut lines = Vec::new();
    while !rest.is_empty() {
        let (whole, later) = split(rest, strict);
        rest = later;
        lines.push(line(lines.len() + 1, whole, std::mem::take(&mut mark), strict)?);
    }
    if lines.is_empty() { Err(LineFault::Empty) } else { Ok(lines) }
}

/// Splits off the first line without its end.
fn split(bytes: &[u8], strict: bool) -> (&[u8], &[u8]) {
    let end = if strict { END } else { b"\n" };
    let at = bytes.windows(end.len()).position(|window| window == end);
    let (line, later) = at.map_or((bytes, &[][..]), |at| (&bytes[..at], &bytes[at + end.len()..]));
    (if strict { line } else { line.strip_suffix(b"\r").unwrap_or(line) }, later)
}

/// Reads a line of which `mark` bytes were taken away before.
fn line(number: usize, bytes: &[u8], mark: usize, strict: bool) -> Result<Line<'_>, LineFault> {
    let frame = LineFault::Frame { line: number };
    let (head, content) = bytes.split_at_checked(7).ok_or(frame)?;
    if !head.iter().all(u8::is_ascii_digit) {
        return Err(frame);
    }
    let digits = |digits: &[u8]| digits.iter().fold(0_u16, |n, d| n * 10 + u16::from(d - b'0'));
    let (said, found) = (usize::from(digits(&head[..3])), content.len() + FRAME);
    if strict && said != found && said != found + mark {
        return Err(LineFault::Length { line: number, said, found });
    }
    Ok(Line { number, field: digits(&head[3..]), content })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read_again() {
        let fields = [(3000, "4711".to_owned()), (6228, String::new()), (3101, "ÄÖ".to_owned())];
        for charset in [Charset::Cp437, Charset::Cp1252, Charset::Utf8] {
            let bytes = message(6310, charset, &fields).unwrap();
            let lines = read(&bytes, true).unwrap();
            assert_eq!(lines, read(&bytes, false).unwrap());
            assert_eq!(lines[0].content, b"6310");
            assert_eq!(lines[1].content, format!("{:05}", bytes.len()).as_bytes());
            let read: Vec<(u16, String)> = lines[2..]
                .iter()
                .map(|line| (line.field, charset.decode(line.content).unwrap()))
                .collect();
            assert_eq!(read, fields);
        }
    }

    #[test]
    fn a_line_or_message_too_long_for_its_digits_is_a_fault() {
        let of = |length: usize| (6227, "x".repeat(length));
        assert!(message(6310, Charset::Ascii, &[of(990)]).is_ok());
        let fault = message(6310, Charset::Ascii, &[of(991)]);
        assert_eq!(fault, Err(WriteFault::Line { field: 6227, bytes: 1000 }));
        let fault = message(6310, Charset::Ascii, &vec![of(990); 101]);
        assert_eq!(fault, Err(WriteFault::Message { bytes: 13 + 14 + 101 * 999 }));
    }

    #[test]
    fn a_length_that_is_not_the_line_s_is_told_with_its_figures() {
        let fault = read(b"013800063021\r\n", true);
        assert_eq!(fault, Err(LineFault::Length { line: 1, said: 13, found: 14 }));
        assert_eq!(read(b"0138000", true), Err(LineFault::Length { line: 1, said: 13, found: 9 }));
        assert_eq!(read(b"01380006302\r\nM\xfcller\r\n", true), Err(LineFault::Frame { line: 2 }));
        assert_eq!(read(b"", true), Err(LineFault::Empty));
        assert!(read(b"01380006302", true).is_ok(), "the last line may lack its end");
        assert!(read(b"01380006302\n01480100000\n\n", false).is_ok());
    }

    #[test]
    fn a_byte_order_mark_stands_before_the_first_line_only() {
        let plain = read(b"01380006302\r\n01330004711\r\n", true);
        for first in ["013", "016"] {
            let marked = format!("\u{feff}{first}80006302\r\n01330004711\r\n");
            assert_eq!(read(marked.as_bytes(), true), plain, "{first}");
            assert_eq!(read(marked.as_bytes(), false), plain, "{first}");
        }
        let fault = read("\u{feff}01480006302\r\n".as_bytes(), true);
        assert_eq!(fault, Err(LineFault::Length { line: 1, said: 14, found: 13 }));
        let second = read("01380006302\r\n\u{feff}01330004711\r\n".as_bytes(), false);
        assert_eq!(second, Err(LineFault::Frame { line: 2 }));
        let counted = read("\u{feff}01380006302\r\n01630004711\r\n".as_bytes(), true);
        assert_eq!(counted, Err(LineFault::Length { line: 2, said: 16, found: 13 }));
        assert_eq!(read("\u{feff}".as_bytes(), true), Err(LineFault::Empty));
    }
}
