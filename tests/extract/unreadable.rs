//! Every file that is no scan, or not a whole one, ends in its named refusal: from `leg::extract`
//! with its code and figures, and from the real program with exit 65, nothing on standard output
//! and one line that names the file. So do files that cannot be had and wrong command lines, each
//! with its own exit code.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::Command;

use rig::refusal::{case, check};
use support::mesh::{Mesh, fixture};
use tempfile::TempDir;

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
        case("zip", zip, "scan-not-this-format", &["a ZIP archive"]),
        case("garbage", garbage, "scan-binary", &["byte "]),
        case("utf-16", b"\xff\xfev\0 \x001\0", "scan-not-this-format", &["UTF-16"]),
        case(
            "stl text",
            "solid body\nfacet normal 0 0 1\n",
            "scan-not-this-format",
            &["looks like STL", "rename"],
        ),
        case("ply text", "ply\nformat ascii 1.0\n", "scan-not-this-format", &["looks like PLY"]),
        case(
            "prose after comments",
            "# a\n\n# b\nHello there\n",
            "scan-not-this-format",
            &["line 4", "Hello"],
        ),
        case("latin-1 prose", latin1_prose, "scan-not-this-format", &["line 1", "Gr??e aus"]),
        case("json", "{\"points\": []}\n", "scan-not-this-format", &["line 1"]),
        case("comments only", "# nothing\n# here\n", "scan-no-points", &["holds no points"]),
        case("faces only", "f 1 2 3\n", "scan-no-points", &["holds no points"]),
    ]);
}

