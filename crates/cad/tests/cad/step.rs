//! STEP files of a tube, of the solid within it and of their mirror images, read back by the few
//! rules of ISO 10303-21.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;

use gaiter_cad::{End, EndNotPlane, FileHeader, Schema, Shape, ends, step};
use gaiter_spline::Surface;
use nalgebra::{Point3, Vector3};
use support::tubes::{dented, tube};

use crate::HEADER;

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

/// What a solid has besides, or more of.
const CAPS: [(&str, usize); 12] = [
    ("ADVANCED_BREP_SHAPE_REPRESENTATION", 1),
    ("ADVANCED_FACE", 2),
    ("AXIS2_PLACEMENT_3D", 2),
    ("CARTESIAN_POINT", 2),
    ("CLOSED_SHELL", 1),
    ("DIRECTION", 4),
    ("EDGE_LOOP", 2),
    ("FACE_OUTER_BOUND", 2),
    ("MANIFOLD_SOLID_BREP", 1),
    ("ORIENTED_EDGE", 2),
    ("PLANE", 2),
    ("PRODUCT_RELATED_PRODUCT_CATEGORY", 0),
];

/// What a solid has not.
const OPEN: [&str; 3] =
    ["MANIFOLD_SURFACE_SHAPE_REPRESENTATION", "OPEN_SHELL", "SHELL_BASED_SURFACE_MODEL"];

const SHAPES: [Shape; 2] = [Shape::Tube, Shape::Solid];
const SCHEMAS: [Schema; 2] = [Schema::Ap214, Schema::Ap242];

/// How often each kind of instance stands in a file, all of them that may stand there.
fn kinds(shape: Shape, schema: Schema) -> BTreeMap<&'static str, usize> {
    let mut kinds: BTreeMap<_, usize> = KINDS.into_iter().collect();
    if shape == Shape::Solid {
        CAPS.into_iter().for_each(|(kind, more)| *kinds.entry(kind).or_default() += more);
        OPEN.into_iter().for_each(|kind| *kinds.get_mut(kind).unwrap() = 0);
    }
    if schema == Schema::Ap242 {
        kinds.insert("PRODUCT_RELATED_PRODUCT_CATEGORY", 1);
    }
    kinds
}

fn file(surface: &Surface, shape: Shape) -> Vec<u8> {
    step::write(surface, shape, Schema::Ap214, &HEADER).unwrap()
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
    for (turn, shape, schema) in combinations() {
        let file = step::write(&tube(turn).0, shape, schema, &HEADER).unwrap();
        let instances = instances(&file);
        let mut kinds = kinds(shape, schema);
        let count: usize = kinds.values().sum();
        for entity in instances.values() {
            let left = kinds.get_mut(kind(entity));
            *left.unwrap_or_else(|| panic!("unexpected {entity}")) -= 1;
        }
        assert!(kinds.values().all(|left| *left == 0), "{kinds:?}");
        assert_eq!(instances.keys().copied().collect::<Vec<_>>(), Vec::from_iter(1..=count));
        for (number, entity) in &instances {
            assert!(references(entity).iter().all(|to| instances.contains_key(to)), "{entity}");
            let users = instances.values().filter(|e| references(e).contains(number)).count();
            // Only the roots stand for themselves.
            let root = [
                "APPLICATION_PROTOCOL_DEFINITION",
                "SHAPE_DEFINITION_REPRESENTATION",
                "PRODUCT_RELATED_PRODUCT_CATEGORY",
            ];
            assert_eq!(users == 0, root.contains(&kind(entity)), "#{number} {entity}");
        }
    }
}

/// Both hands, both shapes, both schemas.
fn combinations() -> impl Iterator<Item = (f64, Shape, Schema)> {
    let pairs = SHAPES.into_iter().flat_map(|shape| SCHEMAS.map(|schema| (shape, schema)));
    pairs.flat_map(|(shape, schema)| [1.0, -1.0].map(|turn| (turn, shape, schema)))
}

#[test]
fn a_tube_under_ap214_has_33_instances_besides_its_points() {
    assert_eq!(instances(&file(&tube(1.0).0, Shape::Tube)).len(), 33 + 150);
}

#[test]
fn each_schema_is_named_in_the_header_and_by_its_application() {
    let said = [
        ("AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }", "'automotive_design',2000,"),
        (
            "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
            "'ap242_managed_model_based_3d_engineering',2014,",
        ),
    ];
    for (schema, (identifier, protocol)) in SCHEMAS.into_iter().zip(said) {
        let file = step::write(&tube(1.0).0, Shape::Solid, schema, &HEADER).unwrap();
        let text = String::from_utf8(file.clone()).unwrap();
        assert!(text.contains(&format!("FILE_SCHEMA(('{identifier}'));\n")), "{text:.500}");
        assert!(only(&instances(&file), "APPLICATION_PROTOCOL_DEFINITION").contains(protocol));
    }
}

