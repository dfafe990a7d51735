//! Measures that a person set. They stand beside the scan's measures and never replace them; what is printed,
//! exported and sent is the amended value with its mark.

mod fault;

use std::ops::RangeInclusive;

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use super::{Length, Measure, girth_mm_at};
use crate::Record;
pub use crate::schema::{Amendment, Deed};
pub use fault::{AmendFault, What};

/// Girths that a leg can have, mm: from a child's ankle to the largest thighs of severe lymphoedema.
const GIRTHS_MM: RangeInclusive<f64> = 50.0..=1500.0;

/// Heights above the floor that a level can have, mm.
const HEIGHTS_MM: RangeInclusive<f64> = 10.0..=1300.0;

/// Lengths and breadths that a foot can have, mm.
const FEET_MM: RangeInclusive<f64> = 30.0..=450.0;

/// A value that differs by more than this from the scan's is asked about once more, as a share of the scan's:
/// five times what one person's readings of a leg scatter by (3 %, te Slaa 2011).
const FAR_SHARE: f64 = 0.15;

/// The longest reason or name, characters: they are printed in a line.
const WORDS_MOST: usize = 120;

/// What a person can set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// Girth and height of a level.
    Level(Level),
    /// The length of the foot.
    FootLength,
    /// The breadth of the foot.
    FootBreadth,
    /// The length of the inside of the leg.
    InsideLeg,
}

/// What holds for a measure after all that people set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByHand<'a> {
    /// The girth, mm; `None` if the scan's counts.
    pub girth_mm: Option<f64>,
    /// The height, mm; `None` if the scan's counts.
    pub height_mm: Option<f64>,
    /// The length, mm; `None` if the scan's counts.
    pub length_mm: Option<f64>,
    /// Whether it cannot be measured.
    pub is_not_measurable: bool,
    /// The last amendment.
    pub last: &'a Amendment,
}

impl Subject {
    /// All subjects, in the order of the measuring sheet.
    pub fn all() -> impl Iterator<Item = Subject> {
        let levels = Level::ALL.into_iter().rev().map(Subject::Level);
        levels.chain([Subject::FootLength, Subject::FootBreadth, Subject::InsideLeg])
    }

    /// The word of the record.
    pub fn word(self) -> &'static str {
        match self {
            Subject::Level(level) => level.name(),
            Subject::FootLength => "foot-length",
            Subject::FootBreadth => "foot-breadth",
            Subject::InsideLeg => "inside-leg",
        }
    }

    /// Its name for people.
    pub fn name(self, language: Language) -> &'static str {
        match self {
            Subject::Level(level) => level.name(),
            other => language.word("report.by_hand.measure", other.word()),
        }
    }

    /// The subject of a word in capital or small letters.
    pub fn of_any_case(word: &str) -> Option<Subject> {
        Subject::all().find(|subject| subject.word().eq_ignore_ascii_case(word))
    }

    /// The subject of a word.
    pub fn of_word(word: &str) -> Option<Subject> {
        Subject::all().find(|subject| subject.word() == word)
    }

    /// The possible girth, height and length, mm; `None` for what the subject does not have.
    fn ranges_mm(self) -> [Option<RangeInclusive<f64>>; 3] {
        match self {
            Subject::Level(level) if level < Level::B => [Some(GIRTHS_MM), None, None],
            Subject::Level(_) => [Some(GIRTHS_MM), Some(HEIGHTS_MM), None],
            Subject::FootLength | Subject::FootBreadth => [None, None, Some(FEET_MM)],
            Subject::InsideLeg => [None, None, Some(HEIGHTS_MM)],
        }
    }
}

