//! What the OBJ decoder takes and what it refuses.

use super::*;

const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";

fn fault(text: &str) -> ScanFault {
    read(text.as_bytes()).unwrap_err()
}

#[test]
fn a_plain_mesh_is_read_whole() {
    let scan = read(TETRAHEDRON.as_bytes()).unwrap();
    assert_eq!(scan.points.len(), 4);
    assert_eq!(scan.triangles.len(), 4);
    assert_eq!(scan.points[3], Point3::new(0.0, 0.0, 1.0));
}

#[test]
fn everyday_variants_give_the_same_mesh() {
    let plain = read(TETRAHEDRON.as_bytes()).unwrap();
    let crlf = TETRAHEDRON.replace('\n', "\r\n");
    let negative = TETRAHEDRON.replace("f 1 2 3", "f -4 -3 -2");
    let coloured = TETRAHEDRON.replace("v 1 0 0\n", "v 1 0 0 0.5 0.5 0.5\n");
    let slashed = TETRAHEDRON.replace("f 1 2 4", "f 1// 2// 4//");
    let named = format!("# unit inches\nmtllib a.mtl\no M\u{fc}ller\n{TETRAHEDRON}");
    let grouped = TETRAHEDRON.replace("f 1 3 4", "g shin\nusemtl skin\nf 1 3 4");
    let cr = TETRAHEDRON.replace('\n', "\r");
    let mixed = TETRAHEDRON.replacen('\n', "\r\n", 3).replacen("0\nf", "0\rf", 1);
    let marked = format!("\u{feff}{TETRAHEDRON}");
    for variant in [cr, mixed, marked, crlf, negative, coloured, slashed, named, grouped] {
        assert_eq!(read(variant.as_bytes()).unwrap(), plain, "{variant}");
    }
    let latin1 = [b"o M\xfcller\n".as_slice(), TETRAHEDRON.as_bytes()].concat();
    assert_eq!(read(&latin1).unwrap(), plain);
}

#[test]
fn a_polygon_becomes_a_fan_and_degenerate_faces_go() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 1 2\n";
    assert_eq!(read(text.as_bytes()).unwrap().triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn nothing_at_all_is_empty() {
    assert_eq!(fault(""), ScanFault::Empty);
    assert_eq!(fault(" \n\r\n"), ScanFault::Empty);
    assert_eq!(fault("\u{feff}"), ScanFault::Empty);
    assert_eq!(fault("\u{feff}\r\n"), ScanFault::Empty);
}

#[test]
fn a_missing_line_end_is_a_cut_file() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3";
    let what = CutSign::NoLineEnd { line: 4 };
    for end in ["\n", "\r\n", "\r"] {
        let cut = ScanFault::CutShort { what: what.clone() };
        assert_eq!(fault(&text.replace('\n', end)), cut, "{end:?}");
    }
}

#[test]
fn lines_are_counted_alike_whatever_ends_them() {
    let nan = TETRAHEDRON.replace("v 0 1 0\n", "\n# blank lines count\nv 0 nan 0\n");
    for end in ["\n", "\r\n", "\r"] {
        for mark in ["", "\u{feff}"] {
            let text = format!("{mark}{}", nan.replace('\n', end));
            let placed = ScanFault::NotFinite { line: 5, found: "nan".into() };
            assert_eq!(fault(&text), placed, "{text:?}");
        }
    }
}

#[test]
fn only_the_mark_of_utf_8_is_skipped_and_only_at_the_start() {
    let utf16 = TETRAHEDRON.encode_utf16().flat_map(u16::to_le_bytes);
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(utf16).collect();
    assert_eq!(read(&utf16), Err(ScanFault::Binary { at: 3, value: 0 }));
    let twice = fault(&format!("\u{feff}\u{feff}{TETRAHEDRON}"));
    assert_eq!(twice, ScanFault::NotThisFormat { line: 1, found: "???v 0 0 0".into() });
    let binary = fault("\u{feff}v 0 0 0\0\n");
    assert_eq!(binary, ScanFault::Binary { at: 10, value: 0 }, "counted from the file's start");
}

