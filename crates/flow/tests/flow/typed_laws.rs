//! Laws of a reader that types, against a model of its keyboard: each line is heard as it was typed, or as
//! unread.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::time::Duration;

use gaiter_flow::booth::PortEvent;
use gaiter_flow::trigger::KeyAction::{self, Down, Repeat, Up};
use gaiter_flow::trigger::code::Codes;
use gaiter_flow::trigger::{Input, InputDecoder};
use gaiter_record::SourceKind;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// The keys of a US keyboard: number, character, character with Shift.
#[rustfmt::skip]
const KEYS: [(u16, char, char); 48] = [
    (41, '`', '~'), (2, '1', '!'), (3, '2', '@'), (4, '3', '#'), (5, '4', '$'), (6, '5', '%'),
    (7, '6', '^'), (8, '7', '&'), (9, '8', '*'), (10, '9', '('), (11, '0', ')'), (12, '-', '_'),
    (13, '=', '+'), (16, 'q', 'Q'), (17, 'w', 'W'), (18, 'e', 'E'), (19, 'r', 'R'), (20, 't', 'T'),
    (21, 'y', 'Y'), (22, 'u', 'U'), (23, 'i', 'I'), (24, 'o', 'O'), (25, 'p', 'P'), (26, '[', '{'),
    (27, ']', '}'), (43, '\\', '|'), (30, 'a', 'A'), (31, 's', 'S'), (32, 'd', 'D'), (33, 'f', 'F'),
    (34, 'g', 'G'), (35, 'h', 'H'), (36, 'j', 'J'), (37, 'k', 'K'), (38, 'l', 'L'), (39, ';', ':'),
    (40, '\'', '"'), (44, 'z', 'Z'), (45, 'x', 'X'), (46, 'c', 'C'), (47, 'v', 'V'), (48, 'b', 'B'),
    (49, 'n', 'N'), (50, 'm', 'M'), (51, ',', '<'), (52, '.', '>'), (53, '/', '?'), (57, ' ', ' '),
];

const KEYPAD: [(u16, char); 16] = [
    (71, '7'),
    (72, '8'),
    (73, '9'),
    (75, '4'),
    (76, '5'),
    (77, '6'),
    (79, '1'),
    (80, '2'),
    (81, '3'),
    (82, '0'),
    (83, '.'),
    (74, '-'),
    (78, '+'),
    (55, '*'),
    (98, '/'),
    (117, '='),
];

const ENTERS: [u16; 2] = [28, 96];
const SHIFT: u16 = 42;
const ALT: u16 = 56;

/// Control, Alt and Meta, left and right.
const MODIFIERS: [u16; 6] = [29, 97, 56, 100, 125, 126];

/// Keys that do nothing by themselves: Shift, Control, the right Alt, Meta, Scroll Lock.
const IDLE: [u16; 6] = [42, 54, 29, 100, 125, 70];

/// Keys that type no character: Escape, Backspace, F1, Left, Delete, the one beside the left Shift, one
/// without a meaning, a button of a mouse.
const OTHERS: [u16; 8] = [1, 14, 59, 105, 111, 86, 240, 272];

/// Numbers that are no character of ASCII, or of too many digits.
const WRONG_NUMBERS: [&str; 8] = ["", "7", "13", "127", "228", "308", "00052", "99999999"];

type Event = (u16, KeyAction);

