//! Keys that a reader types → lines: as a US keyboard would type them, or unread. A line is never passed on
//! without one of its keys.

use std::time::Duration;

use super::lines::{HALF_LINE, LINE_MOST, Line};

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyAction {
    /// It goes down.
    Down,
    /// It goes up.
    Up,
    /// It is held for so long that it repeats.
    Repeat,
}

// Keys by the numbers of Linux's input-event-codes.h.
const ENTERS: [u16; 2] = [28, 96];
const SHIFTS: [u16; 2] = [42, 54];
const CAPS_LOCK: u16 = 58;
const NUM_LOCK: u16 = 69;
const SCROLL_LOCK: u16 = 70;

/// The left Alt, which types a character by its number.
const ALT: u16 = 56;

/// The keys that change what others type: Shift, Control, Alt and Meta, left and right.
const MODIFIERS: [u16; 8] = [42, 54, 29, 97, 56, 100, 125, 126];

/// The characters of keys in rows, starting with the key of this number; those of a US keyboard, which
/// is how readers leave the factory.
const ROWS: [(u16, &str, &str); 10] = [
    (2, "1234567890-=", "!@#$%^&*()_+"),
    (15, "\t", ""),
    (16, "qwertyuiop[]", "QWERTYUIOP{}"),
    (30, "asdfghjkl;'`", "ASDFGHJKL:\"~"),
    (43, "\\zxcvbnm,./", "|ZXCVBNM<>?"),
    (57, " ", " "),
    (55, "*", "*"),
    (KEYPAD, KEYPAD_ROW, KEYPAD_ROW),
    (98, "/", "/"),
    (117, "=", "="),
];

const KEYPAD: u16 = 71;
const KEYPAD_ROW: &str = "789-456+1230.";

/// The most digits of a character's number: with Alt, 0052 is the same as 52.
const NUMBER_MOST: usize = 4;

/// What is known of the line that is being typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum State {
    /// It holds characters, or nothing yet.
    #[default]
    Text,
    /// It is unread, and is reported so at its end: a key that types no character fell into it, or keys were
    /// lost, perhaps with its end.
    Spoilt {
        /// It is also reported as soon as nothing more comes. What follows may be another card, so the end
        /// reports it again.
        is_due: bool,
    },
    /// It was reported as unread: everything that follows up to Enter is its tail, and not a line.
    Tail,
}

/// Collects what a reader types until it types Enter.
#[derive(Debug, Clone, Default)]
pub(super) struct Typed {
    text: String,
    state: State,
    /// The modifiers that are down.
    held: Vec<u16>,
    /// The digits that were typed since Alt went down; `None` if that was not seen.
    number: Option<String>,
    /// These keys were pressed since the device was opened. Nothing shows what the reader takes them to
    /// do: the device is taken from the system that would switch its lights. So the case of letters, or
    /// what digits of the keypad mean, is not known from then on.
    has_caps_lock: bool,
    has_num_lock: bool,
    last_key: Duration,
    dropped: u64,
}

impl Typed {
    /// Processes what a key does; returns the line that Enter ends, and one that is dropped.
    pub fn key(&mut self, code: u16, action: KeyAction, now: Duration) -> Vec<Line> {
        let mut lines: Vec<Line> = self.tick(now).into_iter().collect();
        let is_modifier = MODIFIERS.contains(&code);
        if is_modifier {
            self.held.retain(|held| *held != code);
            self.held.extend((action != KeyAction::Up).then_some(code));
        }
        match (code, action) {
            (ALT, KeyAction::Down) => self.number = Some(String::new()),
            (ALT, KeyAction::Up) => {
                self.last_key = now;
                let number = self.number.take();
                lines.extend(self.push(number.and_then(|digits| numbered(&digits))));
            }
            (_, KeyAction::Up) | (SCROLL_LOCK, _) => {}
            _ if is_modifier => {}
            (CAPS_LOCK, _) => self.has_caps_lock = true,
            (NUM_LOCK, _) => self.has_num_lock = true,
            _ => {
                self.last_key = now;
                let is_end = ENTERS.contains(&code);
                lines.extend(if is_end { self.end(action) } else { self.press(code, action) });
            }
        }
        lines
    }

