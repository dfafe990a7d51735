//! The crotch: where two legs become one body (paper 1, fig. 2a).

use super::leg_tracking::{Parting, Step, follow};
use crate::leg::sections::slice::Mesh;

/// Distance between the fine slices that locate the crotch, mm.
const FINE_STEP_MM: f64 = 1.0;

/// At least this share of the slices above a crotch shows one outline for both legs.
const ONE_SHARE: f64 = 0.8;

/// … and the same share of the first few of them.
const JOIN_STEPS: usize = 5;

/// The fine slices begin this far below the last height at which the thighs are separate, mm.
const FINE_BELOW_MM: f64 = 10.0;

/// The rate at which the thighs approach each other is measured over this height, mm, and
/// extrapolated to where they meet.
const CLOSING_MM: f64 = 5.0;

/// The crotch is at most this much above the last height at which the thighs were seen separate,
/// mm; further up they would still be seen separate.
const CLOSED_MAX_MM: f64 = 8.0;

/// Thighs approach each other by more than this where they meet, mm per mm of height. If they
/// approach more slowly, they run along each other, or the skin in the fold was not seen.
const CLOSING_MIN: f64 = 0.6;

/// Standard error of the crotch if the thighs are seen separate up to it, mm.
const APART_SD_MM: f64 = 3.0;

/// The notch between the thighs in front ends above the crotch, in the pubic region. It ends where
/// it is shallower than this share of the body's depth.
const NOTCH_END_SHARE: f64 = 0.10;

/// … and that point is this share of stature above the crotch: 12 to 35 mm in bodies with a known
/// crotch.
const NOTCH_ABOVE_CROTCH_SHARE: f64 = 0.0145;

/// Standard error of a crotch found from the notch, or from thighs that run along each other, mm.
const NOTCH_SD_MM: f64 = 15.0;

/// Thighs touch if they join this far below the crotch found from the notch, mm: two standard errors.
const TOUCHING_MIN_MM: f64 = 2.0 * NOTCH_SD_MM;

/// Standard error of the crotch if only one leg is followed up to the trunk, mm: from the distance
/// between slices and the slope of a hip.
const ONE_LEG_SD_MM: f64 = 20.0;

/// The assumed crotch height if it is not visible, as a share of stature (ANSUR II).
const MEAN_SHARE: f64 = 0.48;

/// Standard deviation of that share among people (ANSUR II), rounded up.
const SD_SHARE: f64 = 0.015;

/// The height of the crotch and its source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crotch {
    /// Above the floor, mm.
    pub height_mm: f64,
    /// Standard error, mm.
    pub sd_mm: f64,
    /// The source of the height.
    pub from: CrotchFrom,
}

/// The source of the crotch's height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrotchFrom {
    /// The thighs, seen separate up to it.
    Thighs,
    /// The end of the notch in front, because the thighs touch.
    Notch {
        /// Height above which they touch, mm.
        touching_from_mm: f64,
    },
    /// The height at which one leg reaches the trunk, because the other is missing.
    OneLeg,
    /// No observation: the usual height for a body of this size.
    Proportion {
        /// Height above which the legs are joined without a visible fold between them; `None` if
        /// the scan does not reach the crotch.
        touching_from_mm: Option<f64>,
    },
}

impl Crotch {
    /// The crotch at the height where one leg, followed alone, reaches the trunk.
    pub fn of_one_leg(end_mm: f64) -> Crotch {
        Crotch { height_mm: end_mm, sd_mm: ONE_LEG_SD_MM, from: CrotchFrom::OneLeg }
    }

    /// A crotch outside the scan.
    pub fn unseen(stature_mm: f64) -> Crotch {
        let from = CrotchFrom::Proportion { touching_from_mm: None };
        Crotch { height_mm: MEAN_SHARE * stature_mm, sd_mm: SD_SHARE * stature_mm, from }
    }

    /// A crotch hidden between legs that are joined from some height on.
    pub fn hidden(touching_from_mm: f64, stature_mm: f64) -> Crotch {
        let from = CrotchFrom::Proportion { touching_from_mm: Some(touching_from_mm) };
        Crotch { from, ..Crotch::unseen(stature_mm) }
    }

    /// Height above which the legs touch below the crotch, mm, if they do.
    pub fn touching_from_mm(&self) -> Option<f64> {
        match self.from {
            CrotchFrom::Notch { touching_from_mm } => Some(touching_from_mm),
            CrotchFrom::Proportion { touching_from_mm } => touching_from_mm,
            CrotchFrom::Thighs | CrotchFrom::OneLeg => None,
        }
    }

    /// Height above which the legs are joined without a visible fold, mm, if the crotch is hidden.
    pub fn hidden_from_mm(&self) -> Option<f64> {
        if self.is_seen() { None } else { self.touching_from_mm() }
    }

    /// Whether the crotch was seen.
    pub fn is_seen(&self) -> bool {
        !matches!(self.from, CrotchFrom::Proportion { .. })
    }
}

