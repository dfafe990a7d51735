//! Every scan that is no whole person standing as declared ends in its named refusal, through the
//! library and through the real program; things around a body change nothing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::Command;

use gaiter_leg::method::Scope;
use gaiter_leg::{self as leg, Extraction, Level, Method, Side};
use gaiter_scan::Format;
use rig::refusal::{case, check, declared, method};
use support::mesh::{Mesh, Ring};

#[test]
fn a_thing_that_is_no_body_is_refused() {
    let pair = |half_gap: f64| {
        let column = |x: f64| Mesh::column([x, 0.0], 60.0, 0.0, 1700.0);
        column(half_gap).and(column(-half_gap))
    };
    let leg = |x: f64, z: f64| Mesh::column([x, z], 25.0, 0.0, 450.0);
    let chair = Mesh::cuboid([250.0, 250.0], 450.0, 500.0)
        .and(Mesh::cuboid([250.0, 30.0], 500.0, 1100.0))
        .and(leg(200.0, 200.0))
        .and(leg(-200.0, 200.0))
        .and(leg(200.0, -200.0))
        .and(leg(-200.0, -200.0));
    let trestle = Mesh::column([100.0, 0.0], 60.0, 0.0, 850.0)
        .and(Mesh::column([-100.0, 0.0], 60.0, 0.0, 850.0))
        .and(Mesh::cuboid([170.0, 90.0], 830.0, 1700.0));
    let flat = Mesh::mannequin().moved(|[x, y, _]| [x, y, 0.0]);
    check(&[
        case("sphere", Mesh::sphere(1700.0).obj(), "body-not-two-legs", &["0 of 8", "0 at most"]),
        case(
            "box",
            Mesh::cuboid([250.0, 150.0], 0.0, 1700.0).obj(),
            "body-not-two-legs",
            &["0 of 8", "0 at most"],
        ),
        case(
            "one tube",
            Mesh::column([0.0; 2], 60.0, 0.0, 1700.0).obj(),
            "body-facing-unclear",
            &["not a foot"],
        ),
        case("chair", chair.obj(), "body-not-two-legs", &["0 of 8", "4 at most"]),
        case("flat", flat.obj(), "body-not-two-legs", &["0 of 8", "0 at most"]),
        case("two tubes", pair(100.0).obj(), "body-facing-unclear", &["not a foot"]),
        declared(
            case("two tubes, declared", pair(100.0).obj(), "body-facing-unclear", &["not a foot"]),
            &["--facing=+z"],
        ),
        case("trestle", trestle.obj(), "body-facing-unclear", &["not a foot"]),
    ]);
}

#[test]
fn a_part_of_a_body_is_refused() {
    let body = Mesh::body("f_average_clean");
    let part = |keeps: &dyn Fn([f64; 3]) -> bool| body.clone().kept(keeps).obj();
    check(&[
        case("lower half", part(&|p| p[1] < 750.0), "body-no-plausible-unit", &["752.2"]),
        case("upper half", part(&|p| p[1] > 850.0), "body-no-plausible-unit", &["759.0"]),
        case("from the knee up", part(&|p| p[1] > 450.0), "body-facing-unclear", &["not a foot"]),
        declared(
            case(
                "from the shin up, declared",
                part(&|p| p[1] > 120.0),
                "body-facing-unclear",
                &["not a foot"],
            ),
            &["--facing=+z"],
        ),
        case("left half", part(&|p| p[0] > 0.0), "body-side-unclear", &["only one leg"]),
        case("right half", part(&|p| p[0] < 0.0), "body-side-unclear", &["only one leg"]),
        case("back half", part(&|p| p[2] < 0.0), "body-facing-unclear", &["not a foot"]),
        declared(
            case(
                "back half, declared",
                part(&|p| p[2] < 0.0),
                "body-facing-unclear",
                &["not a foot"],
            ),
            &["--facing=+z"],
        ),
        case(
            "feet and ankles cut off",
            part(&|p| p[1] > 150.0),
            "body-facing-unclear",
            &["not a foot"],
        ),
        case(
            "one foot missing",
            part(&|p| p[1] > 100.0 || p[0] > 0.0),
            "body-facing-unclear",
            &["0 points"],
        ),
    ]);
}

