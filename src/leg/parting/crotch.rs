//! The crotch: where two legs become one body (paper 1, fig. 2a).

use super::leg_tracking::{Parting, Step, follow};
use crate::leg::sections::slice::Mesh;

/// Distance of the slices in which the crotch is then found, mm.
const FINE_STEP_MM: f64 = 1.0;

/// Of the slices above a crotch at least this share shows one outline of both legs.
const ONE_SHARE: f64 = 0.8;

/// … and so of the first of them.
const JOIN_STEPS: usize = 5;

/// Fine slices begin this far below the last height at which the thighs are apart, mm.
const FINE_BELOW_MM: f64 = 10.0;

/// The thighs close in on each other over this height, mm, at a rate that leads on to where they
/// meet.
const CLOSING_MM: f64 = 5.0;

/// The crotch is at most this much above the last height at which the thighs were seen apart, mm;
/// further up they would be seen apart still.
const CLOSED_MAX_MM: f64 = 8.0;

/// Thighs close in on each other by more than this, mm in a mm of height, where they meet. Slower
/// ones run along each other, or the skin in the fold was not seen.
const CLOSING_MIN: f64 = 0.6;

/// Standard error of a crotch where the thighs are seen apart up to it, mm.
const APART_SD_MM: f64 = 3.0;

/// The notch between the thighs in front runs out above the crotch, in the pubic region. It is at
/// an end where it is shallower than this share of the body's depth.
const NOTCH_END_SHARE: f64 = 0.10;

/// … and that is this share of stature above the crotch: 12 to 35 mm in bodies of known crotch.
const NOTCH_ABOVE_CROTCH_SHARE: f64 = 0.0145;

/// Standard error of a crotch that is told from the notch, or from thighs that run along each other,
/// mm.
const NOTCH_SD_MM: f64 = 15.0;

/// Thighs that become one this far below the crotch as told from the notch touch, mm: two standard
/// errors.
const TOUCHING_MIN_MM: f64 = 2.0 * NOTCH_SD_MM;

/// Standard error of a crotch where only one leg is followed up to the trunk, mm: the slices'
/// distance and the slope of a hip.
const ONE_LEG_SD_MM: f64 = 20.0;

/// The crotch where nobody can see it, as a share of stature (ANSUR II).
const MEAN_SHARE: f64 = 0.48;

/// Standard deviation of that share among people (ANSUR II), rounded up.
const SD_SHARE: f64 = 0.015;

/// The height of the crotch and how it was told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crotch {
    /// Above the floor, mm.
    pub height_mm: f64,
    /// Standard error, mm.
    pub sd_mm: f64,
    /// What it was told from.
    pub from: CrotchFrom,
}

/// What the crotch was told from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrotchFrom {
    /// The thighs, seen apart up to it.
    Thighs,
    /// The end of the notch in front, because the thighs touch.
    Notch {
        /// Height from which on they touch, mm.
        touching_from_mm: f64,
    },
    /// Where one leg reaches the trunk, because the other is not there.
    OneLeg,
    /// Nothing: it stands where a body of this size has it.
    Proportion {
        /// Height from which on the legs are one and no fold shows between them; none where the
        /// scan does not reach a crotch.
        touching_from_mm: Option<f64>,
    },
}

impl Crotch {
    /// The crotch where one leg, followed alone, reaches the trunk.
    pub fn of_one_leg(end_mm: f64) -> Crotch {
        Crotch { height_mm: end_mm, sd_mm: ONE_LEG_SD_MM, from: CrotchFrom::OneLeg }
    }

    /// The crotch that is not in the scan.
    pub fn unseen(stature_mm: f64) -> Crotch {
        let from = CrotchFrom::Proportion { touching_from_mm: None };
        Crotch { height_mm: MEAN_SHARE * stature_mm, sd_mm: SD_SHARE * stature_mm, from }
    }

    /// The crotch that is hidden between legs that are one from some height on.
    pub fn hidden(touching_from_mm: f64, stature_mm: f64) -> Crotch {
        let from = CrotchFrom::Proportion { touching_from_mm: Some(touching_from_mm) };
        Crotch { from, ..Crotch::unseen(stature_mm) }
    }

    /// Height from which on the legs touch, mm, where they do below it.
    pub fn touching_from_mm(&self) -> Option<f64> {
        match self.from {
            CrotchFrom::Notch { touching_from_mm } => Some(touching_from_mm),
            CrotchFrom::Proportion { touching_from_mm } => touching_from_mm,
            CrotchFrom::Thighs | CrotchFrom::OneLeg => None,
        }
    }

    /// Height from which on no fold shows between the legs and neither is seen for itself, mm.
    pub fn hidden_from_mm(&self) -> Option<f64> {
        if self.is_seen() { None } else { self.touching_from_mm() }
    }

    /// Whether it was seen at all.
    pub fn is_seen(&self) -> bool {
        !matches!(self.from, CrotchFrom::Proportion { .. })
    }
}

/// From which step on legs that were followed upwards are one for good; none where they never are.
///
/// Single slices of a trunk may fall apart where its points are few.
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

/// The crotch of legs that were followed upwards and are one from the step `join` on. `mesh` is
/// asked again in finer steps.
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

/// Where thighs that are apart at `last` and one at `join_mm` meet: as their distance, which is
/// seen until the points of one are as near to the other's as to each other, leads on to zero.
/// With its standard error.
///
/// Below the top of an arch its width grows with the root of the depth, so it is the square of the
/// distance that falls evenly.
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

    /// Steps 10 mm apart in which the legs are one as the pattern says.
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
        // A slice of the trunk that falls apart, even the last, is no crotch.
        assert_eq!(join(&steps("0000011111111011")), Some(5));
        assert_eq!(join(&steps("0000011111111110")), Some(5));
        // Knees that touch are none either.
        assert_eq!(join(&steps("0011100000001111111111")), Some(12));
    }

    #[test]
    fn legs_that_stay_apart_or_part_again_are_never_one() {
        assert_eq!(join(&steps("0000000000")), None);
        assert_eq!(join(&steps("0000111110000000")), None);
        assert_eq!(join(&[]), None);
    }
}
