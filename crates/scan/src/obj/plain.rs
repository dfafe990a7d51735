//! The two usual lines of an OBJ file, such as `v 1.5 -2 3e-4` and `f 1 2 3`, recognised in one pass.
//!
//! Nearly every line of an export is one of these. Whatever differs in the least, be it a decimal
//! comma, a continued line or a negative corner, is left to the general reader of statements; so are
//! the last bytes of a file. The words of a line are read in windows of eight bytes, with one operation
//! on all of them at once. Both functions are inlined, because they return much for so little work.

/// A line with a point.
pub(super) struct PointLine {
    /// Length of `v` and its three coordinates; colours after them do not count.
    pub statement: usize,
    /// Length of the line with its line end.
    pub line: usize,
}

/// A line with a face.
pub(super) struct FaceLine {
    /// The three corners as written, 1-based.
    pub corners: [usize; 3],
    /// Length of the line with its line end.
    pub line: usize,
}

/// The line with a point at the start of a text, if it is a plain one. Its words are of printable ASCII
/// without commas and backslashes; whether they are numbers is not checked.
#[inline]
pub(super) fn point(text: &[u8]) -> Option<PointLine> {
    let mut cursor = Cursor { text, at: 0 };
    cursor.pass(b'v')?;
    for _ in 0..3 {
        cursor.pass_blanks()?;
        cursor.pass_word()?;
    }
    let statement = cursor.at;
    while cursor.pass_line_end().is_none() {
        cursor.pass_blanks()?;
        // After the last word there may still be blanks.
        let _ = cursor.pass_word();
    }
    Some(PointLine { statement, line: cursor.at })
}

/// The line with a face at the start of a text, if it is a plain one: a triangle whose corners are
/// whole numbers, each perhaps followed by those of a texture coordinate and a normal, as in `1/1/1`.
#[inline]
pub(super) fn face(text: &[u8]) -> Option<FaceLine> {
    let mut cursor = Cursor { text, at: 0 };
    cursor.pass(b'f')?;
    let mut corners = [0; 3];
    for corner in &mut corners {
        *corner = cursor.corner()?;
        if cursor.next() == b'/' {
            cursor.pass_word()?;
        }
    }
    if cursor.pass_line_end().is_none() {
        cursor.pass_blanks()?;
        cursor.pass_line_end()?;
    }
    Some(FaceLine { corners, line: cursor.at })
}

/// A place in a text, and the parts of a line that may come next.
struct Cursor<'a> {
    text: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    /// The next byte; at the end one that no line contains.
    fn next(&self) -> u8 {
        self.text.get(self.at).copied().unwrap_or(0)
    }

    /// The next eight bytes, the first of them lowest.
    fn window(&self) -> Option<u64> {
        let window = self.text.get(self.at..)?.first_chunk()?;
        Some(u64::from_le_bytes(*window))
    }

    /// Passes this byte.
    fn pass(&mut self, byte: u8) -> Option<()> {
        let is_next = self.next() == byte;
        self.at += usize::from(is_next);
        is_next.then_some(())
    }

    /// Passes blanks, at least one.
    fn pass_blanks(&mut self) -> Option<()> {
        let start = self.at;
        while matches!(self.next(), b' ' | b'\t') {
            self.at += 1;
        }
        (self.at > start).then_some(())
    }

    /// Passes LF or CR LF.
    fn pass_line_end(&mut self) -> Option<()> {
        self.pass(b'\n').or_else(|| {
            let is_next = self.text.get(self.at..)?.starts_with(b"\r\n");
            self.at += if is_next { 2 } else { 0 };
            is_next.then_some(())
        })
    }

    /// Passes a word of printable ASCII without commas and backslashes. These may also be found in the
    /// next few bytes after a word; it is then refused too, which costs nothing but time.
    fn pass_word(&mut self) -> Option<()> {
        let start = self.at;
        loop {
            let window = self.window()?;
            let refused = equal(window, b',') | equal(window, b'\\') | window & HIGHEST_BITS;
            if refused != 0 {
                return None;
            }
            let ends = below(window, b' ' + 1);
            self.at += first(ends);
            if ends != 0 {
                return (self.at > start).then_some(());
            }
        }
    }

    /// Reads spaces and a whole number of up to seven digits.
    fn corner(&mut self) -> Option<usize> {
        const SPACE: u64 = b' ' as u64;
        let mut window = self.window()?;
        while window & 0xffff == SPACE << 8 | SPACE {
            self.at += 1;
            window = self.window()?;
        }
        // The last byte is now no digit, so the number ends within the window.
        let digits = (window >> 8) ^ each(b'0');
        let length = first((digits.wrapping_add(each(0x7f - 9)) | digits) & HIGHEST_BITS);
        if window & 0xff != SPACE || length == 0 {
            return None;
        }
        self.at += 1 + length;
        // Zeros come before the digits; then pairs of digits become numbers, and pairs of these.
        let ones = digits << (8 * (WINDOW_BYTES - length));
        let hundreds = (10 * ones).wrapping_add(ones >> 8) & 0x00ff_00ff_00ff_00ff;
        let thousands = (100 * hundreds).wrapping_add(hundreds >> 16) & 0x0000_ffff_0000_ffff;
        let number = (10_000 * thousands).wrapping_add(thousands >> 32) as u32;
        Some(number as usize)
    }
}

/// Number of bytes read at once.
const WINDOW_BYTES: usize = 8;

/// The highest bit of each byte of a window. It marks bytes; in ASCII it is free for that.
const HIGHEST_BITS: u64 = each(0x80);

/// A window of eight times the same byte.
const fn each(byte: u8) -> u64 {
    u64::from_le_bytes([byte; WINDOW_BYTES])
}

/// Marks the bytes below a limit. Only the first mark is certain: it may borrow from the next byte.
fn below(window: u64, limit: u8) -> u64 {
    window.wrapping_sub(each(limit)) & !window & HIGHEST_BITS
}

/// Marks the bytes equal to this one; as certain as in [`below`].
fn equal(window: u64, byte: u8) -> u64 {
    below(window ^ each(byte), 1)
}

/// The place of the first mark; after the window if there is none.
fn first(marks: u64) -> usize {
    marks.trailing_zeros() as usize / 8
}

#[cfg(test)]
mod tests;
