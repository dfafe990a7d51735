//! What a leg has of a level, as every table shows it: sheet, terminal, CSV and practice software.

pub mod amendment;
mod at_height;
pub(super) mod csv;

use at_height::girth_sd_mm_near;
pub(super) use at_height::{along_mm_at, girth_mm_at};

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use self::amendment::{ByHand, Subject};
use super::report::Reliability;
use super::rounding;
use super::schema::{EstimateFigures, LandmarkFigures, LegFigures, Record};

/// The doubt of a knee that lies below D by its proportion: it is no knee, so it has no figures.
const BELOW_D: &str = "below-d";

/// A doubt that does not touch the girth by tape or the height.
const HARMLESS: &str = "folds";

/// The doubts that concern the girth alone. All others concern the height at which it was taken.
const OF_GIRTH: [&str; 9] = [
    "gap",
    "scatter",
    "cloth",
    "views-apart",
    "smoothed",
    "folds",
    "not-seen",
    "knee-bent",
    "sole-not-seen",
];

/// The doubt about a girth that is uncertain at its height, or because that is: only both by hand settle it.
const OF_BOTH: &str = "girth-uncertain";

/// The girth and the height of a level. What a person set counts; the rest is the scan's.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure<'a> {
    /// The girth by tape, with its error at this height.
    pub girth: Length,
    /// Standard error of the scan's girth as that of the level, mm: with what the uncertain height adds; `None` if
    /// it is unknown, or a person set the girth.
    pub girth_of_level_sd_mm: Option<f64>,
    /// The vertical height above the floor; `None` on the foot, where the tape is not level.
    pub height: Option<Length>,
    /// Whether the scan's part of it is estimated by a proportion of the body.
    pub is_estimate: bool,
    /// Codes of the reasons not to trust the scan's part of it without a check.
    pub doubts: Vec<&'a str>,
    /// How the scan found it, in English; empty if it did not.
    pub by: &'a str,
    /// What a person set; `None` if all is the scan's.
    pub by_hand: Option<ByHand<'a>>,
}

/// A length with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length {
    /// The length, mm.
    pub mm: f64,
    /// Its standard error, mm; `None` if it is unknown.
    pub sd_mm: Option<f64>,
    /// Whether a person set it.
    pub is_by_hand: bool,
}

/// Why a record has no figures of a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Absent {
    /// The scan does not give it, and nobody set it.
    NotFound,
    /// A person noted that it cannot be measured.
    NotMeasurable,
}

/// The key of the words for why a record has no figures of a level.
pub(crate) fn why_absent(
    record: &Record,
    side: Side,
    level: Level,
    absent: Absent,
) -> &'static str {
    let is_found = |code: &str| record.has_finding_at(code, side, Some(level.name()));
    match absent {
        Absent::NotMeasurable => "report.missing.not_measurable",
        Absent::NotFound if record.leg(side).is_none() => why_no_leg(record, side),
        Absent::NotFound if is_found("level-absent") => "report.missing.level_absent",
        Absent::NotFound if is_found("level-implausible") => "report.missing.level_implausible",
        // The only estimate without figures.
        Absent::NotFound if is_estimated(record, side, level) => "report.missing.below_d",
        Absent::NotFound => "report.missing.level_not_seen",
    }
}

/// The key of the words for why a leg is not in a record.
pub(crate) fn why_no_leg(record: &Record, side: Side) -> &'static str {
    match record.has_finding_at("leg-not-measured", side, None) {
        true => "report.missing.leg_not_measured",
        false => "report.missing.leg_not_in_scan",
    }
}

fn is_estimated(record: &Record, side: Side, level: Level) -> bool {
    record.leg(side).is_some_and(|leg| leg.estimates.contains_key(level.name()))
}

impl Absent {
    /// It in words, in the place of the figures.
    pub fn words(self, language: Language) -> &'static str {
        language.text(match self {
            Absent::NotFound => "report.missing.level_absent",
            Absent::NotMeasurable => "report.missing.not_measurable",
        })
    }
}

