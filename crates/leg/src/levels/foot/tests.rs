//! Feet that are ellipsoids: every plane section of one is an ellipse.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Rotation3, Vector3};

use super::{Foot, FootReport, LATERAL_SHARE, MEDIAL_SHARE, foot};
use crate::doubt::Doubt;
use crate::method::SectionFit;
use crate::parting::segment::Leg;
use crate::sections::axis::LegAxis;
use crate::sections::slice::Mesh;
use crate::side::Side;

const STATURE_MM: f64 = 1500.0;

/// Half the length, the breadth and the height of the ellipsoid, mm. It touches the floor.
const HALF_MM: [f64; 3] = [125.0, 45.0, 50.0];

/// A point of the ellipsoid by longitude and latitude: toes to −Y, left to +X, sole at 0.
fn point(longitude: f64, latitude: f64) -> Point3<f64> {
    let [long, broad, high] = HALF_MM;
    let (x, y) = (broad * longitude.sin(), -long * longitude.cos());
    Point3::new(x * latitude.cos(), y * latitude.cos(), high * (1.0 + latitude.sin()))
}

/// The ellipsoid as the foot of a leg, turned about the vertical, without what `hole` names.
fn leg(side: Side, turn_deg: f64, hole: impl Fn(&Point3<f64>) -> bool) -> Leg {
    const AROUND: u32 = 240;
    const UP: u32 = 120;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), turn_deg.to_radians());
    let far = Vector3::new(100.0 * side.lateral_sign(), 30.0, 0.0);
    let places = (0..=UP).flat_map(|row| (0..AROUND).map(move |column| (row, column)));
    let angles = |(row, column): (u32, u32)| {
        (TAU * f64::from(column) / f64::from(AROUND), PI * (f64::from(row) / f64::from(UP) - 0.5))
    };
    let own: Vec<Point3<f64>> =
        places.clone().map(angles).map(|(along, up)| point(along, up)).collect();
    let at = |row: u32, column: u32| row * AROUND + column % AROUND;
    let pair = |(row, column): (u32, u32)| {
        let [a, b] = [at(row - 1, column), at(row - 1, column + 1)];
        let [c, d] = [at(row, column + 1), at(row, column)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = places.filter(|(row, _)| *row > 0).flat_map(pair);
    let kept = triangles.filter(|corners| !corners.iter().any(|&c| hole(&own[c as usize])));
    let points = own.iter().map(|p| turn * p + far).collect();
    Leg { side, mesh: Mesh::new(points, kept.collect()).part(|_| true), cut_mm: None }
}

fn measured(leg: &Leg) -> Option<FootReport> {
    let axis = LegAxis::straight(Point3::origin(), &Vector3::z(), leg.side);
    foot(leg, &axis, STATURE_MM, SectionFit::Skin)
}

/// The perimeter and the centre's height of the ellipse where the plane through `through`, square
/// to `normal`, meets the ellipsoid: with all half axes scaled to 1 it is a circle.
fn ellipse(through: Point3<f64>, normal: Vector3<f64>) -> [f64; 2] {
    let [long, broad, high] = HALF_MM;
    let half = Vector3::new(broad, long, high);
    let scaled = normal.component_mul(&half);
    let offset = normal.dot(&(through - Point3::new(0.0, 0.0, high))) / scaled.norm();
    let square = scaled.normalize();
    let one = square.cross(&Vector3::new(0.3, 0.5, 0.8)).normalize();
    let other = square.cross(&one);
    let radius = (1.0 - offset * offset).sqrt();
    let at = |step: u32| {
        let (sin, cos) = (TAU * f64::from(step) / 20_000.0).sin_cos();
        (square * offset + (one * cos + other * sin) * radius).component_mul(&half)
    };
    let perimeter = (0..20_000).map(|step| (at(step + 1) - at(step)).norm()).sum();
    [perimeter, high + (square * offset).component_mul(&half).z]
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} for {expected}");
}

