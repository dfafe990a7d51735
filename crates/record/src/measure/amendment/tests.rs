//! What people set: what counts after several amendments, and what is not accepted.

use serde_json::{Value, json};

use super::*;
use crate::chart::VolumeFigures;
use crate::measure::{Absent, Length};
use crate::report::Reliability;
use crate::shape::ShapeFigures;

/// A record of two legs with B, C and D; A is estimated. The girth grows by 0.5 mm per mm of height.
fn record() -> Record {
    let landmark = |height_mm: f64, doubts: &[&str]| {
        json!({"by": "rule", "rule": {"is": "turning-point"},
            "height_mm": height_mm, "along_axis_mm": height_mm,
            "girth_tape_mm": 200.0 + height_mm / 2.0, "girth_contour_mm": 0.0,
            "height_sd_mm": 1.0, "girth_sd_mm": 0.5, "doubts": doubts})
    };
    let heights: Vec<f64> = (0..60).map(|step| 10.0 * f64::from(step)).collect();
    let girths: Vec<f64> = heights.iter().map(|height| 200.0 + height / 2.0).collect();
    let leg = |side: &str| {
        json!({"side": side, "tilt_deg": 0.0,
            "axis": {"foot_mm": vec![0.0; 3], "direction": vec![0.0; 3],
                "front": vec![0.0; 3], "lateral": vec![0.0; 3]},
            "landmarks": {"B": landmark(100.0, &[]), "C": landmark(300.0, &["gap", "shallow"]),
                "D": landmark(400.0, &[])},
            "estimates": {"A": {"by": "share", "rule": {"is": "foot-shares"}, "height_mm": 0.0, "along_axis_mm": 0.0,
                "girth_tape_mm": 230.0, "height_sd_mm": null, "girth_sd_mm": 3.0, "doubts": []}},
            "girth_curve": {"height_mm": heights, "along_axis_mm": heights, "tape_mm": girths,
                "contour_mm": girths, "slope": vec![0.5; heights.len()], "r2": 1.0, "rms_mm": 0.0},
            "sections": [], "features": [], "surface": null, "volume": VolumeFigures::default(),
            "at": [], "profile": [], "along": [], "shape": ShapeFigures::default()})
    };
    from(json!({
        "schema": "gaiter.leg-record/1", "revision": 1, "station": null, "patient": null,
        "acquired": null, "made_by": {"gaiter": "0.1.0", "method": {}},
        "scan": {"sha256": "0", "format": "obj", "unit": "mm", "unit_inferred": false,
                 "points": 0, "triangles": 0},
        "body": {"stature_mm": null, "crotch_height_mm": 780.0, "crotch_from": "saddle",
                 "facing_deg": 0.0,
                 "facing_from": "feet", "from_export": vec![0.0; 16]},
        "legs": [leg("right"), leg("left")], "differences": null, "findings": [],
    }))
}

fn from<T: serde::de::DeserializeOwned>(value: Value) -> T {
    serde_json::from_value(value).unwrap()
}

/// An amendment of the right leg.
fn set(measure: &str, is: Deed, [girth, height, length]: [Option<f64>; 3]) -> Amendment {
    Amendment {
        leg: "right".to_owned(),
        measure: measure.to_owned(),
        is,
        girth_mm: girth,
        height_mm: height,
        length_mm: length,
        reason: "swollen".to_owned(),
        by: "Anna Berg".to_owned(),
        at: "2026-11-25T10:00:00Z".parse().unwrap(),
    }
}

fn girth(measure: &str, mm: f64) -> Amendment {
    set(measure, Deed::Measured, [Some(mm), None, None])
}

fn height(measure: &str, mm: f64) -> Amendment {
    set(measure, Deed::Measured, [None, Some(mm), None])
}

const NONE: [Option<f64>; 3] = [None; 3];

