//! The recorded bodies against the exact truth of the skin behind them (fixtures/README.md).

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::LazyLock;

use gaiter_leg::{Extraction, FacingFrom, LegReport, Level, Method, Side};
use nalgebra::Vector3;
use serde_json::Value;
use support::recorded::{export, truth};

use crate::found::{B_C_D, extraction_of, features, known_mm, landmark, levels};

const CLEAN: [&str; 2] = ["f_average_clean", "m_average_clean"];
const ALL: [&str; 3] = ["f_average_clean", "m_average_clean", "f_average_tc2"];

/// Tape girth of G and the estimates, mm.
const GIRTH_MM: f64 = 1.0;

/// Tape girth of B, C, D and the curve between them on a scan without noise, mm.
const CLEAN_GIRTH_MM: f64 = 0.3;

/// … and what the scan's noise adds to it, as a share of the noise.
const NOISE_SHARE: f64 = 0.8;

/// Height of B, C and D, mm, or the truth's `flat_mm` where that is more.
const HEIGHT_MM: f64 = 5.0;

/// Slope at B1, as a share of the largest.
const SLOPE_SHARE: f64 = 0.93;

/// Mean relative distance of the clean bodies' sections from the surface.
const SURFACE_SHARE: f64 = 0.0015;

/// … and its girth at a level this near to that of the section, mm.
const SURFACE_GIRTH_MM: f64 = 0.05;

/// Less than this is no distance: nothing was compared.
const SOME_SHARE: f64 = 5e-7;
const SOME_MM: f64 = 5e-4;

const FACING_DEG: f64 = 5.0;

/// How far an axis may be off, degrees: three times what it is; 1° of tilt changes the girth at B by
/// some 0.3 mm.
const AXIS_DEG: f64 = 0.25;

/// The soles are never seen, so the floor may be too high by some millimetres.
const STATURE_MM: f64 = 5.0;

/// Thighs nearer to each other than the points of the skin may be taken for one: 12 mm.
const CROTCH_MM: f64 = 12.0;

/// Each body measured once for all tests, with its truth.
static BODIES: LazyLock<BTreeMap<&str, (Extraction, Value)>> = LazyLock::new(|| {
    let body = |name| (extraction_of(&export(name), &Method::default()), truth(name));
    ALL.into_iter().map(|name| (name, body(name))).collect()
});

/// A number of the truth.
#[track_caller]
fn number(truth: &Value) -> f64 {
    truth.as_f64().unwrap()
}

/// A column of a leg's true profile: heights above the floor and values.
fn column(leg: &Value, name: &str) -> Vec<(f64, f64)> {
    let cells = |name: &str| leg["profile"][name].as_array().unwrap().iter().map(Value::as_f64);
    cells("height_mm").zip(cells(name)).filter_map(|(h, v)| Some((h?, v?))).collect()
}

/// A column at a height, between the two nearest rows.
fn at(rows: &[(f64, f64)], height_mm: f64) -> Option<f64> {
    let above = rows.partition_point(|(height, _)| *height <= height_mm);
    let [low, high] = rows.get(above.checked_sub(1)?..=above)? else { return None };
    Some(low.1 + (high.1 - low.1) * (height_mm - low.0) / (high.0 - low.0))
}

/// A column of a leg's true profile at a height.
fn profile(leg: &Value, name: &str, height_mm: f64) -> Option<f64> {
    at(&column(leg, name), height_mm)
}

/// How far off a girth of a body, or of one of its legs, may be, mm.
fn allowed_mm(name: &str) -> f64 {
    let body = name.split(' ').next().unwrap();
    CLEAN_GIRTH_MM + NOISE_SHARE * BODIES[body].1["defects"]["noise"].as_f64().unwrap_or(0.0)
}

/// The value that this share of the values does not exceed.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[(share * sorted.len() as f64).ceil() as usize - 1]
}

/// The figures of a body beside the true ones; a fault is marked and counted.
#[derive(Default)]
struct Table {
    text: String,
    rows: usize,
    faults: usize,
}

