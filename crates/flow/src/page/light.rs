//! The one light: its word, and one sentence on what to do next.

use std::time::Duration;

use gaiter_language::Language;
use serde::Serialize;

use super::distinct;
use super::reasons::{OF_PORT, of_button_away, of_complaint, of_held, of_refused};
use super::scans::ScanShown;
use super::sentence::Sentence;
use crate::Task;
use crate::booth::Signal;
use crate::complaint::Complaint;
use crate::light::{LastOutcome, Progress};
use crate::round::{HeldNext, HoldReason};
use crate::words::at_most;

/// The light on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LightShown {
    /// The signal's stable word; it decides colour and sign.
    pub signal: &'static str,
    /// The word that is read from a distance.
    pub word: &'static str,
    /// What to do next.
    #[serde(flatten)]
    pub said: Sentence,
}

/// The state of the booth.
#[derive(Debug, Clone, Copy)]
pub struct Situation<'a> {
    /// What its light shows.
    pub signal: Signal,
    /// A button is connected to the station.
    pub has_button: bool,
    /// It is not there, or another one is not: presses may be missed.
    pub is_button_away: bool,
    /// How many exports are expected.
    pub awaited: usize,
    /// The ids of the patients who may be next: one if it is certain, several if it is in doubt.
    pub next: &'a [String],
    /// The ids of the patients whose exports are expected; without a button a name opens the capture.
    pub awaited_for: &'a [String],
    /// It is not certain who is next: somebody at the booth must confirm it.
    pub is_asked: bool,
    /// A press may have been missed.
    pub is_in_doubt: bool,
    /// How much longer presses are in doubt for that; `None` while the button cannot be read.
    pub doubt_left: Option<Duration>,
    /// Why the scan that is made next would be held.
    pub held_next: Option<&'a HeldNext>,
    /// How far the export or scan is for which the light shows "measuring".
    pub progress: Option<Progress>,
    /// How the last scan since the last press ended; `None` if none has ended since.
    pub last: Option<&'a LastOutcome>,
    /// The id of that scan; `None` if what happened last is of none.
    pub last_scan: Option<&'a str>,
    /// The ids of the patients to whom that scan belongs, or may belong if it is held.
    pub last_of: &'a [String],
}

/// The light; `fault` is the most serious one, if there is one, `undecided` what a person must do something about.
pub(super) fn light_shown(
    booth: &Situation<'_>,
    fault: Option<&Complaint>,
    undecided: &[ScanShown],
    language: Language,
) -> LightShown {
    let is_any_undecided = undecided.iter().any(|scan| scan.task == Task::Decide);
    let decide = is_any_undecided.then(|| language.text("page.decide"));
    let is_incomplete = |scan: &ScanShown| scan.task == Task::Complete;
    let is_any_incomplete = decide.is_none() && undecided.iter().any(is_incomplete);
    let complete = is_any_incomplete.then(|| language.text("page.complete"));
    let away = of_button_away(language);
    let also_away = booth.is_button_away.then_some(away.as_str());
    let step = || Sentence::new(language.text(next_step(booth)));
    let said = match booth.signal {
        Signal::Attention => {
            let is_of_port = fault.is_some_and(|fault| fault.code.starts_with(OF_PORT));
            let fault = fault.map(|fault| Sentence::new(&of_complaint(fault, language).in_a_row()));
            // The patient waits, a decision can wait.
            let last = of_last(booth, undecided, language);
            let away = also_away.filter(|_| !is_of_port).map(Sentence::new);
            let said = [fault, last, away].into_iter().flatten().reduce(Sentence::then);
            said.unwrap_or_else(|| decide.map_or_else(step, Sentence::new))
        }
        Signal::Done if booth.last == Some(&LastOutcome::Delivered) => {
            on_last(booth, DONE, language).and(also_away).and(decide).and(complete)
        }
        Signal::Armed => {
            step().and(booth.held_next.map(|_| language.text("page.hold.armed"))).and(also_away)
        }
        // Another scan may have ended since the light was lit.
        Signal::Ready | Signal::Done | Signal::NoExport => {
            match (booth.is_button_away, first_to_do(booth, is_any_undecided, language)) {
                (true, _) => Sentence::new(&away),
                (false, Some(words)) if booth.signal == Signal::NoExport => step().then(words),
                (false, Some(words)) => words.then(step()),
                (false, None) => step(),
            }
            .and(decide)
            .and(complete)
        }
        Signal::Receiving | Signal::Paused => step().and(also_away),
    };
    let signal = booth.signal.word();
    let word = match (booth.signal, booth.progress) {
        (Signal::Receiving, Some(Progress::ComingIn)) => "coming_in",
        (Signal::Receiving, Some(Progress::Stopped)) => "stopped",
        _ => signal,
    };
    LightShown { signal, word: language.word("page.light", word), said }
}

