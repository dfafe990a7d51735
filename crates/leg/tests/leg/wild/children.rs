//! Small children are measured, whatever the unit, and tall adults are not taken for them.

use gaiter_leg::method::Unit;

use super::*;

/// The girth at C of both legs, mm.
fn calves_mm(found: &Extraction) -> [f64; 2] {
    [0, 1].map(|leg| {
        let landmarks = &found.legs[leg].landmarks;
        landmarks.iter().find(|landmark| landmark.level == Level::C).unwrap().girth_tape_mm
    })
}

/// A body made so tall, with a head that is so many times as large; exported with this many mm to a unit.
fn export(height_mm: f64, head: f64, unit_mm: f64) -> Mesh {
    let body = Mesh::body("f_average_clean");
    let top = body.points.iter().map(|point| point[1]).fold(0.0, f64::max);
    let chin = 0.865 * top;
    let large = body.moved(|[x, y, z]| {
        let share = ((y - chin) / (0.02 * top)).clamp(0.0, 1.0);
        let grown = 1.0 + (head - 1.0) * share;
        [grown * x, y + (grown - 1.0) * (y - chin), grown * z]
    });
    let top = large.points.iter().map(|point| point[1]).fold(0.0, f64::max);
    large.scaled(height_mm / top / unit_mm)
}

#[test]
fn a_child_of_85_cm_has_the_girths_of_the_body_it_is_a_small_copy_of() {
    let whole = measured(&Mesh::body("f_average_clean"));
    let small = measured(&export(850.0, 1.0, 1.0));
    let share = 850.0 / (whole.body.stature_mm.unwrap() + 1.0);
    for (small, whole) in calves_mm(&small).into_iter().zip(calves_mm(&whole)) {
        assert!((small / whole / share - 1.0).abs() < 0.005, "{small} {whole} {share}");
    }
}

#[test]
fn a_child_in_centimetres_is_no_giant_in_inches_and_the_other_way_round() {
    for height_mm in [810.0, 850.0, 900.0] {
        let found = measured(&export(height_mm, 1.7, 10.0));
        assert_eq!(found.body.unit, Unit::Cm, "{height_mm}");
        assert!(found.body.stature_mm.is_some_and(|mm| (mm - height_mm).abs() < 12.0));
        let found = measured(&export(2.54 * height_mm, 1.0, 25.4));
        assert_eq!(found.body.unit, Unit::In, "{height_mm}");
    }
}
