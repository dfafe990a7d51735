//! Points of a mesh that no face uses: strays are left out, missing faces are told.

#![allow(clippy::unwrap_used)]

use std::fmt::Write;

use gaiter_scan::{Format, ScanFault, read};
use proptest::prelude::*;

/// Points along a side of the sheet.
const SIDE: usize = 80;

/// Their distance.
const STEP: f64 = 5.0;

/// A wavy sheet without the faces of the last rows, and strays around it.
fn sheet(rows: usize, strays: &[[f64; 3]]) -> String {
    let mut text = String::new();
    for row in 0..SIDE {
        for column in 0..SIDE {
            let (x, y) = (STEP * column as f64, STEP * row as f64);
            writeln!(text, "v {x} {y} {}", 20.0 * (x / 60.0).sin() * (y / 70.0).cos()).unwrap();
        }
    }
    for [x, y, z] in strays {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for row in 1..rows {
        for column in 1..SIDE {
            let at = (row - 1) * SIDE + column;
            writeln!(
                text,
                "f {at} {} {}\nf {} {} {}",
                at + 1,
                at + SIDE,
                at + 1,
                at + SIDE + 1,
                at + SIDE
            )
            .unwrap();
        }
    }
    text
}

/// Strays near the sheet and far from it, up to a tenth of its points.
fn strays() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let side = STEP * SIDE as f64;
    let near = [0.0..side, 0.0..side, -30.0..30.0];
    let far = [-side..2.0 * side, -side..2.0 * side, -side..side];
    let stray = prop_oneof![near, far];
    prop::collection::vec(stray, 0..SIDE * SIDE / 10)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn strays_of_an_exporter_are_left_out_and_the_mesh_is_read(strays in strays()) {
        let whole = read(sheet(SIDE, &[]).as_bytes(), Format::Obj).unwrap();
        let scan = read(sheet(SIDE, &strays).as_bytes(), Format::Obj).unwrap();
        prop_assert_eq!(scan, whole);
    }

    #[test]
    fn single_faces_that_are_missing_all_over_are_told(every in 2_usize..12) {
        // The faces around every so many points.
        let whole = sheet(SIDE, &[]);
        let is_left_out = |point: usize| (point % SIDE).is_multiple_of(every) && (point / SIDE).is_multiple_of(every);
        let lines = whole.lines().filter(|line| match line.strip_prefix("f ") {
            None => true,
            Some(face) => face.split(' ').all(|word| !is_left_out(word.parse::<usize>().unwrap() - 1)),
        });
        let text: String = lines.map(|line| format!("{line}\n")).collect();
        let fault = read(text.as_bytes(), Format::Obj).unwrap_err();
        prop_assert!(matches!(fault, ScanFault::CutShort { .. }), "{}", fault);
    }

    #[test]
    fn faces_that_are_cut_off_are_told_whatever_strays_there_are(
        strays in strays(),
        missing in 8_usize..SIDE / 2,
    ) {
        let text = sheet(SIDE - missing, &strays);
        let fault = read(text.as_bytes(), Format::Obj).unwrap_err();
        prop_assert!(matches!(fault, ScanFault::CutShort { .. }), "{}", fault);
    }
}