#[test]
fn a_body_that_does_not_stand_as_declared_is_refused() {
    let body = Mesh::mannequin();
    let moved = |map: &dyn Fn([f64; 3]) -> [f64; 3]| body.clone().moved(map).obj();
    let lying = moved(&|[x, y, z]| [x, z, -y]);
    let high = body
        .clone()
        .moved(|[x, y, z]| if x > 0.0 && y < 800.0 { [x, y + 100.0, z] } else { [x, y, z] });
    check(&[
        case("on its back", lying, "body-no-plausible-unit", &["along y", "1700"]),
        case(
            "on its side",
            moved(&|[x, y, z]| [y, x, -z]),
            "body-no-plausible-unit",
            &["along y", "1700"],
        ),
        case(
            "upside down",
            moved(&|[x, y, z]| [-x, -y, z]),
            "body-facing-unclear",
            &["not a foot"],
        ),
        case("one foot in the air", high.obj(), "body-facing-unclear", &["0 points"]),
        declared(
            case("up x", body.obj(), "body-no-plausible-unit", &["along x", "1700"]),
            &["--up=x"],
        ),
        declared(
            case("up z", body.obj(), "body-no-plausible-unit", &["along z", "1700"]),
            &["--up=z"],
        ),
        declared(
            case("unit cm", body.obj(), "body-unit-implausible", &["unit cm", "17000.0 mm"]),
            &["--unit=cm"],
        ),
        declared(
            case("unit in", body.obj(), "body-unit-implausible", &["unit in", "43180.0 mm"]),
            &["--unit=in"],
        ),
        declared(
            case("unit m", body.obj(), "body-unit-implausible", &["unit m", "1.7e6 mm"]),
            &["--unit=m"],
        ),
        declared(
            case("facing left", body.obj(), "body-facing-contradicted", &["90 degrees"]),
            &["--facing=+x"],
        ),
        declared(
            case("facing right", body.obj(), "body-facing-contradicted", &["90 degrees"]),
            &["--facing=-x"],
        ),
        declared(
            case("facing back", body.obj(), "body-facing-contradicted", &["180 degrees"]),
            &["--facing=-z"],
        ),
    ]);
}

#[test]
fn a_size_that_no_person_has_is_refused() {
    let body = Mesh::mannequin();
    let child = body.clone().scaled(700.0 / 1700.0);
    check(&[
        case("baby of 70 cm", child.obj(), "body-no-plausible-unit", &["700"]),
        declared(
            case("baby of 70 cm, mm", child.obj(), "body-unit-implausible", &["700.0 mm"]),
            &["--unit=mm"],
        ),
        case("ten times", body.clone().scaled(10.0).obj(), "body-no-plausible-unit", &["17000"]),
        case("giant", body.clone().scaled(1.4).obj(), "body-no-plausible-unit", &["2380"]),
        case("1e300", body.clone().scaled(1e297).obj(), "body-no-plausible-unit", &[]),
        case("1e-300", body.clone().scaled(1e-303).obj(), "body-no-plausible-unit", &[]),
        case("beyond numbers", body.clone().scaled(1e306).obj(), "scan-not-finite", &["line 9"]),
        case(
            "all points alike",
            body.clone().moved(|_| [1.0, 2.0, 3.0]).obj(),
            "body-no-plausible-unit",
            &["0.0e0 units"],
        ),
    ]);
}

#[test]
fn a_scan_of_more_or_other_than_one_person_standing_is_refused() {
    let body = Mesh::body("f_average_clean");
    let beside = body.clone().and(body.clone().moved(|[x, y, z]| [x + 600.0, y, z]));
    let behind = body.clone().and(body.clone().moved(|[x, y, z]| [x, y, z + 700.0]));
    check(&[
        case(
            "two people side by side",
            beside.obj(),
            "body-not-two-legs",
            &["0 of 8", "4 at most"],
        ),
        case(
            "one person behind the other",
            behind.obj(),
            "body-not-two-legs",
            &["0 of 8", "4 at most"],
        ),
    ]);
}

