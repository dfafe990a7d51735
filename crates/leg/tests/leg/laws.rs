//! Laws of a measurement: what must not change when the same body is exported in another way.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

use gaiter_leg::method::{Unit, UnitChoice, Up, Winding};
use gaiter_leg::{BodyFault, Extraction, Level, Method, Refusal, Side};
use gaiter_scan::Scan;
use nalgebra::{Point3, Rotation3, Vector3};
use support::recorded::{extract_scan, scan};
use support::solids::Chance;

/// The body that the laws are tried on: y up, mm, looking to +z.
static BODY: LazyLock<Scan> = LazyLock::new(|| scan("f_average_clean"));

/// What is measured on it as it is.
static PLAIN: LazyLock<Extraction> =
    LazyLock::new(|| extract_scan(&BODY, &Method::default()).unwrap());

/// Summing the same numbers in another order leaves this, mm.
const SAME_MM: [f64; 2] = [0.02, 0.02];

/// The body with its points moved.
fn moved(by: impl Fn(&Point3<f64>) -> Point3<f64>) -> Scan {
    Scan { points: BODY.points.iter().map(by).collect(), triangles: BODY.triangles.clone() }
}

/// The body turned about up, counter-clockwise seen from above.
fn yawed(degrees: f64) -> Scan {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), degrees.to_radians());
    moved(|p| turn * p)
}

fn measured(scan: &Scan) -> Extraction {
    measured_by(scan, &Method::default())
}

fn measured_by(scan: &Scan, method: &Method) -> Extraction {
    extract_scan(scan, method).unwrap()
}

fn stature_mm(found: &Extraction) -> f64 {
    found.body.stature_mm.unwrap()
}

/// A level's figures: side, level, tape, contour and height, mm.
type Figures = (Side, Level, [f64; 3]);

fn figures(found: &Extraction) -> Vec<Figures> {
    let mut all = Vec::new();
    for leg in &found.legs {
        for at in &leg.landmarks {
            let lengths = [at.girth_tape_mm, at.girth_contour_mm, at.height_mm];
            all.push((leg.side, at.level, lengths));
        }
    }
    assert_eq!(all.len(), 12, "two legs of B, B1, C, D, G and Y");
    all
}

/// The same levels, with girths and heights that differ by no more than these limits, mm.
#[track_caller]
fn alike(found: &[Figures], expected: &[Figures], [girth_mm, height_mm]: [f64; 2]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert_eq!((&a.0, &a.1), (&b.0, &b.1));
        for (which, limit) in [girth_mm, girth_mm, height_mm].into_iter().enumerate() {
            let off = (a.2[which] - b.2[which]).abs();
            assert!(off <= limit, "{a:?} for {b:?}");
        }
    }
}

#[track_caller]
fn same(found: &Extraction) {
    alike(&figures(found), &figures(&PLAIN), SAME_MM);
}

/// Angle between two directions, degrees.
fn off_deg(a: f64, b: f64) -> f64 {
    ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs()
}

#[test]
fn a_mirrored_body_has_its_legs_swapped() {
    let plain = figures(&PLAIN);
    let b = |side: Side| {
        plain.iter().find(|(of, level, _)| *of == side && *level == Level::B).unwrap().2[0]
    };
    assert!((b(Side::Left) - b(Side::Right)).abs() > 1.0, "the legs must differ");
    let mirrored = Scan {
        points: BODY.points.iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect(),
        triangles: BODY.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    };
    let found = measured(&mirrored);
    let mut swapped = figures(&found);
    for (side, _, _) in &mut swapped {
        *side = side.other();
    }
    swapped.sort_by_key(|(side, level, _)| (*side, *level));
    alike(&swapped, &plain, [0.05, 0.05]);
    assert!(off_deg(found.body.facing_deg, -PLAIN.body.facing_deg) < 0.05);
    // Feature points are mirrored too: same places in their order, same angles.
    let angles = |of: &Extraction, side: Side| -> Vec<(Level, usize, f64)> {
        let leg = of.legs.iter().find(|leg| leg.side == side).unwrap();
        let points = leg.level_sections.iter().flat_map(|at| {
            let points = at.features.iter().enumerate();
            points.map(move |(index, point)| (at.level, index + 1, point.angle_deg))
        });
        points.collect()
    };
    for side in Side::BOTH {
        let (found, expected) = (angles(&found, side), angles(&PLAIN, side.other()));
        assert!(expected.len() >= 8 && found.len() == expected.len(), "{found:?} {expected:?}");
        for (f, e) in found.iter().zip(&expected) {
            assert!(f.0 == e.0 && f.1 == e.1 && off_deg(f.2, e.2) < 0.5, "{f:?} for {e:?}");
        }
    }
}

