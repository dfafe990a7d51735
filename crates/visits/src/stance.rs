//! How a leg stood at a visit, and what a different stance does to girths and volumes.

use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_record::schema::{BodyFigures, LegFigures};

use super::place::{Step, along_mm};

/// Height of the knee as a share of the stature (Drillis and Contini; Winter, Biomechanics, fig. 4.1).
pub(super) const KNEE_SHARE: f64 = 0.285;

/// Half the length along the leg in which a bent knee folds or stretches the skin, mm; see docs/visits.md.
const KNEE_ZONE_MM: f64 = 80.0;

/// Beyond this difference of the knee's bend the girths around the knee are not compared, degrees: behind the
/// knee a girth changes by 2 mm per degree.
const KNEE_BEND_DEG: f64 = 2.0;

/// Beyond this difference of the knee's bend no girth of the leg is compared, degrees.
const BEND_DEG: f64 = 8.0;

/// As much for the tilt of the shank, degrees.
const TILT_DEG: f64 = 6.0;

/// What a degree of bend does to the volume of the leg, as a standard uncertainty, share of it: bodies whose
/// knees are bent change by up to 0.13 % a degree (docs/visits.md), here taken as evenly distributed up to that.
const VOLUME_PER_DEG: f64 = 0.0008;

/// What a degree of bend does to a girth away from the knee, in the same way, mm: up to 0.5 mm.
const GIRTH_MM_PER_DEG: f64 = 0.3;

/// How a leg stood.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stance {
    /// Direction of the shank, upwards, in the body's frame; a unit vector.
    shank: [f64; 3],
    /// Angle between shank and thigh, degrees: to the front and to the lateral side; `None` if the thigh was
    /// not seen.
    bend_deg: Option<[f64; 2]>,
    /// Length from the floor to the knee, mm; `None` if the stature is not known.
    knee_mm: Option<f64>,
}

/// How differently a leg stood at two visits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StanceChange {
    /// Angle between the two directions of the shank, degrees.
    pub tilt_deg: f64,
    /// Difference of the angles at the knee, degrees; 0 if one of them is not known.
    pub bend_deg: f64,
    /// Length from the floor to the knee, mm.
    knee_mm: Option<f64>,
}

impl Stance {
    /// The stance of a record's leg; `None` if its sections are not square to shank and thigh.
    pub fn new(body: &BodyFigures, leg: &LegFigures) -> Option<Stance> {
        let (axis, axes) = (&leg.axis, leg.axes.as_ref()?);
        let shank = axes.shank.direction;
        let bend_deg = axes.thigh.as_ref().map(|thigh| {
            let to = |towards: [f64; 3]| dot(thigh.direction, towards);
            let angle = |aside: [f64; 3]| to(aside).atan2(to(shank)).to_degrees();
            [angle(axis.front), angle(axis.lateral)]
        });
        let knee_mm = body.stature_mm.map(|mm| KNEE_SHARE * mm);
        Some(Stance { shank, bend_deg, knee_mm })
    }

    /// How a later stance differs from this one.
    pub fn to(&self, later: &Stance) -> StanceChange {
        let tilt_deg = dot(self.shank, later.shank).clamp(-1.0, 1.0).acos().to_degrees();
        let bend_deg = match (self.bend_deg, later.bend_deg) {
            (Some([front, aside]), Some([later_front, later_aside])) => {
                (later_front - front).hypot(later_aside - aside)
            }
            _ => 0.0,
        };
        StanceChange { tilt_deg, bend_deg, knee_mm: self.knee_mm.or(later.knee_mm) }
    }
}

impl StanceChange {
    /// Whether it is reported: at some places at least, girths are not compared because of it.
    pub(crate) fn matters(&self) -> bool {
        self.bend_deg > KNEE_BEND_DEG || self.tilt_deg > TILT_DEG
    }

