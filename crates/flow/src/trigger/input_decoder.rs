//! What the station listens for at one port: all of its input → what was received.

use std::time::Duration;

use gaiter_record::SourceKind;

use super::button::Button;
use super::code::{CodeReading, Codes};
use super::debounce::{Contact, DEBOUNCE};
use super::lines::{Line, Lines, Tokens};
use super::report::Pattern;
use super::typed::{KeyAction, Typed};
use crate::booth::{PortEvent, Press};

/// Input from a port at one time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Input {
    /// Nothing arrived in the time that it was listened to.
    Nothing,
    /// Bytes of a serial line, as they arrived.
    Bytes(Vec<u8>),
    /// Whether the contact on its modem line is closed, as sampled.
    Closed(bool),
    /// An input report of a USB device.
    Report(Vec<u8>),
    /// A key, by its number in Linux.
    Key {
        code: u16,
        /// What it did.
        action: KeyAction,
    },
    /// The keys that were down when the device was opened.
    KeysHeld(Vec<u16>),
    /// Keys were lost before they could be read, and these are down after that.
    KeysLost(Vec<u16>),
}

/// How a button shows in the input from its port.
#[derive(Debug, Clone)]
pub enum Shows {
    /// Lines, and a contact across two pins; each is optional.
    Serial {
        /// The lines that are presses.
        tokens: Tokens,
    },
    /// Bits of a report.
    Report(Pattern),
    /// A key of this number.
    Key(u16),
}

/// A contact that is closed for this long is stuck: nobody holds a button for as long.
const STUCK: Duration = Duration::from_secs(30);

/// What is listened for.
#[derive(Debug, Clone)]
enum Sense {
    Button { shows: Shows, lines: Lines, contact: Contact, button: Button },
    Reader { codes: Codes, lines: Lines, typed: Typed },
}

/// A listener at one port.
#[derive(Debug, Clone)]
pub struct InputDecoder {
    sense: Sense,
    /// The last reported state of the contact, for ports that only report changes.
    closed: bool,
    garbage: u64,
}

impl InputDecoder {
    /// Listens for a button. After a press, no other press counts for the time of the lock-out.
    pub fn for_button(shows: Shows, lock_out: Duration) -> InputDecoder {
        let contact = contact(&shows);
        let (lines, button) = (Lines::default(), Button::new(lock_out));
        let sense = Sense::Button { shows, lines, contact, button };
        InputDecoder { sense, closed: false, garbage: 0 }
    }

    /// Listens for ids.
    pub fn for_ids(codes: Codes) -> InputDecoder {
        let (lines, typed) = (Lines::ended_by(codes.end()), Typed::default());
        InputDecoder { sense: Sense::Reader { codes, lines, typed }, closed: false, garbage: 0 }
    }

    /// The port was opened again: nothing is known about its contact. A lock-out continues.
    pub fn begin(&mut self) {
        self.closed = false;
        match &mut self.sense {
            Sense::Button { shows, contact: known, lines, button } => {
                *known = contact(shows);
                lines.clear();
                button.let_go();
            }
            Sense::Reader { lines, typed, .. } => {
                lines.clear();
                typed.clear();
            }
        }
    }

    /// Anything that was started up to now is not a press and not an id: the port was settling. A box
    /// may send a greeting without a line end, and the press after it must count; the rest of an id may
    /// be another id.
    pub fn settled(&mut self) {
        match &mut self.sense {
            Sense::Button { lines, button, .. } => {
                lines.clear();
                button.let_go();
            }
            Sense::Reader { lines, typed, .. } => {
                lines.pass_over();
                typed.pass_over();
            }
        }
    }

    /// Processes what arrived from the port by `now`.
    pub fn decode(&mut self, input: &Input, now: Duration) -> Vec<PortEvent> {
        let (shows, lines, contact, button) = match &mut self.sense {
            Sense::Reader { codes, lines, typed } => {
                let (events, garbage) = read(codes, lines, typed, input, now);
                self.garbage += garbage;
                return events;
            }
            Sense::Button { shows, lines, contact, button } => (shows, lines, contact, button),
        };
        let mut presses: Vec<Press> = Vec::new();
        // A port that reports changes kept its last reported state until this input.
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
            (Shows::Key(button), Input::Key { code, action }) if button == code => match action {
                KeyAction::Down => Some(true),
                KeyAction::Up => Some(false),
                KeyAction::Repeat => None,
            },
            (Shows::Key(_), Input::Key { action, .. }) => {
                self.garbage += u64::from(*action == KeyAction::Down);
                None
            }
            (Shows::Key(button), Input::KeysLost(held)) => Some(held.contains(button)),
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
                let Line::Whole(line) = line else { continue };
                match tokens.press(&line) {
                    Some(press) => presses.extend(button.press(press, now)),
                    None => self.garbage += line.len() as u64,
                }
            }
        }
        // Input that is not a press has no patient: it is only counted.
        let _ = lines.tick(now);
        self.garbage += lines.dropped();
        presses.into_iter().map(PortEvent::Press).collect()
    }

    /// The latest time at which the port must be read again, if anything was started.
    pub fn due(&self) -> Option<Duration> {
        match &self.sense {
            Sense::Button { lines, contact, button, .. } => {
                [lines.due(), contact.due(), button.due()].into_iter().flatten().min()
            }
            Sense::Reader { lines, typed, .. } => lines.due().into_iter().chain(typed.due()).min(),
        }
    }

    /// Whether the contact is closed for longer than anyone holds a button.
    pub fn is_stuck(&self, now: Duration) -> bool {
        let Sense::Button { contact, .. } = &self.sense else { return false };
        contact.closed_since.is_some_and(|since| now.saturating_sub(since) >= STUCK)
    }

    /// How many bytes or keys without a meaning arrived since the last call.
    pub fn garbage(&mut self) -> u64 {
        std::mem::take(&mut self.garbage)
    }
}

/// A contact that has not reported anything yet. One that is sampled may be closed already.
fn contact(shows: &Shows) -> Contact {
    match shows {
        Shows::Serial { .. } => Contact::unknown(DEBOUNCE),
        Shows::Report(_) | Shows::Key(_) => Contact::open(DEBOUNCE),
    }
}

/// Input from a reader: the ids, an unread event for each id that could not be understood, and how much
/// of the input is not an id.
fn read(
    codes: &Codes,
    lines: &mut Lines,
    typed: &mut Typed,
    input: &Input,
    now: Duration,
) -> (Vec<PortEvent>, u64) {
    let mut read = match input {
        Input::Bytes(bytes) => lines.take(bytes, now),
        Input::Key { code, action } => typed.key(*code, *action, now),
        Input::KeysLost(held) => typed.lose(held, now).into_iter().collect(),
        Input::KeysHeld(held) => {
            typed.hold(held);
            Vec::new()
        }
        Input::Nothing | Input::Closed(_) | Input::Report(_) => Vec::new(),
    };
    read.extend(lines.tick(now).into_iter().chain(typed.tick(now)));
    let mut garbage = lines.dropped() + typed.dropped();
    let mut events = Vec::new();
    for line in read {
        let (reading, length) = match &line {
            Line::Whole(line) => (codes.reading(line), line.len() as u64),
            // The length of dropped input is counted where it was dropped.
            Line::Dropped => (CodeReading::Unread, 0),
        };
        let by = SourceKind::Reader;
        match reading {
            CodeReading::Id(id) => events.push(PortEvent::Named { id, by }),
            CodeReading::Unread => {
                garbage += length;
                events.push(PortEvent::Unread);
            }
            CodeReading::Nothing => garbage += length,
        }
    }
    (events, garbage)
}
