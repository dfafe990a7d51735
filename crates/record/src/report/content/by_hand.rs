//! What people set in place of the scan's figures, in words.

use std::fmt::Display;

use gaiter_leg::{Level, Side};

use super::Report;
use crate::measure::amendment::{ByHand, Subject};
use crate::measure::{Length, Measure};
use crate::rounding::cm_words;
use crate::shown;

impl Report<'_> {
    /// A line for each measure that a person set: the value, the scan's beside it, why, who and when.
    pub(super) fn by_hand(&self) -> Vec<String> {
        let sides = Side::FROM_FRONT.into_iter();
        let of_leg = |side| Subject::all().filter_map(move |of| self.set_by_hand(side, of));
        sides.flat_map(of_leg).collect()
    }

    fn set_by_hand(&self, side: Side, subject: Subject) -> Option<String> {
        let hand = self.record.by_hand(side, subject)?;
        let values = match subject {
            _ if hand.is_not_measurable => self.text("report.missing.not_measurable"),
            Subject::Level(level) => self.level_by_hand(side, level, &hand),
            length => {
                let scanned = Length::scanned_of(self.record, side, length).map(|of| of.mm);
                self.with_scanned("report.by_hand.length", hand.length_mm?, scanned)
            }
        };
        let words: [(&str, &dyn Display); 6] = [
            ("leg", &self.leg_heading(side)),
            ("measure", &subject.name(self.language)),
            ("values", &values),
            ("reason", &shown::id(&hand.last.reason)),
            ("by", &shown::id(&hand.last.by)),
            ("when", &self.local(hand.last.at)),
        ];
        Some(self.filled("report.by_hand.line", &words))
    }

    fn level_by_hand(&self, side: Side, level: Level, hand: &ByHand<'_>) -> String {
        let scanned = self.record.leg(side).and_then(|leg| Measure::scanned(leg, level));
        let girth_mm = scanned.as_ref().map(|of| of.girth.mm);
        let height_mm = scanned.and_then(|of| of.height).map(|of| of.mm);
        let girth = hand.girth_mm.map(|mm| ("report.by_hand.girth", mm, girth_mm));
        let height = hand.height_mm.map(|mm| ("report.by_hand.height", mm, height_mm));
        // Where only the height was set, the girth is another than at the scan's height.
        let there = Measure::of(self.record, side, level).ok().filter(|of| !of.girth.is_by_hand);
        let there = there.filter(|_| hand.height_mm.is_some());
        let there = there.map(|of| ("report.by_hand.girth_there", of.girth.mm, girth_mm));
        let said = |(key, mm, scanned_mm)| self.with_scanned(key, mm, scanned_mm);
        [girth, height, there].into_iter().flatten().map(said).collect::<Vec<_>>().join(", ")
    }

    /// `girth 38.5 cm (scan: 38.2)`
    fn with_scanned(&self, key: &'static str, mm: f64, scanned_mm: Option<f64>) -> String {
        let scanned = match scanned_mm {
            Some(mm) => cm_words(mm, self.language),
            None => self.text("report.missing.level_absent"),
        };
        self.filled(key, &[("cm", &cm_words(mm, self.language)), ("scan", &scanned)])
    }
}
