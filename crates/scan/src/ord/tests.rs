//! Measurement files as scanners write them, as they do not, and mangled ones.

use proptest::prelude::*;

use super::*;

/// A file with CRLF, a comment, words for values, an angle and an umlaut in Latin-1.
const USUAL: &[u8] = b"// J\xfcrgen\r\nOPTION UNITS=cm\r\nOPTION POSE=A\r\n\
    MEASURE Head_Top_Height=170.25\r\nMEASURE Calf Left=36,5\r\n  measure Calf_Right = 36.25 \r\n\
    MEASURE Landmarks=none\r\nMEASURE Joints=\r\nMEASURE Seat_Back_Angle=-12\r\nLANDMARK 1 2 3\r\n";

fn text(lines: &[&str]) -> Vec<u8> {
    lines.join("\n").into_bytes()
}

#[test]
fn a_usual_file_gives_its_measures_in_millimetres() {
    let ord = read(USUAL).unwrap();
    let expected = [
        ("Head_Top_Height", 1702.5),
        ("Calf Left", 365.0),
        ("Calf_Right", 362.5),
        ("Seat_Back_Angle", -120.0),
    ];
    assert_eq!(ord.measures, expected.map(|(name, mm)| (name.to_owned(), mm)));
}

#[test]
fn the_unit_holds_for_the_whole_file_wherever_it_stands() {
    for (word, mm) in [("mm", 1.0), ("cm", 10.0), ("in", 25.4), ("IN", 25.4), ("inches", 25.4)] {
        let ord = read(&text(&["MEASURE a=2", &format!("option units = {word}")])).unwrap();
        assert_eq!(ord.measures, [("a".to_owned(), 2.0 * mm)], "{word}");
    }
}

#[test]
fn utf_8_and_a_byte_order_mark_are_read_too() {
    let ord = read("\u{feff}OPTION UNITS=mm\nMEASURE Größe=1700\n".as_bytes()).unwrap();
    assert_eq!(ord.measures, [("Größe".to_owned(), 1700.0)]);
}

#[test]
fn every_fault_is_told_with_its_line() {
    let found = |found: &str| found.to_owned();
    let cases = [
        (
            vec!["OPTION UNITS=cm", "", "MEASURE a=3x6"],
            OrdFault::NotANumber { line: 3, found: found("3x6") },
        ),
        (vec!["MEASURE a=1.234,5"], OrdFault::NotANumber { line: 1, found: found("1.234,5") }),
        (vec!["MEASURE a=1e999"], OrdFault::NotANumber { line: 1, found: found("1e999") }),
        (vec!["x", "MEASURE =5"], OrdFault::NoName { line: 2, found: found("=5") }),
        (vec!["MEASURE Calf 36"], OrdFault::NoName { line: 1, found: found("Calf 36") }),
        (
            vec!["MEASURE a=1", "OPTION UNITS=ft"],
            OrdFault::UnknownUnit { line: 2, found: found("ft") },
        ),
        (
            vec!["OPTION UNITS=cm", "OPTION UNITS=CM", "OPTION UNITS=in"],
            OrdFault::TwoUnits { line: 3, before: "cm", now: "in" },
        ),
        (vec!["MEASURE a=1", "b"], OrdFault::NoUnit { lines: 2 }),
        (vec!["OPTION UNITS=cm", "MEASURE a=word"], OrdFault::NoMeasures { lines: 2 }),
        (vec![], OrdFault::NoMeasures { lines: 0 }),
        (vec!["a", "MEASURE a=1\0"], OrdFault::Binary { line: 2 }),
    ];
    for (lines, fault) in cases {
        assert_eq!(read(&text(&lines)), Err(fault), "{lines:?}");
    }
    assert_eq!(read(&vec![b'\n'; BYTES_MAX + 1]), Err(OrdFault::TooLarge));
    assert!(read(&vec![b'\n'; BYTES_MAX]) != Err(OrdFault::TooLarge));
}

#[test]
fn a_fault_shows_no_more_than_a_short_printable_piece() {
    let line = format!("MEASURE a=1\u{202e}{}", "9".repeat(10_000));
    let said = read(&text(&[&line])).unwrap_err().to_string();
    assert!(said.is_ascii() && said.len() < 100, "{said}");
}

#[test]
fn a_file_belongs_to_the_scan_of_its_stem_with_space_plus_and_underscore_alike() {
    let with = |name: &str, scan: &str| belongs(name.as_bytes(), scan.as_bytes());
    for name in ["a b_1.ord", "a+b+1.ORD", "a_b 1.Ord"] {
        assert!(with(name, "a b_1.obj"), "{name}");
    }
    for name in ["a-b_1.ord", "a b_1.obj", "a b_1", "A b_1.ord", "a b_1.ord.bak", "ab_1.ord"] {
        assert!(!with(name, "a b_1.obj"), "{name}");
    }
    assert!(with("4711.a.ord", "4711.a.obj") && !with("4711.ord", "4711.a.obj"));
    assert!(
        belongs(b"M\xfcller.ord", b"M\xfcller.obj") && !belongs(b"M\xfcller.ord", b"Mller.obj")
    );
}

proptest! {
    // A case found here is kept as a test above.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bytes_of_any_kind_are_answered(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = read(&bytes);
    }

    /// The usual file with a stroke of an eraser and a few bytes typed in.
    #[test]
    fn a_mangled_file_is_answered_with_finite_measures_or_a_line_that_exists(
        from in 0..USUAL.len(), length in 0..30_usize,
        typed in proptest::collection::vec(
            prop_oneof![Just(b'='), Just(b'\n'), Just(b','), Just(b'e'), Just(b'9'), any::<u8>()],
            0..12,
        ),
    ) {
        let to = (from + length).min(USUAL.len());
        let bytes = [&USUAL[..from], &typed, &USUAL[to..]].concat();
        let lines = 1 + bytes.iter().filter(|&&byte| byte == b'\n').count();
        match read(&bytes) {
            Ok(ord) => {
                prop_assert!(ord.measures.len() <= lines);
                let held: usize = ord.measures.iter().map(|(name, _)| name.len()).sum();
                // Latin-1 takes at most twice its bytes.
                prop_assert!(held <= 2 * bytes.len());
                prop_assert!(ord.measures.iter().all(|(name, mm)| !name.is_empty() && mm.is_finite()));
            }
            Err(
                OrdFault::Binary { line }
                | OrdFault::NotANumber { line, .. }
                | OrdFault::NoName { line, .. }
                | OrdFault::UnknownUnit { line, .. }
                | OrdFault::TwoUnits { line, .. },
            ) => prop_assert!((1..=lines).contains(&line)),
            Err(OrdFault::NoUnit { lines: found } | OrdFault::NoMeasures { lines: found }) => {
                prop_assert!(found <= lines);
            }
            Err(OrdFault::TooLarge) => prop_assert!(false, "{} bytes", bytes.len()),
        }
    }
}
