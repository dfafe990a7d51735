//! The visits of one patient in their order, and which of them can be compared.

use std::collections::BTreeSet;

use gaiter_leg::Side;
use gaiter_leg::comparison::tape_volume::VolumeBy;
use gaiter_leg::side::Sides;
use gaiter_record::{Acquired, AcquiredFrom, Record};

use super::left_out::LeftOut;
use super::place::Step;
use super::quantity::Quantity;
use super::visit::{Definition, Visit};

/// The lowest place that is compared, in steps of 4 cm: 12 cm. Below it the tape lies about malleoli and
/// heel, where a millimetre of height is several of girth.
const FIRST_STEP: Step = 3;

/// How visits are to be compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// How all volumes are made of girths; `None` takes the records' own way.
    pub volume: Option<VolumeBy>,
    /// The affected leg; `None` if nobody named it. It is never guessed.
    pub affected: Option<Affected>,
    /// Standard error that all girths of a scan have in common, mm.
    pub girth_common_mm: f64,
}

/// Which leg is affected, as a person named it. The girths cannot show it: after treatment, the healthy leg may
/// be the larger one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Affected {
    /// One; the other is what it is compared with.
    One(Side),
    /// Both: there is no excess of one over the other.
    Both,
    /// Neither: there is no excess.
    Neither,
}

impl Affected {
    /// All that can be named, with the words of the command line and of the JSON form.
    pub const WORDS: [(&str, Affected); 4] = [
        ("left", Affected::One(Side::Left)),
        ("right", Affected::One(Side::Right)),
        ("both", Affected::Both),
        ("none", Affected::Neither),
    ];

    /// The word where nobody named any.
    pub const NOT_NAMED: &str = "not-named";

    /// The word where what a person named cannot be read.
    pub const UNREADABLE: &str = "unreadable";

    /// What a word names; `None` for another word.
    pub fn of_word(word: &str) -> Option<Affected> {
        Affected::WORDS.into_iter().find(|(own, _)| *own == word).map(|(_, affected)| affected)
    }

    /// The word of the command line and of the JSON form.
    pub fn word(self) -> &'static str {
        match self {
            Affected::One(side) => side.word(),
            Affected::Both => "both",
            Affected::Neither => "none",
        }
    }
}

/// The visits of one patient.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// The visits, oldest first; in the order given if one has no time.
    pub visits: Vec<Visit>,
    /// Those that can be compared with each other, in the order of their first visits.
    pub groups: Vec<Group>,
    /// What was chosen.
    pub choice: Choice,
    /// Records of the patient that are no visits because they cannot be used or are gone, oldest first.
    pub left_out: Vec<LeftOut>,
    /// A person named a leg, but what is kept of it cannot be read: none counts.
    pub is_affected_unreadable: bool,
}

/// Visits of one definition.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Indices of its visits, ascending; at least one.
    pub visits: Vec<usize>,
    /// How its volumes are made of girths.
    pub volume: VolumeBy,
    /// The pieces of each leg that all its visits have.
    pub pieces: Sides<BTreeSet<Step>>,
}

/// Why records cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CourseFault {
    /// Fewer than two records.
    #[error("a comparison needs two records or more, this is {found}")]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// Two records are of different patients, or only one of them names its patient.
    #[error(
        "record {other} is not of the patient of record {first}, or only one of the two names a patient"
    )]
    OtherPatient {
        /// Counted from 1.
        first: usize,
        /// Counted from 1.
        other: usize,
    },
    /// Two records come from the same scan.
    #[error("records {first} and {other} are of the same scan")]
    SameScan {
        /// Counted from 1.
        first: usize,
        /// Counted from 1.
        other: usize,
    },
    /// A record has no girths at fixed places.
    #[error(
        "record {at} has no girths at fixed places along the leg: measure its scan again with gaiter \
         reextract"
    )]
    NoPlaces {
        /// Counted from 1.
        at: usize,
    },
    /// Girths have different meanings.
    #[error(
        "the girths of records {first} and {other} do not mean the same ({one}; {another}); measure their \
         scans again with one method: gaiter reextract"
    )]
    OtherDefinition {
        /// Counted from 1.
        first: usize,
        /// Counted from 1.
        other: usize,
        /// The first's definition.
        one: String,
        /// The other's definition.
        another: String,
    },
    /// Volumes are computed in different ways.
    #[error(
        "the volumes of record {first} are of {one}, those of record {other} of {another}: they are not \
         compared; --volume computes all of them in one way"
    )]
    OtherVolume {
        /// Counted from 1.
        first: usize,
        /// Counted from 1.
        other: usize,
        /// The first's method.
        one: &'static str,
        /// The other's method.
        another: &'static str,
    },
}

impl Course {
    /// The course of a patient's records. Visits that cannot be compared with the others stand in groups of
    /// their own.
    ///
    /// # Errors
    /// If the records are not two or more different scans of one patient.
    pub fn from_records(records: &[Record], choice: Choice) -> Result<Course, CourseFault> {
        if records.len() < 2 {
            return Err(CourseFault::TooFew { found: records.len() });
        }
        let visit = |(at, record)| Visit::new(at, record, choice.girth_common_mm);
        let mut visits: Vec<Visit> = records.iter().enumerate().map(visit).collect();
        for other in 1..visits.len() {
            if visits[other].patient != visits[0].patient {
                return Err(CourseFault::OtherPatient { first: 1, other: other + 1 });
            }
            let same = |earlier: &Visit| earlier.sha256 == visits[other].sha256;
            if let Some(first) = visits[..other].iter().position(same) {
                return Err(CourseFault::SameScan { first: first + 1, other: other + 1 });
            }
        }
        if visits.iter().all(|visit| visit.acquired.is_some()) {
            visits.sort_by_key(|visit| visit.acquired.as_ref().map(|acquired| acquired.at));
        }
        let groups = groups(&visits, choice.volume);
        Ok(Course { visits, groups, choice, left_out: Vec::new(), is_affected_unreadable: false })
    }

