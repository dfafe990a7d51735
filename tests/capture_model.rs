//! Captures against a booth that is played out: patients are named, the button is pressed and not
//! always heard, the scanner exports in time, late or never, the port goes away and the station
//! restarts. Whatever happens, no export is given to a patient who was not scanned.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::time::Duration;

use gaiter::flow::capture::{Appeared, Capture, CaptureState, Captures, Judged, Named, Rules};
use gaiter::record::SourceKind;
use proptest::prelude::*;

const RULES: Rules = Rules {
    by_press: true,
    window: Duration::from_secs(60),
    late: Duration::from_secs(300),
    name_lasts: Duration::from_secs(600),
};

/// What happens at the booth, one thing after the other.
#[derive(Debug, Clone)]
enum Step {
    /// A patient is named. Whoever is named stands in the booth from then on.
    Name {
        patient: u8,
    },
    /// The next patient steps in and nobody says who.
    NextUnnamed {
        patient: u8,
    },
    /// The button is pressed: the scanner scans whoever stands in the booth, and exports after so
    /// many seconds, or never.
    Press {
        export_after_s: Option<u64>,
    },
    /// Somebody calls off what waits.
    CallOff,
    Unplug,
    Plug,
    Restart,
    /// Time passes.
    Wait {
        seconds: u64,
    },
}

/// The booth, and what the station makes of it.
struct Booth {
    now: Duration,
    station: Captures,
    is_plugged: bool,
    standing: Option<u8>,
    /// How many presses were heard.
    presses: i64,
    /// Exports to come: when, of whom.
    to_come: Vec<(Duration, u8)>,
    last_look: Option<Duration>,
    /// What became of each heard press: how often it was answered or expired.
    answered: Vec<i64>,
    expired: Vec<i64>,
    called_off: Vec<i64>,
    exports: usize,
    judged: usize,
    given: usize,
}

fn id(patient: u8) -> String {
    format!("{patient}")
}

impl Booth {
    fn new() -> Booth {
        let now = Duration::from_secs(1000);
        Booth {
            now,
            station: heard_since(now, Captures::new(RULES, Vec::new(), None)),
            is_plugged: true,
            standing: None,
            presses: 0,
            to_come: Vec::new(),
            last_look: Some(now),
            answered: Vec::new(),
            expired: Vec::new(),
            called_off: Vec::new(),
            exports: 0,
            judged: 0,
            given: 0,
        }
    }

    fn step(&mut self, step: &Step) {
        match *step {
            Step::Name { patient } => {
                self.standing = Some(patient);
                let named = Named { id: id(patient), by: SourceKind::Operator };
                self.station.named(named, self.presses + 1, self.now);
            }
            Step::NextUnnamed { patient } => {
                // The one who was named before has left; whoever takes over says so.
                self.standing = Some(patient);
                let called_off = self.station.call_off();
                self.called_off.extend(called_off.captures);
            }
            Step::Press { export_after_s } => self.press(export_after_s),
            Step::CallOff => {
                let called_off = self.station.call_off();
                self.called_off.extend(called_off.captures);
            }
            Step::Unplug => {
                self.is_plugged = false;
                self.station.deaf();
            }
            Step::Plug => {
                self.is_plugged = true;
                self.station.hears(self.now);
            }
            Step::Restart => self.restart(),
            Step::Wait { seconds } => (0..seconds).for_each(|_| self.second()),
        }
    }

    fn press(&mut self, export_after_s: Option<u64>) {
        let Some(patient) = self.standing else { return };
        if self.is_plugged {
            self.presses += 1;
            self.station.pressed(self.presses, self.now);
        }
        if let Some(after) = export_after_s {
            self.to_come.push((self.now + Duration::from_secs(after), patient));
            self.exports += 1;
        }
        // The station looks at its folders right after a press.
        self.second();
    }

    /// One second: the exports whose time it is appear, and the station looks.
    fn second(&mut self) {
        let look = self.now;
        self.now += Duration::from_secs(1);
        let (came, to_come) = self.to_come.iter().partition(|(at, _)| *at < look);
        self.to_come = to_come;
        let came: Vec<(Duration, u8)> = came;
        for (_, patient) in came {
            self.take(patient, Appeared { absent: self.last_look, seen: self.now });
        }
        self.last_look = Some(look);
        self.expired.extend(self.station.pass(self.now, &[]).expired);
    }

    fn take(&mut self, patient: u8, appeared: Appeared) {
        let judged = self.station.judge(appeared);
        self.station.answer(&judged);
        self.judged += 1;
        match judged {
            Judged::Of(Capture { patient: Some(named), number, .. }) => {
                assert_eq!(named.id, id(patient), "given to somebody else");
                self.given += 1;
                self.answered.push(number);
            }
            Judged::Of(capture) => self.answered.push(capture.number),
            Judged::Held { answered, .. } => self.answered.extend(answered),
            Judged::Unpressed => {}
        }
    }

    /// The station comes back with what its journal holds.
    fn restart(&mut self) {
        let waiting = self.station.waiting().to_vec();
        let next = self.station.next().cloned();
        self.station = Captures::new(RULES, waiting, next);
        self.last_look = None;
        if self.is_plugged {
            self.station.hears(self.now);
        }
    }

    /// Every heard press is answered, expired, called off or still waiting, and no press is answered
    /// twice.
    fn presses_are_accounted_for(&self) {
        for number in 1..=self.presses {
            let answered = self.answered.iter().filter(|n| **n == number).count();
            let ended = self.expired.contains(&number) || self.called_off.contains(&number);
            let waits = self
                .station
                .waiting()
                .iter()
                .any(|capture| capture.number == number && capture.state == CaptureState::Open);
            assert!(answered <= 1, "press {number} is answered {answered} times");
            assert!(answered == 1 || ended || waits, "press {number} is lost");
        }
    }
}

fn heard_since(now: Duration, mut captures: Captures) -> Captures {
    captures.hears(now - RULES.window - RULES.late);
    captures
}

fn step() -> impl Strategy<Value = Step> {
    // In time, late, or never.
    let export = prop_oneof![6 => (2..50u64).prop_map(Some), 1 => (61..300u64).prop_map(Some), 1 => Just(None)];
    prop_oneof![
        4 => (1..4u8).prop_map(|patient| Step::Name { patient }),
        1 => (1..4u8).prop_map(|patient| Step::NextUnnamed { patient }),
        6 => export.prop_map(|export_after_s| Step::Press { export_after_s }),
        1 => Just(Step::CallOff),
        1 => Just(Step::Unplug),
        2 => Just(Step::Plug),
        1 => Just(Step::Restart),
        6 => (1..90u64).prop_map(|seconds| Step::Wait { seconds }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_export_is_given_to_a_patient_who_was_not_scanned(
        steps in prop::collection::vec(step(), 1..40),
    ) {
        let mut booth = Booth::new();
        for step in &steps {
            booth.step(step);
            booth.presses_are_accounted_for();
        }
        // In the end every export has come and was judged, and no press waits for ever.
        booth.step(&Step::Wait { seconds: 800 });
        booth.presses_are_accounted_for();
        prop_assert_eq!(booth.judged, booth.exports);
        prop_assert!(booth.station.waiting().is_empty());
    }
}

#[test]
fn an_undisturbed_booth_gives_every_export_to_its_patient() {
    let mut booth = Booth::new();
    for patient in 1..100 {
        booth.step(&Step::Name { patient });
        booth.step(&Step::Press { export_after_s: Some(20) });
        booth.step(&Step::Wait { seconds: 30 });
    }
    assert_eq!((booth.given, booth.exports), (99, 99));
}
