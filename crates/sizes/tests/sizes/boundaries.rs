//! Both limits of every range, closed and open, at a step beside them.

#![allow(clippy::unwrap_used)]

use gaiter_leg::Level;
use gaiter_sizes::verdict::{Fit, leg_verdict};
use gaiter_sizes::{Garment, Point};

use crate::rules::{HEAD, given, table_of};

/// A step beside a limit, mm: the last digit of a record.
const STEP_MM: f64 = 0.001;

/// Whether the size fits by the value alone.
fn fits(limits: &str, mm: f64) -> bool {
    let head = HEAD.replace("limits = \"closed\"", &format!("limits = \"{limits}\""));
    let table = table_of(&format!("{head}[[size]]\nname = \"I\"\ncB = [18.3, 20.7]\n"));
    let of = leg_verdict(&table, &Garment::default(), |_| given(mm, None)).unwrap();
    of.fit == Fit::Fits
}

#[test]
fn closed_limits_belong_to_the_range_and_open_ones_do_not() {
    for (limits, at_limit) in [("closed", true), ("open", false)] {
        for (mm, expected) in [
            (183.0 - STEP_MM, false),
            (183.0, at_limit),
            (183.0 + STEP_MM, true),
            (195.0, true),
            (207.0 - STEP_MM, true),
            (207.0, at_limit),
            (207.0 + STEP_MM, false),
        ] {
            assert_eq!(fits(limits, mm), expected, "{limits}, {mm} mm");
        }
    }
}

#[test]
fn at_a_limit_far_from_the_other_one_half_lies_inside_whether_it_is_closed_or_open() {
    for limits in ["closed", "open"] {
        let head = HEAD.replace("limits = \"closed\"", &format!("limits = \"{limits}\""));
        let table = table_of(&format!("{head}[[size]]\nname = \"I\"\ncB = [18, 28]\n"));
        for mm in [180.0, 280.0] {
            let of = leg_verdict(&table, &Garment::default(), |_| given(mm, Some(2.0))).unwrap();
            let point = &of.sizes[0].points[0];
            assert!((point.probability.unwrap() - 0.5).abs() < 1e-12, "{limits}, {mm}");
            assert_eq!(of.fit, Fit::FitsWithinUncertainty);
            assert!(of.sizes[0].is_candidate);
        }
    }
}

#[test]
fn the_verdict_turns_where_the_probability_passes_its_limits() {
    let table = table_of(&format!("{HEAD}[[size]]\nname = \"I\"\ncB = [18, 28]\n"));
    // Φ(1.6449) = 0.95: the quantile of the normal distribution.
    let quantile = 1.644_853_626_951_472_7;
    for (sds, expected) in [
        (quantile + 1e-6, Fit::Fits),
        (quantile - 1e-6, Fit::FitsWithinUncertainty),
        (-quantile + 1e-6, Fit::FitsWithinUncertainty),
        (-quantile - 1e-6, Fit::DoesNotFit),
    ] {
        for mm in [180.0 + 2.0 * sds, 280.0 - 2.0 * sds] {
            let of = leg_verdict(&table, &Garment::default(), |_| given(mm, Some(2.0))).unwrap();
            assert_eq!(of.fit, expected, "{sds} standard uncertainties inside, {mm} mm");
        }
    }
}

#[test]
fn margins_are_signed_and_not_rounded() {
    let table = table_of(&format!("{HEAD}[[size]]\nname = \"I\"\ncB = [18, 20]\n"));
    for (mm, margins_mm) in
        [(179.75, [-0.25, 20.25]), (180.0, [0.0, 20.0]), (200.125, [20.125, -0.125])]
    {
        let of = leg_verdict(&table, &Garment::default(), |_| given(mm, Some(1.0))).unwrap();
        let point = &of.sizes[0].points[0];
        assert_eq!(point.point, Point::Girth(Level::B));
        assert_eq!((point.margins_mm, point.limits_mm), (Some(margins_mm), [180.0, 200.0]));
    }
}

#[test]
fn a_table_in_millimetres_says_the_same_as_one_in_centimetres() {
    let cm = table_of(&format!("{HEAD}[[size]]\nname = \"I\"\ncB = [18.3, 38.9]\n"));
    let head = HEAD.replace("unit = \"cm\"", "unit = \"mm\"");
    let mm = table_of(&format!("{head}[[size]]\nname = \"I\"\ncB = [183, 389]\n"));
    assert_eq!(cm.sizes, mm.sizes);
}
