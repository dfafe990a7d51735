//! The line that splits two thighs that touch: from the notch between them in front to the notch
//! behind.

use nalgebra::Point2;

use crate::statistics::range;

/// Step across the body in the search for the notches, mm.
const STEP_MM: f64 = 2.0;

/// The outline's reach at a position includes points up to this far from it, mm: the spacing of a
/// usual export.
const WINDOW_MM: f64 = 6.0;

/// A notch shallower than this share of the outline's depth is ignored; the line then stays halfway.
const NOTCH_MIN_SHARE: f64 = 0.03;

/// The steepness of a groove is taken between its bottom and the skin this far to both sides, mm: further than
/// exporters round the bottom of a groove (5 to 25 mm across), nearer than the folds of the groin.
const ASIDE_MM: f64 = 20.0;

/// The bottom of the groove in front is up to this far from halfway between the legs, mm; further aside the
/// folds of the groin look like one.
const BOTTOM_OFF_MM: f64 = 4.0;

/// The line that splits the outline of both thighs, as points (x, y) in the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    front: Point2<f64>,
    back: Point2<f64>,
    /// Depth of the notch in front as a share of the outline's depth.
    pub notch_share: f64,
    /// Distance from notch to notch, front to back, as a share of the outline's depth.
    pub thickness_share: f64,
    /// How steeply the skin in front runs inwards to the middle between the legs, mm per mm; negative where the
    /// middle bulges, infinite where no skin was seen there, `None` if there is too little skin.
    pub front_steepness: Option<f64>,
}

/// The reach of an outline to the front and to the back at one position across the body.
#[derive(Debug, Clone, Copy)]
struct Reach {
    x_mm: f64,
    front_mm: f64,
    back_mm: f64,
}

impl Neck {
    /// The neck between the middles (x, mm) of the right and the left leg in the outline of both.
    /// Front is −y.
    pub fn find(outline: &[Point2<f64>], between_mm: [f64; 2]) -> Neck {
        let [from_mm, to_mm] = between_mm;
        let halfway_mm = (from_mm + to_mm) / 2.0;
        let reaches = reaches(outline, from_mm, to_mm);
        let [front_mm, back_mm] = range(outline.iter().map(|point| point.y));
        let depth_mm = (back_mm - front_mm).max(f64::MIN_POSITIVE);
        let front = deepest(&reaches, |reach| reach.front_mm);
        let back = deepest(&reaches, |reach| -reach.back_mm);
        let is_notch = |notch: &Notch| notch.depth_mm >= NOTCH_MIN_SHARE * depth_mm;
        let at = |notch: &Option<Notch>, inward: f64, none_mm: f64| {
            let notch = notch.filter(is_notch);
            let y_mm = notch.map_or(none_mm, |notch| inward * notch.inward_mm);
            let x_mm = notch.map_or(halfway_mm, |notch| notch.x_mm);
            Point2::new(x_mm, y_mm.max(front_mm).min(back_mm))
        };
        let notch_share = front.map_or(0.0, |notch| (notch.depth_mm / depth_mm).clamp(0.0, 1.0));
        let (front, back) = (at(&front, 1.0, front_mm), at(&back, -1.0, back_mm));
        let thickness_share = ((back.y - front.y) / depth_mm).clamp(0.0, 1.0);
        let front_steepness = front_steepness(&reaches);
        Neck { front, back, notch_share, thickness_share, front_steepness }
    }

