//! Figures that clinics chart for a swollen leg, as in `record.json`: volumes, girths at any height, and
//! how the legs differ.

use gaiter_leg::LegReport;
use gaiter_leg::comparison::difference::{
    Difference, Differences, LevelDifference, VolumeDifference,
};
use gaiter_leg::comparison::tape_volume::{Piece, VolumeBy};
use gaiter_leg::comparison::volume::{Slice, Volume};
use gaiter_leg::doubt::Doubt;
use gaiter_leg::levels::at_height::{AtHeight, AtLength, PROFILE_STEP_MM};
use gaiter_leg::sections::axis_length::AxisLength;
use serde::{Deserialize, Serialize};

use super::rounding::{ml, mm, percent};

/// Volumes of one leg.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct VolumeFigures {
    /// From the lowest measured section to the highest, at the crotch; null if a section between them is
    /// open.
    pub whole_ml: Option<f64>,
    /// Height of the lowest section's centre; null like `whole_ml`.
    pub from_height_mm: Option<f64>,
    /// Height of the highest section's centre; null like `whole_ml`.
    pub to_height_mm: Option<f64>,
    /// Standard error of `whole_ml`; null if unknown.
    pub sd_ml: Option<f64>,
    /// Between B and D; null if one of them is absent or a section between them is open.
    pub b_to_d_ml: Option<f64>,
    /// Standard error of `b_to_d_ml`; null if unknown.
    pub b_to_d_sd_ml: Option<f64>,
    /// Slices of 4 cm along the axis from the floor up.
    pub slices: Vec<SliceFigures>,
    /// The volume as clinics compute it from girths every 4 cm along the leg; null if there are none.
    pub by_tape: Option<TapeVolumeFigures>,
}

/// A volume made of girths at fixed places.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TapeVolumeFigures {
    /// `cones` between neighbouring places or `discs` about each. Volumes of different methods are not
    /// compared.
    #[cfg_attr(test, schemars(extend("enum" = ["cones", "discs"])))]
    pub method: String,
    /// Distance between two places.
    pub step_mm: f64,
    /// Lower end, along the axis from the floor.
    pub from_mm: f64,
    /// Upper end, along the axis from the floor; between the two every girth was measured.
    pub to_mm: f64,
    /// The volume between the ends.
    pub ml: f64,
}

/// The volume of a slice across the axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SliceFigures {
    /// Lower end, along the axis from the floor.
    pub from_mm: f64,
    /// Upper end, along the axis from the floor.
    pub to_mm: f64,
    /// The volume between the ends; null if the slice was not measured completely.
    pub ml: Option<f64>,
    /// Standard error; null if unknown.
    pub sd_ml: Option<f64>,
}

/// The girth at a requested height; null if it was not measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AtFigures {
    /// Requested vertical height of the section's centre above the floor.
    pub height_mm: f64,
    /// Distance along the leg's axis from the floor.
    pub along_axis_mm: Option<f64>,
    /// Circumference of the convex hull, as a tape reads it.
    pub girth_tape_mm: Option<f64>,
    /// Circumference along the skin.
    pub girth_contour_mm: Option<f64>,
    /// Standard error of the tape girth.
    pub girth_sd_mm: Option<f64>,
    /// Codes of doubts; `height-not-measured` if there is no girth: its finding states why.
    pub doubts: Vec<String>,
}

/// The girth at a fixed length along the leg; null if it was not measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AlongFigures {
    /// Length along the leg's axis from the floor.
    pub along_axis_mm: f64,
    /// Vertical height of the section's centre above the floor.
    pub height_mm: Option<f64>,
    /// Circumference of the convex hull, as a tape reads it.
    pub girth_tape_mm: Option<f64>,
    /// Circumference along the skin.
    pub girth_contour_mm: Option<f64>,
    /// Standard error of the tape girth at this place.
    pub girth_sd_mm: Option<f64>,
    /// Codes of doubts.
    pub doubts: Vec<String>,
}

/// How the legs differ: left minus right everywhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DifferenceFigures {
    /// Levels found on both legs, lowest first.
    pub levels: Vec<LevelDifferenceFigures>,
    /// Whole volume over the range that both legs have; null if a leg has no whole volume.
    pub whole: Option<VolumeDifferenceFigures>,
    /// Slices that were measured completely on both legs.
    pub slices: Vec<VolumeDifferenceFigures>,
}

/// The difference at one level, left minus right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LevelDifferenceFigures {
    /// The level.
    pub level: String,
    /// Difference of the tape girths.
    pub girth_tape_mm: f64,
    /// Its standard error; null if unknown.
    pub girth_sd_mm: Option<f64>,
    /// Difference of the heights of the level.
    pub height_mm: f64,
    /// Its standard error; null if unknown.
    pub height_sd_mm: Option<f64>,
}

/// The difference of two volumes between the same two distances along the axes, left minus right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct VolumeDifferenceFigures {
    /// Lower end, along the axis from the floor.
    pub from_mm: f64,
    /// Upper end, along the axis from the floor.
    pub to_mm: f64,
    /// Difference of the volumes.
    pub ml: f64,
    /// Its standard error; null if unknown.
    pub sd_ml: Option<f64>,
    /// The difference in % of the smaller volume.
    pub percent: f64,
}

/// Rounds a value. `None` if it is not finite, which means unknown.
pub(crate) fn known(value: f64, rounded: fn(f64) -> f64) -> Option<f64> {
    value.is_finite().then(|| rounded(value))
}

pub(crate) fn codes(doubts: &[Doubt]) -> Vec<String> {
    doubts.iter().map(|doubt| doubt.code().to_owned()).collect()
}