/// The step from which on legs, followed upwards, stay joined; `None` if they never do.
///
/// Single slices of a trunk may fall apart where it has few points.
pub fn join(steps: &[Step]) -> Option<usize> {
    let is_one = |step: &Step| step.neck.is_some();
    let share =
        |part: &[Step]| part.iter().filter(|step| is_one(step)).count() as f64 / part.len() as f64;
    (0..steps.len()).find(|&first| {
        let above = &steps[first..];
        let next = &above[..above.len().min(JOIN_STEPS)];
        is_one(&steps[first]) && share(above) >= ONE_SHARE && share(next) >= ONE_SHARE
    })
}

/// The crotch of legs that were followed upwards and are joined from the step `join` on. Slices
/// `mesh` again in finer steps.
pub fn crotch(mesh: &Mesh, steps: &[Step], join: usize, growth_mm: f64, stature_mm: f64) -> Crotch {
    let (below, joined) = steps.split_at(join);
    let join_mm = joined.first().map_or(0.0, |step| step.height_mm);
    let notched = joined.iter().take_while(|step| notch_share(step) >= NOTCH_END_SHARE).last();
    let by_notch_mm = notched.map(|step| step.height_mm - NOTCH_ABOVE_CROTCH_SHARE * stature_mm);
    if let Some(height_mm) = by_notch_mm.filter(|mm| *mm > join_mm + TOUCHING_MIN_MM) {
        let from = CrotchFrom::Notch { touching_from_mm: join_mm };
        return Crotch { height_mm, sd_mm: NOTCH_SD_MM, from };
    }
    let last = below.iter().rfind(|step| step.neck.is_none());
    let beneath = (join_mm, NOTCH_SD_MM);
    let (height_mm, sd_mm) = last.map_or(beneath, |last| closed(mesh, last, join_mm, growth_mm));
    Crotch { height_mm, sd_mm, from: CrotchFrom::Thighs }
}

fn notch_share(step: &Step) -> f64 {
    step.neck.map_or(0.0, |neck| neck.notch_share)
}

/// The height at which thighs meet that are separate at `last` and joined at `join_mm`, with its
/// standard error. Their distance is visible until the points of one thigh are as close to the
/// other's as to each other; from there it is extrapolated to zero.
///
/// Below the top of an arch the width grows with the square root of the depth, so the square of the
/// distance is what decreases linearly.
fn closed(mesh: &Mesh, last: &Step, join_mm: f64, growth_mm: f64) -> (f64, f64) {
    let from_mm = last.height_mm - FINE_BELOW_MM;
    let count = ((join_mm + FINE_BELOW_MM - from_mm) / FINE_STEP_MM) as usize + 1;
    let heights: Vec<f64> = (0..count).map(|index| from_mm + FINE_STEP_MM * index as f64).collect();
    let fine = follow(mesh, &last.prints, &heights, growth_mm, Parting::Neck);
    let gaps = fine.steps.iter().take_while(|step| step.neck.is_none());
    let gaps: Vec<(f64, f64)> =
        gaps.filter_map(|step| Some((step.height_mm, step.gap_mm?))).collect();
    let (Some(&(first_mm, first)), Some(&(last_mm, gap_mm))) = (gaps.first(), gaps.last()) else {
        return (join_mm, NOTCH_SD_MM);
    };
    let earlier = gaps.iter().find(|(height_mm, _)| *height_mm >= last_mm - CLOSING_MM);
    let closing = earlier
        .map_or(0.0, |(height_mm, gap)| (gap * gap - gap_mm * gap_mm) / (last_mm - height_mm));
    let above_mm = if closing > 0.0 { gap_mm * gap_mm / closing } else { CLOSED_MAX_MM };
    let is_sudden = first - gap_mm >= CLOSING_MIN * (last_mm - first_mm);
    let sd_mm = if is_sudden { APART_SD_MM } else { NOTCH_SD_MM };
    (last_mm + above_mm.min(CLOSED_MAX_MM), sd_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leg::parting::thigh_divider::Neck;
    use crate::leg::side::Sides;

    /// Steps 10 mm apart; the pattern has a 1 where the legs are joined.
    fn steps(pattern: &str) -> Vec<Step> {
        let neck = Neck::of(&[], [-80.0, 80.0]);
        let step = |(index, mark)| Step {
            height_mm: 10.0 * index as f64,
            prints: Sides::default(),
            neck: (mark == '1').then_some(neck),
            gap_mm: None,
        };
        pattern.chars().enumerate().map(step).collect()
    }

    #[test]
    fn legs_are_one_from_where_nearly_all_slices_above_show_one() {
        assert_eq!(join(&steps("0000011111111111")), Some(5));
        // A slice of the trunk that falls apart, even the last one, is not a crotch.
        assert_eq!(join(&steps("0000011111111011")), Some(5));
        assert_eq!(join(&steps("0000011111111110")), Some(5));
        // Knees that touch are not a crotch either.
        assert_eq!(join(&steps("0011100000001111111111")), Some(12));
    }

    #[test]
    fn legs_that_stay_apart_or_part_again_are_never_one() {
        assert_eq!(join(&steps("0000000000")), None);
        assert_eq!(join(&steps("0000111110000000")), None);
        assert_eq!(join(&[]), None);
    }
}