/// A thing that a reader does.
#[derive(Debug, Clone)]
enum Item {
    Key(char),
    Keypad(char),
    /// By its number with Alt, of this many digits at least.
    Numbered(char, usize),
    Idle(u16),
    Other(u16),
    /// A character's key with a modifier.
    Under(u16, char),
    Held(char),
    WrongNumber(&'static str),
    /// A digit of the keypad with Shift: it moves the cursor.
    Shifted,
}

impl Item {
    fn events(&self) -> Vec<Event> {
        match self {
            Item::Key(character) => match key(*character) {
                (code, false) => tap(code).to_vec(),
                (code, true) => with(SHIFT, &[code]),
            },
            Item::Keypad(character) => tap(on_keypad(*character)).to_vec(),
            Item::Numbered(character, width) => {
                let width = *width;
                numbered(&format!("{:0width$}", u32::from(*character)))
            }
            Item::Idle(code) | Item::Other(code) => tap(*code).to_vec(),
            Item::Under(modifier, character) => with(*modifier, &[key(*character).0]),
            Item::Held(character) => {
                let code = key(*character).0;
                vec![(code, Down), (code, Repeat), (code, Repeat), (code, Up)]
            }
            Item::WrongNumber(digits) => numbered(digits),
            Item::Shifted => with(SHIFT, &[76]),
        }
    }
}

/// The key of a character, and whether it needs Shift.
fn key(character: char) -> (u16, bool) {
    let plain = KEYS.iter().find(|(_, plain, _)| *plain == character);
    let shifted = KEYS.iter().find(|(.., shifted)| *shifted == character);
    plain.map(|key| (key.0, false)).or(shifted.map(|key| (key.0, true))).unwrap()
}

fn on_keypad(character: char) -> u16 {
    KEYPAD.iter().find(|(_, key)| *key == character).unwrap().0
}

fn tap(code: u16) -> [Event; 2] {
    [(code, Down), (code, Up)]
}

fn with(modifier: u16, codes: &[u16]) -> Vec<Event> {
    let mut events = vec![(modifier, Down)];
    events.extend(codes.iter().flat_map(|code| tap(*code)));
    events.push((modifier, Up));
    events
}

fn numbered(digits: &str) -> Vec<Event> {
    with(ALT, &digits.chars().map(on_keypad).collect::<Vec<_>>())
}

/// A line with the pauses, ms, before each item and before its Enter.
#[derive(Debug, Clone)]
struct Line {
    items: Vec<(u64, Item)>,
    pause: u64,
    enter: u16,
}

/// What is to be heard of a line.
#[derive(Debug, PartialEq)]
enum Expected {
    Nothing,
    Named(String),
    Unread,
}

impl Line {
    /// What is to be heard of it; `paused` if pauses are kept.
    fn expected(&self, paused: bool) -> Expected {
        let (mut text, mut is_begun, mut is_whole) = (String::new(), false, true);
        for (pause, item) in &self.items {
            is_whole &= !(paused && is_begun && *pause >= 500);
            match item {
                Item::Idle(_) => {}
                Item::Key(character) | Item::Keypad(character) | Item::Numbered(character, _) => {
                    text.push(*character);
                    is_begun = true;
                }
                _ => (is_begun, is_whole) = (true, false),
            }
        }
        is_whole &= !(paused && is_begun && self.pause >= 500);
        match text.trim_matches(' ') {
            _ if !is_begun => Expected::Nothing,
            "" => Expected::Unread,
            _ if !is_whole => Expected::Unread,
            id => Expected::Named(id.to_owned()),
        }
    }

