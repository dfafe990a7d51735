//! The paper's own construction on the recorded bodies: its laws, and how near the truth it comes.

#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;
use std::sync::LazyLock;

use gaiter_leg::frame::body::body;
use gaiter_leg::method::{AxisFit, SectionFit, Tape};
use gaiter_leg::parting::segment::{Leg, segment};
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::sections::equidistant::{Sections, sections};
use gaiter_leg::sections::slice::Mesh;
use gaiter_leg::side::Sides;
use gaiter_leg::{Extraction, Level, Method, Side};
use gaiter_scan::Scan;
use nalgebra::{Point3, Rotation3, Vector3};
use support::recorded::{export, extract_scan, scan, truth};
use support::solids::principal_axis;

use crate::found::{B_C_D, extraction_of, landmark};

/// The paper's own axis.
const PRINCIPAL: Tape = Tape::Leg(AxisFit::Principal);

/// The paper's sections in these planes.
fn paper(tape: Tape) -> Method {
    Method { fit: SectionFit::Paper, tape, ..Method::default() }
}

/// The body that the laws are tried on.
static BODY: LazyLock<Scan> = LazyLock::new(|| scan("f_average_clean"));

fn measured(scan: &Scan) -> Extraction {
    extract_scan(scan, &paper(PRINCIPAL)).unwrap()
}

/// What the paper measures on it.
static PLAIN: LazyLock<Extraction> = LazyLock::new(|| measured(&BODY));

/// Its legs, and their crotch's height in mm.
static LEGS: LazyLock<(Sides<Leg>, f64)> = LazyLock::new(|| {
    let cut = segment(&body(&BODY, &Method::default()).unwrap()).unwrap();
    let legs = Sides { left: cut.legs.left.unwrap(), right: cut.legs.right.unwrap() };
    (legs, cut.crotch.height_mm)
});

fn moved(by: impl Fn(&Point3<f64>) -> Point3<f64>) -> Scan {
    Scan { points: BODY.points.iter().map(by).collect(), triangles: BODY.triangles.clone() }
}

/// A level's figures: side, level, tape girth, contour and height, mm.
type Figures = (Side, Level, [f64; 3]);

fn figures(found: &Extraction) -> Vec<Figures> {
    let mut all = Vec::new();
    for leg in &found.legs {
        // G is measured from the crotch and Y on the foot, by no step of the paper.
        for at in leg.landmarks.iter().filter(|at| ![Level::G, Level::Y].contains(&at.level)) {
            let lengths = [at.girth_tape_mm, at.girth_contour_mm, at.height_mm];
            all.push((leg.side, at.level, lengths));
        }
    }
    assert_eq!(all.len(), 8, "two legs of four levels");
    all
}

/// The same levels with the same figures but for rounding.
#[track_caller]
fn same(found: &[Figures]) {
    for (a, b) in found.iter().zip(figures(&PLAIN)) {
        assert_eq!((a.0, a.1), (b.0, b.1));
        let is_same = a.2.iter().zip(b.2).all(|(x, y)| (x - y).abs() <= 0.02);
        assert!(is_same, "{a:?} for {b:?}");
    }
}

#[test]
fn a_turned_body_keeps_its_girths_and_heights() {
    for degrees in [37.0_f64, -90.0, 180.0] {
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), degrees.to_radians());
        same(&figures(&measured(&moved(|p| turn * p))));
    }
}

#[test]
fn a_mirrored_body_has_its_legs_swapped() {
    let mirrored = Scan {
        points: BODY.points.iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect(),
        triangles: BODY.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    };
    let mut swapped = figures(&measured(&mirrored));
    for (side, _, _) in &mut swapped {
        *side = side.other();
    }
    swapped.sort_by_key(|(side, level, _)| (*side, *level));
    same(&swapped);
}

/// The paper's sections of a leg between 60 mm and the crotch, lengths times `scale`.
fn sections_of(leg: &Leg, axis: LegAxis, scale: f64) -> Sections {
    sections(leg, axis, [60.0 * scale, LEGS.1 * scale], SectionFit::Paper).unwrap()
}

