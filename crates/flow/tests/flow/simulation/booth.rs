//! The simulated booth: patients come one after the other, are named or not, the button is pressed, and
//! the scanner exports without a name. What the journal holds of it survives a crash.

use std::time::Duration;

use gaiter_flow::round::{Capture, CaptureMatch, Named, Names, Rounds, Rules};
use gaiter_flow::settle::Memory;
use gaiter_flow::{OrdersWhen, round::ExportContent};
use gaiter_record::SourceKind;

use super::chance::Chance;
use super::disk::Patient;

/// A visit without an export is given up after this; an export that comes later than `window + late` after
/// its press is beyond what the station promises.
const PATIENCE: Duration = Duration::from_secs(9 * 60);

/// Longer windows than in practice, for the clock of the simulation leaps by minutes.
const RULES: Rules = Rules {
    by_press: true,
    window: Duration::from_secs(5 * 60),
    late: Duration::from_secs(5 * 60),
    name_lasts: Duration::from_secs(60 * 60),
    orders: OrdersWhen::BeforePress,
};

/// What the journal holds of the booth.
#[derive(Debug, Clone, Default)]
pub struct Kept {
    waiting: Vec<Capture>,
    names: Names,
    /// What the looks at the export folder knew.
    pub memory: Memory,
    last_capture: i64,
}

impl Kept {
    /// The captures as a start finds them. The port of the button is open at once.
    pub fn captures(&self, now: Duration) -> Rounds {
        let mut captures = Rounds::new(RULES, self.waiting.clone(), self.names.clone());
        captures.receives(now);
        captures
    }

    /// What holds from now on; the numbers of captures go on.
    pub fn keep(&mut self, captures: &Rounds) {
        self.waiting = captures.waiting().cloned().collect();
        self.names = captures.names().clone();
        let newest = self.waiting.iter().map(|capture| capture.number).max().unwrap_or(0);
        self.last_capture = self.last_capture.max(newest);
    }
}

/// How far a visit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Entered,
    Named,
    /// Since then the export is awaited.
    Pressed(Duration),
}

/// The people at the booth.
#[derive(Debug, Default)]
pub struct Booth {
    visit: Option<(Patient, Stage)>,
}

/// What the people did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Did {
    Nothing,
    Named,
    Pressed,
    GivenUp,
    /// The scanner is to export the body of this patient.
    Scanned(Patient),
}

impl Booth {
    /// Whether somebody is in the booth.
    pub fn is_visited(&self) -> bool {
        self.visit.is_some()
    }

    /// The visit goes one step on. Where the journal fails nothing has happened, and a press is lost.
    pub fn go_on(
        &mut self,
        captures: &mut Rounds,
        kept: &mut Kept,
        journal_fails: bool,
        now: Duration,
        chance: &mut Chance,
    ) -> Did {
        let Some((patient, stage)) = self.visit else {
            self.visit = Some((1 + chance.below(5) as u8, Stage::Entered));
            return Did::Nothing;
        };
        let mut after = captures.clone();
        let (next, did) = match stage {
            // A third of the patients is not named, unless the light shows that another's name waits.
            Stage::Entered if chance.below(3) > 0 || captures.next().is_some() => {
                let by = [SourceKind::Reader, SourceKind::Order][chance.below(2)];
                let named = Named::new(patient.to_string(), by);
                after.named(named, kept.last_capture + 1, now, &[]);
                (Stage::Named, Did::Named)
            }
            Stage::Entered | Stage::Named => {
                after.pressed(kept.last_capture + 1, now);
                (Stage::Pressed(now), Did::Pressed)
            }
            Stage::Pressed(at) if now > at + PATIENCE => {
                self.visit = None;
                after.call_off();
                // Who gives up does so until the station has taken it.
                kept.keep(&after);
                *captures = after;
                return Did::GivenUp;
            }
            Stage::Pressed(_) => {
                self.visit = None;
                return Did::Scanned(patient);
            }
        };
        match (journal_fails, next) {
            // The scan is made all the same.
            (true, Stage::Pressed(_)) => captures.missed_press(now),
            // The person who names sees that it failed, and says it again; an order does so too.
            (true, _) => {
                captures.unread(Some(now));
                return Did::Nothing;
            }
            (false, _) => {
                kept.keep(&after);
                *captures = after;
            }
        }
        self.visit = Some((patient, next));
        did
    }
}

/// What is judged of an export that may be of these patients' refused scan.
pub fn content(
    began: gaiter_flow::Appeared,
    is_known: bool,
    is_cut_short: bool,
    completes: Option<Vec<Patient>>,
) -> ExportContent {
    let named = |patient: Patient| Named::new(patient.to_string(), SourceKind::Order);
    let known = |patients: Vec<Patient>| {
        patients.into_iter().filter(|patient| *patient > 0).map(named).collect()
    };
    let others = Vec::new();
    ExportContent { began, others, is_known, is_cut_short, completes: completes.map(known) }
}

/// The number of the capture that an export answered.
pub fn answered(judged: &CaptureMatch) -> Option<i64> {
    match judged {
        CaptureMatch::Of(capture) => Some(capture.number),
        CaptureMatch::Held { answered, .. } => *answered,
        CaptureMatch::Unpressed | CaptureMatch::Known => None,
    }
}