#[test]
fn a_number_that_is_none_is_refused_with_its_line() {
    let far = first_face();
    check(&[
        case("nan", with_line(7, "v 0 nan 0"), "scan-not-finite", &["line 7", "\"nan\""]),
        case("inf", with_line(9000, "v -inf 1 0"), "scan-not-finite", &["line 9000", "\"-inf\""]),
        case("1e999", with_line(3, "v 0 0 1e999"), "scan-not-finite", &["line 3", "\"1e999\""]),
        case("comma", with_line(5, "v 0,5 1 2"), "scan-malformed", &["line 5", "decimal"]),
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
fn a_single_triangle_is_no_body() {
    let triangle = "v 0 0 0\nv 9 1700 0\nv 0 0 99\nf 1 2 3\n";
    check(&[case("one triangle", triangle, "body-not-two-legs", &["0 "])]);
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
fn a_real_export_cut_at_a_line_end_among_its_faces_is_cut_short() {
    let bytes = fixture("f_average_clean");
    // The points end at 39 % of the file.
    let among_faces = [0.45, 0.6, 0.8, 0.9].map(|share| {
        let [_, whole_lines] = cut(&bytes, share);
        let says = ["of 56234 points belong to no face"];
        case(&format!("faces {share}"), whole_lines, "scan-cut-short", &says)
    });
    check(&among_faces);
}

/// How `gaiter extract NAME` ends in `folder`, and the one line it says. It must not hang.
fn refused(folder: &Path, name: &str) -> (Option<i32>, String) {
    let mut gaiter = Command::new("timeout");
    gaiter.current_dir(folder).arg("20").arg(rig::verb::program()).args(["extract", "--", name]);
    let done = gaiter.output().unwrap();
    assert_ne!(done.status.code(), Some(124), "gaiter hangs on {name:?}");
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(done.stdout, b"", "{name:?}");
    (done.status.code(), said)
}

#[test]
fn a_file_that_cannot_be_had_is_named_with_its_reason() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("folder.obj")).unwrap();
    let made = Command::new("mkfifo").arg(folder.path().join("pipe.obj")).status().unwrap();
    assert!(made.success());
    let (code, said) = refused(folder.path(), "missing.obj");
    assert_eq!(code, Some(66));
    assert!(said.starts_with("gaiter: missing.obj: No such file"), "{said}");
    let (code, said) = refused(folder.path(), "pipe.obj");
    assert_eq!(code, Some(74), "{said}");
    assert!(said.starts_with("gaiter: pipe.obj: is not a regular file"), "{said}");
    // A folder is looked through, whatever it is called.
    let (code, said) = refused(folder.path(), "folder.obj");
    assert_eq!(code, Some(66), "{said}");
    assert!(said.starts_with("gaiter: folder.obj: the folder holds no scan"), "{said}");
}

#[test]
fn a_name_cannot_forge_a_line() {
    let folder = TempDir::new().unwrap();
    let bad = "a\ngaiter: b.obj: fine\u{1b}[2J.obj";
    fs::write(folder.path().join(bad), "").unwrap();
    let shown = r"gaiter: a\ngaiter: b.obj: fine\u{1b}[2J.obj: cannot be measured [scan-empty]";
    let (code, said) = refused(folder.path(), bad);
    assert_eq!(code, Some(65));
    assert!(said.starts_with(shown), "{said}");
    fs::write(folder.path().join("a.x\ny\u{1b}"), "").unwrap();
    let (code, said) = refused(folder.path(), "a.x\ny\u{1b}");
    assert_eq!(code, Some(65));
    assert!(said.contains(r#"the ending "x\ny\u{1b}" is not a scan"#), "{said}");
}

#[test]
fn an_ending_that_is_no_scan_s_is_refused_whatever_is_inside() {
    let folder = TempDir::new().unwrap();
    let endings = [("scan.x3d", "\"x3d\""), ("scan", "\"\""), ("scan.obj.part", "\"part\"")];
    for (name, ending) in endings {
        fs::write(folder.path().join(name), Mesh::mannequin().obj()).unwrap();
        let (code, said) = refused(folder.path(), name);
        assert_eq!(code, Some(65), "{name}");
        assert!(said.contains("[scan-unknown-ending]") && said.contains(ending), "{said}");
        assert!(said.contains(".obj"), "says what it reads: {said}");
    }
}

/// Runs `gaiter extract` in a folder with the same scan under three names.
fn extract(folder: &TempDir, arguments: &[&str]) -> (Option<i32>, String, String) {
    for name in ["a.obj", "b.obj", "a.OBJ"] {
        fs::write(folder.path().join(name), Mesh::mannequin().obj()).unwrap();
    }
    let mut gaiter = Command::new(rig::verb::program());
    let done = gaiter.current_dir(folder.path()).arg("extract").args(arguments).output().unwrap();
    let [stdout, stderr] = [done.stdout, done.stderr].map(|said| String::from_utf8(said).unwrap());
    (done.status.code(), stdout, stderr)
}

#[test]
fn two_scans_for_one_folder_are_a_fault_before_anything_is_done() {
    let folder = TempDir::new().unwrap();
    let (code, stdout, stderr) = extract(&folder, &["b.obj", "a.obj", "./a.OBJ", "--out", "out"]);
    assert_eq!((code, stdout.as_str()), (Some(64), ""));
    assert!(stderr.starts_with("gaiter: a.obj and ./a.OBJ would both go to out/a;"), "{stderr}");
    assert!(!folder.path().join("out").exists());
    let (code, _, stderr) = extract(&folder, &["a.obj", "./a.OBJ"]);
    assert_eq!(code, Some(0), "without --out nothing collides: {stderr}");
}

#[test]
fn a_wrong_command_line_is_explained_and_ends_with_64() {
    let folder = TempDir::new().unwrap();
    let wrong: [&[&str]; 7] = [
        &[],
        &["--json"],
        &["a.obj", "--unit", "ft"],
        &["a.obj", "--up", "w"],
        &["a.obj", "--facing", "front"],
        &["a.obj", "--no-such-option"],
        &["a.obj", "--out"],
    ];
    for arguments in wrong {
        let (code, stdout, stderr) = extract(&folder, arguments);
        assert_eq!((code, stdout.as_str()), (Some(64), ""), "{arguments:?}");
        assert!(stderr.contains("--help"), "{arguments:?}: {stderr}");
    }
    let (code, stdout, stderr) = extract(&folder, &["--help"]);
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    assert!(stdout.contains("--facing"));
}
