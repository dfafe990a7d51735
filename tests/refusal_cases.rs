//! Every bad export ends in its named refusal: from `leg::extract` with its code and figures, and
//! from the real program with exit 65, nothing on standard output and one line that names the file.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "support/mesh.rs"]
mod mesh;

use std::fs;
use std::process::Command;

use gaiter::leg::method::{Axis, FacingChoice, Unit, UnitChoice, Up};
use gaiter::leg::{self, Extraction, Level, Method};
use gaiter::scan::Format;
use mesh::{Mesh, fixture};
use tempfile::TempDir;

/// A bad export and the refusal it must end in.
struct Case {
    name: String,
    bytes: Vec<u8>,
    /// As on the command line.
    options: &'static [&'static str],
    code: &'static str,
    /// What the message must tell, figures above all.
    says: Vec<String>,
}

fn case(name: &str, bytes: impl Into<Vec<u8>>, code: &'static str, says: &[&str]) -> Case {
    let says = says.iter().map(|said| (*said).to_owned()).collect();
    Case { name: name.to_owned(), bytes: bytes.into(), options: &[], code, says }
}

fn declared(mut case: Case, options: &'static [&'static str]) -> Case {
    case.options = options;
    case
}

/// The method that these options choose.
fn method(options: &[&str]) -> Method {
    let mut method = Method::default();
    for option in options {
        match *option {
            "--unit=mm" => method.unit = UnitChoice::Declared(Unit::Mm),
            "--unit=cm" => method.unit = UnitChoice::Declared(Unit::Cm),
            "--unit=in" => method.unit = UnitChoice::Declared(Unit::In),
            "--unit=m" => method.unit = UnitChoice::Declared(Unit::M),
            "--up=x" => method.up = Up::X,
            "--up=z" => method.up = Up::Z,
            "--facing=+x" => method.facing = FacingChoice::Declared(Axis::PlusX),
            "--facing=-x" => method.facing = FacingChoice::Declared(Axis::MinusX),
            "--facing=+z" => method.facing = FacingChoice::Declared(Axis::PlusZ),
            "--facing=-z" => method.facing = FacingChoice::Declared(Axis::MinusZ),
            "--facing=+y" => method.facing = FacingChoice::Declared(Axis::PlusY),
            other => panic!("{other}"),
        }
    }
    method
}

fn check(cases: &[Case]) {
    assert!(!cases.is_empty());
    let dir = TempDir::new().unwrap();
    for Case { name, bytes, options, code, says } in cases {
        let refusal = match leg::extract(bytes, Format::Obj, &method(options)) {
            Err(refusal) => refusal,
            Ok(found) => panic!("{name}: a record with {} legs", found.legs.len()),
        };
        let message = refusal.to_string();
        assert_eq!(refusal.code(), *code, "{name}: {message}");
        for said in says {
            assert!(message.contains(said.as_str()), "{name}: no \"{said}\" in: {message}");
        }
        assert!(!message.contains("NaN"), "{name}: {message}");

        let path = dir.path().join(format!("{}.obj", name.replace([' ', '/'], "_")));
        fs::write(&path, bytes).unwrap();
        let out = dir.path().join("records");
        let done = Command::new(env!("CARGO_BIN_EXE_gaiter"))
            .args(["extract", "--json"])
            .arg(&path)
            .arg("--out")
            .arg(&out)
            .args(*options)
            .output()
            .unwrap();
        let stderr = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(65), "{name}: {stderr}");
        assert_eq!(done.stdout, b"", "{name}");
        let expected =
            format!("gaiter: {}: cannot be measured [{code}]: {message}\n", path.display());
        assert_eq!(stderr, expected, "{name}");
        assert_eq!(message.lines().count(), 1, "{name}: {message}");
        assert!(!out.exists(), "{name}: a record folder for a scan that cannot be measured");
    }
}

/// The mannequin with one of its lines replaced by another.
fn with_line(number: usize, line: &str) -> Vec<u8> {
    let text = String::from_utf8(Mesh::mannequin().obj()).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    lines[number - 1] = line;
    lines.join("\n").into_bytes().into_iter().chain(*b"\n").collect()
}

/// Number of the first face line.
fn first_face() -> usize {
    Mesh::mannequin().points.len() + 1
}