impl Measure<'_> {
    /// The measure of a level, or why there is none.
    ///
    /// # Errors
    /// See [`Absent`].
    pub fn find(record: &Record, side: Side, level: Level) -> Result<Measure<'_>, Absent> {
        let scanned = record.leg(side).and_then(|leg| Measure::scanned(leg, level));
        match record.by_hand(side, Subject::Level(level)) {
            None => scanned.ok_or(Absent::NotFound),
            Some(hand) if hand.is_not_measurable => Err(Absent::NotMeasurable),
            Some(hand) => Measure::amended(record.leg(side), scanned, hand).ok_or(Absent::NotFound),
        }
    }

    /// The scan's measure of a level; `None` if it was not found.
    pub fn scanned(leg: &LegFigures, level: Level) -> Option<Measure<'_>> {
        let estimate = leg.estimates.get(level.name());
        match (leg.landmarks.get(level.name()), estimate) {
            (Some(found), _) => Some(Measure::found(level, found)),
            (None, Some(of)) if !of.doubts.iter().any(|doubt| doubt == BELOW_D) => {
                Some(Measure::estimated(level, of))
            }
            (None, _) => None,
        }
    }

    /// Whether there is a doubt about girth or height by tape.
    pub(crate) fn has_a_doubt_that_matters(&self) -> bool {
        self.doubts.iter().any(|doubt| *doubt != HARMLESS)
    }

    /// How to read its girth.
    pub fn mark(&self) -> Reliability {
        self.mark_of(self.girth)
    }

    /// How to read one of its lengths.
    pub fn mark_of(&self, length: Length) -> Reliability {
        match (length.is_by_hand, self.is_estimate, self.doubts.is_empty()) {
            (true, _, _) => Reliability::ByHand,
            (false, true, _) => Reliability::Estimated,
            (false, false, false) => Reliability::Doubtful,
            (false, false, true) => Reliability::Sure,
        }
    }

    /// How to read its lengths, each once.
    pub fn marks(&self) -> impl Iterator<Item = Reliability> {
        [Some(self.girth), self.height].into_iter().flatten().map(|length| self.mark_of(length))
    }

    fn found(level: Level, of: &LandmarkFigures) -> Measure<'_> {
        Measure {
            girth: Length::scanned(of.girth_tape_mm, of.girth_sd_mm),
            girth_of_level_sd_mm: of.girth_of_level_sd_mm,
            height: height(level, of.height_mm, of.height_sd_mm),
            is_estimate: false,
            doubts: of.doubts.iter().map(String::as_str).collect(),
            by: &of.by,
            by_hand: None,
        }
    }

    fn estimated(level: Level, of: &EstimateFigures) -> Measure<'_> {
        Measure {
            girth: Length::scanned(of.girth_tape_mm, of.girth_sd_mm),
            girth_of_level_sd_mm: of.girth_of_level_sd_mm,
            height: height(level, of.height_mm, of.height_sd_mm),
            is_estimate: true,
            doubts: of.doubts.iter().map(String::as_str).collect(),
            by: &of.by,
            by_hand: None,
        }
    }

    /// What a person set in place of the scan's measure. If they set only the height, the girth is the scan's
    /// at that height. `None` if neither gives a girth.
    fn amended<'a>(
        leg: Option<&LegFigures>,
        scanned: Option<Measure<'a>>,
        hand: ByHand<'a>,
    ) -> Option<Measure<'a>> {
        let girth = match (hand.girth_mm, hand.height_mm) {
            (Some(mm), _) => Length::by_hand(mm),
            (None, Some(height_mm)) => {
                let leg = leg?;
                let girth_mm = rounding::mm(girth_mm_at(leg, height_mm)?);
                Length::scanned(girth_mm, girth_sd_mm_near(leg, height_mm))
            }
            (None, None) => scanned.as_ref()?.girth,
        };
        let height = hand.height_mm.map(Length::by_hand);
        let scanned_height = scanned.as_ref().and_then(|of| of.height);
        // On the foot there is no height, so nothing of an estimate is left beside a girth by hand.
        let is_all_by_hand = girth.is_by_hand && scanned_height.is_none();
        let is_estimate = scanned.as_ref().is_some_and(|of| of.is_estimate);
        let counts = |doubt: &&str| match *doubt {
            // On the foot there is no height.
            OF_BOTH => hand.girth_mm.is_none() || height.is_none() && scanned_height.is_some(),
            doubt if OF_GIRTH.contains(&doubt) => hand.girth_mm.is_none(),
            _ => height.is_none(),
        };
        Some(Measure {
            girth,
            girth_of_level_sd_mm: girth.sd_mm,
            height: height.or(scanned_height),
            is_estimate: is_estimate && height.is_none() && !is_all_by_hand,
            by: scanned.as_ref().map_or("", |of| of.by),
            doubts: scanned.into_iter().flat_map(|of| of.doubts).filter(counts).collect(),
            by_hand: Some(hand),
        })
    }
}

impl Length {
    /// A length that the scan gives.
    pub fn scanned(mm: f64, sd_mm: Option<f64>) -> Length {
        Length { mm, sd_mm, is_by_hand: false }
    }

    /// A length that a person set.
    pub fn by_hand(mm: f64) -> Length {
        Length { mm, sd_mm: None, is_by_hand: true }
    }

    /// A length of a leg that has no girth: of its foot, or of its inside.
    ///
    /// # Errors
    /// See [`Absent`].
    pub fn find(record: &Record, side: Side, subject: Subject) -> Result<Length, Absent> {
        match record.by_hand(side, subject) {
            Some(hand) if hand.is_not_measurable => Err(Absent::NotMeasurable),
            hand => {
                let set = hand.and_then(|hand| hand.length_mm).map(Length::by_hand);
                let scanned = || Length::scanned_of(record, side, subject);
                set.or_else(scanned).ok_or(Absent::NotFound)
            }
        }
    }

    /// The scan's measure of such a length; `None` if it was not seen.
    pub(crate) fn scanned_of(record: &Record, side: Side, subject: Subject) -> Option<Length> {
        let leg = record.leg(side);
        let foot = leg.and_then(|leg| leg.foot.as_ref());
        match subject {
            Subject::Level(_) => None,
            Subject::FootLength => foot.map(|foot| Length::scanned(foot.length_mm, None)),
            Subject::FootBreadth => foot.map(|foot| Length::scanned(foot.breadth_mm, None)),
            Subject::InsideLeg => leg
                .and(record.body.crotch_height_mm)
                .map(|mm| Length::scanned(mm, record.body.crotch_sd_mm)),
        }
    }
}

fn height(level: Level, mm: f64, sd_mm: Option<f64>) -> Option<Length> {
    (level >= Level::B).then_some(Length::scanned(mm, sd_mm))
}
