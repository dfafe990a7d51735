//! Every finding and every doubt that a scan can give is given where its cause is there, and on the
//! leg and level where it is; the same body without the cause has none.

#![allow(clippy::unwrap_used, clippy::panic)]

use gaiter_leg::doubt::Doubt;
use gaiter_leg::finding::Severity;
use gaiter_leg::method::{Axis, FacingChoice};
use gaiter_leg::{Extraction, Finding, Level, Method, Side, What};
use support::chance::Chance;
use support::mesh::Mesh;
use support::recorded::extract_scan;

/// A finding as the record gives it: leg, level, code.
type Found = (Option<Side>, Option<Level>, &'static str);

#[track_caller]
fn measured(mesh: &Mesh, method: &Method) -> Extraction {
    extract_scan(&mesh.scan(), method).unwrap_or_else(|refusal| panic!("{refusal}"))
}

fn findings(extraction: &Extraction) -> Vec<Found> {
    extraction.findings.iter().map(|f| (f.side, f.level, f.code())).collect()
}

/// The middle of the mannequin's left leg at a height, `[x, z]`, of its straight part.
fn middle(y: f64) -> [f64; 2] {
    [100.0 - 0.01 * y, if y < 450.0 { -4.0 } else { 0.0 }]
}

/// The mannequin without the skin of its left leg's outer side, this wide, between two heights.
fn with_gap(width_deg: f64, from_mm: f64, to_mm: f64) -> Mesh {
    Mesh::mannequin().kept(|[x, y, z]| {
        let [mx, mz] = middle(y);
        let off_deg = (z - mz).atan2(x - mx).to_degrees().abs();
        x < 0.0 || !(from_mm..to_mm).contains(&y) || off_deg > width_deg / 2.0
    })
}

/// The mannequin with its left leg's radius changed: by how much, mm, of angle and height.
fn with_radius(mut more_mm: impl FnMut(f64, f64) -> f64) -> Mesh {
    let mut mesh = Mesh::mannequin();
    for point in mesh.points.iter_mut().filter(|[x, y, _]| *x > 0.0 && *y < 800.0) {
        let [x, y, z] = *point;
        let [mx, mz] = middle(y);
        let (dx, dz) = (x - mx, z - mz);
        let factor = 1.0 + more_mm(dz.atan2(dx), y) / dx.hypot(dz);
        *point = [mx + factor * dx, y, mz + factor * dz];
    }
    mesh
}

/// Whether a finding is about G, which is measured from the mannequin's uncertain crotch.
fn is_of_the_crotch((_, level, code): &(Option<Side>, Option<Level>, &'static str)) -> bool {
    *level == Some(Level::G) && *code == "girth-uncertain"
}

/// Fails where the left leg's level has not this finding, or the right leg any at all.
#[track_caller]
fn check_left(mesh: &Mesh, level: Option<Level>, code: &'static str) -> Finding {
    let extraction = measured(mesh, &Method::default());
    let all = findings(&extraction);
    assert!(all.contains(&(Some(Side::Left), level, code)), "no {code} in {all:?}");
    let others = all.iter().filter(|finding| !is_of_the_crotch(finding));
    assert!(others.clone().all(|(side, ..)| *side != Some(Side::Right)), "{all:?}");
    let is_it = |f: &&Finding| f.side == Some(Side::Left) && f.level == level && f.code() == code;
    extraction.findings.iter().find(is_it).unwrap().clone()
}

#[test]
fn a_body_that_gives_no_cause_has_no_findings() {
    // The mannequin's legs and its trunk are tubes that nothing connects, so it has no crotch, and no certain
    // girth below one.
    let found = findings(&measured(&Mesh::mannequin(), &Method::default()));
    let roots = Side::BOTH.map(|side| (Some(side), Some(Level::G), "girth-uncertain"));
    assert_eq!(found, [&[(None, None, "crotch-uncertain")], &roots[..]].concat());
}

#[test]
fn a_gap_at_the_calf_is_doubted_and_one_too_wide_to_close_says_that_the_skin_was_not_seen() {
    let gap = check_left(&with_gap(45.0, 320.0, 360.0), Some(Level::C), "gap");
    let What::Doubtful(Doubt::Gap { gap_deg }) = gap.what else { panic!("{gap:?}") };
    // The columns of the mannequin are 9 degrees apart.
    assert!((45.0..=63.0).contains(&gap_deg), "{gap_deg}");
    let unseen = check_left(&with_gap(360.0, 320.0, 357.0), Some(Level::C), "not-seen");
    assert_eq!(unseen.severity(), Severity::Warning);
}

#[test]
fn points_that_are_no_one_skin_scatter() {
    // Like cloth all along the leg: 3.5 mm in and out.
    let mut chance = Chance(3);
    let rough = with_radius(|_, _| 3.5 * chance.normal());
    check_left(&rough, Some(Level::C), "scatter");
}

#[test]
fn cloth_over_a_part_of_the_leg_scatters_though_its_points_are_disbelieved() {
    let mut chance = Chance(3);
    let wrapped = with_radius(|_, y| {
        let noise = 3.5 * chance.normal();
        if (280.0..400.0).contains(&y) { noise } else { 0.0 }
    });
    check_left(&wrapped, Some(Level::C), "scatter");
}

#[test]
fn skin_that_is_longer_than_a_tape_around_it_is_folded() {
    // Five furrows, 18 mm deep.
    let furrowed = with_radius(|angle, y| {
        let share = ((y - 250.0) / 50.0).clamp(0.0, 1.0) * ((430.0 - y) / 50.0).clamp(0.0, 1.0);
        9.0 * share * (5.0 * angle).cos()
    });
    check_left(&furrowed, Some(Level::C), "folds");
}

#[test]
fn a_girth_that_no_leg_has_is_left_out_as_an_error() {
    // An ankle 22 mm thick.
    let thin = with_radius(|_, y| -21.0 * (-((y - 110.0) / 30.0_f64).powi(2)).exp());
    let finding = check_left(&thin, Some(Level::B), "level-implausible");
    assert_eq!(finding.severity(), Severity::Error);
    let found = measured(&thin, &Method::default());
    assert!(found.legs[0].landmarks.iter().all(|landmark| landmark.level != Level::B));
    assert!(found.legs[1].landmarks.iter().any(|landmark| landmark.level == Level::B));
}

#[test]
fn a_surface_that_lacks_its_lower_end_is_short() {
    check_left(&with_gap(165.0, 50.0, 125.0), None, "surface-short");
}

#[test]
fn a_leg_whose_sections_make_no_surface_is_measured_and_says_so_as_an_error() {
    let method = Method { surface_control_points: Some([300, 24]), ..Method::default() };
    let found = measured(&Mesh::mannequin(), &method);
    for (leg, side) in found.legs.iter().zip(Side::BOTH) {
        assert!(leg.surface.is_none() && leg.landmarks.len() > 3);
        let about = found.findings.iter().filter(|finding| finding.side == Some(side));
        let about = about.filter(|finding| finding.level.is_none());
        let said: Vec<_> = about.map(|finding| (finding.code(), finding.severity())).collect();
        assert_eq!(said, [("no-surface", Severity::Error)]);
    }
}

/// A body whose calves stand above its ankles, and not behind them.
fn without_calves() -> Mesh {
    let behind_mm = |y: f64| ((y - 130.0) / 17.5).min((450.0 - y) / 12.5).clamp(0.0, 8.0);
    Mesh::mannequin().moved(|[x, y, z]| [x, y, z + behind_mm(y)])
}

/// The right foot turned backwards about its ankle.
fn with_foot_turned(mesh: Mesh) -> Mesh {
    mesh.moved(|[x, y, z]| if x < 0.0 && y < 90.0 { [-200.0 - x, y, -z] } else { [x, y, z] })
}

#[test]
fn feet_that_say_nothing_leave_the_facing_to_the_calves_and_then_to_the_declaration() {
    let facing = FacingChoice::Declared(Axis::PlusZ);
    let declared = Method { facing, ..Method::default() };
    let says = |mesh: Mesh, method: &Method| findings(&measured(&mesh, method))[0].2;
    assert_eq!(says(with_foot_turned(Mesh::mannequin()), &declared), "facing-by-calves");
    assert_eq!(says(with_foot_turned(Mesh::mannequin()), &Method::default()), "facing-by-calves");
    assert_eq!(says(with_foot_turned(without_calves()), &declared), "facing-unchecked");
    let unknown = with_foot_turned(without_calves()).scan();
    let fault = extract_scan(&unknown, &Method::default()).unwrap_err();
    assert_eq!(fault.code(), "body-facing-unclear", "{fault}");
}

#[test]
fn a_crotch_at_two_fifths_of_the_stature_is_told() {
    let tall = Mesh::mannequin().moved(|[x, y, z]| [x, y + 0.3 * (y - 900.0).max(0.0), z]);
    assert!(findings(&measured(&tall, &Method::default())).contains(&(None, None, "proportions")));
}

#[test]
fn feet_without_toes_leave_the_facing_to_the_declaration_and_a_plate_under_them_does_not() {
    let declared = FacingChoice::Declared(Axis::PlusZ);
    let method = Method { facing: declared, ..Method::default() };
    for behind_mm in [20.0, 60.0, 100.0] {
        let short = without_calves().kept(|[_, y, z]| y > 80.0 || z < behind_mm);
        let found = measured(&short, &method);
        assert!(findings(&found).contains(&(None, None, "facing-unchecked")), "{behind_mm}");
        assert_eq!(found.legs.len(), 2, "{behind_mm}");
    }
    // What is larger than a foot hides where the floor is.
    let wide =
        Mesh::mannequin().moved(|[x, y, z]| if y < 25.0 { [x, y, 2.0 * z] } else { [x, y, z] });
    let fault = extract_scan(&wide.scan(), &method).unwrap_err();
    assert!(fault.to_string().contains("which is not a foot"), "{fault}");
}

#[test]
fn the_forefoot_s_tape_says_that_nobody_saw_the_sole() {
    let found = measured(&Mesh::body("f_average_clean"), &Method::default());
    for leg in &found.legs {
        let a = leg.estimates.iter().find(|estimate| estimate.level == Level::A).unwrap();
        let codes: Vec<&str> = a.doubts.iter().map(|doubt| doubt.code()).collect();
        assert_eq!(codes, ["sole-not-seen"]);
    }
}