    /// Its events with the pauses before them.
    fn events(&self) -> Vec<(u64, Event)> {
        let mut events = Vec::new();
        let enter = tap(self.enter).to_vec();
        let items = self.items.iter().map(|(pause, item)| (*pause, item.events()));
        for (pause, of_item) in items.chain([(self.pause, enter)]) {
            let pauses = [pause].into_iter().chain(std::iter::repeat(1));
            events.extend(pauses.zip(of_item));
        }
        events
    }
}

fn item() -> impl Strategy<Value = Item> {
    let character = || prop::char::range(' ', '~');
    prop_oneof![
        24 => character().prop_map(Item::Key),
        6 => select(KEYPAD.to_vec()).prop_map(|key| Item::Keypad(key.1)),
        6 => (character(), 2..=4_usize)
            .prop_map(|(character, width)| Item::Numbered(character, width)),
        2 => select(IDLE.to_vec()).prop_map(Item::Idle),
        1 => select(OTHERS.to_vec()).prop_map(Item::Other),
        1 => (select(MODIFIERS.to_vec()), character())
            .prop_map(|(modifier, character)| Item::Under(modifier, character)),
        1 => character().prop_map(Item::Held),
        1 => select(WRONG_NUMBERS.to_vec()).prop_map(Item::WrongNumber),
        1 => Just(Item::Shifted),
    ]
}

fn lines() -> impl Strategy<Value = Vec<Line>> {
    let pause = || prop_oneof![20 => 1..30_u64, 1 => 500..900_u64];
    let line = (vec((pause(), item()), 0..8), pause(), select(ENTERS.to_vec()))
        .prop_map(|(items, pause, enter)| Line { items, pause, enter });
    vec(line, 1..8)
}

/// What is heard up to each Enter, and after the last one.
fn heard(inputs: &[(u64, Input)]) -> Vec<Vec<PortEvent>> {
    let mut decoder = InputDecoder::for_ids(Codes::default());
    decoder.begin();
    let (mut now, mut groups) = (Duration::ZERO, vec![Vec::new()]);
    for (pause, input) in inputs {
        now += Duration::from_millis(*pause);
        groups.last_mut().unwrap().extend(decoder.decode(input, now));
        if matches!(input, Input::Key { code, action: Down } if ENTERS.contains(code)) {
            groups.push(Vec::new());
        }
    }
    let rest = decoder.decode(&Input::Nothing, now + Duration::from_millis(500));
    groups.last_mut().unwrap().extend(rest);
    groups
}

/// What was heard of one line, as far as it is what may be heard.
fn told(group: &[PortEvent]) -> Option<Expected> {
    let is_unread = |heard: &PortEvent| *heard == PortEvent::Unread;
    match group {
        [] => Some(Expected::Nothing),
        [PortEvent::Named { id, by: SourceKind::Reader }] => Some(Expected::Named(id.clone())),
        group => group.iter().all(is_unread).then_some(Expected::Unread),
    }
}

fn input((code, action): Event) -> Input {
    Input::Key { code, action }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A line of characters is heard as they are, however they are typed; one with anything else in it,
    /// or with a pause, is unread; and neither does anything to the next.
    #[test]
    fn a_line_is_what_was_typed_or_unread(lines in lines()) {
        let events = lines.iter().flat_map(Line::events);
        let inputs: Vec<(u64, Input)> =
            events.map(|(pause, event)| (pause, input(event))).collect();
        let groups = heard(&inputs);
        prop_assert_eq!(groups.len(), lines.len() + 1);
        for (group, line) in groups.iter().zip(&lines) {
            prop_assert_eq!(told(group), Some(line.expected(true)), "{:?}", line);
        }
        prop_assert!(groups.last().unwrap().is_empty());
    }

    /// Wherever the system loses keys, the lines before and after are what they are; what came since the
    /// last Enter before it, up to the next one after it, is unread.
    #[test]
    fn a_line_in_which_keys_were_lost_is_unread(
        lines in lines(), at in any::<prop::sample::Index>(), count in 0..40_usize,
    ) {
        let events: Vec<Event> =
            lines.iter().flat_map(Line::events).map(|(_, event)| event).collect();
        let from = at.index(events.len() + 1);
        let to = (from + count).min(events.len());
        let mut held = BTreeSet::new();
        for (code, action) in &events[..to] {
            let _ = if *action == Up { held.remove(code) } else { held.insert(*code) };
        }
        let ends = |events: &[Event]| {
            let is_end = |event: &&Event| ENTERS.contains(&event.0) && event.1 == Down;
            events.iter().filter(is_end).count()
        };
        let (first, last) = (ends(&events[..from]), ends(&events[..to]));
        let mut inputs: Vec<Input> = events[..from].iter().copied().map(input).collect();
        inputs.push(Input::KeysLost(held.into_iter().collect()));
        inputs.extend(events[to..].iter().copied().map(input));
        let inputs: Vec<(u64, Input)> = inputs.into_iter().map(|input| (1, input)).collect();
        let groups = heard(&inputs);
        let before = lines[..first].iter().map(|line| line.expected(false));
        let after = lines.iter().skip(last + 1).map(|line| line.expected(false));
        let mut expected: Vec<_> = before.chain([Expected::Unread]).chain(after).collect();
        if last < lines.len() {
            expected.push(Expected::Nothing);
        }
        let told: Vec<_> = groups.iter().map(|group| told(group)).collect();
        let expected: Vec<_> = expected.into_iter().map(Some).collect();
        prop_assert_eq!(told, expected);
    }
}
