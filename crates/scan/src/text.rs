//! Common parts of all text formats: lines, words, numbers, and detection of binary content.

use nalgebra::Point3;

use super::fault::{CutSign, ScanFault, SourcePosition, cut_short, malformed};

/// The mark that some editors and exporters put before UTF-8 text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Maximum length of the excerpt of a faulty statement in an error, characters.
const EXCERPT_CHARS: usize = 40;

/// Maximum length of a number with a decimal comma, characters. No exporter writes more than 25 digits.
const COMMA_NUMBER_CHARS: usize = 64;

/// The smallest hole that disks and shares leave in a file, bytes.
pub(super) const SECTOR_BYTES: usize = 512;

/// The text without its UTF-8 byte order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// Whether there is only white space.
pub(super) fn is_blank(bytes: &[u8]) -> bool {
    without_mark(bytes).iter().all(u8::is_ascii_whitespace)
}

/// The lines of a text without their line ends: LF, CR LF or, as on old Macs, CR alone.
pub(super) fn lines(text: &[u8]) -> Lines<'_> {
    Lines { rest: text, passed: 0 }
}

/// See [`lines`].
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    passed: usize,
}

impl<'a> Lines<'a> {
    /// What has not been read yet.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Number of lines read so far.
    pub(super) fn passed(&self) -> usize {
        self.passed
    }

    /// Continues with this rest, after this many lines that were read in another way.
    pub(super) fn pass(&mut self, lines: usize, rest: &'a [u8]) {
        self.passed += lines;
        self.rest = rest;
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let (line, after) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = after.strip_prefix(b"\r\n").unwrap_or(after.get(1..).unwrap_or_default());
        self.passed += 1;
        Some(line)
    }
}

/// The non-blank lines, without surrounding white space, with their 1-based numbers.
pub(super) fn numbered(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let trimmed = lines(text).enumerate().map(|(index, line)| (index + 1, line.trim_ascii()));
    trimmed.filter(|(_, line)| !line.is_empty())
}

/// The words of a line, separated by white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Refuses bytes that do not occur in text exports.
///
/// # Errors
/// [`ScanFault::Binary`] with the first such byte; [`ScanFault::CutShort`] if it begins space that
/// was reserved and is not written yet.
pub(super) fn refuse_binary(bytes: &[u8]) -> Result<(), ScanFault> {
    if !bytes.iter().fold(false, |any, &byte| any | is_binary(byte)) {
        return Ok(());
    }
    match bytes.iter().position(|&byte| is_binary(byte)) {
        Some(at) => Err(unwritten(bytes, at).unwrap_or(ScanFault::Binary { at, value: bytes[at] })),
        None => Ok(()),
    }
}

/// The fault of reserved but unwritten zeros from `at` on: up to the end of the file, or at least a
/// disk sector of them, because copying may write blocks in any order.
fn unwritten(bytes: &[u8], at: usize) -> Option<ScanFault> {
    let zeros = bytes[at..].iter().take_while(|&&byte| byte == 0).count();
    if zeros == 0 {
        None
    } else if at + zeros == bytes.len() {
        Some(cut_short(CutSign::Unwritten { bytes: zeros }))
    } else {
        (zeros >= SECTOR_BYTES).then(|| cut_short(CutSign::Hole { at, bytes: zeros }))
    }
}

/// Refuses a file that ends in reserved but unwritten space, whatever comes before it.
///
/// # Errors
/// [`ScanFault::CutShort`] if it ends in at least a disk sector of zeros.
pub(super) fn refuse_reserved(bytes: &[u8]) -> Result<(), ScanFault> {
    let zeros = bytes.iter().rev().take_while(|&&byte| byte == 0).count();
    if zeros < SECTOR_BYTES {
        return Ok(());
    }
    Err(cut_short(CutSign::Unwritten { bytes: zeros }))
}

/// Checks that the last line of a text has a line end.
///
/// # Errors
/// [`ScanFault::CutShort`] if it has none.
pub(super) fn refuse_open_line(bytes: &[u8]) -> Result<(), ScanFault> {
    if bytes.ends_with(b"\n") || bytes.ends_with(b"\r") {
        return Ok(());
    }
    Err(cut_short(CutSign::NoLineEnd { line: lines(bytes).count() }))
}