#[test]
fn length_and_breadth_are_the_ellipsoid_s_whichever_way_it_is_turned() {
    for (side, turn_deg) in [(Side::Left, 0.0), (Side::Left, 25.0), (Side::Right, -40.0)] {
        let Foot { length_mm, breadth_mm } =
            measured(&leg(side, turn_deg, |_| false)).unwrap().foot;
        near(length_mm, 250.0, 0.3);
        near(breadth_mm, 90.0, 0.3);
    }
}

#[test]
fn y_is_the_ellipse_at_45_degrees_from_the_back_edge_of_the_heel() {
    let heel = Point3::new(0.0, HALF_MM[0], 0.0);
    let normal = Vector3::new(0.0, 1.0, 1.0);
    let [girth_mm, height_mm] = ellipse(heel, normal);
    for (side, turn_deg) in [(Side::Left, 0.0), (Side::Right, 0.0), (Side::Left, 20.0)] {
        let y = measured(&leg(side, turn_deg, |_| false)).unwrap().y.unwrap();
        near(y.girth_tape_mm, girth_mm, 0.5);
        near(y.girth_contour_mm, girth_mm, 0.5);
        near(y.height_mm, height_mm, 0.5);
        near(y.along_mm, y.height_mm, 1e-9);
        assert_eq!(y.doubts, []);
        // Heel and floor are known to 2 mm, and so is the plane's place.
        let [above, below] =
            [1.0, -1.0].map(|off| ellipse(heel + normal.normalize() * off, normal));
        near(y.girth_sd_mm, (above[0] - below[0]).abs(), 0.2);
        near(y.height_sd_mm, (above[1] - below[1]).abs(), 0.1);
    }
}

#[test]
fn a_is_the_vertical_ellipse_through_the_metatarsal_heads() {
    // Places on the equator at these shares of the length from the heel.
    let edge = |share: f64, sign: f64| {
        let ahead = 2.0 * share - 1.0;
        let aside = sign * HALF_MM[1] * (1.0 - ahead * ahead).sqrt();
        Point3::new(aside, -HALF_MM[0] * ahead, 0.0)
    };
    let (medial, lateral) = (edge(MEDIAL_SHARE, -1.0), edge(LATERAL_SHARE, 1.0));
    let [girth_mm, height_mm] = ellipse(medial, (lateral - medial).cross(&Vector3::z()));
    for side in Side::BOTH {
        let a = measured(&leg(side, 0.0, |_| false)).unwrap().a.unwrap();
        near(a.girth_tape_mm, girth_mm, 1.0);
        near(a.height_mm, height_mm, 0.5);
        assert_eq!(a.doubts[0], Doubt::SoleNotSeen);
    }
}

#[test]
fn an_unseen_sole_leaves_y_and_costs_a_no_more_than_its_standard_error() {
    let whole = measured(&leg(Side::Left, 0.0, |_| false)).unwrap();
    let soleless = measured(&leg(Side::Left, 0.0, |p| p.z < 2.0)).unwrap();
    let (a, y) = (soleless.a.unwrap(), soleless.y.unwrap());
    near(y.girth_tape_mm, whole.y.unwrap().girth_tape_mm, 0.5);
    near(a.girth_tape_mm, whole.a.unwrap().girth_tape_mm, a.girth_sd_mm);
}

#[test]
fn a_foot_that_is_cut_off_is_none() {
    let toes = |share: f64| move |p: &Point3<f64>| p.y < -HALF_MM[0] * (2.0 * share - 1.0);
    assert!(measured(&leg(Side::Left, 0.0, toes(0.75))).is_none(), "without its toes");
    assert!(measured(&leg(Side::Left, 0.0, |p| p.y > 60.0)).is_none(), "without its heel");
    assert!(measured(&leg(Side::Left, 0.0, toes(0.5))).is_none(), "half a foot");
    assert!(measured(&leg(Side::Left, 0.0, |p| p.z < 60.0)).is_none(), "nothing near the floor");
}

#[test]
fn an_instep_that_is_not_seen_leaves_y_absent() {
    let instep = |p: &Point3<f64>| p.z > 25.0 && p.y > -40.0;
    let found = measured(&leg(Side::Left, 0.0, instep)).unwrap();
    assert_eq!(found.y, None);
    assert!(found.a.is_some());
}