#[test]
fn a_turned_body_keeps_its_girths_and_sides_and_its_facing_turns() {
    for degrees in [37.0, -90.0, 180.0] {
        let found = measured(&yawed(degrees));
        same(&found);
        let expected = PLAIN.body.facing_deg + degrees;
        let found = found.body.facing_deg;
        assert!(off_deg(found, expected) < 0.2, "{found}° for {expected}°");
        assert!((-180.0..=180.0).contains(&found));
    }
}

#[test]
fn a_body_a_tenth_larger_has_girths_and_heights_a_tenth_larger() {
    let mut expected = figures(&PLAIN);
    expected.iter_mut().for_each(|(_, _, lengths)| *lengths = lengths.map(|length| 1.1 * length));
    let found = measured(&moved(|p| p * 1.1));
    // G is a fixed distance below the crotch, which does not grow with the body.
    let growing = |all: Vec<Figures>| all.into_iter().filter(|(_, level, _)| *level != Level::G);
    let (b1, extrema): (Vec<_>, Vec<_>) =
        growing(figures(&found)).partition(|(_, level, _)| *level == Level::B1);
    let (b1_expected, expected): (Vec<_>, Vec<_>) =
        growing(expected).partition(|(_, level, _)| *level == Level::B1);
    // Sections stay 5 mm apart, so the larger body is seen in finer steps.
    // The floor under unseen soles is told by a fixed radius of the foot's edge.
    // Girths agree within the error that a scan without noise may have.
    alike(&extrema, &expected, [0.3, 0.9]);
    // B1 is sought over a fixed 30 mm; its girth moves by 1.3 mm with each mm of its height.
    alike(&b1, &b1_expected, [4.0, 3.0]);
    let off_mm = stature_mm(&found) - 1.1 * stature_mm(&PLAIN);
    assert!(off_mm.abs() < 0.9, "{off_mm}");
}

#[test]
fn every_unit_gives_the_same_figures() {
    // A micrometre, as records write lengths, or a millionth.
    let is_same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b.abs() + 1.01e-3;
    let units = [(Unit::Mm, 1.0), (Unit::Cm, 10.0), (Unit::In, 25.4), (Unit::M, 1000.0)];
    for (unit, in_mm) in units {
        for choice in [UnitChoice::Auto, UnitChoice::Declared(unit)] {
            let method = Method { unit: choice, ..Method::default() };
            let found = measured_by(&moved(|p| p / in_mm), &method);
            assert_eq!(found.body.unit, unit);
            assert_eq!(found.body.unit_inferred, choice == UnitChoice::Auto);
            assert!(is_same(stature_mm(&found), stature_mm(&PLAIN)), "{unit:?}");
            for (a, b) in figures(&found).iter().zip(&figures(&PLAIN)) {
                assert_eq!((a.0, a.1), (b.0, b.1));
                let all_same = a.2.iter().zip(b.2).all(|(a, b)| is_same(*a, b));
                assert!(all_same, "{unit:?}: {a:?} for {b:?}");
            }
        }
    }
}

#[test]
fn a_unit_that_makes_no_person_is_refused() {
    let declared = UnitChoice::Declared(Unit::Cm);
    let method = Method { unit: declared, ..Method::default() };
    let refusal = extract_scan(&BODY, &method).unwrap_err();
    let Refusal::Body(BodyFault::UnitImplausible { unit: Unit::Cm, stature_mm }) = refusal else {
        panic!("{refusal:?}");
    };
    assert!((stature_mm / 16_020.0 - 1.0).abs() < 0.001, "{stature_mm}");
}

#[test]
fn z_up_and_x_up_exports_measure_alike_when_declared_and_are_refused_when_not() {
    // The same body with its front where `facing_deg` is counted from: −y and −z.
    let z_up = moved(|p| Point3::new(p.x, -p.z, p.y));
    let x_up = moved(|p| Point3::new(p.y, p.x, -p.z));
    for (scan, up) in [(z_up, Up::Z), (x_up, Up::X)] {
        let found = measured_by(&scan, &Method { up, ..Method::default() });
        same(&found);
        assert!(off_deg(found.body.facing_deg, PLAIN.body.facing_deg) < 0.05, "{up:?}");
        let refusal = extract_scan(&scan, &Method::default()).unwrap_err();
        assert!(matches!(refusal, Refusal::Body(_)), "{up:?}: {refusal:?}");
    }
}

#[test]
fn a_body_may_stand_anywhere() {
    for far in [Vector3::new(120.0, -250.0, 77.7), Vector3::new(-3e5, 2e5, 1e6)] {
        let found = measured(&moved(|p| p + far));
        same(&found);
        assert!((stature_mm(&found) - stature_mm(&PLAIN)).abs() < 0.01);
    }
}