/// Control characters that do not occur in text exports; the Ctrl-Z end mark of old systems is allowed.
pub(super) fn is_binary(byte: u8) -> bool {
    const CTRL_Z: u8 = 0x1a;
    const DELETE: u8 = 0x7f;
    // Branch-free, because this runs for every byte of every text.
    let is_white = (b'\t'..=b'\r').contains(&byte);
    ((byte < b' ') & !is_white & (byte != CTRL_Z)) | (byte == DELETE)
}

/// The beginning of a statement, printable ASCII only, so that it cannot inject anything into a log.
pub(super) fn excerpt(bytes: &[u8]) -> String {
    let printable = |&b: &u8| if b.is_ascii_graphic() || b == b' ' { b as char } else { '?' };
    bytes.iter().take(EXCERPT_CHARS).map(printable).collect()
}

/// A non-finite binary number, spelled as in text formats.
pub(super) fn spelled(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { value.to_string() }
}

/// A whole number in decimal digits.
pub(super) fn whole<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Reads numbers with a decimal point or a decimal comma, but not both in one file: if both occur,
/// one of them may be a thousands separator, which is ambiguous.
#[derive(Debug, Default)]
pub(super) struct Decimals {
    /// Line of the first number with a point.
    point: Option<usize>,
    /// Line of the first number with a comma.
    comma: Option<usize>,
}

impl Decimals {
    /// Parses a word of a line as a coordinate.
    ///
    /// # Errors
    /// [`ScanFault::NotFinite`] for the substitutes that exporters write for missing numbers, and
    /// [`ScanFault::Malformed`] for anything else that is not a number.
    pub(super) fn number(&mut self, word: &[u8], line: usize) -> Result<f64, ScanFault> {
        let parsed = std::str::from_utf8(word).ok().and_then(|text| text.parse::<f64>().ok());
        let value = match parsed {
            Some(value) => {
                if self.point.is_none() && word.contains(&b'.') {
                    self.point = Some(line);
                    self.refuse_both()?;
                }
                value
            }
            None => {
                let value = with_comma(word).ok_or_else(|| no_number(word, line))?;
                if self.comma.is_none() {
                    self.comma = Some(line);
                    self.refuse_both()?;
                }
                value
            }
        };
        if value.is_finite() { Ok(value) } else { Err(not_finite(word, line)) }
    }

    /// The point of the first three words.
    pub(super) fn point<'a>(
        &mut self,
        mut words: impl Iterator<Item = &'a [u8]>,
        line: usize,
    ) -> Result<Point3<f64>, ScanFault> {
        let mut next = || match words.next() {
            Some(word) => self.number(word, line),
            None => Err(malformed(line, "fewer than three coordinates")),
        };
        Ok(Point3::new(next()?, next()?, next()?))
    }

    fn refuse_both(&self) -> Result<(), ScanFault> {
        let (Some(point), Some(comma)) = (self.point, self.comma) else { return Ok(()) };
        let what = format!(
            "a decimal point or comma, but line {} has the other; export with one of them",
            point.min(comma)
        );
        Err(malformed(point.max(comma), what))
    }
}

/// Parses a word with one decimal comma and no point. Digits must be on both sides: in `1 ,2 ,3`
/// the commas separate columns.
fn with_comma(word: &[u8]) -> Option<f64> {
    let mut text = [0; COMMA_NUMBER_CHARS];
    let text = text.get_mut(..word.len())?;
    text.copy_from_slice(word);
    let comma = text.iter().position(|&b| b == b',')?;
    let is_digit = |at: usize| text.get(at).is_some_and(u8::is_ascii_digit);
    if text.contains(&b'.') || !is_digit(comma.checked_sub(1)?) || !is_digit(comma + 1) {
        return None;
    }
    text[comma] = b'.';
    std::str::from_utf8(text).ok()?.parse().ok()
}

fn not_finite(word: &[u8], line: usize) -> ScanFault {
    ScanFault::NotFinite { place: SourcePosition::Line(line), found: excerpt(word) }
}

/// Microsoft's library writes `-1.#IND` and `1.#QNAN`, glibc `-nan(0x1)`.
fn no_number(word: &[u8], line: usize) -> ScanFault {
    let lower = word.to_ascii_lowercase();
    if lower.contains(&b'#') || lower.windows(3).any(|part| part == b"nan") {
        return not_finite(word, line);
    }
    malformed(line, format!("\"{}\" is not a number", excerpt(word)))
}

#[cfg(test)]
mod tests;