impl Table {
    fn row(&mut self, what: &str, found: f64, true_value: f64, is_good: bool) {
        let mark = if is_good { "" } else { "   <-- beyond the limit" };
        let off = found - true_value;
        writeln!(self.text, "{what:34} {found:10.4} {true_value:10.4} {off:+9.4}{mark}").unwrap();
        self.rows += 1;
        self.faults += usize::from(!is_good);
    }

    /// Fails with the whole table where a row is at fault or rows are missing.
    #[track_caller]
    fn check(&self, rows: usize) {
        let Table { text, faults, .. } = self;
        assert_eq!(self.rows, rows, "rows are missing:\n{text}");
        assert!(self.faults == 0, "{faults} of {rows} beyond their limits:\n{text}");
    }
}

/// All legs of all bodies with their truth.
fn each_leg(names: &[&str], mut what: impl FnMut(&str, &LegReport, &Value)) {
    for name in names {
        let (body, truth) = &BODIES[name];
        let sides: Vec<Side> = body.legs.iter().map(|leg| leg.side).collect();
        assert_eq!(sides, Side::BOTH, "{name}");
        for leg in &body.legs {
            let side = leg.side.word();
            what(&format!("{name} {side}"), leg, &truth["legs"][side]);
        }
    }
}

/// The measured sections of a leg: heights and tape girths, mm.
fn rows(leg: &LegReport) -> Vec<(f64, f64)> {
    let measured = leg.girth_curve.rows.iter().filter_map(|row| row.measured);
    measured.map(|(height_mm, girth)| (height_mm, girth.tape_mm)).collect()
}

#[test]
fn b_c_and_d_have_the_true_girth_and_height() {
    // Of 18 landmarks the 95th percentile is the largest: every one keeps its limit.
    let mut table = Table::default();
    each_leg(&ALL, |name, leg, truth| {
        for level in B_C_D {
            let (found, level) = (landmark(leg, level), level.name());
            let truth = &truth["landmarks"][level];
            let girth_mm = number(&truth["tape_mm"]);
            let off = (found.girth_tape_mm - girth_mm).abs();
            table.row(
                &format!("{name} {level} tape"),
                found.girth_tape_mm,
                girth_mm,
                off <= allowed_mm(name),
            );
            let height_mm = number(&truth["height_mm"]);
            let limit = HEIGHT_MM.max(number(&truth["flat_mm"]));
            let is_good = (found.height_mm - height_mm).abs() <= limit;
            table.row(&format!("{name} {level} height"), found.height_mm, height_mm, is_good);
        }
    });
    table.check(3 * 2 * 3 * 2);
}

#[test]
fn g_and_the_estimates_have_the_true_girth_of_their_heights() {
    let mut table = Table::default();
    each_leg(&ALL, |name, leg, truth| {
        let estimated = |level: Level| {
            let at = leg.estimates.iter().find(|at| at.level == level).unwrap();
            (level.name(), at.height_mm, at.girth_tape_mm)
        };
        let g = landmark(leg, Level::G);
        let g = ("G", g.height_mm, g.girth_tape_mm);
        let places = [estimated(Level::E), estimated(Level::F), g];
        for (level, height_mm, girth_mm) in places {
            // The soles are not seen, so the true girth is that of up to 5 mm further up.
            let [low, high] =
                [-1.0, STATURE_MM].map(|off| profile(truth, "tape_mm", height_mm + off).unwrap());
            let is_good = (low.min(high) - GIRTH_MM..=low.max(high) + GIRTH_MM).contains(&girth_mm);
            table.row(&format!("{name} {level} tape"), girth_mm, (low + high) / 2.0, is_good);
        }
    });
    table.check(3 * 2 * 3);
}

