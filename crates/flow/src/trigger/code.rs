//! A reader of barcodes or cards: a line of text, or keys that it types → an id.

use std::time::Duration;

use super::lines::{HALF_LINE, LINE_MOST, Line};

/// What a reader puts around an id.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Codes {
    /// Before it.
    pub prefix: String,
    /// After it.
    pub suffix: String,
}

/// What a line from a reader means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Said {
    /// This id.
    Id(String),
    /// An id that cannot be understood: the text in its place is empty or not plain text.
    Unread,
    /// Not for us: it lacks the prefix or suffix of an id.
    Nothing,
}

impl Codes {
    /// What a line means.
    pub fn said(&self, line: &[u8]) -> Said {
        let inside = line.strip_prefix(self.prefix.as_bytes());
        let inside = inside.and_then(|rest| rest.strip_suffix(self.suffix.as_bytes()));
        let Some(inside) = inside else { return Said::Nothing };
        let id = inside.trim_ascii();
        let plain = id.iter().all(|byte| byte.is_ascii_graphic() || *byte == b' ');
        match str::from_utf8(id) {
            Ok(id) if plain && !id.is_empty() => Said::Id(id.to_owned()),
            _ => Said::Unread,
        }
    }
}

// Keys by the numbers of Linux's input-event-codes.h.
const ENTER: u16 = 28;
const KEYPAD_ENTER: u16 = 96;
const SHIFTS: [u16; 2] = [42, 54];

/// The characters of keys in rows, starting with the key of this number; those of a US keyboard, which
/// is how readers leave the factory.
const ROWS: [(u16, &str, &str); 6] = [
    (2, "1234567890-=", "!@#$%^&*()_+"),
    (16, "qwertyuiop[]", "QWERTYUIOP{}"),
    (30, "asdfghjkl;'", "ASDFGHJKL:\""),
    (44, "zxcvbnm,./", "ZXCVBNM<>?"),
    (71, "789-456+1230.", "789-456+1230."),
    (57, " ", " "),
];

/// Collects what a reader types until it types Enter.
#[derive(Debug, Clone, Default)]
pub(super) struct Typed {
    text: String,
    /// The text was dropped: everything that follows up to Enter is its tail, and not a line.
    in_tail: bool,
    shift: bool,
    last_key: Duration,
    dropped: u64,
}

impl Typed {
    /// Processes a key that goes down or up; returns the line that Enter ends, and one that is dropped.
    pub fn key(&mut self, code: u16, down: bool, now: Duration) -> Vec<Line> {
        if SHIFTS.contains(&code) {
            self.shift = down;
            return Vec::new();
        }
        if !down {
            return Vec::new();
        }
        let mut lines: Vec<Line> = self.tick(now).into_iter().collect();
        self.last_key = now;
        if code == ENTER || code == KEYPAD_ENTER {
            self.in_tail = false;
            let text = std::mem::take(&mut self.text);
            lines.extend((!text.is_empty()).then(|| Line::Whole(text.into_bytes())));
            return lines;
        }
        match self.character(code) {
            Some(_) if self.in_tail => self.dropped += 1,
            Some(_) if self.text.len() == LINE_MOST => {
                lines.push(self.drop_text());
                self.dropped += 1;
            }
            Some(character) => self.text.push(character),
            None => self.dropped += 1,
        }
        lines
    }

    /// Drops half an id whose rest has not arrived: someone typed, or the reader lost its cable.
    pub fn tick(&mut self, now: Duration) -> Option<Line> {
        self.due().filter(|due| now >= *due).map(|_| self.drop_text())
    }

    /// When half an id is dropped.
    pub fn due(&self) -> Option<Duration> {
        (!self.text.is_empty()).then(|| self.last_key + HALF_LINE)
    }

    /// Starts anew with the next key.
    pub fn clear(&mut self) {
        self.text.clear();
        self.in_tail = false;
    }

    /// Starts anew with the next line.
    pub fn pass_over(&mut self) {
        self.in_tail |= !self.text.is_empty();
        self.text.clear();
    }

    /// How many keys were dropped since the last call.
    pub fn dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    fn drop_text(&mut self) -> Line {
        self.dropped += self.text.len() as u64;
        self.text.clear();
        self.in_tail = true;
        Line::Dropped
    }

    fn character(&self, code: u16) -> Option<char> {
        ROWS.iter().find_map(|(first, plain, shifted)| {
            let row = if self.shift { shifted } else { plain };
            row.chars().nth(usize::from(code.checked_sub(*first)?))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::from_secs(1);

    fn typed(typed: &mut Typed, codes: &[u16]) -> Vec<Line> {
        codes.iter().flat_map(|code| typed.key(*code, true, NOW)).collect()
    }

    fn whole(text: &str) -> [Line; 1] {
        [Line::Whole(text.into())]
    }

    #[test]
    fn an_id_stands_between_prefix_and_suffix_and_is_plain_text() {
        let codes = Codes { prefix: "]C1".into(), suffix: "%".into() };
        assert_eq!(codes.said(b"]C14711%"), Said::Id("4711".into()));
        for line in ["4711", "]C14711", "4711%", "]C1", "x]C14711%", "]c14711%"] {
            assert_eq!(codes.said(line.as_bytes()), Said::Nothing, "{line:?}");
        }
        for line in ["]C1%", "]C1 %", "]C147\u{1}11%", "]C1ü%"] {
            assert_eq!(codes.said(line.as_bytes()), Said::Unread, "{line:?}");
        }
        assert_eq!(codes.said(b"]C1\xff4711%"), Said::Unread);
        assert_eq!(Codes::default().said(b"\xff4711"), Said::Unread);
        assert_eq!(Codes::default().said(b" P4711 "), Said::Id("P4711".into()));
    }

    #[test]
    fn keys_until_enter_are_an_id() {
        let mut keys = Typed::default();
        assert_eq!(typed(&mut keys, &[5, 8, 2, 2, ENTER]), whole("4711"));
        assert_eq!(typed(&mut keys, &[ENTER]), []);
        keys.key(42, true, NOW);
        typed(&mut keys, &[25]);
        keys.key(42, false, NOW);
        assert_eq!(typed(&mut keys, &[79, 80, 12, 44, KEYPAD_ENTER]), whole("P12-z"));
        // A key that goes up types nothing.
        keys.key(5, false, NOW);
        assert_eq!(typed(&mut keys, &[ENTER]), []);
    }

    #[test]
    fn what_is_too_long_or_cut_off_is_no_id_and_neither_is_its_tail() {
        let mut keys = Typed::default();
        assert_eq!(typed(&mut keys, &[&[2; 66][..], &[ENTER]].concat()), [Line::Dropped]);
        assert_eq!(keys.dropped(), 66);
        keys.key(2, true, NOW);
        assert_eq!(keys.due(), Some(NOW + HALF_LINE));
        assert_eq!(keys.key(3, true, NOW + HALF_LINE), [Line::Dropped]);
        assert_eq!((keys.due(), keys.key(ENTER, true, NOW * 9)), (None, vec![]));
        assert_eq!(keys.dropped(), 2);
        assert_eq!(typed(&mut keys, &[59, 1, ENTER]), [], "function keys are no characters");
        assert_eq!(keys.dropped(), 2);
        assert_eq!(typed(&mut keys, &[2, ENTER]), whole("1"));
        // Text that was started before is not a line, and neither is its rest.
        keys.key(2, true, NOW);
        keys.pass_over();
        assert_eq!(typed(&mut keys, &[3, ENTER, 4, ENTER]), whole("3"));
    }
}