#[test]
fn a_face_list_cut_at_a_line_is_a_cut_file() {
    let strip = |faces: usize| {
        let points = (0..2000).map(|i| format!("v {i} 0 {}\n", i % 7));
        let faces = (1..=faces).map(|i| format!("f {} {} {}\n", i, i + 1, i + 2));
        points.chain(faces).collect::<String>()
    };
    // All used, and one in a thousand stray: whole.
    assert_eq!(read(strip(1998).as_bytes()).unwrap().points.len(), 2000);
    assert_eq!(read(strip(1996).as_bytes()).unwrap().points.len(), 1998);
    let what = CutSign::UnusedPoints { unused: 3, points: 2000 };
    assert_eq!(fault(&strip(1995)), ScanFault::CutShort { what });
}

#[test]
fn a_cut_or_empty_file_is_to_be_exported_again() {
    let no_line_end = fault("v 0 0 0\nf 1").to_string();
    assert!(no_line_end.contains("line 2, the last, has no line end; export it again (if your"));
    for text in ["", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n"] {
        let said = fault(text).to_string();
        assert!(said.ends_with("; export it again"), "{said}");
    }
}

#[test]
fn a_file_without_points_names_no_line() {
    for text in ["# nothing\n", "f 1 2 3\n"] {
        assert_eq!(fault(text), ScanFault::NoPoints, "{text}");
    }
    let unplaced = ScanFault::Malformed { line: 0, what: "wrong".into() };
    for said in [ScanFault::NoPoints.to_string(), unplaced.to_string()] {
        assert!(!said.contains("line 0"), "{said}");
    }
    let placed = ScanFault::Malformed { line: 7, what: "wrong".into() };
    assert_eq!(placed.to_string(), "line 7: wrong");
}

#[test]
fn points_without_faces_are_no_surface() {
    assert_eq!(fault("v 0 0 0\nv 1 0 0\n"), ScanFault::NoFaces { points: 2 });
    assert_eq!(fault("v 0 0 0\nv 1 0 0\nf 1 2\n"), ScanFault::NoFaces { points: 2 });
}

#[test]
fn numbers_that_are_none_are_named_with_their_line() {
    let nan = TETRAHEDRON.replace("v 0 1 0", "v 0 nan 0");
    assert_eq!(fault(&nan), ScanFault::NotFinite { line: 3, found: "nan".into() });
    let huge = TETRAHEDRON.replace("v 0 1 0", "v 0 1e999 0");
    assert_eq!(fault(&huge), ScanFault::NotFinite { line: 3, found: "1e999".into() });
    let comma = TETRAHEDRON.replace("v 0 1 0", "v 0,5 1 0");
    assert!(matches!(fault(&comma), ScanFault::Malformed { line: 3, .. }), "{comma}");
    let short = TETRAHEDRON.replace("v 0 1 0", "v 0 1");
    assert!(matches!(fault(&short), ScanFault::Malformed { line: 3, .. }), "{short}");
}

#[test]
fn faces_of_points_that_do_not_exist_are_named_with_their_line() {
    for corner in ["99", "0", "-9", "99999999999999999999", "x"] {
        let text = TETRAHEDRON.replace("f 1 2 4", &format!("f 1 2 {corner}"));
        assert!(matches!(fault(&text), ScanFault::Malformed { line: 6, .. }), "{corner}");
    }
}

#[test]
fn other_files_under_this_ending_are_told_apart() {
    assert_eq!(fault("v 0 0 0\0\n"), ScanFault::Binary { at: 7, value: 0 });
    let stl = "solid leg\nfacet normal 0 0 1\n";
    assert_eq!(fault(stl), ScanFault::NotThisFormat { line: 1, found: "solid leg".into() });
    let escape = fault("hello\u{202e}world\n");
    assert_eq!(escape, ScanFault::NotThisFormat { line: 1, found: "hello???world".into() });
}
