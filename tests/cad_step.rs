//! STEP files of a tube and of its mirror image, read back by the few rules of ISO 10303-21.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use gaiter::cad::{StepHeader, step};
use gaiter::spline::{Basis, GridData, Surface, fit_grid};
use nalgebra::{Point3, Rotation3, Vector3};

const HEADER: StepHeader =
    StepHeader { file_name: "left.step", product: "left leg", time_stamp: "" };

/// What besides the points a file must hold, and how often.
const KINDS: [(&str, usize); 26] = [
    ("(GEOMETRIC_REPRESENTATION_CONTEXT", 1),
    ("(LENGTH_UNIT", 1),
    ("(NAMED_UNIT", 2),
    ("ADVANCED_FACE", 1),
    ("APPLICATION_CONTEXT", 1),
    ("APPLICATION_PROTOCOL_DEFINITION", 1),
    ("B_SPLINE_CURVE_WITH_KNOTS", 3),
    ("B_SPLINE_SURFACE_WITH_KNOTS", 1),
    ("CARTESIAN_POINT", 10 * 15),
    ("EDGE_CURVE", 3),
    ("EDGE_LOOP", 1),
    ("FACE_OUTER_BOUND", 1),
    ("MANIFOLD_SURFACE_SHAPE_REPRESENTATION", 1),
    ("OPEN_SHELL", 1),
    ("ORIENTED_EDGE", 4),
    ("PRODUCT", 1),
    ("PRODUCT_CONTEXT", 1),
    ("PRODUCT_DEFINITION", 1),
    ("PRODUCT_DEFINITION_CONTEXT", 1),
    ("PRODUCT_DEFINITION_FORMATION", 1),
    ("PRODUCT_DEFINITION_SHAPE", 1),
    ("SHAPE_DEFINITION_REPRESENTATION", 1),
    ("SHELL_BASED_SURFACE_MODEL", 1),
    ("UNCERTAINTY_MEASURE_WITH_UNIT", 1),
    ("VERTEX_POINT", 2),
    // Nothing else.
    ("", 0),
];

/// A conical tube of oval sections about an axis that leans and does not pass through the origin.
/// `turn` is +1 where v runs counter-clockwise seen from above, −1 for the mirror image.
fn tube(turn: f64) -> (Surface, impl Fn(f64, f64) -> Point3<f64>) {
    let lean = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.2)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), 0.15);
    let on_skin = move |share: f64, round: f64, radius: f64| {
        let (angle, radius) = (round * TAU - TAU / 4.0, radius * (30.0 + 25.0 * share));
        let upright = Vector3::new(1.1 * radius * angle.cos(), radius * angle.sin(), 340.0 * share);
        let placed = lean * upright + Vector3::new(150.0, -40.0, 98.0);
        Point3::new(turn * placed.x, placed.y, placed.z)
    };
    let along: Vec<f64> = (0..20).map(|i| f64::from(i) / 19.0).collect();
    let around: Vec<f64> = (0..36).map(|j| f64::from(j) / 36.0).collect();
    let places = along.iter().flat_map(|u| around.iter().map(move |v| (*u, *v)));
    let points: Vec<_> = places.map(|(u, v)| on_skin(u, v, 1.0)).collect();
    let data = GridData { along: &along, around: &around, points: &points };
    let bases = (
        Basis::uniform_clamped(0.0, 1.0, 7).unwrap(),
        Basis::uniform_periodic(0.0, 1.0, 12).unwrap(),
    );
    let surface = fit_grid(&data, bases.0, bases.1).unwrap().surface;
    (surface, move |u, v| on_skin(u, v, 0.0))
}