    /// Whether girths from one place to another, in steps, can be compared.
    pub fn allows(&self, from: Step, to: Step) -> bool {
        let is_at_knee = self.knee_mm.is_none_or(|knee_mm| {
            along_mm(to) > knee_mm - KNEE_ZONE_MM && along_mm(from) < knee_mm + KNEE_ZONE_MM
        });
        let limit_deg = if is_at_knee { KNEE_BEND_DEG } else { BEND_DEG };
        self.bend_deg <= limit_deg && self.tilt_deg <= TILT_DEG
    }

    /// Its part of the standard uncertainty of the change of a volume.
    pub(crate) fn of_volume(&self, ml: f64) -> f64 {
        VOLUME_PER_DEG * self.bend_deg * ml
    }

    /// Its part of the standard uncertainty of the change of a girth, mm.
    pub(crate) fn of_girth_mm(&self) -> f64 {
        GIRTH_MM_PER_DEG * self.bend_deg
    }

    /// Its part of the standard uncertainty of the change of a piece's volume: that of its girth, around a
    /// length of one step.
    pub(crate) fn of_piece(&self, ml: f64) -> f64 {
        // A cylinder of this volume V and height h has the girth √(4 π V / h), and dV = 2 V dC / C.
        let cubic_mm = 1000.0 * ml;
        let girth_mm = (4.0 * std::f64::consts::PI * cubic_mm / PROFILE_STEP_MM).sqrt();
        2.0 * ml * self.of_girth_mm() / girth_mm
    }
}

fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one.into_iter().zip(other).map(|(one, other)| one * other).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bent(front_deg: f64) -> Stance {
        Stance { shank: [0.0, 0.0, 1.0], bend_deg: Some([front_deg, 0.0]), knee_mm: Some(480.0) }
    }

    #[test]
    fn a_knee_bent_backwards_is_not_one_bent_forwards_by_as_much() {
        let change = bent(-3.0).to(&bent(3.0));
        assert_eq!((change.bend_deg, change.tilt_deg), (6.0, 0.0));
        assert_eq!(bent(3.0).to(&bent(3.0)).bend_deg, 0.0);
    }

    #[test]
    fn a_bent_knee_moves_the_skin_around_it_before_it_moves_that_of_the_whole_leg() {
        let little = bent(0.0).to(&bent(3.0));
        assert!(little.matters() && little.allows(8, 9) && little.allows(15, 15));
        assert!(!little.allows(12, 12) && !little.allows(9, 11) && !little.allows(13, 14));
        let much = bent(0.0).to(&bent(9.0));
        assert!(!much.allows(8, 9) && !much.allows(15, 15));
        assert!(bent(0.0).to(&bent(1.0)).allows(12, 12));
    }

    #[test]
    fn the_tilt_is_the_angle_between_the_shanks_also_if_both_are_equally_far_from_upright() {
        let leaning = |deg: f64| {
            let (sin, cos) = deg.to_radians().sin_cos();
            Stance { shank: [sin, 0.0, cos], ..bent(0.0) }
        };
        let change = leaning(-4.0).to(&leaning(4.0));
        assert!((change.tilt_deg - 8.0).abs() < 1e-9 && change.matters() && !change.allows(8, 8));
        assert!(leaning(1.0).to(&leaning(4.0)).allows(8, 8));
    }

    #[test]
    fn without_a_stature_every_place_may_be_the_knee() {
        let unknown = |deg: f64| Stance { knee_mm: None, ..bent(deg) };
        assert!(!unknown(0.0).to(&unknown(3.0)).allows(4, 4));
    }

    /// A cylinder of 400 mm girth: 40 mm of it are 509.3 mL, and one millimetre of girth is 0.5 % of that.
    #[test]
    fn a_piece_changes_as_its_girth_squared() {
        let change = bent(0.0).to(&bent(1.0));
        let ml = 400.0_f64.powi(2) * 40.0 / (4.0 * std::f64::consts::PI) / 1000.0;
        assert!((change.of_piece(ml) - 0.005 * 0.3 * ml).abs() < 1e-9);
    }
}
