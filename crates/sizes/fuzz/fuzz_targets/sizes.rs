//! Any bytes as a size table, as a garment and as a mapping: read or refused with places, then used.
#![no_main]

use gaiter_sizes::check::remarks;
use gaiter_sizes::verdict::{Given, Reading, leg_verdict};
use gaiter_sizes::{DocumentFault, Garment, mapping, parse};
use jiff::civil::date;

/// What is true of the faults of any file.
fn placed(bytes: &[u8], faults: &[DocumentFault]) {
    assert!(!faults.is_empty());
    let lines = bytes.iter().filter(|byte| **byte == b'\n').count() + 1;
    for fault in faults {
        assert!((1..=lines).contains(&fault.line) && fault.column >= 1, "{fault}");
        let said = fault.to_string();
        assert!(!said.chars().any(|letter| letter.is_control()), "{said:?}");
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    match parse(bytes) {
        Err(faults) => placed(bytes, &faults),
        Ok(table) => {
            remarks(&table, date(2026, 11, 25), &["AD"]);
            let given = Given { mm: 300.0, uncertainty_mm: Some(1.0), is_by_hand: false };
            for garment in Garment::shipped() {
                let Ok(verdict) = leg_verdict(&table, garment, |_| Reading::Given(given)) else { continue };
                let points = verdict.sizes.iter().flat_map(|size| &size.points);
                for share in points.filter_map(|point| point.probability) {
                    assert!((0.0..=1.0).contains(&share), "{share}");
                }
            }
        }
    }
    if let Err(faults) = mapping::parse(bytes) {
        placed(bytes, &faults);
    }
    match Garment::read(bytes) {
        Err(faults) => placed(bytes, &faults),
        Ok(garment) => {
            for of in garment.boxes() {
                let printed_mm = garment.printed_mm(of.point, 1234.5);
                assert!((printed_mm - 1234.5).abs() <= garment.step_mm(of.point) / 2.0 + 1e-9);
            }
        }
    }
});
