//! A reader of barcodes or cards: a line of text, or keys that it types → an id.

use std::time::Duration;

use super::lines::{HALF_LINE, LINE_MOST};

/// What a reader puts around an id.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Codes {
    /// Before it.
    pub prefix: String,
    /// After it.
    pub suffix: String,
}

impl Codes {
    /// The id in what was read; none where it lacks what stands around an id, or is no plain text.
    pub fn id(&self, read: &[u8]) -> Option<String> {
        let text = str::from_utf8(read).ok()?;
        let id = text.strip_prefix(&*self.prefix)?.strip_suffix(&*self.suffix)?.trim();
        let plain = id.bytes().all(|byte| byte.is_ascii_graphic() || byte == b' ');
        (plain && !id.is_empty()).then(|| id.to_owned())
    }
}

// Keys by the numbers of Linux's input-event-codes.h.
const ENTER: u16 = 28;
const KEYPAD_ENTER: u16 = 96;
const SHIFTS: [u16; 2] = [42, 54];

/// The characters of keys in rows, from the key of this number on; a US keyboard's, which readers
/// are when they leave the factory.
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
pub struct Typed {
    text: String,
    overlong: bool,
    shift: bool,
    last_key: Duration,
    dropped: u64,
}

impl Typed {
    /// Takes a key that goes down or up; gives what was typed, once Enter goes down.
    pub fn key(&mut self, code: u16, down: bool, now: Duration) -> Option<String> {
        if SHIFTS.contains(&code) {
            self.shift = down;
            return None;
        }
        if !down {
            return None;
        }
        self.tick(now);
        self.last_key = now;
        if code == ENTER || code == KEYPAD_ENTER {
            let text = std::mem::take(&mut self.text);
            let whole = !std::mem::take(&mut self.overlong) && !text.is_empty();
            return whole.then_some(text);
        }
        match self.character(code) {
            Some(_) if self.overlong || self.text.len() == LINE_MOST => {
                self.dropped += 1;
                self.overlong = true;
            }
            Some(character) => self.text.push(character),
            None => self.dropped += 1,
        }
        None
    }

    /// Drops half an id whose rest has not come: somebody typed, or the reader lost its cable.
    pub fn tick(&mut self, now: Duration) {
        if self.due().is_some_and(|due| now >= due) {
            self.dropped += self.text.len() as u64;
            self.clear();
        }
    }

    /// When half an id is dropped.
    pub fn due(&self) -> Option<Duration> {
        let half = self.overlong || !self.text.is_empty();
        half.then(|| self.last_key + HALF_LINE)
    }

    /// Begins anew with the key that comes next.
    pub fn clear(&mut self) {
        self.text.clear();
        self.overlong = false;
    }

    /// How many keys were dropped since this was last asked.
    pub fn dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
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

    fn typed(typed: &mut Typed, codes: &[u16]) -> Option<String> {
        codes.iter().fold(None, |_, code| typed.key(*code, true, NOW))
    }

    #[test]
    fn an_id_stands_between_prefix_and_suffix() {
        let codes = Codes { prefix: "]C1".into(), suffix: "%".into() };
        assert_eq!(codes.id(b"]C14711%").as_deref(), Some("4711"));
        for read in ["4711", "]C14711", "4711%", "]C1%", "]C1 %", "]C147\u{1}11%", "]C1ü%"] {
            assert_eq!(codes.id(read.as_bytes()), None, "{read:?}");
        }
        assert_eq!(Codes::default().id(b"\xff4711"), None);
        assert_eq!(Codes::default().id(b" P4711 ").as_deref(), Some("P4711"));
    }

    #[test]
    fn keys_until_enter_are_an_id() {
        let mut keys = Typed::default();
        assert_eq!(typed(&mut keys, &[5, 8, 2, 2, ENTER]).as_deref(), Some("4711"));
        assert_eq!(typed(&mut keys, &[ENTER]), None);
        keys.key(42, true, NOW);
        typed(&mut keys, &[25]);
        keys.key(42, false, NOW);
        let read = typed(&mut keys, &[79, 80, 12, 44, KEYPAD_ENTER]);
        assert_eq!(read.as_deref(), Some("P12-z"));
        // What goes up types nothing.
        keys.key(5, false, NOW);
        assert_eq!(typed(&mut keys, &[ENTER]), None);
    }

    #[test]
    fn what_is_too_long_or_cut_off_is_no_id() {
        let mut keys = Typed::default();
        assert_eq!(typed(&mut keys, &[&[2; 65][..], &[ENTER]].concat()), None);
        assert_eq!(keys.dropped(), 1);
        keys.key(2, true, NOW);
        assert_eq!(keys.due(), Some(NOW + HALF_LINE));
        keys.key(3, true, NOW + HALF_LINE);
        assert_eq!(keys.key(ENTER, true, NOW + HALF_LINE).as_deref(), Some("2"));
        assert_eq!(typed(&mut keys, &[59, 1, ENTER]), None, "function keys are no characters");
        assert_eq!(keys.dropped(), 3);
    }
}