/// The volumes of a leg; `by`: how one is made of girths.
pub(crate) fn volumes(report: &LegReport, by: VolumeBy) -> VolumeFigures {
    let leg = &report.volume;
    let value = |volume: Option<Volume>| volume.and_then(|volume| known(volume.ml, ml));
    let sd = |volume: Option<Volume>| volume.and_then(|volume| known(volume.sd_ml, ml));
    let slice = |slice: &Slice| SliceFigures {
        from_mm: mm(slice.from_mm),
        to_mm: mm(slice.to_mm),
        ml: value(slice.volume),
        sd_ml: sd(slice.volume),
    };
    let [from_height_mm, to_height_mm] =
        [0, 1].map(|end: usize| leg.whole_height_mm.map(|heights| mm(heights[end])));
    VolumeFigures {
        whole_ml: value(leg.whole),
        from_height_mm,
        to_height_mm,
        sd_ml: sd(leg.whole),
        b_to_d_ml: value(leg.b_to_d),
        b_to_d_sd_ml: sd(leg.b_to_d),
        slices: leg.slices.iter().map(slice).collect(),
        by_tape: by_tape(&report.along, by),
    }
}

/// The volume from girths at fixed places, over the longest run of them without a gap.
fn by_tape(along: &[AtLength], by: VolumeBy) -> Option<TapeVolumeFigures> {
    let girth_mm = |at: &AtLength| at.found.as_ref().ok().map(|girth| girth.girth_tape_mm);
    let runs = along.split(|at| at.found.is_err());
    let run = runs.max_by_key(|run| run.len())?;
    let piece = |index: usize| {
        let girths_mm = [Some(&run[index]), run.get(index + 1)].map(|at| at.and_then(girth_mm));
        by.piece(run[index].length_mm, PROFILE_STEP_MM, girths_mm)
    };
    let pieces: Vec<Piece> = (0..run.len()).filter_map(piece).collect();
    Some(TapeVolumeFigures {
        method: by.word().to_owned(),
        step_mm: PROFILE_STEP_MM,
        from_mm: mm(pieces.first()?.from_mm),
        to_mm: mm(pieces.last()?.to_mm),
        ml: ml(pieces.iter().map(|piece| piece.ml).sum()),
    })
}

/// The girth at a height.
pub(crate) fn at(at: &AtHeight, lengths: &AxisLength) -> AtFigures {
    let girth = at.found.as_ref().ok();
    AtFigures {
        height_mm: mm(at.height_mm),
        along_axis_mm: girth.map(|girth| mm(lengths.at(girth.along_mm))),
        girth_tape_mm: girth.map(|girth| mm(girth.girth_tape_mm)),
        girth_contour_mm: girth.map(|girth| mm(girth.girth_contour_mm)),
        girth_sd_mm: girth.and_then(|girth| known(girth.girth_sd_mm, mm)),
        doubts: match girth {
            Some(girth) => codes(&girth.doubts),
            None => vec!["height-not-measured".to_owned()],
        },
    }
}

/// The girth at a fixed length.
pub(crate) fn along(at: &AtLength) -> AlongFigures {
    let girth = at.found.as_ref().ok();
    AlongFigures {
        along_axis_mm: mm(at.length_mm),
        height_mm: at.height_mm.map(mm),
        girth_tape_mm: girth.map(|girth| mm(girth.girth_tape_mm)),
        girth_contour_mm: girth.map(|girth| mm(girth.girth_contour_mm)),
        girth_sd_mm: girth.and_then(|girth| known(girth.girth_sd_mm, mm)),
        doubts: girth.map(|girth| codes(&girth.doubts)).unwrap_or_default(),
    }
}

/// The girths of two legs, right and left, at each height that both have, lowest first.
pub(crate) fn same_heights([right, left]: [&[AtFigures]; 2]) -> Vec<[&AtFigures; 2]> {
    let other = |at: &AtFigures| left.iter().find(|other| other.height_mm == at.height_mm);
    right.iter().filter_map(|at| Some([at, other(at)?])).collect()
}

/// The difference of two girths, left minus right, mm, and its standard error, `None` if unknown. `None`
/// if one of the girths is missing.
pub(crate) fn girth_difference(right: &AtFigures, left: &AtFigures) -> Option<(f64, Option<f64>)> {
    let sds = right.girth_sd_mm.zip(left.girth_sd_mm);
    let difference_mm = left.girth_tape_mm? - right.girth_tape_mm?;
    Some((difference_mm, sds.map(|(right, left)| right.hypot(left))))
}

/// The differences of the legs.
pub(crate) fn differences(legs: &Differences) -> DifferenceFigures {
    DifferenceFigures {
        levels: legs.levels.iter().map(level_difference).collect(),
        whole: legs.whole.as_ref().map(volume_difference),
        slices: legs.slices.iter().map(volume_difference).collect(),
    }
}

fn level_difference(at: &LevelDifference) -> LevelDifferenceFigures {
    let sd = |difference: Difference| known(difference.sd, mm);
    LevelDifferenceFigures {
        level: at.level.name().to_owned(),
        girth_tape_mm: mm(at.girth_mm.value),
        girth_sd_mm: sd(at.girth_mm),
        height_mm: mm(at.height_mm.value),
        height_sd_mm: sd(at.height_mm),
    }
}

fn volume_difference(at: &VolumeDifference) -> VolumeDifferenceFigures {
    VolumeDifferenceFigures {
        from_mm: mm(at.from_mm),
        to_mm: mm(at.to_mm),
        ml: ml(at.ml.value),
        sd_ml: known(at.ml.sd, ml),
        percent: percent(at.percent),
    }
}
