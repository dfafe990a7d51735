//! Skin of the inner leg that nobody saw is bridged, with an error that holds.

#![allow(clippy::unwrap_used)]

use gaiter_leg::Method;
use gaiter_leg::doubt::Doubt;
use support::recorded::{export, extract_scan, scan, truth};
use support::strip::without_strip;

use crate::found::{B_C_D, extraction_of, known_mm, landmark};

const BODIES: [&str; 2] = ["f_average_clean", "f_average_tc2"];

#[test]
fn girths_across_a_strip_that_nobody_saw_are_within_their_errors_and_in_doubt() {
    let method = Method::default();
    for (name, width_deg) in BODIES.into_iter().flat_map(|name| [(name, 60.0), (name, 100.0)]) {
        let whole = extraction_of(&export(name), &method);
        let strip = without_strip(&scan(name), &whole, width_deg);
        let found = extract_scan(&strip, &method).unwrap();
        let truth = truth(name);
        assert_eq!(found.legs.len(), 2, "{name} {width_deg}");
        for leg in &found.legs {
            let side = leg.side.word();
            for level in B_C_D {
                let (at, level) = (landmark(leg, level), level.name());
                let own = &truth["legs"][side]["landmarks"][level];
                let off_mm = at.girth_tape_mm - own["tape_mm"].as_f64().unwrap();
                let sd_mm = known_mm(at.girth_sd_mm);
                let what = format!("{name} {width_deg} {side} {level}: {off_mm}");
                assert!(off_mm.abs() < 2.5 * sd_mm, "{what}, sd {sd_mm}");
                // A twentieth of the girth at most: the bridge follows the skin on both sides.
                assert!(off_mm.abs() < 0.05 * at.girth_tape_mm, "{what}");
                let is_of_gap = |doubt: &Doubt| matches!(doubt, Doubt::Gap { .. });
                assert!(at.doubts.iter().any(is_of_gap), "{what}: {:?}", at.doubts);
            }
        }
    }
}