#[test]
fn numbers_read_back_as_they_were() {
    for turn in [1.0, -1.0] {
        let surface = tube(turn).0;
        let instances = instances(&file(&surface, Shape::Tube));
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
    let instances = instances(&file(&tube(1.0).0, Shape::Tube));
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
    let instances = instances(&file(&tube(-1.0).0, Shape::Tube));
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
        let instances = instances(&file(&surface, Shape::Tube));
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
    let written = file(&tube(1.0).0, Shape::Solid);
    assert_eq!(written, file(&tube(1.0).0, Shape::Solid));
    let header = String::from_utf8(written).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let name =
        format!("FILE_NAME('left.step','',(''),(''),'gaiter {version}','gaiter {version}','');\n");
    assert!(header.contains(&name), "{header:.400}");
}

#[test]
fn a_name_cannot_break_the_file() {
    let name = "left';\nEND-ISO-10303-21;";
    let header = FileHeader { file_name: name, product: name };
    let file = step::write(&tube(1.0).0, Shape::Tube, Schema::Ap214, &header).unwrap();
    assert_eq!(instances(&file).len(), 183);
}

/// The faces with the edges on their loops as they are run in the end, seen from outside: whether
/// along the edge's own way. Senses of the bound and of the face both turn a loop.
fn loops(instances: &BTreeMap<usize, String>) -> Vec<(String, Vec<(usize, bool)>)> {
    let turns = |entity: &str| entity.ends_with(".F.)");
    let faces = instances.values().filter(|entity| kind(entity) == "ADVANCED_FACE");
    let round = |face: &String| {
        let [bound, surface] = references(face)[..] else { panic!("{face}") };
        let bound = &instances[&bound];
        let sides = references(&instances[&references(bound)[0]]);
        // The bound's sense is relative to the face, whose own normal is outward already.
        let side = |side: &usize| {
            let side = &instances[side];
            (references(side)[0], turns(side) == turns(bound))
        };
        (instances[&surface].clone(), sides.iter().map(side).collect())
    };
    faces.map(round).collect()
}

#[test]
fn faces_of_a_solid_run_along_their_edges_in_opposite_ways() {
    for (turn, schema) in [(1.0, Schema::Ap214), (-1.0, Schema::Ap242)] {
        let file = step::write(&tube(turn).0, Shape::Solid, schema, &HEADER).unwrap();
        let mut ways: BTreeMap<usize, Vec<bool>> = BTreeMap::new();
        for (edge, way) in loops(&instances(&file)).into_iter().flat_map(|(_, round)| round) {
            ways.entry(edge).or_default().push(way);
        }
        assert_eq!(ways.len(), 3);
        assert!(ways.values().all(|ways| ways.len() == 2 && ways[0] != ways[1]), "{ways:?}");
    }
}

#[test]
fn caps_face_out_of_the_tube_and_their_loops_turn_left_around_their_normals() {
    for turn in [1.0, -1.0] {
        let (surface, axis) = tube(turn);
        let instances = instances(&file(&surface, Shape::Solid));
        let numbers =
            |number: &usize| Vector3::from_vec(number_lists(&instances[number]).remove(0));
        let mut seen = 0;
        for (plane, round) in loops(&instances).iter().filter(|(on, _)| kind(on) == "PLANE") {
            let axes = references(&instances[&references(plane)[0]]);
            let [place, outward, across] = [0, 1, 2].map(|i| numbers(&axes[i]));
            let way = (axis(1.0, 0.0) - axis(0.0, 0.0)).normalize();
            let upper = (place - axis(1.0, 0.0).coords).norm() < 1e-3;
            assert!((outward.dot(&way) - if upper { 1.0 } else { -1.0 }).abs() < 1e-9, "{outward}");
            assert!(outward.dot(&across).abs() < 1e-12);

            let [(edge, own_way)] = round[..] else { panic!("{round:?}") };
            let curve = *references(&instances[&edge]).last().unwrap();
            let ring: Vec<_> = references(&instances[&curve]).iter().map(numbers).collect();
            assert!(ring.iter().all(|point| (point - place).dot(&outward).abs() < 1e-6));
            let area: Vector3<f64> =
                ring.windows(2).map(|pair| (pair[0] - place).cross(&(pair[1] - place))).sum();
            assert_eq!(area.dot(&outward) > 0.0, own_way, "turn {turn}, upper {upper}");
            seen += 1;
        }
        assert_eq!(seen, 2);
    }
}

#[test]
fn a_solid_has_plane_ends_or_a_reason_and_a_tube_needs_none() {
    let (surface, axis) = tube(1.0);
    let along = (axis(1.0, 0.0) - axis(0.0, 0.0)).normalize();
    let last = surface.control_points().len() - 1;
    for (point, end, far) in
        [(3, End::First, 1e-3), (last, End::Last, 1e-3), (last, End::Last, 1e-5)]
    {
        let dented = dented(&surface, point, along * far);
        let fault = step::write(&dented, Shape::Solid, Schema::Ap214, &HEADER).unwrap_err();
        let EndNotPlane { end: found, off_mm } = fault;
        // The others give way a little.
        assert!(found == end && off_mm > 0.7 * far && off_mm < far, "{fault}");
        assert!(step::write(&dented, Shape::Tube, Schema::Ap214, &HEADER).is_ok());
    }
    let dented = dented(&surface, 3, along * 0.5 * ends::PLANE_MM);
    assert!(step::write(&dented, Shape::Solid, Schema::Ap214, &HEADER).is_ok());
}
