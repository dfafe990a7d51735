//! Bodies that do not stand straight: heels up, a foot ahead of the other, knees bent. They are measured, it is said,
//! and what is said to hold does.

use support::stance::{LegPose, posed};

use super::soles::{drawn, is_floor_doubted, off_in_height};
use super::*;

/// How many of each are drawn.
const DRAWS: u64 = 8;

/// From the ankle to the tips of the toes, mm.
const TOES_MM: f64 = 170.0;

/// The joints of both legs alike, or of one that is drawn.
fn on_legs(by: LegPose, is_both: bool, chance: &mut Chance) -> [LegPose; 2] {
    let mut legs = [by; 2];
    if !is_both {
        legs[chance.below(2)] = LegPose::default();
    }
    legs
}

#[test]
fn heels_that_are_up_are_told_and_girths_hold() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = drawn(&mut chance);
        let (up_mm, is_both) = (12.0 + 28.0 * chance.unit(), chance.below(2) == 0);
        let by = LegPose { heel_deg: (up_mm / TOES_MM).asin().to_degrees(), ..LegPose::default() };
        let legs = on_legs(by, is_both, &mut chance);
        let found = measured(&posed(mesh, truth.crotch.height_mm, legs));
        let told = format!("{seed}: {up_mm} mm, both {is_both}");
        assert!(is_floor_doubted(&found), "{told}");
        assert_eq!(quietly_wrong(&found, truth), [], "{told}");
        assert_eq!(off_in_height(&found, truth, 5.0), [], "{told}");
    }
}

#[test]
fn a_foot_ahead_of_the_other_is_told_and_girths_hold() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = drawn(&mut chance);
        let (by_mm, sign) = (150.0 + 150.0 * chance.unit(), chance.even(1.0).signum());
        let crotch_mm = truth.crotch.height_mm;
        let hip_deg = sign * (by_mm / 2.0 / crotch_mm).asin().to_degrees();
        let legs = [hip_deg, -hip_deg].map(|hip_deg| LegPose { hip_deg, ..LegPose::default() });
        let found = measured(&posed(mesh, crotch_mm, legs));
        let told = format!("{seed}: {sign} {by_mm} mm");
        assert!(is_told(&found, "foot-forward"), "{told}");
        assert!(!is_told(&found, "knee-bent"), "{told}");
        assert_eq!(quietly_wrong(&found, truth), [], "{told}");
        assert_eq!(off_in_height(&found, truth, 15.0), [], "{told}");
    }
}

/// By how much the foot of a leg that is bent must be turned about its ankle for its toes to stand on the floor.
fn on_its_toes(mesh: &Mesh, crotch_mm: f64, bent: LegPose, leg: usize) -> LegPose {
    let lowest_mm = |mesh: &Mesh| {
        let is_own = |point: &&[f64; 3]| (point[0] >= 0.0) == (leg == 1);
        let own = mesh.points.iter().filter(is_own);
        own.map(|point| point[1]).fold(f64::INFINITY, f64::min)
    };
    let floor_mm = lowest_mm(mesh);
    let raised = |heel_deg: f64| LegPose { heel_deg, ..bent };
    let mut between = [0.0, 45.0];
    for _ in 0..7 {
        let heel_deg = (between[0] + between[1]) / 2.0;
        let mut legs = [LegPose::default(); 2];
        legs[leg] = raised(heel_deg);
        let is_above = lowest_mm(&posed(mesh.clone(), crotch_mm, legs)) > floor_mm;
        between[usize::from(!is_above)] = heel_deg;
    }
    raised((between[0] + between[1]) / 2.0)
}

#[test]
fn a_bent_knee_is_told_and_girths_up_to_the_calf_hold() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = drawn(&mut chance);
        let crotch_mm = truth.crotch.height_mm;
        let (is_both, leg) = (chance.below(2) == 0, chance.below(2));
        // Further, the toes of one alone do not reach the floor as a foot.
        let reach_deg = if is_both { 30.0 } else { 10.0 };
        let knee_deg = 20.0 + reach_deg * chance.unit();
        let legs = if is_both {
            [LegPose::bent(knee_deg); 2]
        } else {
            let mut legs = [LegPose::default(); 2];
            legs[leg] = on_its_toes(&mesh, crotch_mm, LegPose::bent(knee_deg), leg);
            legs
        };
        let found = measured(&posed(mesh, crotch_mm, legs));
        let told = format!("{seed}: {knee_deg}, both {is_both}, {leg}");
        assert_eq!(found.legs.len(), 2, "{told}");
        for own in &found.legs {
            let is_bent = is_both || (own.side == Side::Left) == (leg == 1);
            let said = found.findings.iter().filter(|finding| finding.side == Some(own.side));
            let mut said = said.filter(|finding| finding.level.is_none());
            assert_eq!(said.any(|finding| finding.code() == "knee-bent"), is_bent, "{told}");
            let d = own.landmarks.iter().find(|landmark| landmark.level == Level::D);
            let doubts = d.into_iter().flat_map(|d| &d.doubts);
            let doubted = doubts.filter(|doubt| doubt.code() == "knee-bent").count();
            assert_eq!(doubted, usize::from(is_bent && d.is_some()), "{told}");
        }
        // B and C: D is in doubt.
        assert_eq!(quietly_wrong(&found, truth), [], "{told}");
    }
}