    /// Keys were lost, perhaps Enter among them, and these are down now: what came since the last Enter
    /// and what comes up to the next one is one line, and unread. A lock among the lost keys is not
    /// known of.
    pub fn lose(&mut self, held: &[u16], now: Duration) -> Option<Line> {
        let line = self.tick(now);
        self.dropped += self.text.len() as u64;
        self.text.clear();
        self.state = State::Spoilt { is_due: true };
        self.last_key = now;
        self.hold(held);
        line
    }

    /// These keys are down.
    pub fn hold(&mut self, held: &[u16]) {
        self.held = MODIFIERS.into_iter().filter(|key| held.contains(key)).collect();
        self.number = None;
    }

    /// Drops half an id whose rest has not arrived: someone typed, or the reader lost its cable.
    pub fn tick(&mut self, now: Duration) -> Option<Line> {
        self.due().filter(|due| now >= *due).map(|_| self.drop_line())
    }

    /// When half an id is dropped.
    pub fn due(&self) -> Option<Duration> {
        let has_digits = self.number.as_ref().is_some_and(|digits| !digits.is_empty());
        let waits = match self.state {
            State::Text => !self.text.is_empty() || has_digits,
            State::Spoilt { is_due } => is_due,
            State::Tail => false,
        };
        waits.then(|| self.last_key + HALF_LINE)
    }

    /// Starts again with the next key, of a device that was just opened.
    pub fn clear(&mut self) {
        *self = Typed { dropped: self.dropped, ..Typed::default() };
    }

    /// Starts again with the next line; the unfinished line is not counted.
    pub fn pass_over(&mut self) {
        let dropped = self.dropped;
        if self.due().is_some() {
            let _ = self.drop_line();
        }
        self.dropped = dropped;
    }

    /// How many keys were dropped since the last call.
    pub fn dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    /// A key that is not Enter and changes no other.
    fn press(&mut self, code: u16, action: KeyAction) -> Option<Line> {
        let is_down = action == KeyAction::Down;
        let digit = keypad(code).filter(|_| is_down && self.held == [ALT]);
        if let (Some(number), Some(digit)) = (&mut self.number, digit.filter(char::is_ascii_digit))
            && number.len() < NUMBER_MOST
        {
            number.push(digit);
            return None;
        }
        // A reader holds no key: one that repeats is pressed by a person, or is stuck.
        let is_plain = is_down && !self.is_modified();
        let character = if is_plain { self.character(code) } else { None };
        self.push(character)
    }

    /// What a key has typed; `None` if that is no character.
    fn push(&mut self, character: Option<char>) -> Option<Line> {
        match (self.state, character) {
            (State::Text, Some(_)) if self.text.len() == LINE_MOST => {
                self.dropped += 1;
                return Some(self.drop_line());
            }
            (State::Text, Some(character)) => self.text.push(character),
            _ => {
                self.dropped += 1;
                self.spoil();
            }
        }
        None
    }

    fn end(&mut self, action: KeyAction) -> Option<Line> {
        let is_held = action == KeyAction::Repeat && !self.text.is_empty();
        if is_held || self.is_modified() {
            self.spoil();
        }
        // Alt that is still down types into the next line.
        self.number = None;
        let text = std::mem::take(&mut self.text);
        match std::mem::take(&mut self.state) {
            State::Text => (!text.is_empty()).then(|| Line::Whole(text.into_bytes())),
            State::Spoilt { .. } => Some(Line::Dropped),
            State::Tail => None,
        }
    }

    /// The line is unread from here on, if that is not known.
    fn spoil(&mut self) {
        if self.state == State::Text {
            self.dropped += self.text.len() as u64;
            self.text.clear();
            self.number = None;
            self.state = State::Spoilt { is_due: true };
        }
    }

    /// The line is unread, and is reported so now.
    fn drop_line(&mut self) -> Line {
        self.dropped += self.text.len() as u64;
        self.text.clear();
        self.number = None;
        self.state = match self.state {
            State::Spoilt { .. } => State::Spoilt { is_due: false },
            State::Text | State::Tail => State::Tail,
        };
        Line::Dropped
    }

    /// Whether Control, Alt or Meta is down, with which a key is a command.
    fn is_modified(&self) -> bool {
        self.held.iter().any(|held| !SHIFTS.contains(held))
    }

