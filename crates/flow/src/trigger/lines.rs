//! Bytes of a serial port → lines, bounded for any input, and the lines that are presses.

use std::time::Duration;

use crate::booth::Press;

/// The longest line that is kept, bytes. Tokens and patients' ids are far shorter.
pub const LINE_MOST: usize = 64;

/// How long to wait for the rest of a line. A box sends a line in one go, 64 bytes take 70 ms at 9600
/// baud; a line that stops in the middle was cut off and must not be completed by the next press.
pub(super) const HALF_LINE: Duration = Duration::from_millis(500);

/// The outcome of one line, of bytes or of keys.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Line {
    /// It is complete; without its line end, and never empty.
    Whole(Vec<u8>),
    /// It became too long, stopped in the middle, or is not known as a whole: it is dropped, together
    /// with its tail.
    Dropped,
}

/// Collects bytes until a carriage return, a line feed or a byte of the sender's own ends the line.
#[derive(Debug, Clone, Default)]
pub(super) struct Lines {
    /// The sender's own end, which stays a part of the line.
    end: Option<u8>,
    line: Vec<u8>,
    /// The line was dropped: everything that follows up to its end is its tail, and not a line.
    in_tail: bool,
    last_byte: Duration,
    dropped: u64,
}

impl Lines {
    /// Collects lines that may end with this byte, too.
    pub fn ended_by(end: Option<u8>) -> Lines {
        Lines { end, ..Lines::default() }
    }

    /// Processes bytes that were read by `now`; returns the lines that they complete and those that are
    /// dropped. Empty lines are left out; each pair of carriage return and line feed makes one.
    pub fn take(&mut self, bytes: &[u8], now: Duration) -> Vec<Line> {
        let mut lines: Vec<Line> = self.tick(now).into_iter().collect();
        for byte in bytes {
            let is_line_end = matches!(byte, b'\r' | b'\n');
            match byte {
                _ if is_line_end => {}
                _ if self.in_tail => self.dropped += 1,
                _ if self.line.len() == LINE_MOST => {
                    lines.push(self.drop_line());
                    self.dropped += 1;
                }
                byte => self.line.push(*byte),
            }
            if is_line_end || self.end == Some(*byte) {
                self.in_tail = false;
                let line = std::mem::take(&mut self.line);
                lines.extend((!line.is_empty()).then_some(Line::Whole(line)));
            }
        }
        self.last_byte = now;
        lines
    }

    /// Drops half a line whose rest has not arrived.
    pub fn tick(&mut self, now: Duration) -> Option<Line> {
        self.due().filter(|due| now >= *due).map(|_| self.drop_line())
    }

    /// When half a line is dropped; `None` if there is none.
    pub fn due(&self) -> Option<Duration> {
        (!self.line.is_empty()).then(|| self.last_byte + HALF_LINE)
    }

    /// Starts again with the next byte; the unfinished line is not counted.
    pub fn clear(&mut self) {
        self.line.clear();
        self.in_tail = false;
    }

    /// Starts again with the next line; the unfinished line is not counted.
    pub fn pass_over(&mut self) {
        self.in_tail |= !self.line.is_empty();
        self.line.clear();
    }

    /// How many bytes were dropped since the last call.
    pub fn dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    fn drop_line(&mut self) -> Line {
        self.dropped += self.line.len() as u64;
        self.line.clear();
        self.in_tail = true;
        Line::Dropped
    }
}

/// The lines by which a button reports a press: exact matches only.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tokens {
    /// The lines of a short press.
    pub short: Vec<String>,
    /// The lines of a long press.
    pub long: Vec<String>,
}

