//! What a record holds for an order, from its findings and doubts and from what the garment needs.

use std::collections::BTreeSet;

use gaiter_leg::{Level, Side};
use gaiter_sizes::{Garment, Point};

use super::{Again, Check, Completeness, Item, Part};
use crate::measure::amendment::Subject;
use crate::measure::{Absent, Length, Measure};
use crate::schema::{FindingNote, NOT_VOUCHED, Record};

impl Completeness {
    /// What a record holds for an order of this garment.
    pub fn from_record(record: &Record, garment: &Garment) -> Completeness {
        let needs = Needs { record, garment };
        let again = match needs.has_all_by_hand() {
            true => BTreeSet::new(),
            false => needs.all_again(),
        };
        let checks: BTreeSet<Check> = record.findings.iter().filter_map(check).collect();
        let by_hand = Side::FROM_FRONT.map(|side| needs.in_state(side, State::Open));
        let not_measurable =
            Side::FROM_FRONT.map(|side| needs.in_state(side, State::NotMeasurable));
        let (again, checks) = (again.into_iter().collect(), checks.into_iter().collect());
        Completeness { garment: garment.clone(), again, by_hand, not_measurable, checks }
    }
}

/// A record and the garment that it must do for.
struct Needs<'a> {
    record: &'a Record,
    garment: &'a Garment,
}

/// How far a measure that is needed has come.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    /// The scan gives it without a doubt that matters.
    Scanned,
    /// A person set it.
    ByHand,
    /// A person noted that it cannot be measured.
    NotMeasurable,
    /// It must be measured by hand.
    Open,
}