#[test]
fn a_scan_in_shreds_is_refused() {
    let mut shreds = Mesh::default();
    let body = Mesh::mannequin();
    for triangle in &body.triangles {
        let corners = triangle.map(|corner| body.points[corner]);
        let middle: [f64; 3] =
            std::array::from_fn(|i| corners.iter().map(|c| c[i]).sum::<f64>() / 3.0);
        let first = shreds.points.len();
        let inner = |c: [f64; 3]| std::array::from_fn(|i| middle[i] + 0.9 * (c[i] - middle[i]));
        shreds.points.extend(corners.map(inner));
        shreds.triangles.push([first, first + 1, first + 2]);
    }
    check(&[case("shreds", shreds.obj(), "body-only-fragments", &["0.5 %"])]);
}

#[test]
fn legs_that_join_too_low_or_never_are_refused() {
    let body = Mesh::mannequin();
    // Cloth around both legs from the shanks up, and nothing seen through it.
    let ring =
        |i: u32| Ring { y: 265.0 + 5.0 * f64::from(i), middle: [0.0; 2], half: [165.0, 62.0] };
    let cloth = Mesh::tube(&(0..=115).map(ring).collect::<Vec<_>>(), 200);
    let hidden = body.clone().kept(|[_, y, _]| !(265.0..820.0).contains(&y)).and(cloth);
    // Legs up to 1100 mm of 1700.
    let long = body.moved(|[x, y, z]| {
        let longer = if y < 825.0 { y * 4.0 / 3.0 } else { 1100.0 + (y - 825.0) * 600.0 / 875.0 };
        [x, longer, z]
    });
    check(&[
        case("cloth", hidden.obj(), "segment-join-too-low", &["cloth"]),
        case("no trunk", long.obj(), "segment-never-join", &["above any possible crotch"]),
    ]);
}

#[test]
fn legs_without_a_section_that_closes_are_refused() {
    // Nobody saw the front of the legs above the feet.
    let open = Mesh::mannequin().kept(|[x, y, z]| {
        let off_deg = z.atan2(x.abs() - 100.0 + 0.01 * y).to_degrees();
        !(55.0..=812.0).contains(&y) || (off_deg - 90.0).abs() > 100.0
    });
    check(&[case("open in front", open.obj(), "no-leg", &["left", "right"])]);
}

#[test]
fn a_mesh_that_may_be_mirrored_and_a_body_in_two_layers_are_refused() {
    let body = Mesh::mannequin();
    let mut inward = body.clone();
    inward.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let mirrored = body.clone().moved(|[x, y, z]| [-x, y, z]);
    // The legs are at x = 100 mm; the second skin is 3 mm further out.
    let layer = body.clone().moved(|[x, y, z]| {
        let (aside, ahead) = (x - x.signum() * (100.0 - 0.01 * y), z);
        let share = 3.0 / aside.hypot(ahead).max(1.0);
        [x + aside * share, y, z + ahead * share]
    });
    check(&[
        case("inside out", inward.obj(), "body-wound-inward", &["mirrored", "winding"]),
        case("mirrored", mirrored.obj(), "body-wound-inward", &["left and right"]),
        declared(
            case("outwards", body.obj(), "body-wound-outward", &["wound outwards"]),
            &["--winding=inward"],
        ),
        case("two layers", body.and(layer).obj(), "body-layers", &["two skins"]),
    ]);
}

#[test]
fn two_legs_are_no_lone_leg() {
    // The right leg ends above the floor, so that one foot stands there.
    let two = Mesh::mannequin().kept(|[x, y, _]| y < 700.0 && (x > 0.0 || y > 100.0));
    let method = Method { scope: Scope::Leg(Side::Left), ..method(&["--facing=+z"]) };
    let refusal = leg::extract(&two.obj(), Format::Obj, &method).unwrap_err();
    assert_eq!(refusal.code(), "body-two-legs", "{refusal}");
}

