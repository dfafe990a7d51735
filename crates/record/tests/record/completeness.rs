//! What is to be done before the patient dresses: from findings, doubts and the ordered garment, on every
//! surface in the same words.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter_language::Language;
use gaiter_record::Record;
use gaiter_record::completeness::{Completeness, Kind};
use gaiter_record::measure::amendment::{Amendment, Deed};
use gaiter_record::schema::FindingNote;
use gaiter_sizes::Garment;
use support::records::measured;

/// A body of which every level was found, without findings.
static RECORD: LazyLock<Record> = LazyLock::new(|| {
    let mut record = measured("f_average_clean").1.clone();
    record.findings.clear();
    for leg in &mut record.legs {
        leg.landmarks.values_mut().for_each(|found| found.doubts.clear());
    }
    record
});

fn finding(code: &str, leg: Option<&str>, level: Option<&str>) -> FindingNote {
    FindingNote {
        code: code.to_owned(),
        severity: "warning".to_owned(),
        leg: leg.map(str::to_owned),
        level: level.map(str::to_owned),
        message: String::new(),
        says: None,
    }
}

/// The record after a change to its right leg.
fn with_right(change: impl Fn(&mut gaiter_record::schema::LegFigures)) -> Record {
    let mut record = RECORD.clone();
    record.legs.iter_mut().filter(|leg| leg.side == "right").for_each(change);
    record
}

fn doubted(level: &str, doubt: &str) -> Record {
    with_right(|leg| leg.landmarks.get_mut(level).unwrap().doubts = vec![doubt.to_owned()])
}

fn found(finding: FindingNote) -> Record {
    Record { findings: vec![finding], ..RECORD.clone() }
}

fn said(record: &Record, garment: &Garment) -> String {
    Completeness::from_record(record, garment).sentences(Language::En).join(" ")
}

#[test]
fn a_whole_record_is_complete_for_a_calf_stocking_and_estimates_are_not_measures() {
    assert_eq!(Completeness::from_record(&RECORD, &Garment::default()).kind(), Kind::Complete);
    assert_eq!(
        said(&RECORD, &Garment::default()),
        "Complete: all measures for a calf stocking (AD) were taken."
    );
    assert_eq!(
        said(&RECORD, &Garment::named("AF").unwrap()),
        "Measure by hand: right leg: F and E; left leg: F and E."
    );
    assert_eq!(
        said(&RECORD, &Garment::named("AG").unwrap()),
        "Measure by hand: right leg: F and E; left leg: F and E."
    );
}

#[test]
fn what_is_missing_or_doubtful_is_measured_by_hand_if_the_garment_needs_it() {
    let without = |level: &'static str| with_right(move |leg| drop(leg.landmarks.remove(level)));
    for (record, garment, expected) in [
        (without("C"), &Garment::default(), "Measure by hand: right leg: C."),
        (without("Y"), &Garment::default(), "Measure by hand: right leg: Y."),
        (
            without("A"),
            &Garment::default(),
            "Complete: all measures for a calf stocking (AD) were taken.",
        ),
        (
            without("G"),
            &Garment::default(),
            "Complete: all measures for a calf stocking (AD) were taken.",
        ),
        (
            without("G"),
            &Garment::named("AG").unwrap(),
            "Measure by hand: right leg: G, F and E; left leg: F and E.",
        ),
        (doubted("B1", "flat"), &Garment::default(), "Measure by hand: right leg: B1."),
        (
            doubted("G", "gap"),
            &Garment::default(),
            "Complete: all measures for a calf stocking (AD) were taken.",
        ),
        // The tape bridges folds, as the figure says.
        (
            doubted("C", "folds"),
            &Garment::default(),
            "Complete: all measures for a calf stocking (AD) were taken.",
        ),
        (
            with_right(|leg| leg.foot = None),
            &Garment::default(),
            "Measure by hand: right leg: foot.",
        ),
    ] {
        assert_eq!(said(&record, garment), expected);
    }
}