#[test]
fn a_file_that_is_no_obj_text_is_refused() {
    let zip = b"PK\x03\x04\x14\x00\x00\x00\x08\x00v 1 2 3\nf 1 2 3\n";
    let garbage: Vec<u8> =
        (0..5000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let latin1_prose = b"Gr\xfc\xdfe aus der Kabine\nv 1 2 3\n".to_vec();
    check(&[
        case("empty", b"", "scan-empty", &[]),
        case("white space", b" \r\n\t\n \n", "scan-empty", &[]),
        case("png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\n", "scan-binary", &["byte 8 is 0x00"]),
        case("zip", zip, "scan-binary", &["byte 2 is 0x03"]),
        case("garbage", garbage, "scan-binary", &["byte "]),
        case("utf-16", b"\xff\xfev\0 \01\0", "scan-binary", &["byte 3 is 0x00"]),
        case(
            "stl text",
            "solid body\nfacet normal 0 0 1\n",
            "scan-not-this-format",
            &["line 1", "solid body"],
        ),
        case("ply text", "ply\nformat ascii 1.0\n", "scan-not-this-format", &["line 1", "ply"]),
        case(
            "prose after comments",
            "# a\n\n# b\nHello there\n",
            "scan-not-this-format",
            &["line 4", "Hello"],
        ),
        case("latin-1 prose", latin1_prose, "scan-not-this-format", &["line 1", "Gr??e aus"]),
        case("json", "{\"points\": []}\n", "scan-not-this-format", &["line 1"]),
        case("comments only", "# nothing\n# here\n", "scan-malformed", &["not one point"]),
        case("faces only", "f 1 2 3\n", "scan-malformed", &["not one point"]),
    ]);
}

#[test]
fn a_number_that_is_none_is_refused_with_its_line() {
    let far = first_face();
    check(&[
        case("nan", with_line(7, "v 0 nan 0"), "scan-not-finite", &["line 7", "\"nan\""]),
        case("inf", with_line(9000, "v -inf 1 0"), "scan-not-finite", &["line 9000", "\"-inf\""]),
        case("1e999", with_line(3, "v 0 0 1e999"), "scan-not-finite", &["line 3", "\"1e999\""]),
        case("comma", with_line(5, "v 0,5 1 2"), "scan-malformed", &["line 5", "\"0,5\""]),
        case("two coordinates", with_line(6, "v 1 2"), "scan-malformed", &["line 6", "three"]),
        case("word", with_line(8, "v 1 two 3"), "scan-malformed", &["line 8", "\"two\""]),
        case(
            "index too large",
            with_line(far, "f 1 2 999999"),
            "scan-malformed",
            &["\"999999\"", &format!("line {far}")],
        ),
        case(
            "index 0",
            with_line(far + 2, "f 1 0 2"),
            "scan-malformed",
            &["\"0\"", &format!("line {}", far + 2)],
        ),
        case(
            "index below the first",
            with_line(far, "f -1 -2 -99999"),
            "scan-malformed",
            &["\"-99999\""],
        ),
        case("index no number", with_line(far, "f 1 2 x"), "scan-malformed", &["\"x\""]),
        case(
            "index beyond integers",
            with_line(far, "f 1 2 99999999999999999999"),
            "scan-malformed",
            &["line"],
        ),
    ]);
}

#[test]
fn a_body_without_a_surface_is_refused() {
    let mut points_only = Mesh::mannequin();
    points_only.triangles.clear();
    let mut lines_only = points_only.obj();
    (1..500).for_each(|i| lines_only.extend(format!("l {i} {}\n", i + 1).bytes()));
    let mut two_corners = points_only.obj();
    (1..500).for_each(|i| two_corners.extend(format!("f {i} {}\n", i + 1).bytes()));
    let mut degenerate = Mesh::mannequin();
    degenerate.triangles.iter_mut().for_each(|t| t[1] = t[0]);
    let count = format!("{} points", points_only.points.len());
    check(&[
        case("no faces", points_only.obj(), "scan-no-faces", &[&count]),
        case("lines only", lines_only, "scan-no-faces", &[&count]),
        case("faces of two corners", two_corners, "scan-no-faces", &[&count]),
        case("all triangles degenerate", degenerate.obj(), "scan-no-faces", &[&count]),
        case(
            "one triangle",
            "v 0 0 0\nv 9 1700 0\nv 0 0 99\nf 1 2 3\n",
            "body-not-two-legs",
            &["0 "],
        ),
    ]);
}

/// The bytes up to this share of a file, and up to the last whole line before it.
fn cut(bytes: &[u8], share: f64) -> [Vec<u8>; 2] {
    let mut at = (share * bytes.len() as f64) as usize;
    if bytes[at - 1] == b'\n' {
        at -= 1;
    }
    let line = bytes[..at].iter().rposition(|&byte| byte == b'\n').unwrap();
    [bytes[..at].to_vec(), bytes[..=line].to_vec()]
}

#[test]
fn a_real_export_cut_in_the_middle_of_a_line_is_cut_short_wherever_that_is() {
    for name in ["f_average_clean", "f_average_tc2"] {
        let bytes = fixture(name);
        let cases = [0.001, 0.02, 0.25, 0.44, 0.46, 0.6, 0.9, 0.97, 0.999, 0.99999].map(|share| {
            let [middle, _] = cut(&bytes, share);
            let line = middle.iter().filter(|&&byte| byte == b'\n').count() + 1;
            let says = format!("line {line}, the last");
            case(&format!("{name} {share}"), middle, "scan-cut-short", &[&says])
        });
        check(&cases);
    }
}

#[test]
fn a_real_export_cut_at_a_line_end_is_no_surface_or_cut_short() {
    let bytes = fixture("f_average_clean");
    // The points end at 39 % of the file.
    let among_points = [0.1, 0.3].map(|share| {
        let [_, whole_lines] = cut(&bytes, share);
        let points = whole_lines.iter().filter(|&&byte| byte == b'v').count();
        let says = format!("{points} points but no faces");
        case(&format!("points {share}"), whole_lines, "scan-no-faces", &[&says])
    });
    let among_faces = [0.45, 0.6, 0.8].map(|share| {
        let [_, whole_lines] = cut(&bytes, share);
        let says = ["of 55957 points belong to no face"];
        case(&format!("faces {share}"), whole_lines, "scan-cut-short", &says)
    });
    check(&among_points);
    check(&among_faces);
    // Here all but a few points are used and a leg is missing all the same.
    let [_, whole_lines] = cut(&bytes, 0.9);
    check(&[case("faces 0.9", whole_lines, "segment-leg-ends", &["left leg", "621 mm"])]);
}

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
        case("sphere", Mesh::sphere(1700.0).obj(), "body-not-two-legs", &["0 "]),
        case("box", Mesh::cuboid([250.0, 150.0], 0.0, 1700.0).obj(), "body-not-two-legs", &["0 "]),
        case(
            "one tube",
            Mesh::column([0.0; 2], 60.0, 0.0, 1700.0).obj(),
            "body-not-two-legs",
            &["1 "],
        ),
        case("chair", chair.obj(), "body-not-two-legs", &["4 "]),
        case("flat", flat.obj(), "body-not-two-legs", &["0 "]),
        case("two tubes", pair(100.0).obj(), "body-facing-unclear", &["1.00 times"]),
        declared(
            case("two tubes, declared", pair(100.0).obj(), "segment-never-join", &["mm"]),
            &["--facing=+z"],
        ),
        case("trestle", trestle.obj(), "body-facing-unclear", &["1.00 times"]),
    ]);
}

