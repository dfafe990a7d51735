//! What the OBJ decoder takes and what it refuses.

use nalgebra::Point3;

use super::super::{Content, CutSign, Format, Scan, ScanFault, SourcePosition};

fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    super::super::read(bytes, Format::Obj)
}

const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";

fn not_this(found: &str) -> ScanFault {
    ScanFault::NotThisFormat { format: Format::Obj, line: 1, found: found.into() }
}

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
fn a_large_mesh_is_the_same_however_its_lines_are_written() {
    // More triangles than tobj gets as one object.
    let points = (0..20_000).map(|i| format!("v {i} {}.5 -{}\n", i % 7, i % 5));
    let faces = (1..=19_998).map(|i| format!("f {i} {} {}\n", i + 1, i + 2));
    let plain: String = points.chain(faces).collect();
    let scan = read(plain.as_bytes()).unwrap();
    assert_eq!((scan.points.len(), scan.triangles.len()), (20_000, 19_998));
    let (points, faces) = plain.split_at(plain.find('f').unwrap());
    assert!(read(format!("{faces}{points}").as_bytes()).as_ref() == Ok(&scan), "faces first");
    assert_eq!(scan.triangles[19_997], [19_997, 19_998, 19_999]);
    assert_eq!(scan.points[19_999], Point3::new(19_999.0, 0.5, -4.0));
    let ways =
        [(" ", "\n"), ("\t", "\n"), ("  ", "\n"), (" ", "\r\n"), (" ", " \r\n"), (" ", "\r")];
    for (blank, end) in ways {
        let way = plain.replace(' ', blank).replace('\n', end);
        assert!(read(way.as_bytes()).as_ref() == Ok(&scan), "{blank:?} {end:?}");
        let said = fault(&format!("{way}f 1 2 x{end}")).to_string();
        assert!(said.starts_with("line 39999: "), "{blank:?} {end:?}: {said}");
    }
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
            let placed =
                ScanFault::NotFinite { place: SourcePosition::Line(5), found: "nan".into() };
            assert_eq!(fault(&text), placed, "{text:?}");
        }
    }
}

#[test]
fn only_the_mark_of_utf_8_is_skipped_and_only_at_the_start() {
    let utf16 = TETRAHEDRON.encode_utf16().flat_map(u16::to_le_bytes);
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(utf16).collect();
    let utf16 = read(&utf16).unwrap_err();
    assert_eq!(utf16, ScanFault::LooksLike { content: Content::Utf16, format: Format::Obj });
    assert!(utf16.to_string().ends_with("UTF-16 text, not OBJ; export as ASCII or UTF-8"));
    let twice = fault(&format!("\u{feff}\u{feff}{TETRAHEDRON}"));
    assert_eq!(twice, not_this("???v 0 0 0"));
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
    assert!(matches!(fault(&strip(1900)), ScanFault::CutShort { .. }));
    // Of more than a fifth it does not matter where they lie.
    let what = CutSign::UnusedPoints { unused: 401, points: 2000 };
    assert_eq!(fault(&strip(1597)), ScanFault::CutShort { what });
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
    let unplaced = ScanFault::Malformed { place: SourcePosition::Unknown, what: "wrong".into() };
    for said in [ScanFault::NoPoints.to_string(), unplaced.to_string()] {
        assert!(!said.contains("line 0"), "{said}");
    }
    let placed = ScanFault::Malformed { place: SourcePosition::Line(7), what: "wrong".into() };
    assert_eq!(placed.to_string(), "line 7: wrong");
}

#[test]
fn points_without_faces_are_a_cloud_of_all_points() {
    let points = "v 0 0 0\nv 1,5 0 0 255 0 0\nv 1,5 0 0\n";
    for faces in ["", "f 1 2\n", "f 1 2 1\nf 3 3 3\n", "l 1 2\np 3\n"] {
        let cloud = read(format!("{points}{faces}").as_bytes()).unwrap();
        let [a, b] = [Point3::origin(), Point3::new(1.5, 0.0, 0.0)];
        assert_eq!(cloud, Scan { points: vec![a, b, b], triangles: vec![] }, "{faces}");
    }
}