impl Tokens {
    /// The press that a line means; `None` for any other line.
    pub fn press(&self, line: &[u8]) -> Option<Press> {
        let among = |tokens: &[String]| tokens.iter().any(|token| token.as_bytes() == line);
        if among(&self.short) {
            Some(Press::Short)
        } else {
            among(&self.long).then_some(Press::Long)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::from_secs(1);

    fn whole(line: &[u8]) -> Line {
        Line::Whole(line.to_vec())
    }

    #[test]
    fn any_of_three_line_ends_ends_one_line() {
        for end in ["\r", "\n", "\r\n"] {
            let text = format!("one{end}two{end}");
            let lines = Lines::default().take(text.as_bytes(), NOW);
            assert_eq!(lines, [whole(b"one"), whole(b"two")], "{end:?}");
        }
    }

    #[test]
    fn an_end_of_the_sender_s_own_ends_a_line_or_a_tail() {
        let mut lines = Lines::ended_by(Some(3));
        let found = lines.take(b"\x0247\x03\x0211\x03\r\n12\r", NOW);
        assert_eq!(found, [whole(b"\x0247\x03"), whole(b"\x0211\x03"), whole(b"12")]);
        lines.take(b"\x0247", NOW);
        assert_eq!(lines.tick(NOW + HALF_LINE), Some(Line::Dropped));
        assert_eq!(lines.take(b"11\x03\x024711\x03", NOW * 9), [whole(b"\x024711\x03")]);
        let long = [&[b'x'; LINE_MOST][..], b"\x03", b"1\x03"].concat();
        assert_eq!(lines.take(&long, NOW * 9), [Line::Dropped, whole(b"1\x03")]);
    }

    #[test]
    fn a_line_may_come_byte_by_byte() {
        let mut lines = Lines::default();
        let found: Vec<_> =
            b"PRESS\r\n".iter().flat_map(|byte| lines.take(&[*byte], NOW)).collect();
        assert_eq!(found, [whole(b"PRESS")]);
    }

    #[test]
    fn half_a_line_is_dropped_after_the_pause_with_its_tail_and_the_next_is_whole() {
        let mut lines = Lines::default();
        assert!(lines.take(b"5555", NOW).is_empty());
        assert_eq!(lines.due(), Some(NOW + HALF_LINE));
        assert_eq!(lines.tick(NOW + HALF_LINE), Some(Line::Dropped));
        assert_eq!((lines.due(), lines.tick(NOW * 9)), (None, None), "it is dropped once");
        assert_eq!(lines.take(b"10", NOW * 9), []);
        assert_eq!(lines.take(b"03\r\n", NOW * 20), [], "the tail, however late, is no line");
        assert_eq!((lines.dropped(), lines.dropped()), (8, 0));
        assert_eq!(lines.take(b"1003\r", NOW * 20), [whole(b"1003")]);
        // There was no tick in between.
        lines.take(b"PRE", NOW * 30);
        let both = lines.take(b"PRESS\nPRESS\n", NOW * 30 + HALF_LINE);
        assert_eq!(both, [Line::Dropped, whole(b"PRESS")]);
        // Within the pause it is one line.
        lines.take(b"PRE", NOW * 40);
        assert_eq!(lines.take(b"SS\n", NOW * 40 + HALF_LINE / 2), [whole(b"PRESS")]);
    }

    #[test]
    fn a_line_that_is_too_long_is_dropped_to_its_end() {
        let mut lines = Lines::default();
        let long = [b'x'; LINE_MOST + 1];
        assert_eq!(lines.take(&long, NOW), [Line::Dropped]);
        assert_eq!(lines.take(b"PRESS\n", NOW * 9), [], "the tail of a long line is no line");
        assert_eq!(lines.dropped(), LINE_MOST as u64 + 6);
        assert_eq!(lines.take(b"PRESS\n", NOW * 9), [whole(b"PRESS")]);
        assert_eq!(lines.take(&[[b'x'; LINE_MOST].as_slice(), b"\n"].concat(), NOW * 9).len(), 1);
    }

    #[test]
    fn a_line_is_begun_anew_with_what_comes_next_or_with_the_next_line() {
        let mut lines = Lines::default();
        lines.take(b"47", NOW);
        lines.clear();
        assert_eq!(lines.take(b"11\r", NOW), [whole(b"11")]);
        lines.take(b"47", NOW);
        lines.pass_over();
        assert_eq!((lines.due(), lines.take(b"11\r4711\r", NOW)), (None, vec![whole(b"4711")]));
        lines.pass_over();
        assert_eq!(lines.take(b"4711\r", NOW), [whole(b"4711")], "nothing was begun");
    }

    #[test]
    fn only_the_exact_line_is_a_press() {
        let tokens = Tokens { short: vec!["PRESS".into()], long: vec!["HOLD".into()] };
        assert_eq!(tokens.press(b"PRESS"), Some(Press::Short));
        assert_eq!(tokens.press(b"HOLD"), Some(Press::Long));
        for line in ["", "press", "PRESS ", " PRESS", "PRESSPRESS", "PRES", "AT", "\0PRESS"] {
            assert_eq!(tokens.press(line.as_bytes()), None, "{line:?}");
        }
    }
}
