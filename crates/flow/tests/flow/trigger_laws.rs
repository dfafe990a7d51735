//! Laws of what a port gives: garbage never presses, one press that bounces is one, nothing spins.

#![allow(clippy::unwrap_used)]

use std::time::Duration;

use gaiter_flow::booth::{PortEvent, Press};
use gaiter_flow::trigger::code::Codes;
use gaiter_flow::trigger::input_decoder::Shows;
use gaiter_flow::trigger::lines::Tokens;
use gaiter_flow::trigger::report::Pattern;
use gaiter_flow::trigger::{Input, InputDecoder};
use proptest::collection::vec;
use proptest::prelude::*;

const TOKENS: [&str; 2] = ["PRESS", "HOLD"];

fn ms(time: u64) -> Duration {
    Duration::from_millis(time)
}

/// How long after a press no other counts.
const LOCK_OUT: Duration = Duration::from_secs(1);

fn serial() -> InputDecoder {
    let [short, long] = TOKENS.map(|token| vec![token.to_owned()]);
    InputDecoder::for_button(Shows::Serial { tokens: Tokens { short, long } }, LOCK_OUT)
}

/// Bytes that are mostly pieces of what a press is made of.
fn nearly_a_press() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        Just(b"PRESSx".to_vec()),
        Just(b"HOLD ".to_vec()),
        Just(b"\r".to_vec()),
        Just(b"\n".to_vec()),
        Just(b"AT\r".to_vec()),
        Just(b"PRE".to_vec()),
        Just(b"xPRESS\r".to_vec()),
        Just(b" HOLD\n".to_vec()),
        vec(any::<u8>(), 0..80),
    ];
    vec(piece, 0..30).prop_map(|pieces| pieces.concat())
}

/// Cards, whole and spoiled.
fn cards() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        "[0-9]{1,6}".prop_map(String::into_bytes),
        Just(b"\r".to_vec()),
        Just(b"\r\n".to_vec()),
        Just(b" ".to_vec()),
        vec(any::<u8>(), 0..80),
    ];
    vec(piece, 0..30).prop_map(|pieces| pieces.concat())
}

/// How a contact is seen that closes, or opens, at a time and bounces with these gaps, all ms.
fn bounces(at: u64, closing: bool, gaps: &[u64]) -> Vec<(u64, bool)> {
    let mut seen = vec![(at, closing)];
    let mut at = at;
    for (turn, gap) in gaps.iter().enumerate() {
        at += gap;
        seen.push((at, closing == (turn % 2 == 1)));
    }
    seen.push((at + 1, closing));
    seen
}