#[test]
fn a_file_that_is_longer_than_it_says_is_refused() {
    let points = "1 0 0\n0 1 0\n0 0 1\n".repeat(4);
    let ply = "ply\nformat ascii 1.0\nelement vertex 11\nproperty float x\nproperty float y\n\
               property float z\nend_header\n";
    for (bytes, format) in
        [(format!("11\n{points}"), Format::Xyz), (format!("{ply}{points}"), Format::Ply)]
    {
        let refusal = leg::extract(bytes.as_bytes(), format, &Method::default()).unwrap_err();
        assert_eq!(refusal.code(), "scan-too-long", "{refusal}");
        assert!(refusal.to_string().contains("12"), "{refusal}");
    }
}

#[test]
fn a_facing_along_the_up_axis_is_a_wrong_command_line() {
    let refusal = leg::extract(&Mesh::mannequin().obj(), Format::Obj, &method(&["--facing=+y"]));
    assert_eq!(refusal.unwrap_err().code(), "body-facing-vertical");
    for options in [["--facing=+y", "--up=y"], ["--facing=-z", "--up=z"], ["--facing=+x", "--up=x"]]
    {
        let done = Command::new(rig::verb::program())
            .args(["extract", "no-such-file.obj"])
            .args(options)
            .output()
            .unwrap();
        assert_eq!(done.status.code(), Some(64), "{options:?}");
        assert!(String::from_utf8(done.stderr).unwrap().contains("--facing"), "{options:?}");
    }
}

/// Height and tape girth of B, B1, C and D of the left and the right leg.
fn measures(found: &Extraction) -> Vec<(Level, f64, f64)> {
    let levels = found.legs.iter().flat_map(|leg| &leg.landmarks);
    levels
        .filter(|at| Level::SOUGHT.contains(&at.level))
        .map(|at| (at.level, at.height_mm, at.girth_tape_mm))
        .collect()
}

#[test]
fn a_body_with_things_around_it_is_measured_as_without_them() {
    let body = Mesh::mannequin();
    let plain = measures(&leg::extract(&body.obj(), Format::Obj, &Method::default()).unwrap());
    assert_eq!(plain.len(), 8);
    let arm = |side: f64| Mesh::column([side * 260.0, 0.0], 35.0, 650.0, 1300.0);
    let mut spike = body.clone();
    spike.points.push([1e9, 1000.0, 0.0]);
    spike.triangles.push([spike.points.len() - 1, 0, 1]);
    let mut both_sides = body.clone();
    both_sides.triangles.extend(body.triangles.iter().map(|[a, b, c]| [*a, *c, *b]));
    // Triangles from both sides have no normals, so facets stay flat: 0.5 mm on edges of 9 mm.
    let cases = [
        ("arms hanging", 0.1, body.clone().and(arm(1.0)).and(arm(-1.0))),
        ("everything twice", 0.1, body.clone().and(body.clone())),
        ("every triangle from both sides", 0.6, both_sides),
        ("one point a thousand kilometres away", 0.1, spike),
        (
            "a speck on the shin",
            0.1,
            body.clone().and(Mesh::column([100.0, 60.0], 2.0, 300.0, 304.0)),
        ),
    ];
    for (name, girth_mm, mesh) in cases {
        let found = leg::extract(&mesh.obj(), Format::Obj, &Method::default());
        let found = measures(&found.unwrap_or_else(|refusal| panic!("{name}: {refusal}")));
        assert_eq!(found.len(), plain.len(), "{name}");
        for ((level, height, girth), (_, true_height, true_girth)) in found.iter().zip(&plain) {
            let off = [(height - true_height).abs(), (girth - true_girth).abs()];
            assert!(
                off[0] < 1.0 && off[1] < girth_mm,
                "{name}: {level:?} {height} {girth}, {off:?} off"
            );
        }
    }
}