    fn character(&self, code: u16) -> Option<char> {
        let is_shifted = self.held.iter().any(|held| SHIFTS.contains(held));
        let character = ROWS.iter().find_map(|(first, plain, shifted)| {
            let row = if is_shifted { shifted } else { plain };
            row.chars().nth(usize::from(code.checked_sub(*first)?))
        })?;
        // With Shift, or without NumLock, a digit of the keypad moves the cursor.
        let is_number = keypad(code).is_some_and(|key| key.is_ascii_digit() || key == '.');
        let is_unsure = (is_number && (is_shifted || self.has_num_lock))
            || (character.is_ascii_alphabetic() && self.has_caps_lock);
        (!is_unsure).then_some(character)
    }
}

/// The character of a key in the keypad's block of digits.
fn keypad(code: u16) -> Option<char> {
    KEYPAD_ROW.chars().nth(usize::from(code.checked_sub(KEYPAD)?))
}

/// The character of a number that was typed with Alt; `None` if its character set is not ASCII.
fn numbered(digits: &str) -> Option<char> {
    let character = digits.parse::<u8>().ok().map(char::from);
    character.filter(|character| character.is_ascii_graphic() || *character == ' ')
}

#[cfg(test)]
mod tests {
    use super::*;
    use KeyAction::{Down, Repeat, Up};

    const NOW: Duration = Duration::from_secs(1);
    const ENTER: u16 = 28;
    const KEYPAD_ENTER: u16 = 96;
    const SHIFT: u16 = 42;
    const F1: u16 = 59;

    fn typed(typed: &mut Typed, codes: &[u16]) -> Vec<Line> {
        codes.iter().flat_map(|code| typed.key(*code, Down, NOW)).collect()
    }

    /// The lines of these keys, each pressed and let go.
    fn tapped(typed: &mut Typed, codes: &[u16]) -> Vec<Line> {
        let keys = codes.iter().flat_map(|code| [(*code, Down), (*code, Up)]);
        keys.flat_map(|(code, action)| typed.key(code, action, NOW)).collect()
    }

    /// These keys while another is held.
    fn under(typed: &mut Typed, modifier: u16, codes: &[u16]) -> Vec<Line> {
        let mut lines = typed.key(modifier, Down, NOW);
        lines.extend(tapped(typed, codes));
        lines.extend(typed.key(modifier, Up, NOW));
        lines
    }

    fn whole(text: &str) -> [Line; 1] {
        [Line::Whole(text.into())]
    }

    #[test]
    fn keys_until_enter_are_an_id() {
        let mut keys = Typed::default();
        assert_eq!(typed(&mut keys, &[5, 8, 2, 2, ENTER]), whole("4711"));
        assert_eq!(typed(&mut keys, &[ENTER]), []);
        keys.key(SHIFT, Down, NOW);
        typed(&mut keys, &[25]);
        keys.key(SHIFT, Up, NOW);
        assert_eq!(typed(&mut keys, &[79, 80, 12, 44, KEYPAD_ENTER]), whole("P12-z"));
        // A key that goes up types nothing.
        keys.key(5, Up, NOW);
        assert_eq!(typed(&mut keys, &[ENTER]), []);
        // 4711/2 on the keypad, and the keys at the edge of a US keyboard.
        assert_eq!(typed(&mut keys, &[75, 71, 79, 79, 98, 80, ENTER]), whole("4711/2"));
        assert_eq!(typed(&mut keys, &[41, 43, 55, 117, 15, ENTER]), whole("`\\*=\t"));
    }

    #[test]
    fn what_is_too_long_or_cut_off_is_no_id_and_neither_is_its_tail() {
        let mut keys = Typed::default();
        assert_eq!(typed(&mut keys, &[&[2; 66][..], &[ENTER]].concat()), [Line::Dropped]);
        assert_eq!(keys.dropped(), 66);
        keys.key(2, Down, NOW);
        assert_eq!(keys.due(), Some(NOW + HALF_LINE));
        assert_eq!(keys.key(3, Down, NOW + HALF_LINE), [Line::Dropped]);
        assert_eq!((keys.due(), keys.key(ENTER, Down, NOW * 9)), (None, vec![]));
        assert_eq!(keys.dropped(), 2);
        assert_eq!(typed(&mut keys, &[2, ENTER]), whole("1"));
        // Text that was started before is not a line, and neither is its rest.
        keys.key(2, Down, NOW);
        keys.pass_over();
        assert_eq!(typed(&mut keys, &[3, ENTER, 4, ENTER]), whole("3"));
    }