/// A press: when it is seen how.
fn press(closing: &[u64], held: u64, opening: &[u64]) -> Vec<(u64, bool)> {
    let mut seen = bounces(500, true, closing);
    let closed = seen.last().unwrap().0;
    seen.extend(bounces(closed + held, false, opening));
    seen
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Where no line is a token there is no press, however it is cut and whenever it comes: the tail
    /// of a line whose beginning was dropped in a pause is none either.
    #[test]
    fn garbage_never_presses(
        bytes in nearly_a_press(), cuts in vec((1..70_usize, 0..700_u64), 1..40),
    ) {
        let mut lines = bytes.split(|byte| matches!(byte, b'\r' | b'\n'));
        prop_assume!(!lines.any(|line| TOKENS.iter().any(|token| line == token.as_bytes())));
        let (mut decoder, mut rest, mut now) = (serial(), &bytes[..], ms(0));
        for (length, pause) in cuts.into_iter().cycle().take(3000) {
            let (piece, then) = rest.split_at(length.min(rest.len()));
            now += ms(pause);
            prop_assert_eq!(decoder.decode(&Input::Bytes(piece.to_vec()), now), []);
            rest = then;
        }
        prop_assert_eq!(decoder.decode(&Input::Bytes(b"\n".to_vec()), now), []);
        prop_assert!(decoder.garbage() <= bytes.len() as u64);
        // And it is as good as new.
        let press = decoder.decode(&Input::Bytes(b"PRESS\n".to_vec()), now + ms(1000));
        prop_assert_eq!(press, [PortEvent::Press(Press::Short)]);
    }

    /// Each line of a reader is heard once, in its order: as its own id, or as one that was not
    /// understood; never as a part of itself, however it is cut and whenever it comes.
    #[test]
    fn a_line_of_a_reader_is_its_id_or_unread(
        bytes in cards(), cuts in vec((1..20_usize, 0..700_u64), 1..40),
    ) {
        let (mut decoder, mut rest, mut now) = (InputDecoder::for_ids(Codes::default()), &bytes[..], ms(0));
        let mut heard = Vec::new();
        for (length, pause) in cuts.into_iter().cycle().take(3000) {
            let (piece, then) = rest.split_at(length.min(rest.len()));
            now += ms(pause);
            heard.extend(decoder.decode(&Input::Bytes(piece.to_vec()), now));
            rest = then;
        }
        heard.extend(decoder.decode(&Input::Nothing, now + ms(500)));
        let lines: Vec<&[u8]> = bytes
            .split(|byte| matches!(byte, b'\r' | b'\n'))
            .filter(|line| !line.is_empty())
            .collect();
        prop_assert_eq!(heard.len(), lines.len());
        for (heard, line) in heard.iter().zip(lines) {
            match heard {
                PortEvent::Named { id, .. } => prop_assert_eq!(id.as_bytes(), line.trim_ascii()),
                heard => prop_assert_eq!(heard, &PortEvent::Unread),
            }
        }
    }

    /// One press is one, whatever its contact does for a while when it closes and when it opens,
    /// and however often it is looked at.
    #[test]
    fn any_bouncing_of_one_press_is_one_press(
        closing in vec(1..20_u64, 0..12), held in 60..2500_u64,
        opening in vec(1..20_u64, 0..12), sampled in 1..10_u64,
    ) {
        let seen = press(&closing, held, &opening);
        let end = seen.last().unwrap().0 + 500;
        let is_closed = |at: u64| seen.iter().rfind(|(from, _)| *from <= at).is_some_and(|s| s.1);
        let mut decoder = serial();
        let presses: Vec<PortEvent> = (0..end / sampled)
            .map(|sample| sample * sampled)
            .flat_map(|at| decoder.decode(&Input::Closed(is_closed(at)), ms(at)))
            .collect();
        prop_assert_eq!(presses, [PortEvent::Press(Press::Short)]);
    }

    /// The same for a device that tells changes only and is listened to when the decoder asks for it.
    #[test]
    fn any_bouncing_in_reports_is_one_press(
        closing in vec(1..20_u64, 0..12), held in 60..2500_u64, opening in vec(1..20_u64, 0..12),
    ) {
        let pattern = Pattern { mask: vec![1], value: vec![1] };
        let mut decoder = InputDecoder::for_button(Shows::Report(pattern), LOCK_OUT);
        let (mut presses, mut now) = (Vec::new(), ms(0));
        for (at, closed) in press(&closing, held, &opening) {
            while let Some(due) = decoder.due().filter(|due| *due < ms(at)) {
                now = now.max(due);
                presses.extend(decoder.decode(&Input::Nothing, now));
            }
            now = ms(at);
            presses.extend(decoder.decode(&Input::Report(vec![u8::from(closed)]), now));
        }
        presses.extend(decoder.decode(&Input::Nothing, now + ms(30)));
        prop_assert_eq!(presses, [PortEvent::Press(Press::Short)]);
        prop_assert_eq!(decoder.due(), None);
    }

    /// An decoder that asks to be listened to again asks for later once it was: nothing spins.
    #[test]
    fn what_is_due_is_done_when_it_is_due(
        inputs in vec((any::<bool>(), 0..3000_u64, nearly_a_press()), 0..40), ids in any::<bool>(),
    ) {
        let mut decoder = if ids { InputDecoder::for_ids(Codes::default()) } else { serial() };
        let mut now = ms(0);
        for (closed, pause, bytes) in inputs {
            now += ms(pause);
            decoder.decode(&Input::Bytes(bytes), now);
            decoder.decode(&Input::Closed(closed), now);
            if let Some(due) = decoder.due() {
                now = now.max(due);
                decoder.decode(&Input::Nothing, now);
                decoder.decode(&Input::Closed(closed), now);
                prop_assert!(decoder.due().is_none_or(|due| due > now));
            }
        }
    }
}

#[test]
fn a_hundred_presses_a_second_are_one_a_second() {
    let mut decoder = serial();
    let token = || Input::Bytes(b"PRESS\r\n".to_vec());
    let presses: usize = (0..1000).map(|n| decoder.decode(&token(), ms(n * 10)).len()).sum();
    assert_eq!(presses, 10);
}
