//! What one port is listened to for: everything that it gives → what has been heard.

use std::time::Duration;

use super::button::{Button, Times};
use super::code::{Codes, Typed};
use super::edge::Contact;
use super::lines::Lines;
use super::report::Pattern;
use super::token::Tokens;
use crate::flow::booth::{Heard, Press};
use crate::record::SourceKind;

/// What a port gives at one time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Input {
    /// Nothing came in the time that it was listened to.
    Nothing,
    /// Bytes of a serial line, as they came.
    Bytes(Vec<u8>),
    /// Whether the contact on its modem line is closed, as sampled.
    Closed(bool),
    /// An input report of a USB device.
    Report(Vec<u8>),
    /// A key, by its number in Linux, that went down or up.
    Key {
        /// Its number.
        code: u16,
        /// Down or up.
        down: bool,
    },
}

/// How a button shows in what its port gives.
#[derive(Debug, Clone)]
pub enum Shows {
    /// Lines, and a contact across two pins; each may be left out.
    Serial {
        /// The lines that are presses.
        tokens: Tokens,
    },
    /// Bits of a report.
    Report(Pattern),
    /// A key of this number.
    Key(u16),
}

/// How a button is listened to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hearing {
    /// A contact must be seen alike for so long before it is believed.
    pub debounce: Duration,
    /// Lock-out and long press.
    pub times: Times,
    /// A contact that is closed for so long sticks.
    pub stuck: Duration,
}

/// What is listened for.
#[derive(Debug, Clone)]
enum Sense {
    Button { shows: Shows, hearing: Hearing, lines: Lines, contact: Contact, button: Button },
    Reader { codes: Codes, lines: Lines, typed: Typed },
}

/// A listener at one port.
#[derive(Debug, Clone)]
pub struct Ear {
    sense: Sense,
    /// How the contact was last told to be, for ports that tell changes only.
    closed: bool,
    garbage: u64,
}

impl Ear {
    /// Listens for a button.
    pub fn for_button(shows: Shows, hearing: Hearing) -> Ear {
        let contact = contact(&shows, hearing);
        let (lines, button) = (Lines::default(), Button::new(hearing.times));
        let sense = Sense::Button { shows, hearing, lines, contact, button };
        Ear { sense, closed: false, garbage: 0 }
    }

    /// Listens for ids.
    pub fn for_ids(codes: Codes) -> Ear {
        let (lines, typed) = (Lines::default(), Typed::default());
        Ear { sense: Sense::Reader { codes, lines, typed }, closed: false, garbage: 0 }
    }

    /// The port was opened anew: nothing is known of its contact. A lock-out goes on.
    pub fn begin(&mut self) {
        self.closed = false;
        if let Sense::Button { shows, hearing, contact: known, .. } = &mut self.sense {
            *known = contact(shows, *hearing);
        }
        self.settled();
    }

    /// What was begun up to now is no press and no id: the port was settling.
    pub fn settled(&mut self) {
        match &mut self.sense {
            Sense::Button { lines, button, .. } => {
                lines.clear();
                button.let_go();
            }
            Sense::Reader { lines, typed, .. } => {
                lines.clear();
                typed.clear();
            }
        }
    }

    /// Takes what the port gave by `now`.
    pub fn hear(&mut self, input: &Input, now: Duration) -> Vec<Heard> {
        match &mut self.sense {
            Sense::Reader { codes, lines, typed } => {
                let (ids, garbage) = read(codes, lines, typed, input, now);
                self.garbage += garbage;
                ids.into_iter().map(|id| Heard::Named { id, by: SourceKind::Reader }).collect()
            }
            Sense::Button { .. } => {
                self.presses(input, now).into_iter().map(Heard::Press).collect()
            }
        }
    }

    fn presses(&mut self, input: &Input, now: Duration) -> Vec<Press> {
        let Sense::Button { shows, lines, contact, button, .. } = &mut self.sense else {
            return Vec::new();
        };
        let mut presses = Vec::new();
        // A port that tells changes has been as it was told until this one.
        if !matches!(input, Input::Closed(_))
            && !matches!(shows, Shows::Serial { .. })
            && let Some(change) = contact.observe(self.closed, now)
        {
            presses.extend(button.change(change, now));
        }
        let seen = match (&*shows, input) {
            (Shows::Serial { .. }, Input::Closed(closed)) => Some(*closed),
            (Shows::Report(pattern), Input::Report(report)) => {
                let is_down = pattern.is_down(report);
                self.garbage += if is_down.is_none() { report.len() as u64 } else { 0 };
                is_down
            }
            (Shows::Key(button), Input::Key { code, down }) => {
                self.garbage += u64::from(button != code && *down);
                (button == code).then_some(*down)
            }
            _ => None,
        };
        if let Some(closed) = seen {
            self.closed = closed;
            let change = contact.observe(closed, now);
            presses.extend(change.and_then(|change| button.change(change, now)));
        }
        presses.extend(button.tick(now));
        if let (Shows::Serial { tokens }, Input::Bytes(bytes)) = (&*shows, input) {
            for line in lines.take(bytes, now) {
                match tokens.press(&line) {
                    Some(press) => presses.extend(button.press(press, now)),
                    None => self.garbage += line.len() as u64,
                }
            }
        }
        lines.tick(now);
        self.garbage += lines.dropped();
        presses
    }

    /// When the port is to be listened to again at the latest, if anything has been begun.
    pub fn due(&self) -> Option<Duration> {
        match &self.sense {
            Sense::Button { lines, contact, button, .. } => {
                [lines.due(), contact.due(), button.due()].into_iter().flatten().min()
            }
            Sense::Reader { lines, typed, .. } => lines.due().into_iter().chain(typed.due()).min(),
        }
    }

    /// Whether the contact is closed for longer than anybody holds a button.
    pub fn is_stuck(&self, now: Duration) -> bool {
        let Sense::Button { hearing, contact, .. } = &self.sense else { return false };
        contact.closed_since().is_some_and(|since| now.saturating_sub(since) >= hearing.stuck)
    }

    /// What came and meant nothing since this was last asked: bytes, or keys.
    pub fn garbage(&mut self) -> u64 {
        std::mem::take(&mut self.garbage)
    }
}

/// A contact of which nothing is told yet. One that is sampled may be closed already.
fn contact(shows: &Shows, hearing: Hearing) -> Contact {
    match shows {
        Shows::Serial { .. } => Contact::unknown(hearing.debounce),
        Shows::Report(_) | Shows::Key(_) => Contact::open(hearing.debounce),
    }
}

/// The ids in what a reader gave, and how much of it is none.
fn read(
    codes: &Codes,
    lines: &mut Lines,
    typed: &mut Typed,
    input: &Input,
    now: Duration,
) -> (Vec<String>, u64) {
    let texts = match input {
        Input::Bytes(bytes) => lines.take(bytes, now),
        Input::Key { code, down } => {
            typed.key(*code, *down, now).map(String::into_bytes).into_iter().collect()
        }
        _ => Vec::new(),
    };
    lines.tick(now);
    typed.tick(now);
    let mut garbage = lines.dropped() + typed.dropped();
    let mut ids = Vec::new();
    for text in texts {
        match codes.id(&text) {
            Some(id) => ids.push(id),
            None => garbage += text.len() as u64,
        }
    }
    (ids, garbage)
}