    #[test]
    fn a_key_that_types_no_character_makes_its_line_unread() {
        let mut keys = Typed::default();
        // F1, Escape, Backspace, the key beside the left Shift, one without a meaning.
        for key in [F1, 1, 14, 86, 240] {
            for line in [vec![key], vec![5, 8, key, 2, 2], vec![key, 5], vec![5, key]] {
                assert_eq!(tapped(&mut keys, &line), [], "{line:?}");
                assert_eq!(tapped(&mut keys, &[ENTER]), [Line::Dropped], "{line:?}");
                assert_eq!(keys.dropped(), line.len() as u64, "{line:?}");
                assert_eq!(tapped(&mut keys, &[5, ENTER]), whole("4"), "{line:?}");
            }
        }
        // It is reported once it stops, and again at an end that may be another card's.
        tapped(&mut keys, &[F1]);
        assert_eq!(keys.tick(NOW + HALF_LINE), Some(Line::Dropped));
        assert_eq!((keys.due(), keys.tick(NOW * 9)), (None, None));
        assert_eq!(tapped(&mut keys, &[5, 8, 2, 2, ENTER]), [Line::Dropped]);
        assert_eq!(tapped(&mut keys, &[5, 8, 2, 2, ENTER]), whole("4711"));
    }

    #[test]
    fn with_control_alt_or_meta_a_key_is_no_character_and_a_held_one_neither() {
        for modifier in MODIFIERS.into_iter().filter(|key| !SHIFTS.contains(key)) {
            let mut keys = Typed::default();
            tapped(&mut keys, &[5]);
            under(&mut keys, modifier, &[8]);
            assert_eq!(tapped(&mut keys, &[2, ENTER]), [Line::Dropped], "{modifier}");
            under(&mut keys, modifier, &[5, 8, 2, 2]);
            assert_eq!(tapped(&mut keys, &[ENTER]), [Line::Dropped], "{modifier}");
            assert_eq!(tapped(&mut keys, &[5, ENTER]), whole("4"), "{modifier}");
            // One that never comes up ends with the device.
            keys.key(modifier, Down, NOW);
            assert_eq!(tapped(&mut keys, &[5, ENTER, 5, ENTER]), [Line::Dropped, Line::Dropped]);
            keys.clear();
            assert_eq!(tapped(&mut keys, &[5, ENTER]), whole("4"), "{modifier}");
        }
        let mut keys = Typed::default();
        keys.key(5, Down, NOW);
        keys.key(5, Repeat, NOW);
        assert_eq!(tapped(&mut keys, &[ENTER]), [Line::Dropped]);
        // One of two Shifts is enough; a digit of the keypad is none with it.
        keys.key(54, Down, NOW);
        under(&mut keys, SHIFT, &[25]);
        assert_eq!(tapped(&mut keys, &[30, ENTER]), whole("PA"));
        assert_eq!(tapped(&mut keys, &[79, ENTER]), [Line::Dropped]);
        keys.clear();
        assert_eq!(tapped(&mut keys, &[25, ENTER]), whole("p"));
    }

