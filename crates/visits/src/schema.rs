//! A course of visits as JSON, `gaiter.visits/1`: the figures that the report rounds, with their parts of
//! uncertainty.

use gaiter_leg::Side;
use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_record::Acquired;
use gaiter_record::report::Reliability;
use gaiter_record::rounding::{ml, mm, percent};
use serde::Serialize;

use super::caution::Caution;
use super::comparison::{Comparison, LegChange, PlaceChange};
use super::course::{Affected, Course, Group};
use super::excess::{Excess, ExcessChange, NoReduction};
use super::left_out::LeftOut;
use super::place::along_mm;
use super::quantity::{Change, Quantity};
use super::threshold::{Threshold, verdicts};

/// Name and number of the schema.
pub const VISITS: &str = "gaiter.visits/1";

/// A course. Lengths are in mm, volumes in mL; a standard uncertainty ends in `_sd`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CourseFigures {
    /// Always [`VISITS`].
    pub schema: &'static str,
    /// The patient's id; null if the records name none.
    pub patient: Option<String>,
    /// The affected leg as a person named it: `left`, `right`, `both` or `none`; null if nobody did.
    pub affected: Option<&'static str>,
    /// Whether a person named one that cannot be read, so that none counts.
    pub is_affected_unreadable: bool,
    /// Standard error that all girths of a scan have in common.
    pub girth_common_sd_mm: f64,
    /// Length along the leg between two girths.
    pub step_mm: f64,
    /// The visits, oldest first.
    pub visits: Vec<VisitFigures>,
    /// Visits of one definition; only they are compared with each other.
    pub groups: Vec<GroupFigures>,
    /// Records of the patient that are no visits because they cannot be used or are gone, oldest first.
    pub left_out: Vec<LeftOut>,
    /// The last visit compared with the first of its group and with the one before it.
    pub comparisons: Vec<ComparisonFigures>,
}

/// A visit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VisitFigures {
    /// SHA-256 of the scan.
    pub scan_sha256: String,
    /// The record's revision.
    pub revision: u32,
    /// When the scan was taken; null if unknown.
    pub acquired: Option<Acquired>,
    /// The station; null for a bare `extract`.
    pub station: Option<String>,
    /// How the patient held the legs; null if the record does not state it.
    pub posture: Option<String>,
    /// Mean error of the last phantom check before; null if there was none.
    pub phantom_bias_mm: Option<f64>,
    /// What the girths mean.
    pub definition: String,
    /// Reasons for caution in comparing it with the last visit of its group, by code: `time-of-day-differs`.
    pub cautions: Vec<&'static str>,
    /// The legs that were measured.
    pub legs: Vec<LegAtVisitFigures>,
    /// Volume of the left leg minus that of the right one, over the lengths that both have; null if a leg is missing.
    pub left_minus_right_ml: Option<QuantityFigures>,
    /// The excess of the affected leg; null unless `affected` is one leg.
    pub excess: Option<ExcessFigures>,
}

/// A leg at a visit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegAtVisitFigures {
    /// `left` or `right`.
    pub side: &'static str,
    /// Volume over the lengths that all visits of the group have; null if there are none.
    pub volume_ml: Option<QuantityFigures>,
    /// Girths at fixed lengths.
    pub girths: Vec<PlaceFigures>,
    /// Girths at the levels, found again at this visit.
    pub levels: Vec<LevelFigures>,
}

/// A level at a visit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelFigures {
    /// Its name.
    pub level: &'static str,
    /// Its girth.
    pub girth_mm: f64,
    /// Its height above the floor; null on the foot.
    pub height_mm: Option<f64>,
    /// Whether a person measured it.
    pub is_by_hand: bool,
}

/// The girth at a fixed length along the leg.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaceFigures {
    /// The length.
    pub along_mm: f64,
    /// The girth.
    pub girth_mm: f64,
    /// Its standard uncertainty at this place alone.
    pub random_sd_mm: f64,
    /// Whether the record has a doubt about it.
    pub is_doubtful: bool,
}

/// A figure with the parts of its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantityFigures {
    /// The figure.
    pub value: f64,
    /// Its standard uncertainty at this visit; of a leg's volume, that of the report of its scan.
    pub visit_sd: f64,
    /// What counts in a change and is independent from place to place.
    pub random_sd: f64,
    /// What counts in a change and is common to all girths of the scan.
    pub common_sd: f64,
}

/// Visits that can be compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupFigures {
    /// Their places among `visits`, counted from 0.
    pub visits: Vec<usize>,
    /// `cones` or `discs`.
    pub volume_method: &'static str,
    /// The lengths of each leg that count: lower and upper end; null if there are none.
    pub left_mm: Option<[f64; 2]>,
    /// The same of the right leg.
    pub right_mm: Option<[f64; 2]>,
}

