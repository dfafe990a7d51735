//! Where a tape that is not held square reads another girth.

use std::fmt::Display;

use super::Report;
use crate::leg::method::Tape;
use crate::leg::{Level, Side};
use crate::record::rounding::{number, tenths_words};
use crate::record::schema::LegFigures;

/// The tilt that is told of, degrees: one that nobody sees while laying the tape, a difference in height
/// of 6 mm between the two sides of a calf of 110 mm.
const TILT_DEG: f64 = 3.0;

/// Only a difference above this is told, mm. Less is lost in what tapes scatter: one person's readings of
/// a leg differ by 3 % (te Slaa 2011), and order forms have steps of up to 5 mm.
const TELL_MM: f64 = 2.0;

impl Report<'_> {
    /// A statement for each leg with levels where the tilt matters.
    pub(super) fn tilted(&self) -> Vec<String> {
        Side::FROM_FRONT.into_iter().filter_map(|side| self.tilted_at(side)).collect()
    }

    fn tilted_at(&self, side: Side) -> Option<String> {
        let off = off_by_tilt(self.record.leg(side)?);
        let highest = off.first()?.0;
        let at = |(level, off_mm): &(Level, f64)| {
            let mm = tenths_words(*off_mm, self.language);
            self.filled("report.levels.tilted_at", &[("level", &level.name()), ("mm", &mm)])
        };
        let levels = off.iter().map(at).collect::<Vec<_>>().join(", ");
        let (leg, deg) = (self.leg_heading(side), number(TILT_DEG, 0, self.language));
        let words: [(&str, &dyn Display); 3] = [("leg", &leg), ("deg", &deg), ("levels", &levels)];
        let told = self.filled("report.levels.tilted", &words);
        // In the other planes, a tape that is held square reads another girth than that of the record.
        let plane = self.record.made_by.method.get("tape").map(String::as_str);
        let how = (plane == Some(Tape::Shank.word())).then(|| self.held(highest));
        Some([Some(told), how].into_iter().flatten().collect::<Vec<_>>().join(" "))
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