impl Record {
    /// What people set in place of a measure of the scan; `None` if the scan's value counts.
    pub fn by_hand(&self, side: Side, subject: Subject) -> Option<ByHand<'_>> {
        let its = self.amendments.iter().filter(|of| of.is_about(side, subject));
        its.fold(None, |before: Option<ByHand<'_>>, of| match of.is {
            Deed::TakenBack => None,
            Deed::NotMeasurable => Some(ByHand { is_not_measurable: true, ..ByHand::none(of) }),
            Deed::Measured => {
                let before = before.unwrap_or_else(|| ByHand::none(of));
                Some(ByHand {
                    girth_mm: of.girth_mm.or(before.girth_mm),
                    height_mm: of.height_mm.or(before.height_mm),
                    length_mm: of.length_mm.or(before.length_mm),
                    is_not_measurable: false,
                    last: of,
                })
            }
        })
    }

    /// The legs of the record, the right one first: those that were measured, and those of which a person
    /// set a measure.
    pub fn sides(&self) -> impl Iterator<Item = Side> {
        let has_hand = |side: Side| Subject::all().any(|of| self.by_hand(side, of).is_some());
        Side::FROM_FRONT
            .into_iter()
            .filter(move |side| self.leg(*side).is_some() || has_hand(*side))
    }

    /// The record with further amendments. Values that are far off the scan's are only accepted from a person
    /// who is sure of them.
    ///
    /// # Errors
    /// See [`AmendFault`]. Heights are compared with the levels that hold after all of them.
    pub fn amended(&self, amendments: &[Amendment], is_sure: bool) -> Result<Record, AmendFault> {
        let mut record = self.clone();
        for amendment in amendments {
            let (side, subject) = amendment.checked()?;
            if amendment.is == Deed::TakenBack && record.by_hand(side, subject).is_none() {
                return Err(AmendFault::at(side, subject, What::NothingToTakeBack));
            }
            record.amendments.push(amendment.clone());
        }
        for amendment in amendments.iter().filter(|of| of.is == Deed::Measured) {
            let (side, subject) = amendment.checked()?;
            match subject {
                Subject::Level(level) => {
                    record.is_whole(side, level)?;
                    record.is_in_order(side, subject, amendment.height_mm)?;
                }
                Subject::InsideLeg => record.is_in_order(side, subject, amendment.length_mm)?,
                Subject::FootLength | Subject::FootBreadth => {}
            }
            if !is_sure {
                record.is_near(side, subject, amendment)?;
            }
        }
        Ok(record)
    }

    /// Checks that an amended level has girth and height.
    fn is_whole(&self, side: Side, level: Level) -> Result<(), AmendFault> {
        let half = |value| Err(AmendFault::at(side, Subject::Level(level), What::Half { value }));
        match Measure::find(self, side, level) {
            Err(_) => half("girth"),
            Ok(measure) if measure.height.is_none() && level >= Level::B => half("height"),
            Ok(_) => Ok(()),
        }
    }

    /// Checks that a value is not far off the scan's at the height that counts.
    fn is_near(&self, side: Side, subject: Subject, of: &Amendment) -> Result<(), AmendFault> {
        let scanned = self.leg(side).and_then(|leg| match subject {
            Subject::Level(level) => {
                let scanned = Measure::scanned(leg, level);
                let height = Measure::find(self, side, level).ok().and_then(|of| of.height);
                let there = height.and_then(|height| girth_mm_at(leg, height.mm));
                there.or(scanned.map(|of| of.girth.mm))
            }
            length => Length::scanned_of(self, side, length).map(|of| of.mm),
        });
        let set = of.girth_mm.map(|mm| ("girth", mm)).or(of.length_mm.map(|mm| ("length", mm)));
        match set.zip(scanned) {
            Some(((value, found_mm), scanned_mm))
                if (found_mm - scanned_mm).abs() > FAR_SHARE * scanned_mm =>
            {
                Err(AmendFault::at(side, subject, What::FarOff { value, found_mm, scanned_mm }))
            }
            _ => Ok(()),
        }
    }

    /// Checks that an amended height lies between the levels around it; the inside of the leg ends above all
    /// of them.
    fn is_in_order(
        &self,
        side: Side,
        subject: Subject,
        height_mm: Option<f64>,
    ) -> Result<(), AmendFault> {
        let Some(height_mm) = height_mm else { return Ok(()) };
        for other in Level::ALL.into_iter().filter(|other| subject != Subject::Level(*other)) {
            let theirs = Measure::find(self, side, other).ok().filter(|of| !of.is_estimate);
            let Some(other_mm) = theirs.and_then(|of| of.height).map(|height| height.mm) else {
                continue;
            };
            let is_above = match subject {
                Subject::Level(level) => other < level,
                _ => true,
            };
            let is_in_order = if is_above { other_mm < height_mm } else { height_mm < other_mm };
            if !is_in_order {
                let what = What::Order { height_mm, is_above, other: other.name(), other_mm };
                return Err(AmendFault::at(side, subject, what));
            }
        }
        Ok(())
    }
}

impl ByHand<'_> {
    fn none(last: &Amendment) -> ByHand<'_> {
        ByHand { girth_mm: None, height_mm: None, length_mm: None, is_not_measurable: false, last }
    }
}

impl Amendment {
    fn is_about(&self, side: Side, subject: Subject) -> bool {
        self.leg == side.word() && self.measure == subject.word()
    }

    /// The leg and measure, if this is a possible amendment of some record.
    ///
    /// # Errors
    /// See [`AmendFault`].
    pub fn checked(&self) -> Result<(Side, Subject), AmendFault> {
        let side = Side::of_word(&self.leg).ok_or_else(|| AmendFault::Leg(self.leg.clone()))?;
        let subject = Subject::of_word(&self.measure);
        let subject = subject.ok_or_else(|| AmendFault::Measure(self.measure.clone()))?;
        a_line(&self.reason, "reason")?;
        a_line(&self.by, "by")?;
        let fault = |what| Err(AmendFault::at(side, subject, what));
        let values =
            [("girth", self.girth_mm), ("height", self.height_mm), ("length", self.length_mm)];
        let mut has_one = false;
        for ((value, set), range) in values.into_iter().zip(subject.ranges_mm()) {
            let Some(found_mm) = set else { continue };
            has_one = true;
            match range.filter(|_| self.is == Deed::Measured) {
                None => return fault(What::NoSuch { value }),
                Some(range) if !range.contains(&found_mm) => {
                    let range_mm = [*range.start(), *range.end()];
                    return fault(What::Range { value, found_mm, range_mm });
                }
                Some(_) => {}
            }
        }
        match self.is == Deed::Measured && !has_one {
            true => fault(What::Nothing),
            false => Ok((side, subject)),
        }
    }
}

/// Checks that reason or name can be printed in a line.
fn a_line(words: &str, which: &'static str) -> Result<(), AmendFault> {
    if words.trim().is_empty() {
        return Err(AmendFault::NoWords(which));
    }
    let fits = words.chars().count() <= WORDS_MOST && !words.chars().any(char::is_control);
    if fits { Ok(()) } else { Err(AmendFault::Words(which)) }
}

#[cfg(test)]
mod tests;
