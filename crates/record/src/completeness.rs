//! Whether a record holds all measures that an order needs, and what to do before the patient dresses:
//! nothing, measure by hand, or scan again.
//!
//! It is derived here and nowhere else; report, operator's page, light and terminal show it in the same words.

mod rule;
mod words;

use gaiter_leg::Level;
use gaiter_sizes::Garment;

use super::measure::amendment::Subject;

/// What a record holds for an order of one garment.
#[derive(Debug, Clone, PartialEq)]
pub struct Completeness {
    /// The garment that is ordered.
    pub garment: Garment,
    /// What to do otherwise when the patient is scanned again; empty if another scan would not help.
    pub again: Vec<Again>,
    /// What to measure by hand on each leg, in the order of [`Side::FROM_FRONT`](gaiter_leg::Side::FROM_FRONT);
    /// highest first.
    pub by_hand: [Vec<Item>; 2],
    /// What a person noted as not measurable on each leg, in the same order.
    pub not_measurable: [Vec<Item>; 2],
    /// What a person must make sure of before the order.
    pub checks: Vec<Check>,
}

gaiter_leg::word_enum! {
    /// What to do.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Kind {
        /// Every measure was taken without a doubt, or set by a person.
        Complete => "complete",
        /// There is nothing left to measure: a person noted that the rest cannot be measured.
        NotMeasurable => "not-measurable",
        /// Some measures must be taken or made sure of by hand.
        ByHand => "by-hand",
        /// The patient should be scanned again before dressing.
        ScanAgain => "scan-again",
    }
}

/// A measure of one leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    /// A level.
    Level(Level, Part),
    /// Length of the foot.
    Foot,
    /// Length of the inside of the leg.
    InsideLeg,
}

impl Item {
    /// What it asks of a measure: `girth`, `height` or `length`.
    pub fn values_of(self, subject: Subject) -> &'static [&'static str] {
        match (self, subject) {
            (Item::Level(level, part), Subject::Level(of)) if level == of => match part {
                // On the foot there is no height.
                Part::Both if level < Level::B => &["girth"],
                Part::Both => &["girth", "height"],
                Part::Girth => &["girth"],
                Part::Height => &["height"],
            },
            (Item::Foot, Subject::FootLength) | (Item::InsideLeg, Subject::InsideLeg) => {
                &["length"]
            }
            _ => &[],
        }
    }
}

/// What to measure of a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Girth and height.
    Both,
    /// The girth: a person set the height.
    Girth,
    /// The height: a person set the girth.
    Height,
}

gaiter_leg::word_enum! {
    /// What must differ in another scan.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Again {
        /// Both legs must be in view, whole.
        WholeLegs => "whole_legs",
        /// The legs must be bare.
        BareLegs => "bare_legs",
        /// The patient must stand still.
        Still => "still",
        /// The legs must stand apart.
        LegsApart => "legs_apart",
        /// The knees must be straight.
        StraightKnees => "straight_knees",
        /// Both feet must stand flat on the floor.
        FeetFlat => "feet_flat",
        /// The patient must be barefoot.
        Barefoot => "barefoot",
        /// A girth was found that no leg has.
        Implausible => "implausible",
    }
}

gaiter_leg::word_enum! {
    /// What a person must make sure of.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Check {
        /// Which leg is the left one.
        Sides => "sides",
        /// The unit of the scan.
        Unit => "unit",
        /// That head and feet are whole in the scan, so that heights are right.
        WholeBody => "whole-body",
        /// Why the scanner's own measures differ.
        ScannerMeasures => "scanner-measures",
        /// That the export was not cut short.
        Export => "export",
        /// Where the record comes from: nothing vouches for its figures.
        Source => "source",
    }
}

impl Completeness {
    /// What to do.
    pub fn kind(&self) -> Kind {
        if !self.again.is_empty() {
            Kind::ScanAgain
        } else if self.by_hand.iter().any(|leg| !leg.is_empty()) || !self.checks.is_empty() {
            Kind::ByHand
        } else if self.not_measurable.iter().any(|leg| !leg.is_empty()) {
            Kind::NotMeasurable
        } else {
            Kind::Complete
        }
    }
}
