//! The search for the crotch: the saddle of the skin, or what stands in for it.

use super::crotch::{APART_SD_MM, Crotch, CrotchFrom, HIDDEN_SD_MM, NOTCH_ABOVE_CROTCH_SHARE};
use super::crotch_by_slices;
use super::fold_end::{FoldEnd, fold_end};
use super::leg_tracking::Step;
use super::saddle::Saddle;
use crate::sections::slice::Mesh;

/// At least this share of the slices above a crotch shows one outline for both legs.
const ONE_SHARE: f64 = 0.8;

/// … and the same share of the first few of them.
const JOIN_STEPS: usize = 5;

/// A crotch below which the thighs touch joins the slices this far lower, mm, or further; where the
/// fold narrows, slices join a little early on every body.
const TOUCHING_MIN_MM: f64 = 30.0;

/// The body is examined between these heights above a saddle, mm: in one slice or two.
const NECK_ABOVE_MM: [f64; 2] = [12.0, 25.0];

/// The perineum is at least this share of the body's depth thick from front to back there (0.45 to 0.93 in
/// bodies with a known crotch); skins of thighs that grew together are thinner (0.21 to 0.26).
const NECK_MIN_SHARE: f64 = 0.40;

/// Thighs are grown together if the fold between them continues this far above a crotch found otherwise, mm, or
/// two of its standard errors: on bodies with separate thighs it does for up to 17 mm.
const GROWN_MIN_MM: f64 = 20.0;

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

/// The crotch of legs that were followed upwards and are joined from the step `join` on: the saddle
/// of their skin, unless it is missing, or the thighs grew together above it.
pub fn crotch(
    mesh: &Mesh,
    steps: &[Step],
    join: usize,
    saddle: Option<Saddle>,
    stature_mm: f64,
) -> Crotch {
    let found = by_skin(mesh, steps, join, saddle, stature_mm);
    let Some(end) = fold_end(&steps[join..], stature_mm) else { return found };
    if found.from == CrotchFrom::Notch {
        return Crotch { height_mm: end.crotch_mm, sd_mm: end.sd_mm, ..found };
    }
    let is_web =
        found.from == CrotchFrom::Saddle && saddle.is_some_and(|saddle| is_web(steps, &saddle));
    let grown_mm = found.height_mm + GROWN_MIN_MM.max(2.0 * found.sd_mm);
    if is_web || end.by_slices_mm.is_some_and(|height_mm| height_mm > grown_mm) {
        grown_together(&end, steps[join].height_mm)
    } else {
        found
    }
}

/// The crotch at the end of the fold between thighs that are joined from a height on.
fn grown_together(end: &FoldEnd, join_mm: f64) -> Crotch {
    let touching_from_mm = Some(join_mm).filter(|mm| *mm < end.crotch_mm - TOUCHING_MIN_MM);
    let crotch = Crotch::at(end.crotch_mm, end.sd_mm, CrotchFrom::GrownTogether);
    Crotch { touching_from_mm, ..crotch }
}

/// The crotch where the skins of the legs are connected.
fn by_skin(
    mesh: &Mesh,
    steps: &[Step],
    join: usize,
    saddle: Option<Saddle>,
    stature_mm: f64,
) -> Crotch {
    let by_slices = || crotch_by_slices::crotch(mesh, steps, join, stature_mm);
    let seen = |saddle: Saddle| Crotch::at(saddle.height_mm, APART_SD_MM, CrotchFrom::Saddle);
    let Some(saddle) = saddle else { return by_slices() };
    if mesh.triangles().is_empty() {
        let by_slices = by_slices();
        // In a cloud thighs that touch are connected like one skin.
        let is_sure = by_slices.sd_mm <= APART_SD_MM
            && !is_web(steps, &saddle)
            && saddle.border_bottom_mm.is_none();
        return if is_sure { seen(saddle) } else { by_slices };
    }
    let found = match saddle.border_bottom_mm {
        Some(bottom_mm) => beside_border(saddle.height_mm, bottom_mm, stature_mm),
        None => seen(saddle),
    };
    let join_mm = steps.get(join).map(|step| step.height_mm);
    let touching_from_mm = join_mm.filter(|mm| *mm < found.height_mm - TOUCHING_MIN_MM);
    Crotch { touching_from_mm, ..found }
}

