//! What every decoder must guarantee for any bytes.

use gaiter_scan::{End, Format, ScanFault, completeness, reading};

/// Decodes the bytes and checks the invariants of the result.
pub fn held(bytes: &[u8], format: Format) {
    let complete = completeness(bytes, format);
    let reading = reading(bytes, format);
    match reading.scan {
        Ok(scan) => {
            assert!(reading.end != End::CutShort, "decoded although cut short");
            assert_eq!(complete.is_ok(), reading.end == End::Whole);
            assert!(!scan.points.is_empty());
            assert!(scan.points.iter().all(|p| p.iter().all(|c| c.is_finite())));
            let mut used = vec![false; scan.points.len()];
            for &[a, b, c] in &scan.triangles {
                assert!(a != b && b != c && c != a);
                [a, b, c].iter().for_each(|&corner| used[corner as usize] = true);
            }
            assert!(scan.triangles.is_empty() || used.iter().all(|used| *used));
        }
        Err(fault) => {
            let said = fault.to_string();
            assert!(!said.is_empty() && said.lines().count() == 1 && said.len() < 400, "{said}");
            assert!(said.chars().all(|c| !c.is_control()), "{said:?}");
            if let Err(cut) = &complete {
                assert!(
                    *cut == fault || matches!(fault, ScanFault::LooksLike { .. }),
                    "{cut} but {fault}"
                );
            }
        }
    }
}