    #[test]
    fn alt_and_digits_of_the_keypad_type_the_character_of_that_number() {
        let mut keys = Typed::default();
        let numbers: [(&[u16], Option<&str>); 13] = [
            (&[76, 80], Some("x4x")),
            (&[82, 76, 80], Some("x4x")),
            (&[82, 82, 76, 80], Some("x4x")),
            (&[73, 82], Some("xZx")),
            (&[79, 79, 79], Some("xox")),
            (&[79, 80, 77], Some("x~x")),
            // 127, 308, 00052 and 13; then keys that are no digits of the keypad, and none.
            (&[79, 80, 71], None),
            (&[81, 82, 72], None),
            (&[82, 82, 82, 76, 80], None),
            (&[79, 81], None),
            (&[5, 6], None),
            (&[76, F1, 80], None),
            (&[], None),
        ];
        for (digits, text) in numbers {
            let expected = text.map_or(Line::Dropped, |text| Line::Whole(text.into()));
            tapped(&mut keys, &[45]);
            under(&mut keys, ALT, digits);
            assert_eq!(tapped(&mut keys, &[45, ENTER]), [expected], "{digits:?}");
        }
        // Shift beside it is another command, and Enter comes too early.
        keys.key(SHIFT, Down, NOW);
        under(&mut keys, ALT, &[76, 80]);
        keys.key(SHIFT, Up, NOW);
        assert_eq!(tapped(&mut keys, &[ENTER]), [Line::Dropped]);
        assert_eq!(under(&mut keys, ALT, &[76, 80, ENTER, 76, 80]), [Line::Dropped]);
        assert_eq!(tapped(&mut keys, &[ENTER]), [Line::Dropped]);
        // A number that stops in the middle.
        keys.key(ALT, Down, NOW);
        tapped(&mut keys, &[76]);
        assert_eq!(keys.tick(NOW + HALF_LINE), Some(Line::Dropped));
        keys.key(ALT, Up, NOW * 9);
        assert_eq!(tapped(&mut keys, &[ENTER]), []);
    }

    #[test]
    fn where_keys_were_lost_all_up_to_the_next_enter_is_one_unread_line() {
        let mut keys = Typed::default();
        for before in [&[][..], &[5, 8], &[5, 8, 2, 2]] {
            for after in [&[][..], &[2, 6]] {
                tapped(&mut keys, before);
                assert_eq!(keys.lose(&[], NOW), None);
                tapped(&mut keys, after);
                assert_eq!(tapped(&mut keys, &[ENTER]), [Line::Dropped], "{before:?} {after:?}");
                assert_eq!(tapped(&mut keys, &[5, ENTER]), whole("4"));
            }
        }
        // Shift went down or up among them.
        keys.lose(&[SHIFT, 25], NOW);
        tapped(&mut keys, &[ENTER]);
        assert_eq!(tapped(&mut keys, &[25, ENTER]), whole("P"));
        keys.lose(&[], NOW);
        tapped(&mut keys, &[ENTER]);
        assert_eq!(tapped(&mut keys, &[25, ENTER]), whole("p"));
        // Half of a number was lost.
        keys.key(ALT, Down, NOW);
        keys.lose(&[ALT], NOW);
        tapped(&mut keys, &[ENTER, 76, 80]);
        keys.key(ALT, Up, NOW);
        assert_eq!(tapped(&mut keys, &[ENTER]), [Line::Dropped]);
        // A card whose end was lost is reported by itself, and so is the one that follows.
        tapped(&mut keys, &[5, 8]);
        keys.lose(&[], NOW);
        assert_eq!(keys.tick(NOW + HALF_LINE), Some(Line::Dropped));
        assert_eq!(tapped(&mut keys, &[5, 8, 2, 2, ENTER]), [Line::Dropped]);
        // The same while the device settles.
        keys.lose(&[], NOW);
        keys.pass_over();
        assert_eq!(tapped(&mut keys, &[2, 2, ENTER]), [Line::Dropped]);
    }

    #[test]
    fn after_a_lock_the_keys_that_it_changes_are_unsure_until_the_device_is_opened_anew() {
        let mut keys = Typed::default();
        tapped(&mut keys, &[SCROLL_LOCK, CAPS_LOCK]);
        assert_eq!(tapped(&mut keys, &[5, 79, ENTER]), whole("41"));
        assert_eq!(tapped(&mut keys, &[25, 79, ENTER]), [Line::Dropped]);
        tapped(&mut keys, &[NUM_LOCK]);
        assert_eq!(tapped(&mut keys, &[5, 78, ENTER]), whole("4+"));
        assert_eq!(tapped(&mut keys, &[5, 79, ENTER]), [Line::Dropped]);
        under(&mut keys, ALT, &[76, 80]);
        assert_eq!(tapped(&mut keys, &[ENTER]), whole("4"), "a number is a number");
        keys.clear();
        assert_eq!(tapped(&mut keys, &[25, 79, ENTER]), whole("p1"));
    }
}