#[test]
fn what_another_scan_would_do_better_comes_first() {
    for (record, garment, expected) in [
        (
            doubted("C", "cloth"),
            &Garment::default(),
            "Scan again: with bare legs. Or measure by hand: right leg: C.",
        ),
        (
            doubted("C", "scatter"),
            &Garment::default(),
            "Scan again: standing still. Or measure by hand: right leg: C.",
        ),
        (
            found(finding("leg-not-measured", Some("left"), None)),
            &Garment::default(),
            "Scan again: both legs whole in view.",
        ),
        (found(finding("feet-cut", None, None)), &Garment::default(), "Scan again: barefoot."),
        (
            found(finding("floor-uneven", None, None)),
            &Garment::default(),
            "Scan again: both feet flat on the floor.",
        ),
        // The leg has all that a calf stocking needs.
        (
            found(finding("leg-cut", Some("left"), None)),
            &Garment::default(),
            "Complete: all measures for a calf stocking (AD) were taken.",
        ),
        (
            found(finding("thighs-touch", None, None)),
            &Garment::default(),
            "Complete: all measures for a calf stocking (AD) were taken.",
        ),
    ] {
        assert_eq!(said(&record, garment), expected);
        let kind = Completeness::from_record(&record, garment).kind();
        assert_eq!(kind == Kind::ScanAgain, expected.starts_with("Scan again"), "{expected}");
    }
    let mut touching = doubted("G", "gap");
    let expected =
        "Scan again: legs apart. Or measure by hand: right leg: G, F and E; left leg: F and E.";
    for code in ["thighs-touch", "crotch-uncertain"] {
        touching.findings = vec![finding(code, None, None)];
        assert_eq!(said(&touching, &Garment::named("AG").unwrap()), expected);
        assert_eq!(
            Completeness::from_record(&touching, &Garment::default()).kind(),
            Kind::Complete
        );
    }
    let implausible = with_right(|leg| drop(leg.landmarks.remove("C")));
    let note = finding("level-implausible", Some("right"), Some("C"));
    let implausible = Record { findings: vec![note], ..implausible };
    let expected =
        "Scan again: a girth was found that no leg has. Or measure by hand: right leg: C.";
    assert_eq!(said(&implausible, &Garment::default()), expected);
}

#[test]
fn what_a_person_must_make_sure_of_is_never_complete() {
    for code in
        ["facing-unchecked", "ord-sides", "ord-unit", "proportions", "no-faces", "not-vouched"]
    {
        for garment in Garment::shipped() {
            let verdict = Completeness::from_record(&found(finding(code, None, None)), garment);
            assert_eq!(verdict.kind(), Kind::ByHand, "{code}");
            for language in Language::ALL {
                let last = verdict.sentences(language).pop().unwrap();
                assert!(last.ends_with('.') && last.len() > 20, "{code}: {last}");
            }
        }
    }
}

#[test]
fn a_leg_that_is_cut_off_above_what_is_needed_needs_no_other_scan() {
    let mut cut = found(finding("leg-cut", Some("right"), None));
    assert_eq!(
        Completeness::from_record(&cut, &Garment::named("AF").unwrap()).kind(),
        Kind::ByHand,
        "E and F are estimates"
    );
    let right = cut.legs.iter_mut().find(|leg| leg.side == "right").unwrap();
    ["F", "G"].into_iter().for_each(|level| {
        right.landmarks.remove(level);
        right.estimates.remove(level);
    });
    for garment in [&Garment::named("AF").unwrap(), &Garment::named("AG").unwrap()] {
        assert_eq!(Completeness::from_record(&cut, garment).kind(), Kind::ScanAgain);
    }
    assert_eq!(Completeness::from_record(&cut, &Garment::default()).kind(), Kind::Complete);
}

/// What a person set on the right leg.
fn by_hand(record: &Record, measure: &str, is: Deed, cm: [Option<f64>; 3]) -> Record {
    let [girth_mm, height_mm, length_mm] = cm.map(|cm| cm.map(|cm| 10.0 * cm));
    let amendment = Amendment {
        leg: "right".to_owned(),
        measure: measure.to_owned(),
        is,
        girth_mm,
        height_mm,
        length_mm,
        reason: "swollen".to_owned(),
        by: "Anna Berg".to_owned(),
        at: "2026-11-25T10:00:00Z".parse().unwrap(),
    };
    record.amended(&[amendment], true).unwrap()
}

