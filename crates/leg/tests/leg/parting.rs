//! Legs that are hard to part, and legs that are not all there: thighs that touch, a leg that is
//! missing or cut, a leg alone. What can be measured is what it is on the whole body.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::LazyLock;

use gaiter_leg::method::Scope;
use gaiter_leg::{CrotchFrom, Extraction, Level, Method, Refusal, Side};
use support::mesh::{Mesh, Ring};
use support::recorded::extract_scan;

/// The body that the legs are taken from: y up, mm, the patient's left at +x. Its crotch is at
/// 744.5 mm.
static BODY: LazyLock<Mesh> = LazyLock::new(|| Mesh::body("f_average_clean"));

/// What is measured on it as it is.
static PLAIN: LazyLock<Extraction> = LazyLock::new(|| measured(&BODY));

/// The same skin cut in another way leaves this of a girth, mm, and of a height.
const SAME_MM: [f64; 2] = [0.5, 1.5];

/// The axis of a lower leg leans otherwise than that of the whole leg, by some degrees, and sections
/// are square to it.
const PART_MM: [f64; 2] = [4.5, 4.0];

fn tried(mesh: &Mesh, scope: Scope) -> Result<Extraction, Refusal> {
    extract_scan(&mesh.scan(), &Method { scope, ..Method::default() })
}

#[track_caller]
fn measured(mesh: &Mesh) -> Extraction {
    tried(mesh, Scope::Body).unwrap_or_else(|refusal| panic!("{refusal}"))
}

#[track_caller]
fn refused(mesh: &Mesh, scope: Scope) -> Refusal {
    match tried(mesh, scope) {
        Ok(found) => panic!("it was measured: {:?}", found.findings),
        Err(refusal) => refusal,
    }
}

fn codes(extraction: &Extraction, side: Option<Side>) -> Vec<&'static str> {
    let own = extraction.findings.iter().filter(|finding| finding.side == side);
    own.map(gaiter_leg::Finding::code).collect()
}

/// Fails where a leg's levels up to `to_mm` are not those of the whole body's.
#[track_caller]
fn check_leg(found: &Extraction, side: Side, to_mm: f64, within_mm: [f64; 2]) {
    let leg = |of: &Extraction| of.legs.iter().find(|leg| leg.side == side).cloned();
    let (own, plain) = (leg(found).expect("the leg was measured"), leg(&PLAIN).unwrap());
    let mut levels = 0;
    for expected in plain.landmarks.iter().filter(|l| l.height_mm < to_mm) {
        let Some(level) = own.landmarks.iter().find(|l| l.level == expected.level) else {
            panic!("{side:?} {:?} is missing: {:?}", expected.level, found.findings);
        };
        let girth_mm = level.girth_tape_mm - expected.girth_tape_mm;
        let height_mm = level.height_mm - expected.height_mm;
        // B1 lies where the girth grows by 1 mm and more in each mm of height.
        let slack = if level.level == Level::B1 { 4.0 } else { 1.0 };
        // A lone leg has the stature, and with it the ends of its shank, from its foot. This body's is
        // 0.134 of its stature, three standard errors short and less than anybody's in ANSUR II.
        let by_stature_mm = match found.body.stature_mm {
            None => [5.0 * level.girth_sd_mm, 2.0 * level.height_sd_mm],
            Some(_) => [0.0; 2],
        };
        assert!(
            girth_mm.abs() < slack * within_mm[0] + by_stature_mm[0]
                && height_mm.abs() < slack * within_mm[1] + by_stature_mm[1],
            "{side:?} {:?}: {girth_mm:+.2} mm at {height_mm:+.2} mm, sd {:.2} mm",
            level.level,
            level.girth_sd_mm
        );
        levels += 1;
    }
    assert!(levels > 0);
}

/// Half the distance between the thighs at heights 10 mm apart from 400 mm on.
fn half_gaps() -> Vec<f64> {
    let at = |index: u32| {
        let y_mm = 400.0 + 10.0 * f64::from(index);
        let near = BODY.points.iter().filter(|p| (p[1] - y_mm).abs() < 10.0);
        near.map(|p| p[0].abs()).fold(f64::INFINITY, f64::min)
    };
    (0..40).map(at).collect()
}