/// The instances of a file by number; a number given twice or a line out of place fails.
fn instances(file: &[u8]) -> BTreeMap<usize, String> {
    let text = std::str::from_utf8(file).unwrap();
    assert!(text.starts_with("ISO-10303-21;\nHEADER;\n"));
    assert!(text.ends_with("\nENDSEC;\nEND-ISO-10303-21;\n"));
    let data = text.split_once("DATA;\n").unwrap().1.split_once("ENDSEC;").unwrap().0;
    let mut found = BTreeMap::new();
    for instance in data.split_terminator(";\n") {
        let (number, entity) = instance.strip_prefix('#').unwrap().split_once('=').unwrap();
        let entity = entity.replace('\n', "");
        assert_eq!(found.insert(number.parse().unwrap(), entity), None, "#{number} twice");
    }
    found
}

fn kind(entity: &str) -> &str {
    let name = entity[1..].find('(').unwrap() + 1;
    &entity[..name]
}

/// The one instance of a kind.
fn only<'a>(instances: &'a BTreeMap<usize, String>, wanted: &str) -> &'a str {
    let found: Vec<_> = instances.values().filter(|entity| kind(entity) == wanted).collect();
    assert_eq!(found.len(), 1, "{wanted}");
    found[0]
}

/// The numbers behind each `#`.
fn references(entity: &str) -> Vec<usize> {
    let number = |rest: &str| rest.split(|c: char| !c.is_ascii_digit()).next().unwrap().parse();
    entity.split('#').skip(1).map(|rest| number(rest).unwrap()).collect()
}

/// The numbers in the innermost parentheses, list by list; lists of other things are left out.
fn number_lists(entity: &str) -> Vec<Vec<f64>> {
    let inner = entity.split('(').filter_map(|part| part.split_once(')')).map(|(list, _)| list);
    inner.filter_map(|list| list.split(',').map(|n| n.parse().ok()).collect()).collect()
}

fn knots(multiplicities: &[f64], values: &[f64]) -> Vec<f64> {
    assert_eq!(multiplicities.len(), values.len());
    let pairs = multiplicities.iter().zip(values);
    pairs.flat_map(|(times, value)| vec![*value; *times as usize]).collect()
}

#[test]
fn every_entity_is_there_once_and_every_reference_leads_to_one() {
    for turn in [1.0, -1.0] {
        let instances = instances(&step::tube(&tube(turn).0, &HEADER));
        let mut kinds: BTreeMap<&str, usize> = KINDS.into_iter().collect();
        for entity in instances.values() {
            let left = kinds.get_mut(kind(entity));
            *left.unwrap_or_else(|| panic!("unexpected {entity}")) -= 1;
        }
        assert!(kinds.values().all(|left| *left == 0), "{kinds:?}");
        assert_eq!(instances.len() - 150, 33);
        assert_eq!(instances.keys().copied().collect::<Vec<_>>(), Vec::from_iter(1..=183));
        for (number, entity) in &instances {
            assert!(references(entity).iter().all(|to| instances.contains_key(to)), "{entity}");
            let users = instances.values().filter(|e| references(e).contains(number)).count();
            // Only the roots stand for themselves.
            let root = ["APPLICATION_PROTOCOL_DEFINITION", "SHAPE_DEFINITION_REPRESENTATION"];
            assert_eq!(users == 0, root.contains(&kind(entity)), "#{number} {entity}");
        }
    }
}

#[test]
fn numbers_read_back_as_they_were() {
    for turn in [1.0, -1.0] {
        let surface = tube(turn).0;
        let instances = instances(&step::tube(&surface, &HEADER));
        let entity = only(&instances, "B_SPLINE_SURFACE_WITH_KNOTS");
        let (around, control_points) = surface.clamped_around();
        let [u_times, v_times, u, v] = &number_lists(entity)[..] else { panic!("{entity}") };
        assert_eq!(knots(u_times, u), surface.along().knots());
        assert_eq!(knots(v_times, v), around);
        let point = |number: &usize| number_lists(&instances[number]).remove(0);
        let points: Vec<_> = references(entity).iter().map(point).collect();
        assert_eq!(points.len(), control_points.len());
        for (found, expected) in points.iter().zip(&control_points) {
            let found = Point3::from_slice(found);
            assert!((found - expected).norm() < 1e-9, "{found} {expected}");
        }
    }
}