#[test]
fn a_part_of_a_body_is_refused() {
    let body = Mesh::body("f_average_clean");
    let part = |keeps: &dyn Fn([f64; 3]) -> bool| body.clone().kept(keeps).obj();
    check(&[
        case("lower half", part(&|p| p[1] < 800.0), "body-no-plausible-unit", &["802"]),
        case("up to the chest", part(&|p| p[1] < 1100.0), "segment-never-join", &["606 mm"]),
        case("upper half", part(&|p| p[1] > 800.0), "body-no-plausible-unit", &["808"]),
        case("from the knee up", part(&|p| p[1] > 450.0), "body-facing-unclear", &["1.06"]),
        case("left half", part(&|p| p[0] > 0.0), "body-not-two-legs", &["1 "]),
        case("right half", part(&|p| p[0] < 0.0), "body-not-two-legs", &["1 "]),
        case("back half", part(&|p| p[2] < 0.0), "body-facing-unclear", &["180 degrees apart"]),
        declared(
            case(
                "back half, declared",
                part(&|p| p[2] < 0.0),
                "no-leg",
                &["left: only 0 of", "right: only 0 of"],
            ),
            &["--facing=+z"],
        ),
        case("feet and ankles cut off", part(&|p| p[1] > 150.0), "body-facing-unclear", &["1.2"]),
        case(
            "one foot missing",
            part(&|p| p[1] > 100.0 || p[0] > 0.0),
            "body-facing-unclear",
            &["0 points"],
        ),
        case(
            "one lower leg missing",
            part(&|p| p[1] > 450.0 || p[0] > 0.0 || p[0] < -250.0),
            "body-not-two-legs",
            &["1 "],
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
        case("on its back", lying, "body-no-plausible-unit", &["along Y", "1700"]),
        case(
            "on its side",
            moved(&|[x, y, z]| [y, x, -z]),
            "body-no-plausible-unit",
            &["along Y", "1700"],
        ),
        case("upside down", moved(&|[x, y, z]| [-x, -y, z]), "body-not-two-legs", &[]),
        case("one foot in the air", high.obj(), "body-facing-unclear", &["0 points"]),
        declared(
            case("up x", body.obj(), "body-no-plausible-unit", &["along X", "1700"]),
            &["--up=x"],
        ),
        declared(
            case("up z", body.obj(), "body-no-plausible-unit", &["along Z", "1700"]),
            &["--up=z"],
        ),
        declared(
            case("unit cm", body.obj(), "body-unit-implausible", &["unit cm", "17000 mm"]),
            &["--unit=cm"],
        ),
        declared(
            case("unit in", body.obj(), "body-unit-implausible", &["unit in", "43180 mm"]),
            &["--unit=in"],
        ),
        declared(
            case("unit m", body.obj(), "body-unit-implausible", &["unit m", "1700000 mm"]),
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
    let child = body.clone().scaled(900.0 / 1700.0);
    check(&[
        case("child of 90 cm", child.obj(), "body-no-plausible-unit", &["900"]),
        declared(
            case("child of 90 cm, mm", child.obj(), "body-unit-implausible", &["900 mm"]),
            &["--unit=mm"],
        ),
        case("ten times", body.clone().scaled(10.0).obj(), "body-no-plausible-unit", &["17000"]),
        case("giant", body.clone().scaled(1.4).obj(), "body-no-plausible-unit", &["2380"]),
        case("1e300", body.clone().scaled(1e297).obj(), "body-no-plausible-unit", &[]),
        case("1e-300", body.clone().scaled(1e-303).obj(), "body-no-plausible-unit", &[]),
        case("beyond numbers", body.clone().scaled(1e306).obj(), "scan-not-finite", &["line 8"]),
        case(
            "all points alike",
            body.clone().moved(|_| [1.0, 2.0, 3.0]).obj(),
            "body-no-plausible-unit",
            &["0 units"],
        ),
    ]);
}

#[test]
fn a_scan_of_more_or_other_than_one_person_standing_is_refused() {
    let body = Mesh::body("f_average_clean");
    let beside = body.clone().and(body.clone().moved(|[x, y, z]| [x + 600.0, y, z]));
    let behind = body.clone().and(body.clone().moved(|[x, y, z]| [x, y, z + 700.0]));
    // The middle of the right ankle; its foot turns about that.
    let ankle: Vec<_> =
        body.points.iter().filter(|p| p[0] < 0.0 && (85.0..100.0).contains(&p[1])).collect();
    let mean = |axis: usize| ankle.iter().map(|p| p[axis]).sum::<f64>() / ankle.len() as f64;
    let [mx, mz] = [mean(0), mean(2)];
    let turned = body.clone().moved(|[x, y, z]| {
        if x < 0.0 && y < 90.0 { [2.0 * mx - x, y, 2.0 * mz - z] } else { [x, y, z] }
    });
    check(&[
        case("two people side by side", beside.obj(), "body-not-two-legs", &["4 "]),
        case("one person behind the other", behind.obj(), "body-not-two-legs", &["4 "]),
        case(
            "one foot turned backwards",
            turned.obj(),
            "body-facing-unclear",
            &["160 degrees apart"],
        ),
    ]);
}

#[test]
fn a_facing_along_the_up_axis_is_a_wrong_command_line() {
    let refusal = leg::extract(&Mesh::mannequin().obj(), Format::Obj, &method(&["--facing=+y"]));
    assert_eq!(refusal.unwrap_err().code(), "body-facing-vertical");
    for options in [["--facing=+y", "--up=y"], ["--facing=-z", "--up=z"], ["--facing=+x", "--up=x"]]
    {
        let done = Command::new(env!("CARGO_BIN_EXE_gaiter"))
            .args(["extract", "no-such-file.obj"])
            .args(options)
            .output()
            .unwrap();
        assert_eq!(done.status.code(), Some(64), "{options:?}");
        assert!(String::from_utf8(done.stderr).unwrap().contains("--facing"), "{options:?}");
    }
}

/// Height and tape girth of every level of the left and the right leg.
fn measures(found: &Extraction) -> Vec<(Level, f64, f64)> {
    let levels = found.legs.iter().flat_map(|leg| &leg.landmarks);
    levels.map(|at| (at.level, at.height_mm, at.girth_tape_mm)).collect()
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