#[test]
fn the_feet_of_a_body_are_alike_and_as_long_as_feet_are() {
    let mut table = Table::default();
    for name in ALL {
        let (found, _) = &BODIES[name];
        let feet: Vec<f64> =
            found.legs.iter().filter_map(|leg| Some(leg.foot.as_ref()?.length_mm)).collect();
        let [left, right] = feet[..] else { panic!("{name}: {feet:?}") };
        // The bodies' feet are mirror images; ANSUR II: 0.139 to 0.169 of stature, and these
        // bodies' are at its lower end.
        table.row(&format!("{name} feet"), left, right, (left - right).abs() <= 1.5);
        let share = left / found.body.stature_mm.unwrap();
        table.row(&format!("{name} foot share"), share, 0.14, (0.13..0.17).contains(&share));
        let y = [0, 1].map(|leg| landmark(&found.legs[leg], Level::Y).girth_tape_mm);
        table.row(&format!("{name} Y"), y[0], y[1], (y[0] - y[1]).abs() <= 2.0);
    }
    table.check(3 * 3);
}

#[test]
fn the_true_girth_grows_at_b1_nearly_as_fast_as_anywhere() {
    let mut table = Table::default();
    each_leg(&ALL, |name, leg, truth| {
        let slope = profile(truth, "slope", landmark(leg, Level::B1).height_mm).unwrap();
        let largest = number(&truth["landmarks"]["B1"]["slope"]);
        table.row(&format!("{name} B1 slope"), slope, largest, slope >= SLOPE_SHARE * largest);
    });
    table.check(3 * 2);
}

#[test]
fn no_level_is_missed_and_none_is_invented() {
    each_leg(&ALL, |name, leg, truth| {
        let undecidable = truth["undecidable"].as_array().unwrap();
        let found = levels(leg);
        for level in Level::SOUGHT {
            if undecidable.iter().all(|either| either != level.name()) {
                let is_there = truth["landmarks"].get(level.name()).is_some();
                assert_eq!(found.contains(&level), is_there, "{name} {}", level.name());
            }
        }
        let others = found.iter().filter(|level| !Level::SOUGHT.contains(level));
        assert!(others.eq(&[Level::Y, Level::G]), "{name}: {found:?}");
    });
}

#[test]
fn the_sides_are_the_patient_s_own() {
    for name in ALL {
        let (body, truth) = &BODIES[name];
        let girths = |side: &str| {
            ["B", "C"].map(|l| number(&truth["legs"][side]["landmarks"][l]["tape_mm"]))
        };
        let differ = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        let (left, right) = (girths("left"), girths("right"));
        assert!(differ(left, right) > 3.0 * GIRTH_MM, "{name} cannot tell its sides");
        for leg in &body.legs {
            let found = [Level::B, Level::C].map(|level| landmark(leg, level).girth_tape_mm);
            let (own, other) = if leg.side == Side::Left { (left, right) } else { (right, left) };
            assert!(differ(found, own) < differ(found, other) / 2.0, "{name} {}", leg.side.word());
        }
        // The patient's left is +X: to the left of somebody who looks along −Y.
        for leg in &body.legs {
            let sign = if leg.side == Side::Left { 1.0 } else { -1.0 };
            assert!(features(leg).count() > 0);
            let is_beside = features(leg).all(|feature| feature.position.x * sign > 0.0);
            assert!(is_beside, "{name} {}", leg.side.word());
        }
    }
}

#[test]
fn the_surface_of_a_clean_body_is_within_0_15_percent_of_its_sections() {
    let mut table = Table::default();
    each_leg(&CLEAN, |name, leg, _| {
        let surface = leg.surface.as_ref().unwrap();
        let share = surface.to_sections.mean_relative;
        let is_good = (SOME_SHARE..=SURFACE_SHARE).contains(&share);
        table.row(&format!("{name} to sections"), share, 0.0, is_good);
        let (b_mm, [from_mm, _]) = (landmark(leg, Level::B).height_mm, surface.height_mm);
        let reaches = from_mm <= b_mm - 20.0;
        table.row(&format!("{name} reach below B"), b_mm - from_mm, 20.0, reaches);
        let (low_mm, high_mm) = surface.surface.along().domain();
        let sections = leg.level_sections.iter().map(|at| &at.section);
        let covered = sections.filter(|section| (low_mm..=high_mm).contains(&section.along_mm));
        let off = covered.map(|section| {
            let girth_mm = surface.surface.girth_mm(section.along_mm);
            (girth_mm - section.girth.contour_mm).abs()
        });
        let worst = off.fold(0.0, f64::max);
        let is_good = (SOME_MM..=SURFACE_GIRTH_MM).contains(&worst);
        table.row(&format!("{name} girth"), worst, 0.0, is_good);
    });
    table.check(2 * 2 * 3);
}

