//! Where a tape that is not held square reads another girth.

use std::fmt::Display;

use gaiter_leg::method::Tape;
use gaiter_leg::{Level, Side};

use super::Report;
use crate::rounding::{number, tenths_words};
use crate::schema::LegFigures;

/// The tilt that is told of, degrees: one that nobody sees while laying the tape, a difference in height
/// of 6 mm between the two sides of a calf of 110 mm.
const TILT_DEG: f64 = 3.0;

/// Only a difference above this is told, mm. Less is lost in what tapes scatter: one person's readings of
/// a leg differ by 3 % (te Slaa 2011), and order forms have steps of up to 5 mm.
const TELL_MM: f64 = 2.0;

impl Report<'_> {
    /// Where the tilt matters, on both legs, and how to hold the tape; `None` where it does not.
    pub(super) fn tilted(&self) -> Option<String> {
        let off = |side: Side| Some((side, off_by_tilt(self.record.leg(side)?)));
        let legs = Side::FROM_FRONT.into_iter().filter_map(off);
        let legs: Vec<(Side, Vec<(Level, f64)>)> =
            legs.filter(|(_, off)| !off.is_empty()).collect();
        let highest = legs.iter().filter_map(|(_, off)| Some(off.first()?.0)).max()?;
        let said: Vec<String> = legs.iter().map(|(side, off)| self.tilted_at(*side, off)).collect();
        let deg = number(TILT_DEG, 0, self.language);
        let words: [(&str, &dyn Display); 2] = [("deg", &deg), ("legs", &said.join("; "))];
        let told = self.filled("report.levels.tilted", &words);
        // In the other planes, a tape that is held square reads another girth than that of the record.
        let plane = self.record.made_by.method.get("tape").map(String::as_str);
        let how = (plane == Some(Tape::Shank.word())).then(|| self.held(highest));
        Some([Some(told), how].into_iter().flatten().collect::<Vec<_>>().join(" "))
    }

    /// `right leg D 2.7 mm, C 2.1 mm`
    fn tilted_at(&self, side: Side, off: &[(Level, f64)]) -> String {
        let at = |(level, off_mm): &(Level, f64)| {
            let mm = tenths_words(*off_mm, self.language);
            self.filled("report.levels.tilted_at", &[("level", &level.name()), ("mm", &mm)])
        };
        let levels = off.iter().map(at).collect::<Vec<_>>().join(", ");
        format!("{} {levels}", self.leg(side))
    }

    /// How to hold the tape at levels up to this one.
    fn held(&self, highest: Level) -> String {
        match highest > Level::D {
            true => self.text("report.levels.hold_square_to_both"),
            false => self.text("report.levels.hold_square"),
        }
    }
}

/// The levels where the tilt matters, highest first, and what it does to their girths, mm.
fn off_by_tilt(leg: &LegFigures) -> Vec<(Level, f64)> {
    let off = |level: Level| {
        let off_mm = TILT_DEG * leg.landmarks.get(level.name())?.girth_per_deg_mm?;
        (off_mm > TELL_MM).then_some((level, off_mm))
    };
    Level::ALL.into_iter().rev().filter_map(off).collect()
}
