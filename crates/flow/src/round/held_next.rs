//! Why the next scan would be held: shown before it is made, with what ends it.

use std::time::Duration;

use super::{Appeared, Capture, CaptureMatch, CaptureState, Rounds, distinct};

/// The trial press: no capture of the journal has its number.
const TRIAL: i64 = i64::MAX;

/// From a look without the export to the look that shows it: any time serves.
const A_MOMENT: Duration = Duration::from_millis(1);

/// Why the next scan would be held, and how long at the most.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeldNext {
    pub why: HoldReason,
    /// The patients whom the earlier captures name.
    pub of: Vec<String>,
    /// When it ends by itself, from now; `None` if that is not known.
    pub left: Option<Duration>,
}

/// Why the next scan would be held. Where there are more reasons, the first of these that applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HoldReason {
    /// An earlier scan was refused, and may be made again. Ends with that scan, or if it is given up.
    MayComeAgain,
    /// An earlier scan is held. Ends with a person's decision about it.
    Undecided,
    /// A press may have been missed.
    Unheard,
    /// An earlier export has not come. Ends when it comes, or if it is called off.
    NotCome,
    /// It is not certain who is in the booth.
    Uncertain,
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
        if !matches!(trial.match_export(export, now), CaptureMatch::Held { .. }) {
            return None;
        }
        let late = self.rules.late;
        let reason = |why: HoldReason, which: fn(&Capture) -> bool| {
            let of = self.open.iter().filter(|capture| capture.number != own && which(capture));
            let of: Vec<&Capture> = of.filter(|capture| capture.may_have(export, late)).collect();
            let end = of.iter().map(|capture| capture.until + late).max()?;
            let of = distinct(of.into_iter().flat_map(Capture::named));
            let of = of.into_iter().map(|named| named.id).collect();
            Some(HeldNext { why, of, left: Some(end.saturating_sub(now)) })
        };
        let gap = || {
            let (why, of, left) = (HoldReason::Unheard, Vec::new(), self.doubt_left(now));
            self.is_in_doubt(now).then_some(HeldNext { why, of, left })
        };
        let uncertain = || HeldNext { why: HoldReason::Uncertain, of: Vec::new(), left: None };
        let held = reason(HoldReason::MayComeAgain, |of| of.is_refused && of.is_waiting())
            .or_else(|| reason(HoldReason::Undecided, |of| of.state == CaptureState::Held))
            .or_else(gap)
            .or_else(|| reason(HoldReason::NotCome, Capture::is_waiting));
        Some(held.unwrap_or_else(uncertain))
    }
}