/// A comparison of two visits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonFigures {
    /// The place of the earlier visit among `visits`, counted from 0.
    pub earlier: usize,
    /// The place of the later one.
    pub later: usize,
    /// Whether the earlier visit replaces a record that is left out.
    pub is_earlier_stand_in: bool,
    /// Whether a record that is left out is newer than the later visit.
    pub is_later_stand_in: bool,
    /// The legs that both visits have.
    pub legs: Vec<LegChangeFigures>,
    /// Of the volume of the left leg minus that of the right one; null if a leg is missing or the posture is
    /// another.
    pub left_minus_right_ml: Option<ChangeFigures>,
    /// The excess of the affected leg; null unless `affected` is one leg, and with `left_minus_right_ml`.
    pub excess: Option<ExcessChangeFigures>,
    /// Reasons for caution in the comparison, by code; see docs/codes.md.
    pub cautions: Vec<&'static str>,
    /// The verdicts of the clinic's own thresholds.
    pub thresholds: Vec<ThresholdFigures>,
}

/// The change of a leg.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegChangeFigures {
    /// `left` or `right`.
    pub side: &'static str,
    /// Of the volume, mL; null without common lengths, and if the posture is another.
    pub volume_ml: Option<ChangeFigures>,
    /// Of girths at fixed lengths, mm.
    pub girths_mm: Vec<PlaceChangeFigures>,
    /// Of the volume of slices, mL; each begins at its length and is one step long.
    pub slices_ml: Vec<PlaceChangeFigures>,
}

/// A change at a place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaceChangeFigures {
    /// The length along the leg.
    pub along_mm: f64,
    /// The change.
    #[serde(flatten)]
    pub change: ChangeFigures,
    /// Whether one of the records has a doubt there.
    pub is_doubtful: bool,
}

/// A change, later minus earlier.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangeFigures {
    /// In the unit of its list.
    pub change: f64,
    /// % of the earlier figure; null for the difference of two legs, which may be nothing.
    pub percent_change: Option<f64>,
    /// The smallest change that is shown.
    pub detectable: f64,
    /// The same, % of the earlier figure; null with it.
    pub detectable_percent: Option<f64>,
    /// `larger`, `smaller` or `no-change-shown`.
    pub shown: &'static str,
    /// The independent part of its standard uncertainty.
    pub random_sd: f64,
    /// The part that is common to all girths of a scan.
    pub common_sd: f64,
    /// The part that comes from another stance.
    pub stance_sd: f64,
}

/// The excess volume of a leg.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExcessFigures {
    /// The affected leg.
    pub affected: &'static str,
    /// Its volume minus that of the other leg, mL.
    pub volume_ml: QuantityFigures,
    /// % of the other leg.
    pub excess_percent: f64,
}

/// The change of the excess volume.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExcessChangeFigures {
    /// The affected leg.
    pub affected: &'static str,
    /// In mL.
    pub volume_ml: ChangeFigures,
    /// 100 (earlier − later) / earlier; null if it is not reported.
    pub percent_reduction: Option<f64>,
    /// Its expanded uncertainty, percentage points; null with it.
    pub percent_reduction_u95: Option<f64>,
    /// Why it is not reported: `no-change-shown`, `within-uncertainty` (the earlier excess is) or `smaller-leg`
    /// (the affected leg was the smaller one); null if it is.
    pub no_percent_reduction: Option<&'static str>,
}

/// The verdict of a threshold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ThresholdFigures {
    /// Its name.
    pub name: String,
    /// Its source.
    pub source: String,
    /// What it limits.
    pub of: &'static str,
    /// The limit.
    pub limit: f64,
    /// `left` or `right`.
    pub side: &'static str,
    /// The figure.
    pub value: f64,
    /// `reached`, `not-reached` or `open`.
    pub reached: &'static str,
}

/// The figures of a course.
pub fn figures(course: &Course, thresholds: &[Threshold]) -> CourseFigures {
    let group = course.last_group();
    let compared = group.map(|group| course.last_compared(group)).unwrap_or_default();
    CourseFigures {
        schema: VISITS,
        patient: course.visits.first().and_then(|visit| visit.patient.clone()),
        affected: course.choice.affected.map(Affected::word),
        is_affected_unreadable: course.is_affected_unreadable,
        girth_common_sd_mm: course.choice.girth_common_mm,
        step_mm: PROFILE_STEP_MM,
        visits: (0..course.visits.len()).map(|at| visit(course, at)).collect(),
        groups: course.groups.iter().map(group_figures).collect(),
        left_out: course.left_out.clone(),
        comparisons: compared.iter().map(|of| comparison(of, thresholds)).collect(),
    }
}