#[test]
fn the_girth_curve_of_a_clean_body_is_the_true_one_from_below_b_to_above_d() {
    for name in CLEAN {
        let (found, truth) = &BODIES[name];
        // Heights lack what the unseen soles lack; girths do not.
        let sole_mm = number(&truth["stature_mm"]) - found.body.stature_mm.unwrap();
        for leg in &found.legs {
            let side = leg.side.word();
            let from = landmark(leg, Level::B).height_mm - 20.0;
            let to = landmark(leg, Level::D).height_mm + 20.0;
            let mut table = Table::default();
            for (height_mm, tape_mm) in rows(leg) {
                if (from..to).contains(&height_mm) {
                    let truth = &truth["legs"][side];
                    let girth_mm = profile(truth, "tape_mm", height_mm + sole_mm).unwrap();
                    let off = (tape_mm - girth_mm).abs();
                    let what = format!("{name} {side} {height_mm:.3}");
                    table.row(&what, tape_mm, girth_mm, off <= 1.5);
                }
            }
            assert!(5.5 * table.rows as f64 > to - from, "{} rows", table.rows);
            table.check(table.rows);
        }
    }
}

#[test]
fn the_girth_curve_is_the_true_one_but_for_the_height_of_the_floor() {
    let mut over_allowed = Vec::new();
    each_leg(&ALL, |name, leg, truth| {
        let at_level = |level: &str| number(&truth["landmarks"][level]["height_mm"]);
        let (from_mm, to_mm) = (at_level("B"), at_level("D"));
        let rows: Vec<_> =
            rows(leg).into_iter().filter(|(h, _)| (from_mm..=to_mm).contains(h)).collect();
        assert!(5.5 * rows.len() as f64 > to_mm - from_mm, "{name}: {} rows", rows.len());
        let tape = column(truth, "tape_mm");
        let off = |raised_mm: f64| -> Vec<f64> {
            rows.iter().map(|(h, girth)| girth - at(&tape, h + raised_mm).unwrap()).collect()
        };
        let squares = |raised_mm: f64| off(raised_mm).iter().map(|e| e * e).sum::<f64>();
        let shifts = (-32..=32).map(|quarter| f64::from(quarter) / 4.0);
        let raised_mm = shifts.min_by(|a, b| squares(*a).total_cmp(&squares(*b))).unwrap();
        // What the floor may be off by is all that a shift may take away.
        assert!(raised_mm.abs() <= STATURE_MM, "{name}: {raised_mm} mm");
        over_allowed.extend(off(raised_mm).iter().map(|error| error.abs() / allowed_mm(name)));
    });
    let share = quantile(&over_allowed, 0.95);
    assert!(share <= 1.0, "{share} of what is allowed, {} sections", over_allowed.len());
}

#[test]
fn the_girth_of_b1_belongs_to_its_height_wherever_that_is() {
    let mut table = Table::default();
    for (name, (found, truth)) in BODIES.iter() {
        for leg in &found.legs {
            let (b1, side) = (landmark(leg, Level::B1), leg.side.word());
            let at_mm = |height_mm| profile(&truth["legs"][side], "tape_mm", height_mm).unwrap();
            let girth_mm = at_mm(b1.height_mm);
            // What the floor is off by shifts all heights.
            let shift_mm = at_mm(b1.height_mm + 2.0 * found.body.floor_sd_mm) - girth_mm;
            let limit_mm = allowed_mm(name).hypot(shift_mm);
            let is_good = (b1.girth_tape_mm - girth_mm).abs() <= limit_mm;
            table.row(&format!("{name} {side} B1"), b1.girth_tape_mm, girth_mm, is_good);
            assert!(b1.girth_sd_mm <= b1.girth_of_level_sd_mm, "{b1:?}");
            // That its place is uncertain by centimetres is no reason to measure by hand.
            let is_uncertain =
                b1.doubts.iter().any(|of| matches!(of.code(), "girth-uncertain" | "flat"));
            assert!(!is_uncertain, "{name} {side}: {b1:?}");
        }
    }
    table.check(3 * 2);
}

