//! The words of a report of visits.

use std::fmt::Display;

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::rounding::{number, signed, tenths_words};
use gaiter_record::shown;

use crate::caution::Caution;
use crate::comparison::Comparison;
use crate::course::{Affected, Course};
use crate::excess::Reduction;
use crate::left_out::StandIns;
use crate::quantity::{Change, Shown};
use crate::visit::Visit;

/// The decimals that volumes can have in words, and what one of the last place is a part of; the most are those of the
/// JSON form.
const ML_DECIMALS: [(usize, f64); 4] = [(0, 1.0), (1, 10.0), (2, 100.0), (3, 1000.0)];

/// The same of percentages.
const PERCENT_DECIMALS: [(usize, f64); 2] = [(1, 10.0), (2, 100.0)];

/// Behind the day of a visit that replaces a record that is left out.
const STAND_IN: &str = " #";

/// Whether a change, as printed, reaches the detectable change, as printed, exactly if it is shown.
fn reads_as_shown([by, detectable]: [f64; 2], shown: Shown, scale: f64) -> bool {
    let is_reached = (scale * by).round().abs() >= scale * up(detectable, scale) - 0.5;
    is_reached == (shown != Shown::NoChange)
}

/// Rounded up, so that the detectable change never looks smaller than it is.
fn up(value: f64, scale: f64) -> f64 {
    (scale * value - 1e-9).ceil() / scale
}

/// Writes the words of one course in one language.
#[derive(Debug, Clone, Copy)]
pub(super) struct Words<'a> {
    pub course: &'a Course,
    pub language: Language,
}

