//! What is there is measured: legs whose toes are missing, the sound leg beside a prosthesis.

#![allow(clippy::unwrap_used, clippy::panic)]

use gaiter_leg::method::{Axis, FacingChoice};
use gaiter_leg::{BodyFault, Extraction, LegReport, Level, Method, Refusal, Side};
use support::chance::Chance;
use support::mesh::Mesh;
use support::recorded::extract_scan;

/// How many are drawn of each kind.
const DRAWS: u64 = 20;

/// The fixtures' bodies that are exported in mm; in all of them the toes point to +z.
const BODIES: [&str; 2] = ["f_average_clean", "m_average_clean"];

fn measured(mesh: &Mesh, told: &str) -> Extraction {
    let found = extract_scan(&mesh.scan(), &Method::default());
    found.unwrap_or_else(|fault| panic!("{told}: {fault}"))
}

fn has(found: &Extraction, code: &str) -> bool {
    found.findings.iter().any(|finding| finding.code() == code)
}

/// B, C and D of a leg are those of the whole body's leg.
fn assert_same(own: &LegReport, whole: &Extraction, told: &str) {
    let whole = whole.legs.iter().find(|leg| leg.side == own.side).unwrap();
    for level in [Level::B, Level::C, Level::D] {
        let [own, whole] = [own, whole]
            .map(|leg| leg.landmarks.iter().find(|landmark| landmark.level == level).unwrap());
        let off_mm = own.girth_tape_mm - whole.girth_tape_mm;
        let allowed_mm = 0.5 + own.girth_of_level_sd_mm;
        assert!(off_mm.abs() < allowed_mm, "{told}: {:?} {level:?} {off_mm}", own.girth_sd_mm);
    }
}

/// A body without its toes, turned: the feet end at a drawn distance before the ankles.
fn without_toes(body: &str, chance: &mut Chance) -> (Mesh, String) {
    let (ends_mm, [left, right]) =
        (50.0 + 50.0 * chance.unit(), [chance.even(15.0), chance.even(15.0)]);
    let turn_deg = 360.0 * chance.unit();
    let is_there =
        |[x, y, z]: [f64; 3]| y > 90.0 || z < ends_mm + if x > 0.0 { left } else { right };
    let mesh = Mesh::body(body).kept(is_there).turned(turn_deg);
    (mesh, format!("{body}, feet end at {ends_mm}, {left}, {right}, turned by {turn_deg}"))
}

#[test]
fn legs_without_toes_are_measured_and_left_is_left() {
    for body in BODIES {
        let whole = measured(&Mesh::body(body), body);
        let mut by_calves = 0;
        for seed in 0..DRAWS {
            let (mesh, told) = without_toes(body, &mut Chance(seed));
            let found = measured(&mesh, &told);
            assert_eq!(found.legs.len(), 2, "{told}");
            found.legs.iter().for_each(|leg| assert_same(leg, &whole, &told));
            by_calves += u32::from(has(&found, "facing-by-calves"));
        }
        assert!(by_calves > 5, "{body}: {by_calves} of {DRAWS} feet do not tell");
    }
}

#[test]
fn a_declared_facing_that_the_calves_contradict_is_refused() {
    let is_there = |[_, y, z]: [f64; 3]| y > 90.0 || z < 40.0;
    let mesh = Mesh::body("f_average_clean").kept(is_there);
    let declared = |axis| {
        let method = Method { facing: FacingChoice::Declared(axis), ..Method::default() };
        extract_scan(&mesh.scan(), &method)
    };
    assert!(declared(Axis::PlusZ).is_ok());
    let fault = declared(Axis::MinusZ).unwrap_err();
    let is_contradicted = matches!(fault, Refusal::Body(BodyFault::FacingContradicted { off_deg }) if off_deg > 150.0);
    assert!(is_contradicted, "{fault}");
}

/// A body with a prosthesis below a knee: a socket on the stump, a pylon, a shoe.
fn with_prosthesis(body: &str, side: Side, chance: &mut Chance) -> (Mesh, String) {
    let sign = if side == Side::Left { 1.0 } else { -1.0 };
    let (cut_mm, socket_mm) = (260.0 + 70.0 * chance.unit(), 60.0 + 40.0 * chance.unit());
    let (pylon_mm, wide_mm) = (10.0 + 6.0 * chance.unit(), 48.0 + 12.0 * chance.unit());
    let whole = Mesh::body(body);
    let own = |p: &&[f64; 3]| p[0] * sign > 10.0;
    let near = |y: f64| {
        let ring: Vec<_> =
            whole.points.iter().filter(own).filter(|p| (p[1] - y).abs() < 8.0).collect();
        [0, 2].map(|axis| ring.iter().map(|p| p[axis]).sum::<f64>() / ring.len() as f64)
    };
    let (knee, foot) = (near(cut_mm), near(100.0));
    let shoe = Mesh::cuboid([40.0, 115.0], 0.0, 45.0)
        .moved(|[x, y, z]| [x + foot[0], y, z + foot[1] + 60.0]);
    let pylon = Mesh::column(foot, pylon_mm, 40.0, cut_mm - socket_mm);
    let pylon = pylon.moved(|[x, y, z]| {
        let share = (y - 40.0) / (cut_mm - 40.0);
        [x + share * (knee[0] - foot[0]), y, z + share * (knee[1] - foot[1])]
    });
    let socket = Mesh::column(knee, wide_mm, cut_mm - socket_mm, cut_mm + 10.0);
    let stump = whole.kept(|[x, y, _]| x * sign < 10.0 || y > cut_mm);
    let told = format!("{body}, {side:?} cut at {cut_mm}, socket {socket_mm}, pylon {pylon_mm}");
    (stump.and(shoe).and(pylon).and(socket), told)
}

#[test]
fn the_sound_leg_beside_a_prosthesis_is_measured_as_itself() {
    for body in BODIES {
        let whole = measured(&Mesh::body(body), body);
        for seed in 0..DRAWS {
            let mut chance = Chance(seed);
            let side = if chance.below(2) == 0 { Side::Left } else { Side::Right };
            let (mesh, told) = with_prosthesis(body, side, &mut chance);
            let found = measured(&mesh, &told);
            let sides: Vec<Side> = found.legs.iter().map(|leg| leg.side).collect();
            assert_eq!(sides, [side.other()], "{told}");
            assert_same(&found.legs[0], &whole, &told);
            assert!(has(&found, "leg-not-measured"), "{told}");
        }
    }
}