#[test]
fn what_a_person_set_is_not_asked_for_again() {
    const COMPLETE: &str = "Complete: all measures for a calf stocking (AD) were taken.";
    let measured = |record: &Record, level, girth, height| {
        by_hand(record, level, Deed::Measured, [girth, height, None])
    };
    let gap = doubted("C", "gap");
    assert_eq!(said(&measured(&gap, "C", Some(38.0), None), &Garment::default()), COMPLETE);
    let only_height = measured(&gap, "C", None, Some(31.0));
    assert_eq!(said(&only_height, &Garment::default()), "Measure by hand: right leg: C (girth).");
    let shallow = doubted("C", "shallow");
    assert_eq!(said(&measured(&shallow, "C", None, Some(31.0)), &Garment::default()), COMPLETE);
    let only_girth = measured(&shallow, "C", Some(38.0), None);
    assert_eq!(said(&only_girth, &Garment::default()), "Measure by hand: right leg: C (height).");
    // Where another scan was wanted for this level alone, none is now.
    let cloth = doubted("C", "cloth");
    assert_eq!(said(&measured(&cloth, "C", Some(38.0), Some(31.0)), &Garment::default()), COMPLETE);
    let implausible = with_right(|leg| drop(leg.landmarks.remove("C")));
    let note = finding("level-implausible", Some("right"), Some("C"));
    let implausible = Record { findings: vec![note], ..implausible };
    assert_eq!(
        said(&measured(&implausible, "C", Some(38.0), Some(31.0)), &Garment::default()),
        COMPLETE
    );
    let no_foot = with_right(|leg| leg.foot = None);
    let foot = by_hand(&no_foot, "foot-length", Deed::Measured, [None, None, Some(25.0)]);
    assert_eq!(said(&foot, &Garment::default()), COMPLETE);
}

#[test]
fn what_cannot_be_measured_is_said_and_is_never_complete() {
    let missing = with_right(|leg| drop(leg.landmarks.remove("C")));
    let noted = by_hand(&missing, "C", Deed::NotMeasurable, [None; 3]);
    let verdict = Completeness::from_record(&noted, &Garment::default());
    assert_eq!((verdict.kind(), verdict.kind().word()), (Kind::NotMeasurable, "not-measurable"));
    assert_eq!(said(&noted, &Garment::default()), "Not measurable: right leg: C.");
    let and_b1 = Record { legs: doubted("B1", "flat").legs, ..noted };
    assert_eq!(
        said(&and_b1, &Garment::default()),
        "Measure by hand: right leg: B1. Not measurable: right leg: C."
    );
    let back = by_hand(&and_b1, "C", Deed::TakenBack, [None; 3]);
    assert_eq!(said(&back, &Garment::default()), "Measure by hand: right leg: B1.");
}

#[test]
fn with_every_level_set_by_hand_nothing_depends_on_another_scan() {
    let uneven = found(finding("floor-uneven", None, None));
    let mut record = uneven;
    for leg in ["right", "left"] {
        for (level, girth, height) in [
            ("Y", 33.0, None),
            ("B", 22.0, Some(11.0)),
            ("B1", 27.0, Some(15.0)),
            ("C", 37.0, Some(31.0)),
            ("D", 34.0, Some(40.0)),
        ] {
            assert_eq!(
                Completeness::from_record(&record, &Garment::default()).kind(),
                Kind::ScanAgain,
                "{leg} {level}"
            );
            let mut set = by_hand(&record, level, Deed::Measured, [Some(girth), height, None]);
            set.amendments.last_mut().unwrap().leg = leg.to_owned();
            record = set;
        }
    }
    assert_eq!(Completeness::from_record(&record, &Garment::default()).kind(), Kind::Complete);
}

#[test]
fn a_record_without_legs_is_never_complete() {
    let record = Record { legs: Vec::new(), ..RECORD.clone() };
    assert_eq!(said(&record, &Garment::default()), "Scan again: both legs whole in view.");
}

#[test]
fn every_code_that_it_goes_by_is_one_that_findings_and_doubts_have() {
    let rule = include_str!("../../../../crates/record/src/completeness/rule.rs");
    let words = rule.split('"').skip(1).step_by(2);
    let codes: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    assert!(codes.len() >= 15, "{codes:?}");
    for code in codes {
        let is_known = Language::En.find(&format!("finding.{code}.title")).is_some();
        assert!(is_known, "no finding or doubt has the code {code}");
    }
}

#[test]
fn a_scan_of_one_leg_is_not_asked_for_the_other() {
    let mut record = RECORD.clone();
    record.legs.retain(|leg| leg.side == "left");
    assert_eq!(Completeness::from_record(&record, &Garment::default()).kind(), Kind::Complete);
}