    /// The course of records that must all be comparable.
    ///
    /// # Errors
    /// As [`Course::from_records`], and if one of them cannot be compared with the others.
    pub fn comparable(records: &[Record], choice: Choice) -> Result<Course, CourseFault> {
        let course = Course::from_records(records, choice)?;
        if let Some(visit) = course.visits.iter().find(|visit| !has_places(visit)) {
            return Err(CourseFault::NoPlaces { at: visit.record + 1 });
        }
        match course.groups.as_slice() {
            [_] => Ok(course),
            groups => Err(course.fault_between(&groups[0], &groups[1])),
        }
    }

    /// The course with the records that are left out of it.
    pub fn with_left_out(self, mut left_out: Vec<LeftOut>) -> Course {
        left_out.sort_by_key(|of| of.seen);
        Course { left_out, ..self }
    }

    /// The course of a patient whose affected leg was named but cannot be read, if that is so. A leg that was chosen
    /// counts all the same.
    pub fn with_affected_unreadable(self, is_unreadable: bool) -> Course {
        let is_affected_unreadable = is_unreadable && self.choice.affected.is_none();
        Course { is_affected_unreadable, ..self }
    }

    /// The word for the affected leg, also where none is known.
    pub(crate) fn affected_word(&self) -> &'static str {
        match self.choice.affected {
            Some(affected) => affected.word(),
            None if self.is_affected_unreadable => Affected::UNREADABLE,
            None => Affected::NOT_NAMED,
        }
    }

    /// When a record that is left out was first seen, on the clock of the last visit's scanner.
    pub fn seen(&self, of: &LeftOut) -> Acquired {
        let last = self.visits.iter().rev().find_map(|visit| visit.acquired.as_ref());
        last.map_or_else(|| Acquired::new(of.seen, AcquiredFrom::Unknown), |last| of.at(last))
    }

    /// The group of the last visit.
    pub fn last_group(&self) -> Option<&Group> {
        let last = self.visits.len().checked_sub(1)?;
        self.groups.iter().find(|group| group.visits.contains(&last))
    }

    /// The volume of a leg at a visit, over the pieces that all visits of the group have, mL. Its ± is that of the
    /// whole leg in the report of the visit's scan, so that the two never differ.
    pub fn volume(&self, group: &Group, visit: usize, side: Side) -> Option<Quantity> {
        let pieces = group.pieces.get(side);
        let visit = &self.visits[visit];
        let leg = visit.legs.get(side).as_ref()?;
        let volume = leg.volume(group.volume, pieces, &visit.common)?;
        Some(Quantity { sd: leg.volume_sd_ml.unwrap_or(volume.sd), ..volume })
    }

    fn fault_between(&self, one: &Group, another: &Group) -> CourseFault {
        let [first, other] = [one, another].map(|group| group.visits[0]);
        let girths = |at: usize| self.visits[at].definition.girths.clone();
        let (first_girths, other_girths) = (girths(first), girths(other));
        let [first, other] = [first, other].map(|at| self.visits[at].record + 1);
        if first_girths == other_girths {
            let (one, another) = (one.volume.word(), another.volume.word());
            return CourseFault::OtherVolume { first, other, one, another };
        }
        CourseFault::OtherDefinition { first, other, one: first_girths, another: other_girths }
    }
}

fn has_places(visit: &Visit) -> bool {
    Side::BOTH
        .into_iter()
        .any(|side| visit.legs.get(side).as_ref().is_some_and(|leg| !leg.places.is_empty()))
}

/// The visits that can be compared with each other.
fn groups(visits: &[Visit], chosen: Option<VolumeBy>) -> Vec<Group> {
    let mut found: Vec<(Definition, Vec<usize>)> = Vec::new();
    for (index, visit) in visits.iter().enumerate() {
        let volume = chosen.or(visit.definition.volume);
        let definition = Definition { girths: visit.definition.girths.clone(), volume };
        let known = found.iter_mut().find(|(of, _)| *of == definition);
        match known.filter(|_| has_places(visit)) {
            Some((_, visits)) => visits.push(index),
            None => found.push((definition, vec![index])),
        }
    }
    let group = |(definition, of): (Definition, Vec<usize>)| {
        let volume = definition.volume.unwrap_or_default();
        let pieces = Sides::of_each(|side| common_pieces(visits, &of, side, volume));
        Group { visits: of, volume, pieces }
    };
    found.into_iter().map(group).collect()
}

/// The pieces of a leg that all visits on which it was measured have.
fn common_pieces(visits: &[Visit], of: &[usize], side: Side, by: VolumeBy) -> BTreeSet<Step> {
    let legs = of.iter().filter_map(|visit| visits[*visit].legs.get(side).as_ref());
    let pieces = legs.map(|leg| {
        leg.pieces(by).into_keys().filter(|step| *step >= FIRST_STEP).collect::<BTreeSet<Step>>()
    });
    pieces.reduce(|all, own| &all & &own).unwrap_or_default()
}
