//! A body of known girths is measured as it is, and what is wrong with the scanner shows.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;

use gaiter_leg::Method;
use gaiter_leg::phantom::{Phantom, PhantomCheck, PhantomFault, check};
use gaiter_scan::Format;
use support::mesh::{Mesh, Ring};
use support::solids::near;

/// A cone: its radius falls by 0.1 mm per mm, from 80 mm at the floor. 500 mm high.
const RADIUS_MM: f64 = 80.0;
const SLOPE: f64 = 0.1;
const TOP_MM: f64 = 500.0;

fn radius_mm(height_mm: f64) -> f64 {
    RADIUS_MM - SLOPE * height_mm
}

/// Rings 4 mm apart, points 4 to 5 mm apart, as in an export. The facets lie up to 0.04 mm inside.
fn solid(radius: impl Fn(f64) -> f64) -> Mesh {
    let ring = |i: u32| {
        let y = f64::from(i) * 4.0;
        Ring { y, middle: [30.0, -20.0], half: [radius(y); 2] }
    };
    let rings = (0..=(TOP_MM / 4.0) as u32).map(ring);
    Mesh::tube(&rings.collect::<Vec<_>>(), 100)
}

/// The cone's girths at 5, 20 and 40 cm.
fn known() -> Phantom {
    let at = |height_cm: f64| format!("{height_cm}:{}", TAU * radius_mm(height_cm * 10.0) / 10.0);
    [5.0, 20.0, 40.0].map(at).join(",").parse().unwrap()
}

fn checked(mesh: &Mesh, phantom: &Phantom) -> Result<PhantomCheck, PhantomFault> {
    check(&mesh.obj(), Format::Obj, phantom, &Method::default())
}

#[test]
fn a_cone_has_the_girths_that_it_has() {
    let found = checked(&solid(radius_mm), &known()).unwrap();
    assert_eq!(found.girths.len(), 3);
    for girth in &found.girths {
        near(girth.measured_mm, TAU * radius_mm(girth.height_mm), 0.1, "girth");
    }
    assert!(found.is_within(0.1) && found.tilt_deg < 0.01, "{found:?}");
}

#[test]
fn a_cylinder_that_leans_in_any_unit_has_its_girth_at_every_height() {
    let phantom = Phantom::Cylinder { girth_mm: TAU * 55.0 };
    let (sin, cos) = 5_f64.to_radians().sin_cos();
    let leaning = solid(|_| 55.0).moved(|[x, y, z]| [x * cos + y * sin, y * cos - x * sin, z]);
    for in_mm in [1.0, 10.0, 25.4, 1000.0] {
        let found = checked(&leaning.clone().scaled(1.0 / in_mm), &phantom).unwrap();
        assert_eq!(found.girths.len(), 5);
        near(found.worst_mm(), 0.0, 0.1, "girth");
        near(found.tilt_deg, 5.0, 0.05, "tilt");
    }
}

/// Two cylinders on top of each other, with the girths known on each.
fn stepped() -> (Mesh, Phantom) {
    let girths = [8.0, 17.0, 33.0, 42.0].map(|height_cm: f64| {
        format!("{height_cm}:{}", TAU * if height_cm < 25.0 { 8.0 } else { 5.0 })
    });
    let radius = |height_mm: f64| if height_mm < 250.0 { 80.0 } else { 50.0 };
    (solid(radius), girths.join(",").parse().unwrap())
}

#[test]
fn a_scanner_whose_scale_is_off_shows_by_how_much() {
    let (mesh, phantom) = stepped();
    let line = checked(&mesh.scaled(0.97), &phantom).unwrap().line().unwrap();
    near(line.scale, -0.03, 0.001, "scale");
    near(line.offset_mm, 0.0, 0.4, "offset");
    let cylinder = Phantom::Cylinder { girth_mm: TAU * 55.0 };
    let found = checked(&solid(|_| 55.0).scaled(0.97), &cylinder).unwrap();
    near(found.bias_mm(), -0.03 * TAU * 55.0, 0.1, "bias of a cylinder");
    assert!(!found.is_within(2.0));
}

#[test]
fn views_that_do_not_meet_add_twice_their_distance_at_every_girth() {
    // Front and back 2 mm apart.
    let apart = |[x, y, z]: [f64; 3]| [x, y, z + (z + 20.0).signum()];
    let (mesh, phantom) = stepped();
    let line = checked(&mesh.moved(apart), &phantom).unwrap().line().unwrap();
    near(line.offset_mm, 4.0, 0.5, "offset");
    near(line.scale, 0.0, 0.002, "scale");
}

#[test]
fn a_cone_shows_that_the_scale_is_off_but_not_that_it_is_the_scale() {
    let found = checked(&solid(radius_mm).scaled(0.97), &known()).unwrap();
    // The cone is lower too, so at each height its radius is smaller by 3 % of that at the floor.
    near(found.bias_mm(), -0.03 * TAU * RADIUS_MM, 0.1, "bias");
    assert_eq!(found.line(), None);
}

#[test]
fn what_is_not_the_phantom_is_refused_with_what_was_found() {
    let cone = solid(radius_mm);
    let two = cone.clone().and(Mesh::column([600.0, 0.0], 60.0, 0.0, 500.0));
    assert!(matches!(checked(&two, &known()), Err(PhantomFault::NotThePhantom { .. })));
    let low = cone.clone().kept(|[_, y, _]| y < 380.0);
    let Err(PhantomFault::TooLow { found_mm, needed_mm }) = checked(&low, &known()) else {
        panic!("{:?}", checked(&low, &known()))
    };
    assert!((found_mm - 380.0).abs() < 5.0 && needed_mm > 400.0, "{found_mm} {needed_mm}");
    let behind = cone.clone().kept(|[x, _, _]| x > 20.0);
    assert!(matches!(checked(&behind, &known()), Err(PhantomFault::NotSeen { .. })));
    let nothing = check(b"v 1 2 3\n", Format::Obj, &known(), &Method::default());
    assert!(nothing.is_err());
}
