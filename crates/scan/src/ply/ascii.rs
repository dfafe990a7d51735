//! The elements of a text PLY: one record per line; blank lines are ignored.

use super::super::fault::{ScanFault, SourcePosition, malformed};
use super::super::text::{self, Decimals, excerpt};
use super::header::{Header, Scalar};
use super::values::{Record, Values};

/// Number of non-blank lines after the header.
pub(super) fn line_count(bytes: &[u8], header: &Header) -> usize {
    text::numbered(&bytes[header.end..]).count()
}

/// The records of a text.
pub(super) struct Lines<'a> {
    lines: text::Lines<'a>,
    /// The rest of the current line.
    rest: &'a [u8],
    /// Its 1-based number.
    line: usize,
    /// Number of lines of the header.
    header_lines: usize,
    decimals: Decimals,
}

impl<'a> Lines<'a> {
    /// The records after a header.
    pub(super) fn after_header(bytes: &'a [u8], header: &Header) -> Lines<'a> {
        Lines {
            lines: text::lines(&bytes[header.end..]),
            rest: b"",
            line: 0,
            header_lines: header.line_count,
            decimals: Decimals::default(),
        }
    }

    fn word(&mut self) -> Result<&'a [u8], ScanFault> {
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest.trim_ascii_start();
        if word.is_empty() {
            return Err(malformed(self.line, "fewer numbers than the header says"));
        }
        Ok(word)
    }
}

impl Values for Lines<'_> {
    fn begin(&mut self, record: Record) -> Result<(), ScanFault> {
        let next = self.lines.by_ref().map(<[u8]>::trim_ascii).find(|line| !line.is_empty());
        self.rest = next.ok_or_else(|| record.element.missing(record.number - 1))?;
        self.line = self.header_lines + self.lines.passed();
        Ok(())
    }

    fn coordinate(&mut self, _: Scalar, _: Record) -> Result<f64, ScanFault> {
        let word = self.word()?;
        self.decimals.number(word, self.line)
    }

    fn whole(&mut self, _: Scalar, _: Record) -> Result<i64, ScanFault> {
        let word = self.word()?;
        let fault = || malformed(self.line, format!("\"{}\" is no whole number", excerpt(word)));
        text::whole(word).ok_or_else(fault)
    }

    fn skip(&mut self, _: Scalar, count: usize, _: Record) -> Result<(), ScanFault> {
        (0..count).try_for_each(|_| self.word().map(|_| ()))
    }

    fn end(&mut self, _: Record) -> Result<(), ScanFault> {
        if self.rest.is_empty() {
            return Ok(());
        }
        let what = format!("\"{}\" is more than the header says", excerpt(self.rest));
        Err(malformed(self.line, what))
    }

    fn place(&self, _: Record) -> SourcePosition {
        SourcePosition::Line(self.line)
    }
}
