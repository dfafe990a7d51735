//! Legs that no constant was set on: drawn anew, with girths that a closed form gives.

#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use gaiter_leg::Level;
use gaiter_leg::levels::search;
use gaiter_leg::method::{B1, SectionFit};
use nalgebra::Vector3;
use proptest::prelude::*;
use support::solids::{CROTCH_MM, STATURE_MM, Tube, curve_of, tape_mm};

/// Tape girth on a scan without noise, mm, as for the recorded bodies …
const GIRTH_MM: f64 = 0.3;

/// … and what noise adds to it, as a share of the noise.
const NOISE_SHARE: f64 = 0.8;

/// Height, mm, or as far as the girth stays within [`FLAT_MM`] of the extremum.
const HEIGHT_MM: f64 = 5.0;
const FLAT_MM: f64 = 0.5;

/// A leg: its mean radius at the floor, B, C, D and above the crotch, and how far it is from round.
#[derive(Debug, Clone)]
struct Shape {
    /// Along the axis and mean radius, mm, lowest first.
    knots: [[f64; 2]; 5],
    /// Amplitudes of two and three waves around, as shares of the mean radius.
    waves: [f64; 2],
    /// By how much the waves turn along the leg, rad/mm.
    twist: f64,
    /// How the axis leans, per mm of height.
    lean: [f64; 2],
    noise_mm: f64,
    seed: u64,
}

impl Shape {
    /// The radius in a direction, rad, at a distance along the axis, mm: half waves of a cosine from
    /// knot to knot.
    fn radius_mm(&self, angle: f64, along: f64) -> f64 {
        let next = self.knots.iter().position(|knot| along < knot[0]).unwrap_or(4).max(1);
        let [[from, low], [to, high]] = [self.knots[next - 1], self.knots[next]];
        let share = ((along - from) / (to - from)).clamp(0.0, 1.0);
        let mean = low + (high - low) * (1.0 - (PI * share).cos()) / 2.0;
        let [two, three] = self.waves;
        let turned = angle + self.twist * along;
        mean * (1.0 + two * (2.0 * turned).cos() + three * (3.0 * turned).cos())
    }

    fn girth_mm(&self, along: f64) -> f64 {
        tape_mm(|angle| self.radius_mm(angle, along))
    }

    /// How far along the girth stays within [`FLAT_MM`] of that at a knot, mm.
    fn flat_mm(&self, along: f64) -> f64 {
        let girth = self.girth_mm(along);
        let leaves = |way: f64| {
            let steps = (1..100).map(f64::from);
            let mut steps = steps
                .skip_while(|step| (self.girth_mm(along + way * step) - girth).abs() <= FLAT_MM);
            steps.next().unwrap_or(100.0)
        };
        leaves(1.0).max(leaves(-1.0))
    }
}

fn shapes() -> impl Strategy<Value = Shape> {
    let heights = (90.0..150.0, 170.0..240.0, 90.0..150.0);
    let radii = (40.0..55.0, 30.0..40.0, 12.0..24.0, 5.0..12.0, 70.0..95.0);
    let form = (0.0..0.06, 0.0..0.03, -0.002..0.002);
    let scan = (prop::array::uniform2(-0.05..0.05), 0.0..0.8, any::<u64>());
    (heights, radii, form, scan).prop_map(|(heights, radii, form, scan)| {
        let (b, c, d) = (heights.0, heights.0 + heights.1, heights.0 + heights.1 + heights.2);
        let (low, ankle, calf) = (radii.0, radii.1, radii.1 + radii.2);
        let knots = [[0.0, low], [b, ankle], [c, calf], [d, calf - radii.3], [900.0, radii.4]];
        let (waves, twist, (lean, noise_mm, seed)) = ([form.0, form.1], form.2, scan);
        Shape { knots, waves, twist, lean, noise_mm, seed }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn b_c_and_d_of_a_leg_never_seen_before_are_where_they_are(shape in shapes()) {
        let radius = |angle: f64, along: f64| shape.radius_mm(angle, along);
        let direction = Vector3::new(shape.lean[0], shape.lean[1], 1.0);
        let tube = Tube {
            direction,
            noise_mm: shape.noise_mm,
            is_scattered: true,
            seed: shape.seed | 1,
            ..Tube::upright(&radius)
        };
        let sections = tube.sections(SectionFit::default());
        let curve = curve_of(&sections);
        let found = search::levels(&curve, STATURE_MM, CROTCH_MM, B1::Steepest, &sections).found;
        for (level, knot) in [(Level::B, 1), (Level::C, 2), (Level::D, 3)] {
            let along = shape.knots[knot][0];
            let at = found.iter().find(|landmark| landmark.level == level);
            prop_assert!(at.is_some(), "{level:?} at {along:.0} mm was not found");
            let at = at.unwrap();
            let girth_off = at.girth_tape_mm - shape.girth_mm(along);
            let girth_most = GIRTH_MM + NOISE_SHARE * shape.noise_mm;
            prop_assert!(girth_off.abs() <= girth_most, "{level:?}: girth off by {girth_off:.2} mm");
            let height_off = at.height_mm - along * direction.normalize().z;
            let height_most = HEIGHT_MM.max(shape.flat_mm(along));
            prop_assert!(height_off.abs() <= height_most, "{level:?}: {height_off:.1} mm high");
        }
    }
}
