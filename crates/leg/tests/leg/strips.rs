//! Skin of the inner leg that nobody saw is bridged, with an error that holds.

#![allow(clippy::unwrap_used)]

use gaiter_leg::Method;
use support::recorded::{export, obj, scan, truth};
use support::records::record_of;
use support::strip::without_strip;

const BODIES: [&str; 2] = ["f_average_clean", "f_average_tc2"];

#[test]
fn girths_across_a_strip_that_nobody_saw_are_within_their_errors_and_in_doubt() {
    let method = Method::default();
    for (name, width_deg) in BODIES.into_iter().flat_map(|name| [(name, 60.0), (name, 100.0)]) {
        let (whole, _) = record_of(&export(name), &method);
        let strip = without_strip(&scan(name), &whole, width_deg);
        let (_, record) = record_of(&obj(&strip), &method);
        let truth = truth(name);
        assert_eq!(record.legs.len(), 2, "{name} {width_deg}");
        for leg in &record.legs {
            for level in ["B", "C", "D"] {
                let at = &leg.landmarks[level];
                let own = &truth["legs"][&leg.side]["landmarks"][level];
                let off_mm = at.girth_tape_mm - own["tape_mm"].as_f64().unwrap();
                let sd_mm = at.girth_sd_mm.unwrap();
                let what = format!("{name} {width_deg} {} {level}: {off_mm}", leg.side);
                assert!(off_mm.abs() < 2.5 * sd_mm, "{what}, sd {sd_mm}");
                // A twentieth of the girth at most: the bridge follows the skin on both sides.
                assert!(off_mm.abs() < 0.05 * at.girth_tape_mm, "{what}");
                assert!(at.doubts.iter().any(|doubt| doubt == "gap"), "{what}: {:?}", at.doubts);
            }
        }
    }
}