fn visit(course: &Course, at: usize) -> VisitFigures {
    let of = &course.visits[at];
    let group = course.groups.iter().find(|group| group.visits.contains(&at));
    let leg = |side: Side| {
        let leg = of.legs.get(side).as_ref()?;
        let volume = group.and_then(|group| course.volume(group, at, side));
        let girths = leg.places.iter().map(|(step, place)| PlaceFigures {
            along_mm: along_mm(*step),
            girth_mm: place.girth_mm,
            random_sd_mm: place.girth_sd_mm,
            is_doubtful: place.is_doubtful,
        });
        let levels = of.levels.get(side).iter().map(|of| LevelFigures {
            level: of.level.name(),
            girth_mm: of.girth_mm,
            height_mm: of.height_mm,
            is_by_hand: of.mark == Reliability::ByHand,
        });
        Some(LegAtVisitFigures {
            side: side.word(),
            volume_ml: volume.map(|volume| quantity(&volume)),
            girths: girths.collect(),
            levels: levels.collect(),
        })
    };
    VisitFigures {
        scan_sha256: of.sha256.clone(),
        revision: of.revision,
        acquired: of.acquired.clone(),
        station: of.station.clone(),
        posture: of.posture.clone(),
        phantom_bias_mm: of.phantom_mm,
        definition: of.definition.girths.clone(),
        cautions: group
            .and_then(|group| course.other_time_of_day(group, at))
            .iter()
            .map(Caution::code)
            .collect(),
        legs: Side::BOTH.into_iter().filter_map(leg).collect(),
        left_minus_right_ml: group
            .and_then(|group| course.left_minus_right(group, at))
            .map(|of| quantity(&of)),
        excess: group.and_then(|group| course.excess(group, at)).map(|of| excess(&of)),
    }
}

fn group_figures(of: &Group) -> GroupFigures {
    let range = |side: Side| {
        let pieces = of.pieces.get(side);
        Some([along_mm(*pieces.first()?), along_mm(*pieces.last()?) + PROFILE_STEP_MM])
    };
    GroupFigures {
        visits: of.visits.clone(),
        volume_method: of.volume.word(),
        left_mm: range(Side::Left),
        right_mm: range(Side::Right),
    }
}

fn comparison(of: &Comparison, thresholds: &[Threshold]) -> ComparisonFigures {
    let leg = |side: Side| {
        let LegChange { volume, girths, pieces } = of.legs.get(side).as_ref()?;
        Some(LegChangeFigures {
            side: side.word(),
            volume_ml: volume.as_ref().map(change),
            girths_mm: girths.iter().map(place_change).collect(),
            slices_ml: pieces.iter().map(place_change).collect(),
        })
    };
    let of_threshold = verdicts(thresholds, of).into_iter().map(|verdict| ThresholdFigures {
        name: verdict.threshold.name.clone(),
        source: verdict.threshold.source.clone(),
        of: verdict.threshold.of.word(),
        limit: verdict.threshold.limit,
        side: verdict.side.word(),
        value: percent(verdict.value),
        reached: verdict.reached().word(),
    });
    ComparisonFigures {
        earlier: of.earlier,
        later: of.later,
        is_earlier_stand_in: of.stand_ins.earlier,
        is_later_stand_in: of.stand_ins.later,
        legs: Side::BOTH.into_iter().filter_map(leg).collect(),
        left_minus_right_ml: of.left_minus_right.as_ref().map(difference_change),
        excess: of.excess.as_ref().map(excess_change),
        cautions: of.cautions.iter().map(Caution::code).collect(),
        thresholds: of_threshold.collect(),
    }
}

fn place_change(of: &PlaceChange) -> PlaceChangeFigures {
    PlaceChangeFigures {
        along_mm: along_mm(of.step),
        change: change(&of.change),
        is_doubtful: of.is_doubtful,
    }
}

fn change(of: &Change) -> ChangeFigures {
    ChangeFigures {
        change: mm(of.by),
        percent_change: Some(percent(of.percent)),
        detectable: mm(of.detectable()),
        detectable_percent: Some(percent(of.detectable_percent())),
        shown: of.shown().word(),
        random_sd: mm(of.random),
        common_sd: mm(of.common),
        stance_sd: mm(of.stance),
    }
}

/// A change of the difference of two legs, without a percentage: the difference may be zero.
fn difference_change(of: &Change) -> ChangeFigures {
    ChangeFigures { percent_change: None, detectable_percent: None, ..change(of) }
}

fn quantity(of: &Quantity) -> QuantityFigures {
    QuantityFigures {
        value: ml(of.value),
        visit_sd: ml(of.sd),
        random_sd: ml(of.parts.random),
        common_sd: ml(of.parts.common()),
    }
}

fn excess(of: &Excess) -> ExcessFigures {
    ExcessFigures {
        affected: of.affected.word(),
        volume_ml: quantity(&of.ml),
        excess_percent: percent(of.percent),
    }
}

fn excess_change(of: &ExcessChange) -> ExcessChangeFigures {
    ExcessChangeFigures {
        affected: of.later.affected.word(),
        // The percentage of an excess is its reduction.
        volume_ml: match of.reduction {
            Ok(_) => change(&of.change),
            Err(_) => difference_change(&of.change),
        },
        percent_reduction: of.reduction.ok().map(|of| percent(of.percent)),
        percent_reduction_u95: of.reduction.ok().map(|of| percent(of.expanded)),
        no_percent_reduction: of.reduction.err().map(NoReduction::word),
    }
}