    /// Whether a point lies to the left of the line, where the left leg is.
    pub fn is_left(&self, place: &Point2<f64>) -> bool {
        let depth_mm = self.back.y - self.front.y;
        let share = ((place.y - self.front.y) / depth_mm.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        place.x > self.front.x + share * (self.back.x - self.front.x)
    }
}

/// The outline's reach at positions across the body. A position without points, because the skin in
/// the fold was not seen, counts as a notch of infinite depth.
fn reaches(outline: &[Point2<f64>], from_mm: f64, to_mm: f64) -> Vec<Reach> {
    let mut across = outline.to_vec();
    across.sort_by(|p, q| p.x.total_cmp(&q.x));
    // From the middle to both sides, so that a mirrored body is split along the mirrored line.
    let middle_mm = (from_mm + to_mm) / 2.0;
    let beside = ((to_mm - from_mm) / 2.0 / STEP_MM).max(0.0) as usize;
    let reach = |index: usize| {
        let x_mm = middle_mm + STEP_MM * (index as f64 - beside as f64);
        let first = across.partition_point(|point| point.x < x_mm - WINDOW_MM);
        let near = across[first..].iter().take_while(|point| point.x <= x_mm + WINDOW_MM);
        let none = Reach { x_mm, front_mm: f64::INFINITY, back_mm: f64::NEG_INFINITY };
        near.fold(none, |reach, point| Reach {
            x_mm,
            front_mm: reach.front_mm.min(point.y),
            back_mm: reach.back_mm.max(point.y),
        })
    };
    (0..=2 * beside).map(reach).collect()
}

/// How steeply the outline in front runs inwards to its middle, from the bottom that makes it steepest.
fn front_steepness(reaches: &[Reach]) -> Option<f64> {
    let [aside, off] = [ASIDE_MM, BOTTOM_OFF_MM].map(|mm| (mm / STEP_MM) as usize);
    let middle = reaches.len() / 2;
    let first = middle.checked_sub(off + aside)?;
    let front_mm: Vec<f64> = reaches[first..].iter().map(|reach| reach.front_mm).collect();
    // Counted from `first`, so that the skin aside of each bottom is one of them.
    let bottoms = [aside, aside + off, aside + 2 * off];
    if bottoms.iter().all(|bottom| front_mm[*bottom] == f64::INFINITY) {
        return Some(f64::INFINITY);
    }
    let steepness = |bottom: usize| {
        let aside_mm = (front_mm[bottom - aside] + front_mm[bottom + aside]) / 2.0;
        (front_mm[bottom] - aside_mm) / ASIDE_MM
    };
    bottoms.into_iter().map(steepness).filter(|value| value.is_finite()).reduce(f64::max)
}

/// The deepest point of a fold.
#[derive(Debug, Clone, Copy)]
struct Notch {
    /// Position across the body.
    x_mm: f64,
    /// How far inward the outline lies at this position.
    inward_mm: f64,
    /// Its depth relative to the lower of the two adjacent crests.
    depth_mm: f64,
}

/// The deepest notch of an outline; `inward_mm` gives how far inward it lies. If several positions
/// are equally deep, the middle between the first and the last.
fn deepest(reaches: &[Reach], inward_mm: impl Fn(&Reach) -> f64) -> Option<Notch> {
    let inward: Vec<f64> = reaches.iter().map(inward_mm).collect();
    let most = inward.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let first = inward.iter().position(|mm| *mm == most)?;
    let last = inward.iter().rposition(|mm| *mm == most)?;
    let crest = |side: &[f64]| side.iter().copied().fold(f64::INFINITY, f64::min);
    let lesser = crest(&inward[..first]).max(crest(&inward[last + 1..]));
    let x_mm = (reaches[first].x_mm + reaches[last].x_mm) / 2.0;
    let depth_mm = if most.is_finite() { most - lesser } else { f64::MAX };
    lesser.is_finite().then_some(Notch { x_mm, inward_mm: most, depth_mm })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Two circles as the outline of thighs; each only as far as it is outside the other.
    fn thighs(middles: [[f64; 2]; 2], radius: f64) -> Vec<Point2<f64>> {
        let [a, b] = middles.map(|[x, y]| Point2::new(x, y));
        let ring = |middle: Point2<f64>, other: Point2<f64>| {
            (0..180)
                .map(|i| f64::from(2 * i).to_radians())
                .map(move |t| Point2::new(middle.x + radius * t.cos(), middle.y + radius * t.sin()))
                .filter(move |p| (p - other).norm() >= radius)
        };
        ring(a, b).chain(ring(b, a)).collect()
    }

    #[test]
    fn thighs_that_touch_are_parted_where_they_touch() {
        let outline = thighs([[-70.0, 0.0], [90.0, 0.0]], 90.0);
        let neck = Neck::find(&outline, [-70.0, 90.0]);
        for y in [-90.0, -20.0, 0.0, 60.0] {
            assert!(neck.is_left(&Point2::new(14.0, y)), "{y}");
            assert!(!neck.is_left(&Point2::new(6.0, y)), "{y}");
        }
        // The circles meet 41 mm in front of and behind the line through their middles.
        let depth = (90.0 - (90.0_f64.powi(2) - 80.0_f64.powi(2)).sqrt()) / 180.0;
        // A window of 6 mm to each side fills the sharp bottom of the notch.
        assert!((neck.notch_share - depth).abs() < 0.06, "{} for {depth}", neck.notch_share);
    }

    #[test]
    fn the_groove_in_front_is_steep_between_thighs_even_if_its_bottom_is_round() {
        // The further thighs are pressed together, the shallower the groove.
        for apart_mm in [90.0, 85.0, 80.0, 70.0] {
            let sharp = thighs([[-apart_mm, 0.0], [apart_mm, 0.0]], 90.0);
            // The exporter closed the groove with a bridge of 10 mm.
            let edge_mm = sharp.iter().filter(|p| p.x.abs() < 6.0 && p.y < 0.0).map(|p| p.y);
            let edge_mm = edge_mm.fold(0.0, f64::min);
            let bridged = sharp.iter().filter(|p| p.x.abs() > 5.0).copied();
            let bridge = (-2..=2).map(|i| Point2::new(2.5 * f64::from(i), edge_mm));
            let bridged: Vec<_> = bridged.chain(bridge).collect();
            let middles = [-apart_mm, apart_mm];
            let [sharp, bridged] =
                [sharp, bridged].map(|o| Neck::find(&o, middles).front_steepness.unwrap());
            assert!(sharp > 0.45, "{apart_mm}: {sharp}");
            assert!(bridged > 0.3, "{apart_mm}: {bridged}");
        }
    }

    #[test]
    fn a_trunk_whose_middle_bulges_has_no_groove_between_the_folds_of_the_groin() {
        let front = |x: f64| -110.0 + 12.0 * (-(x.abs() - 35.0).powi(2) / 100.0).exp();
        let trunk: Vec<_> = (-150..=150)
            .map(f64::from)
            .flat_map(|x| [Point2::new(x, front(x)), Point2::new(x, 110.0)])
            .collect();
        for off_mm in [-8.0, 0.0, 8.0] {
            let steepness = Neck::find(&trunk, [off_mm - 80.0, off_mm + 80.0]).front_steepness;
            assert!(steepness.unwrap() < 0.1, "{off_mm}: {steepness:?}");
        }
    }

    #[test]
    fn a_leg_set_forward_makes_a_slanting_line() {
        let outline = thighs([[-80.0, -30.0], [80.0, 30.0]], 90.0);
        let neck = Neck::find(&outline, [-80.0, 80.0]);
        // The notches are accurate to some millimetres.
        let parts = outline.iter().filter(|p| p.x.abs() > 18.0 || p.y.abs() > 40.0);
        for place in parts {
            let left = (place - Point2::new(80.0, 30.0)).norm() < 90.5;
            let right = (place - Point2::new(-80.0, -30.0)).norm() < 90.5;
            assert!(left == right || neck.is_left(place) == left, "{place}");
        }
    }

    #[test]
    fn a_trunk_has_no_notch_and_is_parted_halfway() {
        let trunk: Vec<_> = (0..360)
            .map(|i| f64::from(i).to_radians())
            .map(|t| Point2::new(170.0 * t.cos(), 110.0 * t.sin()))
            .collect();
        let neck = Neck::find(&trunk, [-85.0, 85.0]);
        assert!(neck.notch_share < NOTCH_MIN_SHARE, "{}", neck.notch_share);
        assert!(neck.is_left(&Point2::new(0.1, 0.0)) && !neck.is_left(&Point2::new(-0.1, 0.0)));
    }

    #[test]
    fn skin_that_nobody_saw_between_the_thighs_is_the_deepest_notch() {
        let outline: Vec<_> = thighs([[-80.0, 0.0], [80.0, 0.0]], 90.0)
            .into_iter()
            .filter(|p| p.x.abs() > 15.0)
            .collect();
        let neck = Neck::find(&outline, [-80.0, 80.0]);
        assert_eq!(neck.notch_share, 1.0);
        assert_eq!(neck.front_steepness, Some(f64::INFINITY));
        assert!(neck.is_left(&Point2::new(2.0, 0.0)) && !neck.is_left(&Point2::new(-2.0, 0.0)));
    }
}