impl Words<'_> {
    pub(super) fn text(&self, key: &'static str) -> String {
        self.language.text(key).to_owned()
    }

    /// Those of some texts that hold here, in their order.
    pub(super) fn joined(&self, all: &[(bool, &'static str)]) -> String {
        let texts = all.iter().filter(|(holds, _)| *holds);
        texts.map(|&(_, key)| self.language.text(key)).collect::<Vec<_>>().join(" ")
    }

    pub(super) fn filled(&self, key: &'static str, words: &[(&str, &dyn Display)]) -> String {
        self.language.filled(key, words)
    }

    /// Both legs, the affected one first; without one as a person who faces the patient sees them.
    pub(super) fn affected_first(&self) -> [Side; 2] {
        match self.course.choice.affected {
            Some(Affected::One(side)) => [side, side.other()],
            Some(Affected::Both | Affected::Neither) | None => Side::FROM_FRONT,
        }
    }

    pub(super) fn leg(&self, side: Side) -> &'static str {
        self.language.word("leg.heading", side.word())
    }

    pub(super) fn leg_in_sentence(&self, side: Side) -> &'static str {
        self.language.word("leg", side.word())
    }

    /// The day of a visit, or its number if its time is not known.
    pub(super) fn day(&self, visit: usize) -> String {
        match &self.course.visits[visit].acquired {
            Some(acquired) => {
                acquired.local().strftime(self.language.text("visits.day")).to_string()
            }
            None => self.filled("visits.number", &[("number", &(visit + 1))]),
        }
    }

    /// The days of a comparison: of the earlier visit, of the later one. One that stands in the place of a record
    /// that is left out has a sign.
    pub(super) fn days(&self, of: &Comparison) -> [String; 2] {
        let StandIns { earlier, later } = of.stand_ins;
        [(of.earlier, earlier), (of.later, later)].map(|(visit, is_stand_in)| {
            let sign = if is_stand_in { STAND_IN } else { "" };
            self.day(visit) + sign
        })
    }

    /// Day and time of a visit; UTC, and marked so, if the zone is not known.
    pub(super) fn time(&self, visit: &Visit) -> String {
        let Some(acquired) = &visit.acquired else { return self.text("report.fact.time_unknown") };
        let words = acquired.local().strftime(self.language.text("report.time")).to_string();
        if acquired.utc_offset_min.is_some() { words } else { words + " UTC" }
    }

    pub(super) fn patient(&self) -> String {
        let patient = self.course.visits.first().and_then(|visit| visit.patient.as_deref());
        patient.map_or_else(|| self.text("report.fact.not_assigned"), shown::id)
    }

    pub(super) fn posture(&self, visit: &Visit) -> String {
        match &visit.posture {
            Some(posture) => self.language.word("posture", posture).to_owned(),
            None => self.text("visits.unknown"),
        }
    }

    /// A volume, mL, with its sign.
    pub(super) fn ml_change(&self, ml: f64) -> String {
        signed(ml, &number(ml, 0, self.language))
    }

    /// A percent reduction and its uncertainty: without decimals where that is 10 % or more. Only a negative one has
    /// a sign.
    pub(super) fn reduction(&self, of: &Reduction) -> [String; 2] {
        let (decimals, scale) = if of.expanded < 10.0 { (1, 10.0) } else { (0, 1.0) };
        let words = |value: f64| number(value, decimals, self.language);
        let percent = signed(of.percent, &words(of.percent));
        [percent.trim_start_matches('+').to_owned(), words(up(of.expanded, scale))]
    }

    /// A percentage with its sign.
    pub(super) fn percent_change(&self, percent: f64) -> String {
        signed(percent, &tenths_words(percent, self.language))
    }

    /// A change of a volume, mL, and from which on it can be shown: whole ones, because a ± is one.
    pub(super) fn printed(&self, change: &Change) -> [String; 2] {
        self.printed_with(&ML_DECIMALS, [change.by, change.detectable()], change.shown())
    }

    /// The percentage of a change, and from which on it can be shown.
    pub(super) fn printed_percent(&self, change: &Change) -> [String; 2] {
        let figures = [change.percent, change.detectable_percent()];
        self.printed_with(&PERCENT_DECIMALS, figures, change.shown())
    }

    /// A change with its sign, and the detectable change. Only where the printed change would reach the printed
    /// detectable one without being shown, or the reverse, both have enough decimals to distinguish them.
    fn printed_with(
        &self,
        all: &[(usize, f64)],
        [by, detectable]: [f64; 2],
        shown: Shown,
    ) -> [String; 2] {
        let reads_right =
            |(_, scale): &&(usize, f64)| reads_as_shown([by, detectable], shown, *scale);
        let found = all.iter().find(reads_right).or(all.last());
        let (decimals, scale) = found.copied().unwrap_or((0, 1.0));
        let words = |value: f64| number(value, decimals, self.language);
        [signed(by, &words(by)), words(up(detectable, scale))]
    }

    /// A reason for caution in a comparison.
    pub(super) fn caution(&self, of: &Comparison, caution: &Caution) -> String {
        let whole = |value: f64| number(value, 0, self.language);
        let tenths = |value: f64| tenths_words(value, self.language);
        let code = caution.code();
        let with = |words: &[(&str, &dyn Display)]| {
            self.language.filled_word("visits.caution", code, words)
        };
        match caution {
            Caution::TimeOfDay { hours } => with(&[("hours", &whole(*hours))]),
            Caution::Posture => {
                let [before, after] =
                    [of.earlier, of.later].map(|visit| self.posture(&self.course.visits[visit]));
                with(&[("before", &before), ("after", &after)])
            }
            Caution::Stance { side, change } => with(&[
                ("leg", &self.leg(*side)),
                ("tilt", &whole(change.tilt_deg)),
                ("bend", &whole(change.bend_deg)),
            ]),
            Caution::Drift { by_mm } => with(&[("mm", &signed(*by_mm, &tenths(*by_mm)))]),
            Caution::ByHand { side } => with(&[("leg", &self.leg(*side))]),
            Caution::TimeUnknown | Caution::Station | Caution::NoPhantom => with(&[]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::{Parts, Quantity};

    fn change([before, after]: [f64; 2], random: f64) -> Change {
        let quantity = |value: f64| Quantity::new(value, Parts { random, ..Parts::default() });
        Change::between(&quantity(before), &quantity(after))
    }

    fn course() -> Course {
        Course {
            visits: Vec::new(),
            groups: Vec::new(),
            choice: CHOICE,
            left_out: Vec::new(),
            is_affected_unreadable: false,
        }
    }

    fn told(ends: [f64; 2], random: f64) -> [String; 2] {
        let course = course();
        let words = Words { course: &course, language: Language::En };
        words.printed(&change(ends, random))
    }

    const CHOICE: crate::course::Choice =
        crate::course::Choice { volume: None, affected: None, girth_common_mm: 1.0 };

    #[test]
    fn a_change_is_told_in_whole_ml_also_where_the_rounded_volumes_differ_by_another_figure() {
        let of = |ends: [f64; 2]| told(ends, 1.0);
        assert_eq!(of([175.0, 185.0]), ["+10", "3"]);
        // 175 before, 185 after.
        assert_eq!(of([175.4, 184.7]), ["+9", "3"]);
        assert_eq!(of([184.7, 175.4]), ["\u{2212}9", "3"]);
    }

    #[test]
    fn a_change_is_told_as_reaching_what_can_be_shown_only_if_it_is_shown() {
        // 2 √2 · 3.5 = 9.9.
        assert_eq!(told([100.0, 109.7], 3.5), ["+9.7", "9.9"]);
        assert_eq!(told([100.0, 110.2], 3.55), ["+10.2", "10.1"]);
        assert_eq!(told([100.0, 112.0], 3.5), ["+12", "10"]);
    }

    #[test]
    fn a_reduction_has_no_digits_that_its_uncertainty_hides() {
        let course = course();
        let words = Words { course: &course, language: Language::En };
        let told = |percent: f64, expanded: f64| words.reduction(&Reduction { percent, expanded });
        assert_eq!(told(61.83, 12.31), ["62", "13"]);
        assert_eq!(told(61.83, 8.01), ["61.8", "8.1"]);
        assert_eq!(told(-12.0, 4.0), ["\u{2212}12.0", "4.0"]);
    }
}
