//! Scans of one body on other days: in other stances, with other noise, as other exports.

#![allow(clippy::unwrap_used)]

use gaiter_leg::{Method, Side};
use gaiter_record::Record;
use gaiter_scan::Scan;
use gaiter_visits::{Caution, Choice, Comparison, Course, GIRTH_COMMON_MM, Shown};
use support::mesh::Mesh;
use support::noise::roughened;
use support::recorded::truth;
use support::records::record_of_scan;
use support::stance::Stance;

pub const CHOICE: Choice =
    Choice { volume: None, affected: None, girth_common_mm: GIRTH_COMMON_MM };

/// The noise of a good scanner, mm.
pub const NOISE_MM: f64 = 0.5;

pub const BODIES: [&str; 2] = ["f_average_clean", "m_average_clean"];

/// The record of a body in a stance, with noise of its own.
fn standing(name: &str, stance: Stance, seed: u64) -> Record {
    let crotch_mm = truth(name)["crotch_height_mm"].as_f64().unwrap();
    let scan = stance.of(Mesh::body(name), crotch_mm).scan();
    record_of_scan(&roughened(&scan, NOISE_MM, seed), &Method::default())
}

pub fn compared(earlier: &Record, later: Record) -> Comparison {
    let course = Course::comparable(&[earlier.clone(), later], CHOICE).unwrap();
    course.last_compared(&course.groups[0]).remove(0)
}

/// Nothing of an unchanged body is told as changed.
fn assert_unchanged(what: &str, compared: &Comparison) {
    for side in Side::BOTH {
        let leg = compared.legs.get(side).as_ref().unwrap();
        let volume = leg.volume.unwrap();
        assert_eq!(volume.shown(), Shown::NoChange, "{what} {side:?}: {volume:?}");
        for of in leg.girths.iter().chain(&leg.pieces) {
            assert_eq!(of.change.shown(), Shown::NoChange, "{what} {side:?}: {of:?}");
        }
    }
    assert_eq!(compared.excess, None, "{what}: nobody named an affected leg");
    // One figure a comparison, so two standard errors would be passed by chance: three are not.
    let of = compared.left_minus_right.unwrap();
    let sd = of.random.hypot(of.common).hypot(of.stance);
    assert!(of.by.abs() < 3.0 * sd, "{what}: {of:?}");
}

#[test]
fn another_scan_of_the_same_stance_has_the_same_volume_within_three_parts_in_a_thousand() {
    for name in BODIES {
        let first = standing(name, Stance::default(), 1);
        for seed in 2..6 {
            let compared = compared(&first, standing(name, Stance::default(), seed));
            assert_unchanged(name, &compared);
            assert!(compared.cautions.iter().all(|of| !matches!(of, Caution::Stance { .. })));
            for side in Side::BOTH {
                let volume = compared.legs.get(side).as_ref().unwrap().volume.unwrap();
                assert!(volume.percent.abs() < 0.3, "{name} {side:?}: {volume:?}");
            }
        }
    }
}

/// docs/visits.md, what bounds the limit: almost only the millimetre that all girths of a scan may be off by
/// together. What the floor and single girths add is a fifth of it.
#[test]
fn an_average_womans_limit_is_bound_by_the_common_error_and_is_one_and_a_half_percent_below_a_millimetre()
 {
    let records = [1, 2].map(|seed| standing("f_average_clean", Stance::default(), seed));
    let detectable = |girth_common_mm: f64| {
        let course = Course::comparable(&records, Choice { girth_common_mm, ..CHOICE }).unwrap();
        let of = course.last_compared(&course.groups[0]).remove(0);
        let percent =
            |side: Side| of.legs.get(side).as_ref().unwrap().volume.unwrap().detectable_percent();
        Side::BOTH.map(percent).into_iter().fold(0.0, f64::max)
    };
    let [none, little, usual, much] = [0.0, 0.95, 1.0, 2.0].map(detectable);
    assert!((1.5..1.6).contains(&usual) && little <= 1.5, "{usual} %, {little} %");
    assert!(none < 0.2 * usual && much > 1.9 * usual, "{none} %, {much} %");
}

/// Two legs of a scan do not know the error that they have in common: what a scanner that is off by a millimetre
/// does to both is what a millimetre of swelling of both does. Their difference is free of it, and told as such.
#[test]
fn the_difference_of_the_legs_is_told_five_times_finer_than_the_change_of_either() {
    let records = [1, 2].map(|seed| standing("f_average_clean", Stance::default(), seed));
    let course = Course::comparable(&records, CHOICE).unwrap();
    let of = course.last_compared(&course.groups[0]).remove(0);
    let apart = of.left_minus_right.unwrap().detectable();
    for side in Side::BOTH {
        let own = of.legs.get(side).as_ref().unwrap().volume.unwrap().detectable();
        assert!(apart < 0.2 * own, "{apart} mL, {own} mL of one leg");
    }
}

#[test]
fn an_unchanged_body_in_another_stance_shows_no_change() {
    let apart = [-2.0, -1.0, 1.0, 2.0, 3.0].map(|deg| Stance { apart_deg: deg, bent_deg: 0.0 });
    let bent = [2.0, 4.0, 6.0, 8.0].map(|deg| Stance { apart_deg: 0.0, bent_deg: deg });
    let both = [Stance { apart_deg: 2.0, bent_deg: 5.0 }];
    for name in BODIES {
        let first = standing(name, Stance::default(), 1);
        for (seed, stance) in apart.into_iter().chain(bent).chain(both).enumerate() {
            let compared = compared(&first, standing(name, stance, 50 + seed as u64));
            assert_unchanged(&format!("{name} {stance:?}"), &compared);
        }
    }
}

#[test]
fn a_bent_knee_is_told_and_girths_around_it_are_not_compared() {
    let first = standing("m_average_clean", Stance::default(), 1);
    let bent = Stance { apart_deg: 0.0, bent_deg: 8.0 };
    let compared = compared(&first, standing("m_average_clean", bent, 2));
    let told = |side: Side| {
        compared
            .cautions
            .iter()
            .any(|of| matches!(of, Caution::Stance { side: of, .. } if *of == side))
    };
    let knee_mm = 0.285 * first.body.stature_mm.unwrap();
    for side in Side::BOTH {
        assert!(told(side));
        let leg = compared.legs.get(side).as_ref().unwrap();
        let lengths: Vec<f64> = leg.girths.iter().map(|of| 40.0 * f64::from(of.step)).collect();
        assert!(lengths.iter().all(|mm| (mm - knee_mm).abs() >= 80.0), "{lengths:?}");
        assert!(lengths.iter().any(|mm| *mm < knee_mm) && lengths.iter().any(|mm| *mm > knee_mm));
    }
}

#[test]
fn another_export_of_the_body_shows_no_change() {
    let first = standing("m_average_clean", Stance::default(), 1);
    let mesh = || Mesh::body("m_average_clean");
    let metres = mesh().scaled(0.001).scan();
    let turned = mesh().turned(7.0).scan();
    let without_triangles = Scan { triangles: Vec::new(), ..mesh().scan() };
    let moved = mesh().moved(|[x, y, z]| [x + 300.0, y + 1200.0, z - 80.0]).scan();
    for (what, scan, noise) in [
        ("metres", metres, NOISE_MM / 1000.0),
        ("turned", turned, NOISE_MM),
        ("moved", moved, NOISE_MM),
        ("points", without_triangles, NOISE_MM),
    ] {
        let later = record_of_scan(&roughened(&scan, noise, 9), &Method::default());
        assert_unchanged(what, &compared(&first, later));
    }
}