/// The crotch at a saddle that lies on a border of the skin. The way from leg to leg goes around what
/// was not seen, and no further up than to the end of the notch in front; so the crotch lies between
/// the lower end of that border, or of that notch, and the saddle.
fn beside_border(saddle_mm: f64, bottom_mm: f64, stature_mm: f64) -> Crotch {
    let notch_mm = NOTCH_ABOVE_CROTCH_SHARE * stature_mm;
    let below_mm = ((saddle_mm - bottom_mm) / 2.0).min(notch_mm);
    let sd_mm = APART_SD_MM.hypot(HIDDEN_SD_MM * below_mm / notch_mm);
    Crotch::at(saddle_mm - below_mm, sd_mm, CrotchFrom::Border)
}

/// Whether a saddle in the skin lies on a web between the thighs: the body above it is thin from front to back, or
/// the legs are separate there.
fn is_web(steps: &[Step], saddle: &Saddle) -> bool {
    let [low_mm, high_mm] = NECK_ABOVE_MM.map(|mm| saddle.height_mm + mm);
    let above = steps.iter().filter(|step| (low_mm..=high_mm).contains(&step.height_mm));
    let necks = above.filter_map(|step| step.neck);
    let thinnest = necks.map(|neck| neck.thickness_share).reduce(f64::min).unwrap_or(0.0);
    saddle.border_bottom_mm.is_none() && thinnest < NECK_MIN_SHARE
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use nalgebra::{Point2, Point3};

    use super::*;
    use crate::parting::thigh_divider::Neck;
    use crate::side::Sides;

    /// Steps 10 mm apart; the pattern has a 1 where the legs are joined.
    fn steps(pattern: &str) -> Vec<Step> {
        let neck = Neck::find(&[], [-80.0, 80.0]);
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

    /// The crotch of a body of 1.7 m whose skin has a saddle at 700 mm, with a fold of this steepness in front up to a
    /// height.
    fn crotch_of(steepness: f64, fold_to_mm: f64) -> Crotch {
        // Without notches, so that nothing looks thin.
        let across = (-40..=40).map(|x| 2.0 * f64::from(x));
        let outline: Vec<_> =
            across.flat_map(|x| [-100.0, 100.0].map(|y| Point2::new(x, y))).collect();
        let step = |index: u32| {
            let height_mm = 605.0 + 10.0 * f64::from(index);
            let mut neck = Neck::find(&outline, [-80.0, 80.0]);
            neck.front_steepness = Some(if height_mm < fold_to_mm { steepness } else { -0.1 });
            let neck = (height_mm > 690.0).then_some(neck);
            Step { height_mm, prints: Sides::default(), neck, gap_mm: None }
        };
        let steps: Vec<Step> = (0..35).map(step).collect();
        let corners = [[0.0, 0.0], [5.0, 0.0], [0.0, 5.0]].map(|[x, y]| Point3::new(x, y, 700.0));
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]);
        let saddle = Saddle { height_mm: 700.0, border_bottom_mm: None };
        let join = join(&steps).unwrap();
        crotch(&mesh, &steps, join, Some(saddle), 1700.0)
    }

    #[test]
    fn a_saddle_far_below_the_end_of_the_fold_is_where_the_thighs_grew_together() {
        let found = crotch_of(1.0, 808.5);
        assert_eq!(found.from, CrotchFrom::GrownTogether, "{found:?}");
        assert!((found.height_mm - 800.0).abs() < 10.0 && found.sd_mm > 15.0, "{found:?}");
        assert_eq!(found.touching_from_mm, Some(695.0));
    }

    #[test]
    fn a_saddle_just_below_the_end_of_the_fold_is_the_crotch() {
        for (steepness, fold_to_mm) in [(1.0, 700.0), (1.0, 720.0), (0.2, 808.5)] {
            let found = crotch_of(steepness, fold_to_mm);
            let seen = Crotch::at(700.0, APART_SD_MM, CrotchFrom::Saddle);
            assert_eq!(found, seen, "{steepness} {fold_to_mm}");
        }
    }

    #[test]
    fn legs_that_stay_apart_or_part_again_are_never_one() {
        assert_eq!(join(&steps("0000000000")), None);
        assert_eq!(join(&steps("0000111110000000")), None);
        assert_eq!(join(&[]), None);
    }
}
