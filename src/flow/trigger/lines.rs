//! Bytes of a serial port → lines, bounded whatever comes.

use std::time::Duration;

/// The longest line that is kept, bytes. Tokens and ids of patients are shorter by far.
pub const LINE_MOST: usize = 64;

/// How long the rest of a line is awaited. A box sends a line in one go, 64 bytes take 70 ms at
/// 9600 baud; what stops in the middle was cut off and must not be completed by the next press.
pub const HALF_LINE: Duration = Duration::from_millis(500);

/// Collects bytes until a carriage return or a line feed ends the line.
#[derive(Debug, Clone, Default)]
pub struct Lines {
    line: Vec<u8>,
    /// The line has become too long: what still comes of it is dropped.
    overlong: bool,
    last_byte: Duration,
    dropped: u64,
}

impl Lines {
    /// Takes bytes that were read by `now`; gives the lines that they end, without their ends and
    /// without empty ones, of which each pair of carriage return and line feed makes one.
    pub fn take(&mut self, bytes: &[u8], now: Duration) -> Vec<Vec<u8>> {
        self.tick(now);
        let mut lines = Vec::new();
        for byte in bytes {
            match byte {
                b'\r' | b'\n' => {
                    let line = std::mem::take(&mut self.line);
                    let whole = !std::mem::take(&mut self.overlong) && !line.is_empty();
                    lines.extend(whole.then_some(line));
                }
                _ if self.overlong => self.dropped += 1,
                _ if self.line.len() == LINE_MOST => {
                    self.drop_line();
                    self.dropped += 1;
                    self.overlong = true;
                }
                byte => self.line.push(*byte),
            }
        }
        self.last_byte = now;
        lines
    }

    /// Drops half a line whose rest has not come.
    pub fn tick(&mut self, now: Duration) {
        if self.due().is_some_and(|due| now >= due) {
            self.drop_line();
            self.overlong = false;
        }
    }

    /// When half a line is dropped; none where there is none.
    pub fn due(&self) -> Option<Duration> {
        let half = self.overlong || !self.line.is_empty();
        half.then(|| self.last_byte + HALF_LINE)
    }

    /// Begins anew with what comes next; what was begun is not counted.
    pub fn clear(&mut self) {
        self.line.clear();
        self.overlong = false;
    }

    /// How many bytes were dropped since this was last asked.
    pub fn dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    fn drop_line(&mut self) {
        self.dropped += self.line.len() as u64;
        self.line.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::from_secs(1);

    #[test]
    fn any_of_three_line_ends_ends_one_line() {
        for end in ["\r", "\n", "\r\n"] {
            let text = format!("one{end}two{end}");
            let lines = Lines::default().take(text.as_bytes(), NOW);
            assert_eq!(lines, [b"one".to_vec(), b"two".to_vec()], "{end:?}");
        }
    }

    #[test]
    fn a_line_may_come_byte_by_byte() {
        let mut lines = Lines::default();
        let found: Vec<_> =
            b"PRESS\r\n".iter().flat_map(|byte| lines.take(&[*byte], NOW)).collect();
        assert_eq!(found, [b"PRESS".to_vec()]);
    }

    #[test]
    fn half_a_line_is_dropped_after_the_pause_and_the_next_is_whole() {
        let mut lines = Lines::default();
        assert!(lines.take(b"PRE", NOW).is_empty());
        assert_eq!(lines.due(), Some(NOW + HALF_LINE));
        assert_eq!(lines.take(b"PRESS\n", NOW + HALF_LINE), [b"PRESS".to_vec()]);
        assert_eq!((lines.dropped(), lines.dropped()), (3, 0));
        // Within the pause it is one line.
        lines.take(b"PRE", NOW * 2);
        assert_eq!(lines.take(b"SS\n", NOW * 2 + HALF_LINE / 2), [b"PRESS".to_vec()]);
    }

    #[test]
    fn a_line_that_is_too_long_is_dropped_to_its_end() {
        let mut lines = Lines::default();
        let long = [b'x'; LINE_MOST + 1];
        assert!(lines.take(&long, NOW).is_empty());
        assert!(lines.take(b"PRESS\n", NOW).is_empty(), "the tail of a long line is no line");
        assert_eq!(lines.dropped(), LINE_MOST as u64 + 6);
        assert_eq!(lines.take(b"PRESS\n", NOW), [b"PRESS".to_vec()]);
        assert_eq!(lines.take(&[[b'x'; LINE_MOST].as_slice(), b"\n"].concat(), NOW).len(), 1);
    }
}