#[test]
fn a_leg_twice_as_large_has_sections_twice_as_large_at_twice_the_height() {
    for leg in [&LEGS.0.left, &LEGS.0.right] {
        let points = leg.mesh.points().iter().map(|p| p * 2.0).collect();
        let large = Leg {
            side: leg.side,
            mesh: Mesh::new(points, leg.mesh.triangles().to_vec()),
            cut_mm: None,
        };
        let axes = [(leg, LEGS.1), (&large, 2.0 * LEGS.1)];
        let [own, large_own] = axes.map(|(leg, crotch)| principal_axis(leg, crotch).unwrap());
        let along: Vec<f64> = (0..60).map(|i| 80.0 + 10.0 * f64::from(i)).collect();
        let twice: Vec<f64> = along.iter().map(|along| 2.0 * along).collect();
        let found = sections_of(&large, large_own, 2.0).at(&large, &twice);
        let plain = sections_of(leg, own, 1.0).at(leg, &along);
        let mut closed = 0;
        for (large, plain) in found.iter().zip(&plain) {
            let (Some(large), Some(plain)) = (large, plain) else {
                assert!(large.is_none() && plain.is_none());
                continue;
            };
            assert_eq!(large.points, plain.points);
            assert!((large.girth.tape_mm - 2.0 * plain.girth.tape_mm).abs() < 1e-6);
            closed += 1;
        }
        assert!(closed > 40, "only {closed} sections close");
    }
}

#[test]
fn triangles_mean_nothing_to_the_paper() {
    let leg = &LEGS.0.right;
    let bare =
        Leg { side: leg.side, mesh: Mesh::cloud(leg.mesh.points().to_vec(), 6.0), cut_mm: None };
    let [own, bare_own] = [leg, &bare].map(|leg| principal_axis(leg, LEGS.1).unwrap());
    assert_eq!(own.foot, bare_own.foot);
    let girths = |sections: Sections| -> Vec<Option<f64>> {
        let rows = sections.rows.into_iter();
        rows.map(|row| row.section.map(|section| section.girth.tape_mm)).collect()
    };
    let plain = girths(sections_of(leg, own, 1.0));
    assert!(plain.iter().flatten().count() > 100);
    assert_eq!(girths(sections_of(&bare, bare_own, 1.0)), plain);
}

/// How far the paper's tape girths and heights may be off on clean bodies, mm, in our planes:
/// several times what the skin's are (truth.rs).
const IN_OUR_PLANES_MM: [f64; 2] = [6.0, 12.0];

/// … and on its own, which the foot pulls over by 10°: sections are cut obliquely, and which point
/// at the crotch is whose moves the ankle by centimetres.
const ON_ITS_AXIS_MM: [f64; 2] = [10.0, 30.0];

#[test]
fn the_paper_finds_the_ankle_of_clean_bodies_and_in_our_planes_the_calf_and_the_knee_of_one() {
    let cases = [
        ("f_average_clean", PRINCIPAL, &[Level::B][..], ON_ITS_AXIS_MM),
        ("m_average_clean", PRINCIPAL, &[Level::B], ON_ITS_AXIS_MM),
        ("f_average_clean", Tape::Shank, &B_C_D, IN_OUR_PLANES_MM),
        // On its left leg a swing of the polynomial is taken for the calf.
        ("m_average_clean", Tape::Shank, &[Level::B], IN_OUR_PLANES_MM),
    ];
    for (name, tape, levels, [girth_mm, height_mm]) in cases {
        let found = extraction_of(&export(name), &paper(tape));
        let truth = truth(name);
        for (leg, level) in found.legs.iter().flat_map(|leg| levels.iter().map(move |l| (leg, *l)))
        {
            let (found, side, level) = (landmark(leg, level), leg.side.word(), level.name());
            let true_level = &truth["legs"][side]["landmarks"][level];
            let girth_off = found.girth_tape_mm - true_level["tape_mm"].as_f64().unwrap();
            let height_off = found.height_mm - true_level["height_mm"].as_f64().unwrap();
            let what = format!("{name} {tape:?} {side} {level}: {girth_off} {height_off}");
            assert!(girth_off.abs() < girth_mm && height_off.abs() < height_mm, "{what}");
        }
    }
}

#[test]
fn the_foot_pulls_the_principal_axis_aside_and_the_polynomial_is_open_at_the_back() {
    let centroids = extract_scan(&BODY, &paper(Tape::Leg(AxisFit::Centroids))).unwrap();
    for (leg, ours) in PLAIN.legs.iter().zip(&centroids.legs) {
        let off_deg = leg.axis.foot.normal.angle(&ours.axis.foot.normal).to_degrees();
        assert!((5.0..15.0).contains(&off_deg), "{off_deg}° apart");
        // The toes lie ahead of the leg, low down: the axis leans back towards its top.
        assert!(leg.axis.foot.normal.y > ours.axis.foot.normal.y + 0.1);
        let step = |at: &gaiter_leg::LevelSection| {
            at.section.curve.radius(PI) - at.section.curve.radius(-PI)
        };
        let steps: Vec<f64> = leg.level_sections.iter().map(step).collect();
        assert!(steps.iter().any(|step| step.abs() > 0.1), "{steps:?}");
    }
}