/// The body with thighs so thick that they touch from about 580 mm up, over a breadth of some
/// centimetres. Where they touch their skin is flat against each other, or was not seen.
fn with_thighs_that_touch(is_seen: bool) -> Mesh {
    let half_gaps = half_gaps();
    let thick = BODY.clone().moved(|[x, y, z]| {
        let row = (((y - 400.0) / 10.0).round().max(0.0) as usize).min(half_gaps.len() - 1);
        // From nothing at 480 mm to 8 mm beyond the middle at 580 mm; as before above 760 mm.
        let grown = ((y - 480.0) / 100.0).clamp(0.0, 1.0) * ((790.0 - y) / 40.0).clamp(0.0, 1.0);
        let inward = grown * (half_gaps[row] + 8.0) * (-x.abs() / 200.0).exp();
        if x.abs() > 220.0 || inward == 0.0 {
            return [x, y, z];
        }
        [x.signum() * (x.abs() - inward).max(0.5), y, z]
    });
    if is_seen {
        return thick;
    }
    thick.kept(|[x, y, _]| x.abs() > 4.0 || !(480.0..760.0).contains(&y))
}

#[test]
fn legs_whose_thighs_touch_far_below_the_crotch_are_parted_and_measured() {
    for is_seen in [true, false] {
        let found = measured(&with_thighs_that_touch(is_seen));
        for side in Side::BOTH {
            // Thicker thighs have their middle elsewhere, and the axis leans after it by 2.3°.
            check_leg(&found, side, 460.0, [1.5, 1.5]);
        }
        let crotch_mm = found.crotch.height_mm;
        let off = (crotch_mm - PLAIN.crotch.height_mm).abs();
        assert!(off < 2.0 * found.crotch.sd_mm, "{is_seen}: {:?}", found.crotch);
        if is_seen {
            assert_eq!(found.crotch.from, CrotchFrom::Saddle);
            let touching_from_mm = found.crotch.touching_from_mm.unwrap();
            assert!((540.0..620.0).contains(&touching_from_mm), "{touching_from_mm}");
            assert_eq!(codes(&found, None), ["thighs-touch"]);
        }
    }
}

#[test]
fn under_a_narrow_skirt_the_legs_are_measured_below_its_hem_and_nothing_is_made_up_above() {
    // Narrow around both calves, wider above, and nothing of the legs is seen through it.
    let ring = |i: u32| {
        let y = 400.0 + 5.0 * f64::from(i);
        Ring { y, middle: [0.0, -35.0], half: [215.0 - 0.1 * (y - 400.0), 100.0] }
    };
    let skirt = Mesh::tube(&(0..=90).map(ring).collect::<Vec<_>>(), 200);
    let bare = BODY.clone().kept(|[x, y, _]| !(405.0..840.0).contains(&y) || x.abs() > 260.0);
    match tried(&bare.and(skirt), Scope::Body) {
        Err(refusal) => assert_eq!(refusal.code(), "segment-legs-end", "{refusal}"),
        Ok(found) => {
            for leg in &found.legs {
                check_leg(&found, leg.side, 330.0, PART_MM);
                assert!(leg.landmarks.iter().all(|l| l.height_mm < 400.0), "{:?}", leg.landmarks);
            }
        }
    }
}

#[test]
fn where_a_leg_is_missing_the_other_is_measured_and_the_missing_one_is_a_finding() {
    for side in Side::BOTH {
        let sign = side.lateral_sign();
        // Amputated below the knee and above it; hands hang beyond 250 mm.
        for end_mm in [450.0, 650.0] {
            let one =
                BODY.clone().kept(|[x, y, _]| y > end_mm || x * sign < 0.0 || x * sign > 260.0);
            let found = measured(&one);
            check_leg(&found, side.other(), 500.0, SAME_MM);
            assert_eq!(found.legs.len(), 1);
            assert_eq!(codes(&found, Some(side)), ["leg-not-measured"], "{:?}", found.findings);
            let off = found.crotch.height_mm - PLAIN.crotch.height_mm;
            assert!(off.abs() < 2.0 * found.crotch.sd_mm, "{off}");
        }
    }
}

#[test]
fn a_leg_that_is_cut_is_measured_up_to_its_end() {
    for side in Side::BOTH {
        let sign = side.lateral_sign();
        // A band that nobody saw, from above the calf to the groin.
        let cut = BODY
            .clone()
            .kept(|[x, y, _]| !(400.0..640.0).contains(&y) || x * sign < 0.0 || x * sign > 260.0);
        let found = measured(&cut);
        check_leg(&found, side, 380.0, PART_MM);
        check_leg(&found, side.other(), 500.0, SAME_MM);
        let own = codes(&found, Some(side));
        assert!(own.contains(&"leg-cut") && own.contains(&"level-absent"), "{own:?}");
    }
}