impl Needs<'_> {
    /// What the garment needs of a leg, highest first. A leg that is not in the record at all is not asked
    /// for.
    fn items(&self, side: Side) -> Vec<Item> {
        if !self.record.sides().any(|known| known == side) {
            return Vec::new();
        }
        let inside_leg = self.garment.needs(Point::InsideLeg).then_some(Item::InsideLeg);
        let levels = self.garment.levels().iter();
        let levels = levels.map(|level| Item::Level(*level, self.open_part(side, *level)));
        let foot = self.garment.needs(Point::Foot).then_some(Item::Foot);
        inside_leg.into_iter().chain(levels).chain(foot).collect()
    }

    fn in_state(&self, side: Side, state: State) -> Vec<Item> {
        let items = self.items(side).into_iter();
        items.filter(|item| self.state(side, *item) == state).collect()
    }

    fn state(&self, side: Side, item: Item) -> State {
        match item {
            Item::Level(level, _) => self.level_state(side, level),
            Item::Foot => self.length_state(side, Subject::FootLength, true),
            Item::InsideLeg => {
                let is_sure = !self.record.has_finding("crotch-uncertain");
                self.length_state(side, Subject::InsideLeg, is_sure)
            }
        }
    }

    /// What of a level is still to be measured, if anything is.
    fn open_part(&self, side: Side, level: Level) -> Part {
        let hand = self.record.by_hand(side, Subject::Level(level));
        let needs_girth = self.garment.needs(Point::Girth(level));
        let needs_height = self.garment.needs(Point::Length(level));
        match hand.map(|hand| (hand.girth_mm, hand.height_mm)) {
            // On the foot there is no height.
            _ if needs_girth && !needs_height && level >= Level::B => Part::Girth,
            _ if !needs_girth => Part::Height,
            Some((Some(_), None)) => Part::Height,
            Some((None, Some(_))) => Part::Girth,
            _ => Part::Both,
        }
    }

    fn level_state(&self, side: Side, level: Level) -> State {
        match Measure::find(self.record, side, level) {
            Err(Absent::NotMeasurable) => State::NotMeasurable,
            Err(Absent::NotFound) => State::Open,
            Ok(of) if self.is_by_hand_where_needed(level, &of) => State::ByHand,
            Ok(of) if of.is_estimate || of.has_a_doubt_that_matters() => State::Open,
            Ok(of) => of.by_hand.map_or(State::Scanned, |_| State::ByHand),
        }
    }

    /// Whether a person set the only part of a level that the garment needs: the other may stay doubtful.
    fn is_by_hand_where_needed(&self, level: Level, of: &Measure<'_>) -> bool {
        let is_by_hand = |length: Option<Length>| length.is_some_and(|of| of.is_by_hand);
        let needs = [Point::Girth(level), Point::Length(level)].map(|of| self.garment.needs(of));
        match needs {
            [true, false] if level >= Level::B => is_by_hand(Some(of.girth)),
            [false, true] => is_by_hand(of.height),
            _ => false,
        }
    }

    /// The state of a length of foot or inside leg.
    fn length_state(&self, side: Side, subject: Subject, is_scan_sure: bool) -> State {
        match Length::find(self.record, side, subject) {
            Err(Absent::NotMeasurable) => State::NotMeasurable,
            Err(Absent::NotFound) => State::Open,
            Ok(length) if length.is_by_hand => State::ByHand,
            Ok(_) if is_scan_sure => State::Scanned,
            Ok(_) => State::Open,
        }
    }

    /// Whether people settled every level that the garment needs on every leg of the record: then nothing
    /// depends on the scan any more.
    fn has_all_by_hand(&self) -> bool {
        let mut sides = self.record.sides().peekable();
        let is_settled = |side: Side| {
            let mut levels = self.garment.levels().iter();
            levels.all(|level| self.is_settled(side, *level))
        };
        sides.peek().is_some() && sides.all(is_settled)
    }

    /// Whether a person set a level, or noted that it cannot be measured.
    fn is_settled(&self, side: Side, level: Level) -> bool {
        matches!(self.level_state(side, level), State::ByHand | State::NotMeasurable)
    }

    /// What another scan must do better.
    fn all_again(&self) -> BTreeSet<Again> {
        let findings = self.record.findings.iter().filter_map(|finding| self.again(finding));
        let doubts = self.record.sides().flat_map(|side| self.doubts(side));
        let doubts = doubts.filter_map(again_for_doubt);
        let no_leg = self.record.legs.is_empty().then_some(Again::WholeLegs);
        findings.chain(doubts).chain(no_leg).collect()
    }

    /// The doubts at the levels that the garment needs.
    fn doubts(&self, side: Side) -> Vec<&str> {
        let of_level = |level: &Level| match Measure::find(self.record, side, *level) {
            Ok(Measure { doubts, by_hand: Some(_), .. }) => doubts,
            Err(Absent::NotMeasurable) => Vec::new(),
            // The doubts of an estimate that is not shown count, too: a bent knee may be below D.
            _ => self.scanned_doubts(side, *level).unwrap_or_default(),
        };
        self.garment.levels().iter().flat_map(of_level).collect()
    }

    /// The scan's doubts at a level that it found or estimated; `None` if it did neither.
    fn scanned_doubts(&self, side: Side, level: Level) -> Option<Vec<&str>> {
        let leg = self.record.leg(side)?;
        let found = leg.landmarks.get(level.name()).map(|of| &of.doubts);
        let doubts = found.or_else(|| leg.estimates.get(level.name()).map(|of| &of.doubts))?;
        Some(doubts.iter().map(String::as_str).collect())
    }

    /// What another scan must do better because of a finding.
    fn again(&self, finding: &FindingNote) -> Option<Again> {
        match finding.code.as_str() {
            "leg-not-measured" => Some(Again::WholeLegs),
            "leg-cut" => self.lacks_a_level(finding).then_some(Again::WholeLegs),
            "level-implausible" => self.is_needed(finding).then_some(Again::Implausible),
            "crotch-not-seen" => self.reaches_the_thigh().then_some(Again::LegsApart),
            "thighs-touch" | "crotch-uncertain" => {
                self.is_thigh_doubted().then_some(Again::LegsApart)
            }
            "thigh-axis-missing" => self.reaches_the_thigh().then_some(Again::StraightKnees),
            "floor-uneven" => Some(Again::FeetFlat),
            "feet-cut" => Some(Again::Barefoot),
            _ => None,
        }
    }

    fn reaches_the_thigh(&self) -> bool {
        self.garment.levels().contains(&Level::F)
    }

    /// Whether a finding is about a level that the garment needs and that no person has settled.
    fn is_needed(&self, finding: &FindingNote) -> bool {
        let levels = self.garment.levels().iter();
        let level = levels.copied().find(|of| finding.level.as_deref() == Some(of.name()));
        level.is_some_and(|level| finding.side().is_none_or(|side| !self.is_settled(side, level)))
    }

    /// Whether the leg of a finding has neither figures nor an estimate of a level that is needed.
    fn lacks_a_level(&self, finding: &FindingNote) -> bool {
        finding.side().is_some_and(|side| {
            let mut levels = self.garment.levels().iter();
            let is_missing = |level: &Level| {
                self.scanned_doubts(side, *level).is_none() && !self.is_settled(side, *level)
            };
            self.record.leg(side).is_some() && levels.any(is_missing)
        })
    }

    /// Whether the skin of a thigh was not seen where a level is needed.
    fn is_thigh_doubted(&self) -> bool {
        let is_doubted = |side: Side| match Measure::find(self.record, side, Level::G) {
            Ok(root) if root.is_estimate => true,
            Ok(root) => root.has_a_doubt_that_matters(),
            Err(absent) => absent == Absent::NotFound,
        };
        self.garment.levels().contains(&Level::G) && self.record.sides().any(is_doubted)
    }
}

/// What another scan must do better because of a doubt at a level that is needed.
fn again_for_doubt(code: &str) -> Option<Again> {
    match code {
        "cloth" => Some(Again::BareLegs),
        "scatter" => Some(Again::Still),
        "knee-bent" => Some(Again::StraightKnees),
        _ => None,
    }
}

/// What a person must make sure of because of a finding.
fn check(finding: &FindingNote) -> Option<Check> {
    match finding.code.as_str() {
        "facing-unchecked" | "facing-by-calves" | "ord-sides" => Some(Check::Sides),
        "ord-unit" => Some(Check::Unit),
        "proportions" => Some(Check::WholeBody),
        "ord-disagrees" => Some(Check::ScannerMeasures),
        "no-faces" => Some(Check::Export),
        NOT_VOUCHED => Some(Check::Source),
        _ => None,
    }
}