#[test]
fn the_uncertainties_of_b_c_and_d_are_neither_too_small_nor_too_large() {
    let (mut girths, mut heights) = (Vec::new(), Vec::new());
    each_leg(&ALL, |_, leg, truth| {
        for level in B_C_D {
            let (found, truth) = (landmark(leg, level), &truth["landmarks"][level.name()]);
            let girth_off = found.girth_tape_mm - number(&truth["tape_mm"]);
            girths.push((girth_off.abs(), known_mm(found.girth_sd_mm)));
            let height_off = found.height_mm - number(&truth["height_mm"]);
            heights.push((height_off.abs(), known_mm(found.height_sd_mm)));
        }
    });
    for (what, claims) in [("girths", girths), ("heights", heights)] {
        assert_eq!(claims.len(), 3 * 2 * 3);
        let covered = claims.iter().filter(|(error, sd)| *error <= 2.0 * sd).count();
        assert!(covered as f64 >= 0.9 * claims.len() as f64, "{what}: {covered}, {claims:?}");
        let (errors, sds): (Vec<f64>, Vec<f64>) = claims.into_iter().unzip();
        let [error, sd] = [errors, sds].map(|values| quantile(&values, 0.5));
        assert!(sd <= 3.0 * error, "{what}: median sd {sd}, median error {error}");
    }
}

#[test]
fn the_axes_of_shank_and_thigh_are_true_to_a_quarter_of_a_degree() {
    let mut table = Table::default();
    each_leg(&ALL, |name, leg, truth| {
        let (shank, bend) = (leg.axis.foot.normal, leg.axis.bend.as_ref().unwrap());
        for (what, found) in [("shank", shank), ("thigh", bend.thigh.direction)] {
            let direction = &truth[what]["direction"];
            let direction = Vector3::from([0, 1, 2].map(|axis| number(&direction[axis])));
            let off_deg = found.into_inner().angle(&direction).to_degrees();
            table.row(&format!("{name} {what}"), off_deg, 0.0, off_deg <= AXIS_DEG);
        }
        let (bend_deg, true_deg) = (bend.angle_deg(), number(&truth["bend_deg"]));
        let is_good = (bend_deg - true_deg).abs() <= AXIS_DEG;
        table.row(&format!("{name} bend"), bend_deg, true_deg, is_good);
        let upright_deg = shank.into_inner().angle(&Vector3::z()).to_degrees();
        let tilt_deg = leg.axis.tilt_deg();
        let is_good = (tilt_deg - upright_deg).abs() < 0.01;
        table.row(&format!("{name} tilt"), tilt_deg, upright_deg, is_good);
    });
    table.check(3 * 2 * 4);
}

#[test]
fn facing_stature_crotch_and_unit_are_the_body_s() {
    let mut table = Table::default();
    for name in ALL {
        let (Extraction { body, crotch, .. }, truth) = &BODIES[name];
        assert!(crotch.is_seen(), "{name}");
        let pairs = [
            ("facing", body.facing_deg, &truth["facing_deg"], FACING_DEG),
            ("stature", body.stature_mm.unwrap(), &truth["stature_mm"], STATURE_MM),
            ("crotch", crotch.height_mm, &truth["crotch_height_mm"], CROTCH_MM),
        ];
        for (what, found, true_value, limit) in pairs {
            let is_good = (found - number(true_value)).abs() <= limit;
            table.row(&format!("{name} {what}"), found, number(true_value), is_good);
        }
        assert_eq!(body.unit.word(), truth["unit"], "{name}");
        assert!(body.unit_inferred && body.facing_from == FacingFrom::Feet);
    }
    table.check(3 * 3);
}
