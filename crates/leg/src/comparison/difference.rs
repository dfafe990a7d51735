//! Differences between the two legs of a patient, always left minus right.

use super::volume::Volume;
use crate::level::Level;
use crate::measured::LegReport;
use crate::side::Side;

/// A girth difference of at least this much is reported as a swelling, mm. From memory of clinical
/// use, not checked against a source.
pub const GIRTH_MM: f64 = 20.0;

/// A volume difference of at least this much is reported as a swelling, % of the smaller leg. From
/// memory of clinical use, not checked against a source.
const VOLUME_PERCENT: f64 = 10.0;

/// A difference counts as real if it exceeds this many of its standard errors.
const REAL_SDS: f64 = 2.0;

/// The differences of one patient's legs.
#[derive(Debug, Clone, PartialEq)]
pub struct Differences {
    /// Levels found on both legs, lowest first.
    pub levels: Vec<LevelDifference>,
    /// Whole volume, over the range along the axis that was measured on both legs; `None` if one
    /// leg has no whole volume.
    pub whole: Option<VolumeDifference>,
    /// Slices of 4 cm that were measured completely on both legs, lowest first.
    pub slices: Vec<VolumeDifference>,
}

/// A difference and its standard error; the errors of the two legs are independent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Left minus right.
    pub value: f64,
    /// Standard error; not finite if unknown.
    pub sd: f64,
}

/// The difference at one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelDifference {
    /// Which level.
    pub level: Level,
    /// Difference of the tape girths, mm.
    pub girth_mm: Difference,
    /// Difference of the level's heights, mm.
    pub height_mm: Difference,
}

/// The difference of the volumes between the same two distances along the legs' axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeDifference {
    /// Lower end, mm along each axis.
    pub from_mm: f64,
    /// Upper end, mm along each axis.
    pub to_mm: f64,
    /// Difference of the volumes, mL.
    pub ml: Difference,
    /// The same, % of the smaller volume.
    pub percent: f64,
}

coded_enum! {
    /// A difference that reaches the swelling threshold and exceeds its own uncertainty.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum LegsDiffer {
        /// In the tape girth at a level.
        Girth {
            /// The leg with the larger girth.
            larger: Side,
            /// By how much, mm.
            by_mm: f64,
            /// Standard error, mm.
            sd_mm: f64,
        } => "legs-differ",
        /// In the volume of the whole leg.
        Volume {
            /// The leg with the larger volume.
            larger: Side,
            /// By how much, mL.
            by_ml: f64,
            /// By how much, % of the smaller one.
            percent: f64,
            /// Standard error, mL.
            sd_ml: f64,
        } => "legs-differ",
    }
}

impl Difference {
    fn between(left: [f64; 2], right: [f64; 2]) -> Difference {
        Difference { value: left[0] - right[0], sd: left[1].hypot(right[1]) }
    }

    /// Whether the difference exceeds its own uncertainty.
    pub fn is_real(&self) -> bool {
        self.value.abs() > REAL_SDS * self.sd
    }

    fn larger(&self) -> Side {
        if self.value > 0.0 { Side::Left } else { Side::Right }
    }
}

/// The differences between the legs; `None` if one of them was not measured.
pub(crate) fn differences(legs: &[LegReport]) -> Option<Differences> {
    let of = |side: Side| legs.iter().find(|leg| leg.side == side);
    let (left, right) = (of(Side::Left)?, of(Side::Right)?);
    let level = |level: Level| {
        let at = |leg: &LegReport| leg.landmarks.iter().find(|l| l.level == level).cloned();
        let (l, r) = (at(left)?, at(right)?);
        Some(LevelDifference {
            level,
            girth_mm: Difference::between(
                [l.girth_tape_mm, l.girth_of_level_sd_mm],
                [r.girth_tape_mm, r.girth_of_level_sd_mm],
            ),
            height_mm: Difference::between(
                [l.height_mm, l.height_sd_mm],
                [r.height_mm, r.height_sd_mm],
            ),
        })
    };
    let slices = left.volume.slices.iter().zip(&right.volume.slices);
    Some(Differences {
        levels: Level::ALL.into_iter().filter_map(level).collect(),
        whole: whole(left, right),
        slices: slices.filter_map(|(l, r)| Some(volume(l.volume?, r.volume?))).collect(),
    })
}

