//! Why the scan that is made next would be held: told before it is made, with what ends it.

use std::time::Duration;

use super::{Appeared, Capture, CaptureState, Judged, Rounds, Why};

/// The trial press: no capture of the journal has its number.
const TRIAL: i64 = i64::MAX;

/// From a look without the export to the look that shows it: any time serves.
const A_MOMENT: Duration = Duration::from_millis(1);

/// Why the next scan would be held. Where there are more reasons, the first of these that applies; the patients
/// are those whom the earlier captures name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum HeldNext {
    /// The scan of these patients was refused, and may be made again. Ends with that scan, or if it is given up.
    MayComeAgain(Vec<String>),
    /// An earlier scan is held. Ends with a person's decision about it.
    Undecided(Vec<String>),
    /// A press may have been missed. Ends with time.
    Unheard,
    /// The export of these patients has not come. Ends when it comes, with time, or if it is called off.
    NotCome(Vec<String>),
    /// It is not certain who is in the booth.
    Uncertain,
}

impl HeldNext {
    /// The patients whom the reason names.
    pub fn patients(&self) -> &[String] {
        match self {
            HeldNext::MayComeAgain(of) | HeldNext::Undecided(of) | HeldNext::NotCome(of) => of,
            HeldNext::Unheard | HeldNext::Uncertain => &[],
        }
    }
}

impl Rounds {
    /// Why an export would be held that came now: of the press that waits for one, or else of a press at this moment.
    /// `None` if it would not.
    pub fn held_next(&self, now: Duration) -> Option<HeldNext> {
        let mut trial = self.clone();
        let is_own = |capture: &&Capture| capture.is_open() && !capture.is_refused;
        let own = match self.open.iter().rfind(is_own) {
            Some(own) => own.number,
            None if self.rules.by_press => trial.pressed(TRIAL, now).number,
            None => TRIAL,
        };
        let export = Appeared { absent: Some(now), seen: now + A_MOMENT };
        let Judged::Held { why, .. } = trial.judge(export, now) else { return None };
        let earlier = |which: fn(&Capture) -> bool| {
            let of = self.open.iter().filter(|capture| capture.number != own && which(capture));
            let mut of = of.filter(|capture| capture.may_have(export, self.rules.late)).peekable();
            of.peek()?;
            let mut ids: Vec<String> = Vec::new();
            for named in of.flat_map(Capture::named) {
                if !ids.contains(&named.id) {
                    ids.push(named.id.clone());
                }
            }
            Some(ids)
        };
        let may_come_again = earlier(|capture| capture.is_refused && capture.is_waiting());
        let undecided = earlier(|capture| capture.state == CaptureState::Held);
        let is_unheard = why == Why::Unheard || self.is_in_doubt(now);
        may_come_again
            .map(HeldNext::MayComeAgain)
            .or_else(|| undecided.map(HeldNext::Undecided))
            .or_else(|| is_unheard.then_some(HeldNext::Unheard))
            .or_else(|| earlier(Capture::is_waiting).map(HeldNext::NotCome))
            .or(Some(HeldNext::Uncertain))
    }
}