#[test]
fn a_narrow_band_that_nobody_saw_does_not_end_a_leg() {
    let band = BODY.clone().kept(|[_, y, _]| !(560.0..585.0).contains(&y));
    let found = measured(&band);
    for side in Side::BOTH {
        check_leg(&found, side, 500.0, SAME_MM);
        assert!(!codes(&found, Some(side)).contains(&"leg-cut"));
    }
}

/// One leg of the body alone, up to a height.
fn lone_leg(side: Side, to_mm: f64) -> Mesh {
    let sign = side.lateral_sign();
    BODY.clone().kept(|[x, y, _]| y < to_mm && x * sign > 0.0 && x * sign < 260.0)
}

#[test]
fn a_leg_alone_is_measured_as_on_the_body_in_any_unit() {
    for side in Side::BOTH {
        for (to_mm, factor) in [(720.0, 1.0), (720.0, 0.1), (480.0, 1.0 / 25.4), (480.0, 0.001)] {
            let leg = lone_leg(side, to_mm).scaled(factor);
            let found = tried(&leg, Scope::Leg(side)).unwrap_or_else(|refusal| panic!("{refusal}"));
            check_leg(&found, side, 460.0, if to_mm > 500.0 { SAME_MM } else { PART_MM });
            assert_eq!(found.legs.len(), 1);
            assert_eq!((found.body.stature_mm, found.crotch.is_seen()), (None, false));
            assert!(codes(&found, None).is_empty() && codes(&found, Some(side.other())).is_empty());
        }
    }
}

#[test]
fn a_lone_leg_has_the_side_that_was_declared_and_mirrors_with_it() {
    let leg = lone_leg(Side::Left, 720.0);
    let as_left = tried(&leg, Scope::Leg(Side::Left)).unwrap();
    let as_right = tried(&leg.mirrored(), Scope::Leg(Side::Right)).unwrap();
    let features = |of: &Extraction| -> Vec<f64> {
        of.legs[0].level_sections[0].features.iter().map(|f| f.angle_deg).collect()
    };
    let (left, right) = (features(&as_left), features(&as_right));
    assert_eq!(left.len(), right.len());
    for (left, right) in left.iter().zip(&right) {
        assert!((left - right).abs() < 1.0, "{left} {right}");
    }
}

#[test]
fn a_lone_leg_and_a_body_are_not_taken_for_each_other() {
    let code = |mesh: &Mesh, scope| refused(mesh, scope).code();
    let two = BODY.clone().kept(|[x, y, _]| y < 720.0 && x.abs() < 260.0);
    assert_eq!(code(&lone_leg(Side::Left, 720.0), Scope::Body), "body-no-plausible-unit");
    assert_eq!(code(&two, Scope::Leg(Side::Left)), "body-no-plausible-leg");
    assert_eq!(code(&BODY, Scope::Leg(Side::Right)), "body-no-plausible-leg");
    assert_eq!(code(&lone_leg(Side::Left, 190.0), Scope::Leg(Side::Left)), "body-no-plausible-leg");
}

#[test]
fn half_a_body_does_not_say_which_leg_it_has() {
    for sign in [1.0, -1.0] {
        let half = BODY.clone().kept(|[x, _, _]| x * sign > 0.0);
        let refusal = refused(&half, Scope::Body);
        assert_eq!(refusal.code(), "body-side-unclear", "{refusal}");
    }
}

#[test]
fn a_fold_that_hangs_out_at_the_knee_does_not_end_a_leg() {
    // 28 mm all around, from 480 to 500 mm.
    let band = |y: f64| ((y - 472.0).min(508.0 - y) / 8.0).clamp(0.0, 1.0);
    let is_knee =
        |[x, y, _]: &[f64; 3], sign: f64| band(*y) > 0.0 && (0.0..230.0).contains(&(x * sign));
    let middle = |sign: f64| {
        let knee: Vec<_> = BODY.points.iter().filter(|point| is_knee(point, sign)).collect();
        let sum = knee.iter().fold([0.0; 2], |sum, point| [sum[0] + point[0], sum[1] + point[2]]);
        sum.map(|sum| sum / knee.len() as f64)
    };
    let (left, right) = (middle(1.0), middle(-1.0));
    let folded = BODY.clone().moved(|point| {
        let [x, y, z] = point;
        let [mx, mz] = if x > 0.0 { left } else { right };
        if !is_knee(&point, x.signum()) {
            return point;
        }
        let (aside, ahead) = (x - mx, z - mz);
        let share = 28.0 * band(y) / aside.hypot(ahead);
        [x + share * aside, y, z + share * ahead]
    });
    let found = measured(&folded);
    assert_eq!(found.legs.len(), 2);
    Side::BOTH.into_iter().for_each(|side| check_leg(&found, side, 400.0, PART_MM));
}