#[test]
fn the_order_of_points_and_triangles_means_nothing() {
    let mut chance = Chance(7);
    let mut shuffled = |count: usize| {
        let mut order: Vec<u32> = (0..count as u32).collect();
        (1..count).rev().for_each(|i| order.swap(i, chance.below(i + 1)));
        order
    };
    for _ in 0..3 {
        let places = shuffled(BODY.points.len());
        let mut points = BODY.points.clone();
        for (point, place) in BODY.points.iter().zip(&places) {
            points[*place as usize] = *point;
        }
        let triangle = |which: u32| {
            let [a, b, c] = BODY.triangles[which as usize].map(|corner| places[corner as usize]);
            if which.is_multiple_of(3) { [b, c, a] } else { [a, b, c] }
        };
        let triangles = shuffled(BODY.triangles.len()).into_iter().map(triangle).collect();
        same(&measured(&Scan { points, triangles }));
    }
}

#[test]
fn flipping_every_triangle_changes_nothing_once_it_is_declared() {
    let triangles = BODY.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let flipped = Scan { points: BODY.points.clone(), triangles };
    same(&measured_by(&flipped, &Method { winding: Winding::Inward, ..Method::default() }));
}

#[test]
fn flipping_every_other_decimetre_changes_nothing() {
    let plain = scan("f_average_tc2");
    // The export is in centimetres.
    let is_even = |corner: u32| (plain.points[corner as usize].y / 10.0).floor() % 2.0 == 0.0;
    let flip = |&[a, b, c]: &[u32; 3]| if is_even(a) { [a, c, b] } else { [a, b, c] };
    let flipped = Scan {
        points: plain.points.clone(),
        triangles: plain.triangles.iter().map(flip).collect(),
    };
    let share = flipped.triangles.iter().zip(&plain.triangles).filter(|(a, b)| a != b).count();
    assert!(share > plain.triangles.len() / 4 && share < plain.triangles.len() * 3 / 4);
    alike(&figures(&measured(&flipped)), &figures(&measured(&plain)), SAME_MM);
}

#[test]
fn from_export_brings_a_point_of_the_export_to_where_the_surface_is() {
    // Inches, z up, turned and shifted: nothing about the export is the body's own.
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 1.2);
    let export =
        moved(|p| (turn * Point3::new(p.x, -p.z, p.y)) / 25.4 + Vector3::new(40.0, 9.0, -3.0));
    let method = Method { up: Up::Z, ..Method::default() };
    let found = measured_by(&export, &method);
    let map = found.body.from_export;
    assert_eq!(map.row(3), nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0));
    let linear = map.fixed_view::<3, 3>(0, 0).into_owned();
    assert!((linear.determinant() / 25.4_f64.powi(3) - 1.0).abs() < 1e-9, "right-handed, mm");
    assert!((linear * linear.transpose() / 25.4_f64.powi(2)).is_identity(1e-9), "no shear");

    let points: Vec<Point3<f64>> = export.points.iter().map(|p| map.transform_point(p)).collect();
    let lowest = points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let highest = points.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    // Soles are not seen; what is seen ends some millimetres above the floor.
    assert!((0.0..4.0).contains(&lowest), "the lowest skin is at {lowest} mm");
    assert!((highest - stature_mm(&found)).abs() < 1e-3, "the crown is at {highest} mm");

    for leg in &found.legs {
        let (surface, side) = (leg.surface.as_ref().unwrap(), leg.side.lateral_sign());
        let (low, high) = surface.surface.along().domain();
        let own = |p: &&Point3<f64>| {
            p.x * side > 0.0 && (low..high).contains(&leg.axis.along(p)) && p.z < 600.0
        };
        let mut count = 0;
        for point in points.iter().filter(own) {
            let along = leg.axis.along(point);
            let ring: Vec<Vector3<f64>> = (0..24)
                .map(|i| surface.surface.point(along, TAU * f64::from(i) / 24.0 - PI).coords)
                .collect();
            let middle = Point3::from(ring.iter().sum::<Vector3<f64>>() / 24.0);
            let arm = leg.axis.place(point).1 - leg.axis.place(&middle).1;
            let foot = surface.surface.closest(point, along, arm.y.atan2(arm.x));
            assert!(foot.distance_mm < 1.0, "{point} is {} mm off", foot.distance_mm);
            count += 1;
        }
        assert!(count > 2000, "{count} points");
    }
}

#[test]
fn two_runs_and_any_number_of_threads_give_the_same_to_the_last_bit() {
    let scan = scan("f_average_tc2");
    let all = || format!("{:?}", measured(&scan));
    let first = all();
    // Both as text are too long to be told.
    assert!(first == all(), "two runs");
    for threads in [1, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(first == pool.install(all), "{threads} threads");
    }
}