#[test]
fn every_real_has_a_decimal_point() {
    let instances = instances(&step::tube(&tube(1.0).0, &HEADER));
    let points = instances.values().filter(|entity| kind(entity) == "CARTESIAN_POINT");
    let mut reals: Vec<&str> =
        points.flat_map(|p| p.split(['(', ')']).nth(2).unwrap_or_default().split(',')).collect();
    for entity in instances.values().filter(|entity| kind(entity).starts_with("B_SPLINE")) {
        // The knots, last of the lists: everything but the last word.
        reals.extend(entity.rsplit(['(', ')']).nth(2).unwrap_or_default().split(','));
    }
    assert!(reals.len() > 450, "{}", reals.len());
    for real in reals {
        assert!(real.contains('.') && real.parse::<f64>().is_ok(), "{real}");
        assert!(real.starts_with(|c: char| c == '-' || c.is_ascii_digit()), "{real}");
        assert!(!real.contains('e'), "{real}");
    }
}

#[test]
fn the_edges_are_the_surface_s_own_ends_and_seam() {
    let instances = instances(&step::tube(&tube(-1.0).0, &HEADER));
    let net = references(only(&instances, "B_SPLINE_SURFACE_WITH_KNOTS"));
    let curves: Vec<_> =
        instances.values().filter(|e| kind(e) == "B_SPLINE_CURVE_WITH_KNOTS").collect();
    let seam: Vec<usize> = net.iter().step_by(15).copied().collect();
    let expected = [(&net[..15], ".T."), (&net[135..], ".T."), (&seam[..], ".F.")];
    for (curve, (points, closed)) in curves.iter().zip(expected) {
        assert_eq!(references(curve), points);
        assert!(curve.contains(&format!(".UNSPECIFIED.,{closed},.F.,")), "{curve}");
    }
    let ends = instances.values().filter(|e| kind(e) == "VERTEX_POINT");
    assert_eq!(ends.flat_map(|e| references(e)).collect::<Vec<_>>(), [net[0], net[135]]);
}

#[test]
fn the_face_points_outward_whichever_way_the_surface_is_turned() {
    let mut seen = Vec::new();
    for turn in [1.0, -1.0] {
        let (surface, axis) = tube(turn);
        let instances = instances(&step::tube(&surface, &HEADER));
        let senses = ["ADVANCED_FACE", "FACE_OUTER_BOUND"].map(|kind| only(&instances, kind));
        let same_sense = senses[0].ends_with(".T.)");
        assert_eq!(senses[1].ends_with(".T.)"), same_sense);
        for (u, v) in [(0.0, 0.1), (0.3, 0.4), (0.7, 0.6), (1.0, 0.9)] {
            let at = surface.derivatives(u, v);
            let normal = at.du.cross(&at.dv) * if same_sense { 1.0 } else { -1.0 };
            assert!(normal.dot(&(at.point - axis(u, v))) > 0.0, "turn {turn}, {u} {v}");
        }
        seen.push(same_sense);
    }
    assert_eq!(seen, [false, true]);
}

#[test]
fn the_same_surface_gives_the_same_bytes() {
    let file = step::tube(&tube(1.0).0, &HEADER);
    assert_eq!(file, step::tube(&tube(1.0).0, &HEADER));
    let header = String::from_utf8(file).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let name =
        format!("FILE_NAME('left.step','',(''),(''),'gaiter {version}','gaiter {version}','');\n");
    assert!(header.contains(&name), "{header:.400}");
}

#[test]
fn a_name_cannot_break_the_file() {
    let name = "left';\nEND-ISO-10303-21;";
    let header = StepHeader { file_name: name, product: name, time_stamp: "2026-11-21T09:15:00Z" };
    let file = step::tube(&tube(1.0).0, &header);
    assert_eq!(instances(&file).len(), 183);
    assert!(String::from_utf8(file).unwrap().contains("'2026-11-21T09:15:00Z'"));
}