fn what(fault: AmendFault) -> What {
    match fault {
        AmendFault::At { what, .. } => what,
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_a_person_set_counts_and_the_rest_and_the_other_leg_stay_the_scans() {
    let before = record();
    let after = before.amended(&[girth("C", 385.0)], true).unwrap();
    let c = Measure::find(&after, Side::Right, Level::C).unwrap();
    assert_eq!((c.girth.mm, c.mark()), (385.0, Reliability::ByHand));
    let height = c.height.unwrap();
    assert_eq!((height.mm, height.sd_mm), (300.0, Some(1.0)));
    // The doubt about the girth is settled, the doubt about the height is not.
    assert_eq!((c.doubts.as_slice(), c.mark_of(height)), (&["shallow"][..], Reliability::Doubtful));
    let other = Measure::find(&after, Side::Left, Level::C).unwrap();
    assert_eq!(other, Measure::find(&before, Side::Left, Level::C).unwrap());
    assert_eq!(after.legs, before.legs, "the scan's value never changes");
}

#[test]
fn where_only_the_height_is_set_the_girth_is_the_scans_there() {
    let after = record().amended(&[height("C", 312.0)], true).unwrap();
    let c = Measure::find(&after, Side::Right, Level::C).unwrap();
    assert_eq!((c.girth.mm, c.girth.is_by_hand), (356.0, false));
    assert_eq!((c.height.unwrap().mm, c.doubts.as_slice()), (312.0, &["gap"][..]));
    // Also where the scan did not find the level at all.
    let after = record().amended(&[height("B1", 150.0)], true).unwrap();
    let b1 = Measure::find(&after, Side::Right, Level::B1).unwrap();
    assert_eq!((b1.girth.mm, b1.height.unwrap().mm, b1.is_estimate), (275.0, 150.0, false));
}

#[test]
fn later_amendments_add_to_earlier_ones_and_taking_back_ends_them_all() {
    fn c(of: &Record) -> Result<Measure<'_>, Absent> {
        Measure::find(of, Side::Right, Level::C)
    }
    let both = record().amended(&[girth("C", 385.0), height("C", 305.0)], true).unwrap();
    let measure = c(&both).unwrap();
    assert_eq!((measure.girth.mm, measure.height.unwrap().mm), (385.0, 305.0));
    assert!(measure.doubts.is_empty());
    let again = both.amended(&[girth("C", 386.0)], true).unwrap();
    assert_eq!(c(&again).unwrap().girth.mm, 386.0);
    let not = again.amended(&[set("C", Deed::NotMeasurable, NONE)], true).unwrap();
    assert_eq!(c(&not), Err(Absent::NotMeasurable));
    let anew = not.amended(&[girth("C", 387.0)], true).unwrap();
    let measure = c(&anew).unwrap();
    // What was set before it was noted as not measurable does not come back.
    assert_eq!((measure.girth.mm, measure.height.unwrap().mm), (387.0, 300.0));
    let back = anew.amended(&[set("C", Deed::TakenBack, NONE)], true).unwrap();
    assert_eq!(c(&back), c(&record()));
    assert_eq!(back.amendments.len(), 6, "all of them stay");
    let fault = back.amended(&[set("C", Deed::TakenBack, NONE)], true).unwrap_err();
    assert_eq!(what(fault), What::NothingToTakeBack);
}

#[test]
fn a_level_that_the_scan_did_not_find_needs_girth_and_height_on_the_foot_a_girth() {
    let fault = record().amended(&[girth("E", 400.0)], true).unwrap_err();
    assert_eq!(what(fault), What::Half { value: "height" });
    let fault = record().amended(&[height("G", 700.0)], true).unwrap_err();
    assert_eq!(what(fault), What::Half { value: "girth" }, "the scan has no girth up there");
    let e = set("E", Deed::Measured, [Some(400.0), Some(450.0), None]);
    assert!(record().amended(&[e], true).is_ok());
    let y = record().amended(&[girth("Y", 330.0), girth("A", 235.0)], true).unwrap();
    for (level, mm) in [(Level::Y, 330.0), (Level::A, 235.0)] {
        let of = Measure::find(&y, Side::Right, level).unwrap();
        assert_eq!(
            (of.girth.mm, of.height, of.mark()),
            (mm, None, Reliability::ByHand),
            "{level:?}"
        );
    }
}

#[test]
fn a_height_lies_between_those_of_the_other_levels_after_all_that_is_set_at_once() {
    let fault = record().amended(&[height("C", 401.0)], true).unwrap_err();
    let order = What::Order { height_mm: 401.0, is_above: false, other: "D", other_mm: 400.0 };
    assert_eq!(what(fault), order);
    let fault = record().amended(&[height("C", 100.0)], true).unwrap_err();
    assert!(matches!(what(fault), What::Order { is_above: true, other: "B", .. }));
    // Both move: neither order of the two is wrong.
    for pair in [["C", "D"], ["D", "C"]] {
        let set = pair.map(|level| height(level, if level == "C" { 410.0 } else { 450.0 }));
        assert!(record().amended(&set, true).is_ok());
    }
}

#[test]
fn what_is_far_off_the_scan_is_only_set_by_a_person_who_is_sure() {
    // The scan has 350 mm at 300 mm, and 15 % of it are 52.5 mm.
    for (mm, is_near) in [(298.0, true), (297.0, false), (402.0, true), (403.0, false)] {
        let set = [girth("C", mm)];
        assert_eq!(record().amended(&set, false).is_ok(), is_near, "{mm}");
        assert!(record().amended(&set, true).is_ok());
    }
    let fault = record().amended(&[girth("C", 138.0)], false).unwrap_err();
    assert!(fault.is_far_off());
    assert_eq!(
        what(fault),
        What::FarOff { value: "girth", found_mm: 138.0, scanned_mm: 350.0 },
        "inches"
    );
    // Compared with the scan at the height that is set, not at the scan's own.
    let moved = set("B", Deed::Measured, [Some(330.0), Some(250.0), None]);
    assert!(record().amended(&[moved], false).is_ok());
    // What the scan does not give cannot be compared.
    assert!(record().amended(&[girth("Y", 330.0)], false).is_ok());
}

#[test]
fn the_inside_of_the_leg_ends_above_all_levels() {
    let length = |mm| set("inside-leg", Deed::Measured, [None, None, Some(mm)]);
    let fault = record().amended(&[length(300.0)], true).unwrap_err();
    assert!(matches!(what(fault), What::Order { is_above: true, other: "C", .. }));
    assert!(record().amended(&[length(760.0)], true).is_ok());
}

#[test]
fn values_that_no_leg_has_are_not_set() {
    for (amendment, expected) in [
        (girth("C", 49.9), "girth"),
        (girth("C", 1500.1), "girth"),
        (height("C", 9.0), "height"),
        (set("foot-length", Deed::Measured, [None, None, Some(451.0)]), "length"),
        (set("inside-leg", Deed::Measured, [None, None, Some(f64::INFINITY)]), "length"),
    ] {
        let what = what(record().amended(&[amendment], true).unwrap_err());
        assert!(matches!(what, What::Range { value, .. } if value == expected), "{what:?}");
    }
    for (amendment, value) in [
        (height("Y", 50.0), "height"),
        (girth("foot-length", 250.0), "girth"),
        (set("C", Deed::Measured, [None, None, Some(300.0)]), "length"),
        (set("C", Deed::NotMeasurable, [Some(380.0), None, None]), "girth"),
    ] {
        assert_eq!(what(record().amended(&[amendment], true).unwrap_err()), What::NoSuch { value });
    }
    let nothing = record().amended(&[set("C", Deed::Measured, NONE)], true).unwrap_err();
    assert_eq!(what(nothing), What::Nothing);
    assert!(record().amended(&[girth("C", f64::NAN)], true).is_err());
}

#[test]
fn reason_and_name_are_one_line_that_says_something() {
    for words in ["", "  "] {
        let reason = Amendment { reason: words.to_owned(), ..girth("C", 385.0) };
        assert_eq!(record().amended(&[reason], true).unwrap_err(), AmendFault::NoWords("reason"));
        let by = Amendment { by: words.to_owned(), ..girth("C", 385.0) };
        assert_eq!(record().amended(&[by], true).unwrap_err(), AmendFault::NoWords("by"));
    }
    for words in ["a\nb", "a\u{7f}b", &"x".repeat(WORDS_MOST + 1)] {
        let reason = Amendment { reason: words.to_owned(), ..girth("C", 385.0) };
        assert_eq!(record().amended(&[reason], true).unwrap_err(), AmendFault::Words("reason"));
        let by = Amendment { by: words.to_owned(), ..girth("C", 385.0) };
        assert_eq!(record().amended(&[by], true).unwrap_err(), AmendFault::Words("by"));
    }
    let long = Amendment { by: "ü".repeat(WORDS_MOST), ..girth("C", 385.0) };
    assert!(record().amended(&[long], true).is_ok());
    let leg = Amendment { leg: "both".to_owned(), ..girth("C", 385.0) };
    assert_eq!(record().amended(&[leg], true).unwrap_err(), AmendFault::Leg("both".to_owned()));
    let measure = girth("C2", 385.0);
    assert!(matches!(record().amended(&[measure], true).unwrap_err(), AmendFault::Measure(_)));
}

#[test]
fn lengths_of_foot_and_inside_leg_are_set_on_one_leg_alone() {
    let length = |measure| set(measure, Deed::Measured, [None, None, Some(250.0)]);
    let inside = set("inside-leg", Deed::Measured, [None, None, Some(760.0)]);
    let after = record().amended(&[length("foot-length"), inside], true).unwrap();
    let of = |side, subject| Length::find(&after, side, subject);
    assert_eq!(of(Side::Right, Subject::FootLength), Ok(Length::by_hand(250.0)));
    assert_eq!(of(Side::Left, Subject::FootLength), Err(Absent::NotFound));
    assert_eq!(of(Side::Right, Subject::FootBreadth), Err(Absent::NotFound));
    assert_eq!(of(Side::Right, Subject::InsideLeg), Ok(Length::by_hand(760.0)));
    assert_eq!(of(Side::Left, Subject::InsideLeg).unwrap().mm, 780.0);
}

#[test]
fn a_leg_that_was_not_in_the_scan_can_be_measured_by_hand() {
    let mut record = record();
    record.legs.retain(|leg| leg.side == "left");
    assert_eq!(record.sides().collect::<Vec<_>>(), [Side::Left]);
    let c = set("C", Deed::Measured, [Some(380.0), Some(300.0), None]);
    let after = record.amended(&[c], true).unwrap();
    assert_eq!(after.sides().collect::<Vec<_>>(), [Side::Right, Side::Left]);
    assert_eq!(Measure::find(&after, Side::Right, Level::C).unwrap().girth.mm, 380.0);
}

#[test]
fn a_record_that_was_read_back_holds_only_possible_amendments() {
    let mut record = record().amended(&[girth("C", 385.0)], true).unwrap();
    assert!(record.clone().checked().is_ok());
    record.amendments[0].girth_mm = Some(5.0);
    assert!(record.checked().unwrap_err().to_string().contains("girth 0.5 cm"));
}

#[test]
fn every_fault_is_said_in_every_language() {
    let faults = [
        AmendFault::Leg("x".to_owned()),
        AmendFault::Measure("x".to_owned()),
        AmendFault::NoWords("reason"),
        AmendFault::Words("by"),
    ];
    let order = |is_above| What::Order { height_mm: 1.0, is_above, other: "B", other_mm: 2.0 };
    let whats = [
        What::Nothing,
        What::NoSuch { value: "girth" },
        What::Range { value: "height", found_mm: 1.0, range_mm: [2.0, 3.0] },
        What::Half { value: "length" },
        order(true),
        order(false),
        What::FarOff { value: "girth", found_mm: 100.0, scanned_mm: 300.0 },
        What::NothingToTakeBack,
    ];
    let at = |what| AmendFault::at(Side::Right, Subject::FootLength, what);
    for fault in faults.into_iter().chain(whats.map(at)) {
        let [en, de] = [Language::En, Language::De].map(|language| fault.in_words(language));
        assert!(!en.is_empty() && en != de, "{en} / {de}");
    }
}