/// The whole volumes, over the range of distances that both legs have.
fn whole(left: &LegReport, right: &LegReport) -> Option<VolumeDifference> {
    let (l, r) = (left.volume.whole?, right.volume.whole?);
    let (from_mm, to_mm) = (l.from_mm.max(r.from_mm), l.to_mm.min(r.to_mm));
    let common = |leg: &LegReport| leg.volume.areas.volume(from_mm, to_mm);
    Some(volume(common(left)?, common(right)?))
}

fn volume(left: Volume, right: Volume) -> VolumeDifference {
    let ml = Difference::between([left.ml, left.sd_ml], [right.ml, right.sd_ml]);
    let percent = 100.0 * ml.value / left.ml.min(right.ml);
    VolumeDifference { from_mm: left.from_mm, to_mm: left.to_mm, ml, percent }
}

impl Differences {
    /// The differences that reach the swelling threshold and are real, each girth with its level.
    ///
    /// B1 is left out: it lies on a slope, so its girth reflects its height more than the leg.
    pub(crate) fn swellings(&self) -> Vec<(Option<Level>, LegsDiffer)> {
        let girth = |at: &LevelDifference| {
            let found = at.girth_mm;
            let (by_mm, sd_mm) = (found.value.abs(), found.sd);
            let differ = LegsDiffer::Girth { larger: found.larger(), by_mm, sd_mm };
            (by_mm >= GIRTH_MM && found.is_real()).then_some((Some(at.level), differ))
        };
        let volume = |at: &VolumeDifference| {
            let (by_ml, sd_ml, percent) = (at.ml.value.abs(), at.ml.sd, at.percent.abs());
            let differ = LegsDiffer::Volume { larger: at.ml.larger(), by_ml, percent, sd_ml };
            (percent >= VOLUME_PERCENT && at.ml.is_real()).then_some((None, differ))
        };
        let levels = self.levels.iter().filter(|at| at.level != Level::B1);
        levels.filter_map(girth).chain(self.whole.iter().filter_map(volume)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences with one girth, at B1 and C, and one volume.
    fn with(girth_mm: [f64; 2], ml: [f64; 2], percent: f64) -> Differences {
        let difference = |[value, sd]: [f64; 2]| Difference { value, sd };
        let (girth_mm, height_mm) = (difference(girth_mm), difference([0.0, 1.0]));
        let level = |level| LevelDifference { level, girth_mm, height_mm };
        let (from_mm, to_mm) = (60.0, 700.0);
        let whole = VolumeDifference { from_mm, to_mm, ml: difference(ml), percent };
        Differences {
            levels: vec![level(Level::B1), level(Level::C)],
            whole: Some(whole),
            slices: Vec::new(),
        }
    }

    #[test]
    fn a_difference_is_told_from_20_mm_or_10_percent_on_and_with_the_larger_leg() {
        assert_eq!(with([19.9, 0.1], [500.0, 5.0], 9.9).swellings(), []);
        let told = with([-20.0, 0.1], [500.0, 5.0], 10.0).swellings();
        let girth = LegsDiffer::Girth { larger: Side::Right, by_mm: 20.0, sd_mm: 0.1 };
        assert_eq!(told[0], (Some(Level::C), girth));
        let larger = Side::Left;
        let volume = LegsDiffer::Volume { larger, by_ml: 500.0, percent: 10.0, sd_ml: 5.0 };
        assert_eq!(told[1..], [(None, volume)]);
    }

    #[test]
    fn nothing_below_its_own_uncertainty_is_told() {
        assert_eq!(with([40.0, 20.0], [500.0, 250.0], 20.0).swellings(), []);
        for unknown in [f64::INFINITY, f64::NAN] {
            assert_eq!(with([40.0, unknown], [500.0, unknown], 20.0).swellings(), []);
        }
        assert_eq!(with([40.1, 20.0], [500.1, 250.0], 20.0).swellings().len(), 2);
    }
}
