//! The line that splits two thighs that touch: from the notch between them in front to the notch
//! behind.

use nalgebra::Point2;

/// Step across the body in the search for the notches, mm.
const STEP_MM: f64 = 2.0;

/// The outline's reach at a position includes points up to this far from it, mm: the spacing of a
/// usual export.
const WINDOW_MM: f64 = 6.0;

/// A notch shallower than this share of the outline's depth is ignored; the line then stays halfway.
const NOTCH_MIN_SHARE: f64 = 0.03;

/// The line that splits the outline of both thighs, as points (x, y) in the body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    front: Point2<f64>,
    back: Point2<f64>,
    /// Depth of the notch in front as a share of the outline's depth.
    pub notch_share: f64,
    /// Distance from notch to notch, front to back, as a share of the outline's depth.
    pub thickness_share: f64,
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
    pub fn of(outline: &[Point2<f64>], between_mm: [f64; 2]) -> Neck {
        let [from_mm, to_mm] = between_mm;
        let halfway_mm = (from_mm + to_mm) / 2.0;
        let reaches = reaches(outline, from_mm, to_mm);
        let (front_mm, back_mm) =
            outline.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(front, back), point| {
                (front.min(point.y), back.max(point.y))
            });
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
        Neck { front, back, notch_share, thickness_share }
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
        let neck = Neck::of(&outline, [-70.0, 90.0]);
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
    fn a_leg_set_forward_makes_a_slanting_line() {
        let outline = thighs([[-80.0, -30.0], [80.0, 30.0]], 90.0);
        let neck = Neck::of(&outline, [-80.0, 80.0]);
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
        let neck = Neck::of(&trunk, [-85.0, 85.0]);
        assert!(neck.notch_share < NOTCH_MIN_SHARE, "{}", neck.notch_share);
        assert!(neck.is_left(&Point2::new(0.1, 0.0)) && !neck.is_left(&Point2::new(-0.1, 0.0)));
    }

    #[test]
    fn skin_that_nobody_saw_between_the_thighs_is_the_deepest_notch() {
        let outline: Vec<_> = thighs([[-80.0, 0.0], [80.0, 0.0]], 90.0)
            .into_iter()
            .filter(|p| p.x.abs() > 15.0)
            .collect();
        let neck = Neck::of(&outline, [-80.0, 80.0]);
        assert_eq!(neck.notch_share, 1.0);
        assert!(neck.is_left(&Point2::new(2.0, 0.0)) && !neck.is_left(&Point2::new(-2.0, 0.0)));
    }
}