#[test]
fn repeated_points_are_one() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 4 6 5\n";
    let scan = read(text.as_bytes()).unwrap();
    assert_eq!(scan.points.len(), 4);
    assert_eq!(scan.triangles, [[0, 1, 2], [1, 3, 2]]);
}

#[test]
fn a_backslash_goes_on_with_the_next_line_but_not_in_names() {
    let plain = read(TETRAHEDRON.as_bytes()).unwrap();
    let broken = TETRAHEDRON.replace("v 1 0 0", "v 1 \\\n 0 \\\r\n0").replace("f 1 3", "f 1\\\n3");
    let named = format!("# C:\\scans\\\nmtllib C:\\scans\\\n{broken}");
    assert_eq!(read(named.as_bytes()).unwrap(), plain);
    let open = ScanFault::CutShort { what: CutSign::NoLineEnd { line: 8 } };
    assert_eq!(fault(&TETRAHEDRON.replace("f 2 3 4", "f 2 3 \\")), open);
    let nan = broken.replace("v 0 1 0", "v 0 \\\nnan 0");
    assert!(fault(&nan).to_string().starts_with("line 5: "), "where the statement begins");
}

#[test]
fn faces_may_stand_before_their_points_and_count_back() {
    let [points, faces] = [&TETRAHEDRON[..32], &TETRAHEDRON[32..]];
    let before = format!("{faces}{points}");
    assert_eq!(read(before.as_bytes()), read(TETRAHEDRON.as_bytes()));
    let back = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -1 -3 -4\nf 1 2 3\n";
    assert_eq!(read(back.as_bytes()).unwrap().triangles, [[0, 1, 2], [3, 1, 0], [4, 0, 1]]);
}

#[test]
fn decimal_commas_are_read_and_mixed_signs_are_not() {
    let comma = TETRAHEDRON.replace("v 1 0 0", "v 1,5 0 0");
    let scan = read(comma.as_bytes()).unwrap();
    assert_eq!(scan.points[1], Point3::new(1.5, 0.0, 0.0));
    let mixed = fault(&comma.replace("v 0 0 1", "v 0 0 1.5")).to_string();
    assert!(mixed.starts_with("line 4: ") && mixed.contains("line 2"), "{mixed}");
}

#[test]
fn numbers_that_are_none_are_named_with_their_line() {
    let not_finite =
        |found: &str| ScanFault::NotFinite { place: SourcePosition::Line(3), found: found.into() };
    for found in ["nan", "1e999", "-1.#IND"] {
        let text = TETRAHEDRON.replace("v 0 1 0", &format!("v 0 {found} 0"));
        assert_eq!(fault(&text), not_finite(found));
    }
    for statement in ["v 0,5,5 1 0", "v 0 1", "v 0 1 ", "v 0  1", "v 0 two 0", "v 0 1/2 0", "v"] {
        let said = fault(&TETRAHEDRON.replace("v 0 1 0", statement)).to_string();
        assert!(said.starts_with("line 3: "), "{said}");
    }
}

#[test]
fn faces_of_points_that_do_not_exist_are_named_with_their_line() {
    for corner in ["99", "0", "-9", "99999999999999999999", "x"] {
        let text = TETRAHEDRON.replace("f 1 2 4", &format!("f 1 2 {corner}"));
        let place = SourcePosition::Line(6);
        let what = format!("\"{corner}\" is no corner of a face");
        assert_eq!(fault(&text), ScanFault::Malformed { place, what });
    }
}

#[test]
fn other_files_under_this_ending_are_told_apart() {
    assert_eq!(fault("v 0 0 0\0\n"), ScanFault::Binary { at: 7, value: 0 });
    let json = "{\"points\": []}\n";
    assert_eq!(fault(json), not_this("{\"points\": []}"));
    let escape = fault("hello\u{202e}world\n");
    assert_eq!(escape, not_this("hello???world"));
    let said = fault("solid leg\nfacet normal 0 0 1\n").to_string();
    assert_eq!(said, "the content looks like STL, not OBJ; rename the file or mend the exporter");
}
