//! The words of a report of visits.

use std::fmt::Display;

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::rounding::{number, signed, tenths_words};
use gaiter_record::shown;

use crate::caution::Caution;
use crate::comparison::Comparison;
use crate::course::Course;
use crate::left_out::StandIns;
use crate::quantity::Change;
use crate::visit::Visit;

/// Behind the day of a visit that stands in the place of a record that is left out.
const STAND_IN: &str = " #";

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

    pub(super) fn filled(&self, key: &'static str, words: &[(&str, &dyn Display)]) -> String {
        self.language.filled(key, words)
    }

    /// A text with the key of a code, with words in its places; the code itself if it has none.
    pub(super) fn of_code(
        &self,
        table: &str,
        code: &str,
        words: &[(&str, &dyn Display)],
    ) -> String {
        let text = self.language.word(table, code);
        let words = |place: &str, _: &str| {
            let word = words.iter().find(|(name, _)| *name == place);
            Some(word.map_or_else(|| format!("{{{place}}}"), |(_, word)| word.to_string()))
        };
        gaiter_language::fill(text, words).unwrap_or_default()
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

    /// A percentage with its sign.
    pub(super) fn percent_change(&self, percent: f64) -> String {
        signed(percent, &tenths_words(percent, self.language))
    }

    /// The smallest percentage that is shown, rounded up, so that it is never told as smaller than it is.
    pub(super) fn detectable(&self, percent: f64) -> String {
        tenths_words((10.0 * percent - 1e-9).ceil() / 10.0, self.language)
    }

    /// The smallest change of a volume that is shown, mL, rounded up.
    pub(super) fn detectable_ml(&self, change: &Change) -> String {
        number((change.detectable() - 1e-9).ceil(), 0, self.language)
    }

    /// What speaks against a comparison.
    pub(super) fn caution(&self, of: &Comparison, caution: &Caution) -> String {
        let whole = |value: f64| number(value, 0, self.language);
        let tenths = |value: f64| tenths_words(value, self.language);
        let code = caution.code();
        let with = |words: &[(&str, &dyn Display)]| self.of_code("visits.caution", code, words);
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