/// Keys of a sentence that may name patients: without ids, and with them.
type Keys = [&'static str; 2];

const DONE: Keys = ["page.step.done", "page.step.done_of"];
const HELD: Keys = ["page.step.held", "page.step.held_of"];
const REFUSED: Keys = ["page.step.refused", "page.step.refused_of"];
const LACKS: Keys = ["page.step.lacks", "page.step.lacks_of"];
const KNOWN: Keys = ["page.step.known", "page.step.known_of"];

/// A sentence that names these patients, if there are any.
fn naming(
    ids: &[String],
    [without, with]: Keys,
    before_last: &'static str,
    language: Language,
) -> Sentence {
    let unnamed = Sentence::new(language.text(without));
    match distinct(ids).as_slice() {
        [] => unnamed,
        patients => {
            let named = Sentence::naming(language.text(with), patients, language.text(before_last));
            Sentence { anonymous: unnamed.anonymous, ..named }
        }
    }
}

/// A sentence on the last scan.
fn on_last(booth: &Situation<'_>, keys: Keys, language: Language) -> Sentence {
    let is_held = matches!(booth.last, Some(LastOutcome::Held { .. }));
    let before_last = if is_held { "page.next.or" } else { "page.next.and" };
    naming(booth.last_of, keys, before_last, language)
}

/// What happens until the next scan is not held any more, and how long at the most.
fn until(held: &HeldNext, language: Language) -> Option<String> {
    let time = at_most(held.left?, language);
    Some(language.filled("page.hold.until", &[("time", &time)]))
}

/// What must be done before the next scan, or it is held; `None` if it would not be, or the light asks already.
fn first_to_do(
    booth: &Situation<'_>,
    is_any_undecided: bool,
    language: Language,
) -> Option<Sentence> {
    let held = booth.held_next?;
    let keys = match held.why {
        HoldReason::Unheard => {
            return Some(Sentence::new(&in_doubt(held.left, language)));
        }
        HoldReason::Uncertain if booth.is_asked => return None,
        HoldReason::Uncertain if booth.signal == Signal::NoExport => return None,
        // The patient whose export is missing can be scanned again without being held; only others are.
        _ if booth.signal == Signal::NoExport => ["page.hold.others"; 2],
        HoldReason::Uncertain => ["page.hold.uncertain"; 2],
        HoldReason::MayComeAgain => ["page.hold.again", "page.hold.again_of"],
        HoldReason::Undecided if is_any_undecided => ["page.hold.undecided"; 2],
        // Of a held scan that was given up it is not known whether it was theirs.
        HoldReason::Undecided | HoldReason::NotCome => {
            ["page.hold.not_come", "page.hold.not_come_of"]
        }
    };
    let words = naming(&held.of, keys, "page.next.and", language);
    Some(words.and(until(held, language).as_deref()))
}

/// A press may have been missed, and how much longer that matters.
pub(super) fn in_doubt(left: Option<Duration>, language: Language) -> String {
    match left {
        Some(left) => {
            language.filled("page.next.in_doubt_for", &[("time", &at_most(left, language))])
        }
        None => language.text("page.next.in_doubt").to_owned(),
    }
}

/// What the last scan needs from a person at the booth; `None` if nothing.
fn of_last(booth: &Situation<'_>, undecided: &[ScanShown], language: Language) -> Option<Sentence> {
    let unusable = undecided
        .iter()
        .find(|scan| Some(scan.scan.as_str()) == booth.last_scan && scan.unmeasured.is_some());
    let unusable = unusable.and_then(|scan| scan.advice.as_ref());
    let text = |key| language.text(key);
    let of = |keys| on_last(booth, keys, language);
    let also_held = |words: Sentence| match booth.held_next {
        Some(held) if held.why == HoldReason::MayComeAgain => {
            let is_it = booth.last_of.iter().all(|id| held.of.contains(id));
            let or =
                if is_it { text("page.hold.or_give_up") } else { text("page.hold.first_other") };
            words.and([or]).and(until(held, language).as_deref())
        }
        Some(held) if held.why == HoldReason::Undecided => {
            words.and(until(held, language).as_deref())
        }
        _ => words,
    };
    Some(match booth.last? {
        LastOutcome::Delivered => return None,
        LastOutcome::Incomplete { to_do } => {
            let named = of(LACKS).and(to_do.iter().map(String::as_str));
            match (to_do.as_slice(), booth.last_of) {
                ([], _) => named,
                (_, []) => Sentence::new(&to_do.join(" ")),
                _ => Sentence { anonymous: to_do.join(" "), ..named },
            }
        }
        LastOutcome::Held { code } => {
            let why = of_held(code, language).what;
            let [why, next] = match unusable {
                Some(advice) => [advice.what.as_str(), &advice.next],
                None => [why.as_str(), text("page.step.decide_held")],
            };
            also_held(of(HELD).and([why, next]))
        }
        LastOutcome::Unassigned { to_do } => {
            let to_do = to_do.iter().map(String::as_str);
            Sentence::new(text("page.step.unassigned")).and(to_do)
        }
        LastOutcome::Refused { code } => {
            also_held(of(REFUSED).and([of_refused(code, language).in_a_row().as_str()]))
        }
        LastOutcome::NameUnread => Sentence::new(text("page.step.name_unread")),
        LastOutcome::Known => of(KNOWN).and([text("page.step.export_new")]),
    })
}

/// The key of the sentence on what to do next.
fn next_step(booth: &Situation<'_>) -> &'static str {
    match (booth.signal, booth.has_button) {
        (Signal::Ready, true) if booth.is_asked => "page.step.say_who",
        (Signal::Ready, true) if !booth.next.is_empty() => "page.step.press_for_named",
        (Signal::Ready, true) => "page.step.press",
        (Signal::Ready, false) => "page.step.scan",
        (Signal::Armed, _) => "page.step.armed",
        (Signal::Receiving, _) => match booth.progress {
            Some(Progress::ComingIn) => "page.step.coming_in",
            Some(Progress::Stopped) => "page.step.stopped",
            Some(Progress::Measuring) | None => "page.step.receiving",
        },
        (Signal::Done, _) => "page.step.done",
        (Signal::Attention, _) => "page.step.attention",
        (Signal::Paused, _) => "page.step.paused",
        (Signal::NoExport, true) => "page.step.no_export",
        (Signal::NoExport, false) => "page.step.no_export_without_button",
    }
}
