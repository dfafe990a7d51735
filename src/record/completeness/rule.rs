//! What a record holds for an order, from its findings and doubts and from what the garment needs.

use super::{Again, Check, Completeness, Item};
use crate::leg::{Level, Side};
use crate::record::garment::Garment;
use crate::record::schema::{FindingNote, LegFigures, NOT_VOUCHED, Record};

/// A leg that was sought and could not be measured.
const LEG_NOT_MEASURED: &str = "leg-not-measured";

/// A doubt that does not touch the girth by tape or the height.
const HARMLESS: &str = "folds";

impl Completeness {
    /// What a record holds for an order of this garment.
    pub fn of(record: &Record, garment: Garment) -> Completeness {
        let needs = Needs { record, garment };
        let mut again: Vec<Again> =
            record.findings.iter().filter_map(|finding| needs.again(finding)).collect();
        let legs = record.legs.iter();
        again.extend(legs.flat_map(|leg| needs.doubts(leg)).filter_map(again_for_doubt));
        again.extend(record.legs.is_empty().then_some(Again::WholeLegs));
        again.sort_unstable();
        again.dedup();
        let mut checks: Vec<Check> = record.findings.iter().filter_map(check).collect();
        checks.sort_unstable();
        checks.dedup();
        let by_hand = Side::FROM_FRONT.map(|side| needs.by_hand(side));
        Completeness { garment, again, by_hand, checks }
    }
}

/// A record and the garment that it must do for.
struct Needs<'a> {
    record: &'a Record,
    garment: Garment,
}

impl Needs<'_> {
    /// What is to be measured by hand on a leg. A leg that is not in the scan at all is not asked for.
    fn by_hand(&self, side: Side) -> Vec<Item> {
        let Some(leg) = self.record.leg(side) else { return Vec::new() };
        let levels = self.garment.levels().iter().filter(|level| !is_sure(leg, **level));
        let inside_leg =
            (self.garment.needs_inside_leg() && !self.is_crotch_sure()).then_some(Item::InsideLeg);
        let foot = leg.foot.is_none().then_some(Item::Foot);
        inside_leg.into_iter().chain(levels.map(|level| Item::Level(*level))).chain(foot).collect()
    }

    fn is_crotch_sure(&self) -> bool {
        let is_doubted = self.record.has_finding("crotch-uncertain");
        self.record.body.crotch_height_mm.is_some() && !is_doubted
    }

    /// The doubts at the levels that the garment needs.
    fn doubts<'l>(&self, leg: &'l LegFigures) -> Vec<&'l str> {
        let of_level = |level: &Level| {
            let found = leg.landmarks.get(level.name()).map(|of| &of.doubts);
            found.or_else(|| leg.estimates.get(level.name()).map(|of| &of.doubts))
        };
        let levels = self.garment.levels().iter().filter_map(of_level);
        levels.flatten().map(String::as_str).collect()
    }

    /// What another scan must do better because of a finding.
    fn again(&self, finding: &FindingNote) -> Option<Again> {
        match finding.code.as_str() {
            LEG_NOT_MEASURED => Some(Again::WholeLegs),
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

    fn is_needed(&self, finding: &FindingNote) -> bool {
        let level = finding.level.as_deref();
        self.garment.levels().iter().any(|needed| level == Some(needed.name()))
    }

    /// Whether the leg of a finding has neither figures nor an estimate of a level that is needed.
    fn lacks_a_level(&self, finding: &FindingNote) -> bool {
        let leg = self.record.legs.iter().find(|leg| finding.leg.as_deref() == Some(&leg.side));
        leg.is_some_and(|leg| {
            let mut names = self.garment.levels().iter().map(|level| level.name());
            names.any(|name| !leg.landmarks.contains_key(name) && !leg.estimates.contains_key(name))
        })
    }

    /// Whether the skin of a thigh was not seen where a level is needed.
    fn is_thigh_doubted(&self) -> bool {
        let is_doubted = |leg: &LegFigures| match leg.landmarks.get(Level::G.name()) {
            Some(root) => root.doubts.iter().any(|doubt| doubt != HARMLESS),
            None => true,
        };
        self.garment.levels().contains(&Level::G) && self.record.legs.iter().any(is_doubted)
    }
}

/// Whether a level was found on a leg, without a doubt that matters for an order.
fn is_sure(leg: &LegFigures, level: Level) -> bool {
    let found = leg.landmarks.get(level.name());
    found.is_some_and(|found| found.doubts.iter().all(|doubt| doubt == HARMLESS))
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
        "facing-unchecked" | "ord-sides" => Some(Check::Sides),
        "ord-unit" => Some(Check::Unit),
        "proportions" => Some(Check::WholeBody),
        "ord-disagrees" => Some(Check::ScannerMeasures),
        "no-faces" => Some(Check::Export),
        NOT_VOUCHED => Some(Check::Source),
        _ => None,
    }
}
