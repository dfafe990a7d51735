//! The points of an order form from a record, the sizes of tables for it, and its calibre jumps.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::sync::LazyLock;

use gaiter_leg::{Level, Side};
use gaiter_record::Record;
use gaiter_record::measure::amendment::{Amendment, Deed};
use gaiter_record::sizing::calibre::{Stretch, stretches};
use gaiter_record::sizing::{SizeChoice, SizeVerdicts, TAPE_GIRTH_MM, reading};
use gaiter_sizes::table::SizeTable;
use gaiter_sizes::verdict::{Fit, Given, NotComparable, NotGiven, Reading};
use gaiter_sizes::{Garment, Point, parse};
use jiff::civil::date;
use serde_json::Value;
use support::recorded::truth;
use support::records;

/// A body of which every level was found, without findings.
pub static RECORD: LazyLock<Record> = LazyLock::new(|| {
    let mut record = records::measured("m_average_clean").1.clone();
    record.findings.clear();
    for leg in &mut record.legs {
        leg.landmarks.values_mut().for_each(|found| found.doubts.clear());
    }
    record
});

pub fn table(sizes: &str) -> SizeTable {
    let text = format!(
        "format = \"gaiter-size-table/1\"\nid = \"t\"\nmaker = \"m\"\nproduct = \"p\"\n\
         table_edition = \"e\"\nsource = \"s\"\nstatus = \"released\"\nentered_by = \"A\"\n\
         checked_by = \"B\"\nvalid_until = 2026-12-31\nunit = \"mm\"\nlimits = \"closed\"\n\
         decides = \"cB\"\nmatch = \"all\"\nlengths_from = \"floor\"\nskin_or_tension = \"skin\"\n{sizes}"
    );
    parse(text.as_bytes()).unwrap()
}

pub fn choice(tables: Vec<SizeTable>) -> SizeChoice {
    SizeChoice { tables, today: date(2026, 11, 25), scanner_girth_mm: 0.0 }
}

pub fn measured(
    record: &Record,
    level: &str,
    girth_mm: Option<f64>,
    height_mm: Option<f64>,
) -> Record {
    let amendment = Amendment {
        leg: "right".to_owned(),
        measure: level.to_owned(),
        is: Deed::Measured,
        girth_mm,
        height_mm,
        length_mm: None,
        reason: "swollen".to_owned(),
        by: "Anna Berg".to_owned(),
        at: "2026-11-25T10:00:00Z".parse().unwrap(),
    };
    record.amended(&[amendment], true).unwrap()
}

fn right(name: &str, record: &Record) -> Reading {
    reading(record, Side::Right, Point::named(name).unwrap(), 0.0)
}

fn given(of: Reading) -> Given {
    match of {
        Reading::Given(given) => given,
        Reading::NotGiven { why } => panic!("{why:?}"),
    }
}

/// Where a height lies along the leg of a generated body, mm.
fn along_mm(profile: &Value, height_mm: f64) -> f64 {
    let column =
        |name: &str| profile[name].as_array().unwrap().iter().map(|mm| mm.as_f64().unwrap());
    let known: Vec<(f64, f64)> = column("height_mm").zip(column("along_axis_mm")).collect();
    let is_around = |pair: &&[(f64, f64)]| pair[0].0 <= height_mm && height_mm <= pair[1].0;
    let [(low_mm, from_mm), (high_mm, to_mm)] =
        known.windows(2).find(is_around).unwrap().try_into().unwrap();
    from_mm + (height_mm - low_mm) / (high_mm - low_mm) * (to_mm - from_mm)
}

fn with_doubt(level: &str, doubt: &str) -> Record {
    let mut record = RECORD.clone();
    let legs = record.legs.iter_mut().filter(|leg| leg.side == "right");
    legs.for_each(|leg| leg.landmarks.get_mut(level).unwrap().doubts = vec![doubt.to_owned()]);
    record
}

#[test]
fn a_point_is_the_record_s_figure_with_its_uncertainty_to_the_last_digit() {
    let leg = RECORD.leg(Side::Right).unwrap();
    let c = &leg.landmarks["C"];
    let girth = given(right("cC", &RECORD));
    assert_eq!((girth.mm, girth.uncertainty_mm), (c.girth_tape_mm, c.girth_sd_mm));
    let height = given(right("lC", &RECORD));
    assert_eq!((height.mm, height.uncertainty_mm), (c.height_mm, c.height_sd_mm));
    let foot = given(right("foot", &RECORD));
    assert_eq!((foot.mm, foot.uncertainty_mm), (leg.foot.as_ref().unwrap().length_mm, None));
    let inside = given(right("lK", &RECORD));
    assert_eq!(Some(inside.mm), RECORD.body.crotch_height_mm);
}

#[test]
fn an_error_common_to_all_girths_is_added_in_squares_and_to_girths_only() {
    let sd_mm = RECORD.leg(Side::Right).unwrap().landmarks["C"].girth_sd_mm.unwrap();
    let with = |name: &str| given(reading(&RECORD, Side::Right, Point::named(name).unwrap(), 3.0));
    let expected = (sd_mm * sd_mm + 9.0).sqrt();
    assert!((with("cC").uncertainty_mm.unwrap() - expected).abs() < 1e-12);
    assert_eq!(with("lC"), given(right("lC", &RECORD)));
    let by_hand = measured(&RECORD, "C", Some(380.0), None);
    let tape = given(reading(&by_hand, Side::Right, Point::named("cC").unwrap(), 3.0));
    assert_eq!(tape.uncertainty_mm, Some(TAPE_GIRTH_MM), "the scanner had no part in it");
}

#[test]
fn what_is_estimated_doubtful_or_absent_is_to_be_measured_by_hand() {
    let why = |name: &str, record: &Record| match right(name, record) {
        Reading::NotGiven { why } => Some(why),
        Reading::Given(_) => None,
    };
    assert_eq!(why("cA", &RECORD), Some(NotGiven::Estimated));
    assert_eq!(why("cT", &RECORD), Some(NotGiven::Beyond));
    assert_eq!(why("cC", &with_doubt("C", "gap")), Some(NotGiven::Doubtful));
    assert_eq!(why("cC", &with_doubt("C", "folds")), None, "folds do not change what a tape reads");
    let mut without = RECORD.clone();
    without.legs.iter_mut().for_each(|leg| drop(leg.landmarks.remove("C")));
    assert_eq!(why("cC", &without), Some(NotGiven::NotFound));
    assert_eq!(why("lBD", &with_doubt("D", "shallow")), Some(NotGiven::Doubtful));
    let by_hand = measured(&with_doubt("C", "gap"), "C", Some(380.0), None);
    assert_eq!(given(right("cC", &by_hand)).mm, 380.0, "a person's value needs no scan");
}

#[test]
fn a_length_between_levels_goes_along_the_leg_also_to_a_level_set_by_hand() {
    let leg = RECORD.leg(Side::Right).unwrap();
    let [b, d] = ["B", "D"].map(|level| &leg.landmarks[level]);
    let length = given(right("lBD", &RECORD));
    assert_eq!(length.mm, d.along_axis_mm - b.along_axis_mm);
    let sd_mm = (b.height_sd_mm.unwrap().powi(2) + d.height_sd_mm.unwrap().powi(2)).sqrt();
    assert!((length.uncertainty_mm.unwrap() - sd_mm).abs() < 1e-12);
    let lower = |lower_mm: f64| {
        let height_mm = d.height_mm - lower_mm;
        given(right("lBD", &measured(&RECORD, "D", None, Some(height_mm))))
    };
    assert!((lower(0.0).mm - length.mm).abs() < 0.002, "set where it is: {}", lower(0.0).mm);
    // Towards the knee the middle of the leg leans by 22°: 10 mm of height are 10.7 mm of its line.
    let truth = &truth("m_average_clean")["legs"]["right"]["profile"];
    let true_mm = |height_mm: f64| along_mm(truth, height_mm) - along_mm(truth, b.height_mm);
    for lower_mm in [0.0, 10.0, 20.0, 40.0, 80.0] {
        let off_mm = lower(lower_mm).mm - true_mm(d.height_mm - lower_mm);
        assert!(off_mm.abs() < 0.6, "{lower_mm} mm lower: {off_mm} mm");
    }
    let by_hand = lower(10.0);
    assert!(by_hand.is_by_hand && by_hand.uncertainty_mm.is_none());
}

#[test]
fn sizes_are_sought_with_all_digits_and_not_with_those_that_are_printed() {
    let mm = RECORD.leg(Side::Right).unwrap().landmarks["B"].girth_tape_mm;
    let printed = (mm / 5.0).round() * 5.0;
    assert!((mm - printed).abs() > 0.5, "{mm} is printed as it is");
    // A limit between the value and what a form with steps of 5 mm prints.
    let limit = (mm + printed) / 2.0;
    let [low, high] = if mm < limit { [100.0, limit] } else { [limit, 400.0] };
    let table = table(&format!("[[size]]\nname = \"I\"\ncB = [{low:.3}, {high:.3}]\n"));
    let verdicts = SizeVerdicts::new(&RECORD, &Garment::default(), &choice(vec![table]));
    let leg = &verdicts.tables[0].legs[0];
    assert_eq!((leg.side, leg.verdict.fit), ("right", Fit::Fits));
    let point = &leg.verdict.sizes[0].points[0];
    assert_eq!(given(point.reading).mm, mm);
    let json = serde_json::to_value(&verdicts).unwrap();
    assert_eq!(json["tables"][0]["legs"][0]["sizes"][0]["points"][0]["reading"]["mm"], mm);
}

#[test]
fn a_person_s_girth_near_a_limit_is_judged_with_the_tape_s_error() {
    let table = table("[[size]]\nname = \"I\"\ncB = [180, 380]\n");
    for (mm, fit) in [
        (182.5, Fit::FitsWithinUncertainty),
        (180.0 + 1.65 * TAPE_GIRTH_MM, Fit::Fits),
        (180.0 - 1.65 * TAPE_GIRTH_MM, Fit::DoesNotFit),
    ] {
        let record = measured(&RECORD, "B", Some(mm), None);
        let verdicts =
            SizeVerdicts::new(&record, &Garment::default(), &choice(vec![table.clone()]));
        assert_eq!(verdicts.tables[0].legs[0].verdict.fit, fit, "{mm}");
    }
}

#[test]
fn tables_stand_side_by_side_and_none_speaks_for_another() {
    let skin = table("[[size]]\nname = \"I\"\ncB = [100, 400]\n");
    let mut tension = skin.clone();
    tension.basis = Some(gaiter_sizes::table::Basis::Tension);
    let mut old = skin.clone();
    old.valid_until = Some(date(2026, 11, 24));
    let choice = choice(vec![tension, skin, old]);
    let verdicts = SizeVerdicts::new(&RECORD, &Garment::default(), &choice);
    let said: Vec<_> =
        verdicts.tables.iter().map(|of| (of.not_comparable, of.is_expired)).collect();
    assert_eq!(said, [(Some(NotComparable::Tension), false), (None, false), (None, true)]);
    assert!(verdicts.tables[0].legs.is_empty());
    let sides: Vec<&str> = verdicts.tables[1].legs.iter().map(|leg| leg.side).collect();
    assert_eq!(sides, ["right", "left"]);
    let last_day = SizeChoice { today: date(2026, 11, 24), ..choice };
    let verdicts = SizeVerdicts::new(&RECORD, &Garment::default(), &last_day);
    assert!(!verdicts.tables[2].is_expired, "valid until the end of its last day");
}

fn of_right(record: &Record) -> Vec<Stretch> {
    let all = stretches(record, &Garment::default());
    all.into_iter().filter(|of| of.side == "right").collect()
}

#[test]
fn the_calibre_is_the_change_of_girth_per_length_between_adjacent_points_of_the_form() {
    let leg = RECORD.leg(Side::Right).unwrap();
    let stretches = of_right(&RECORD);
    let places: Vec<_> = stretches.iter().map(|of| (of.from, of.to)).collect();
    assert_eq!(places, [("B", "B1"), ("B1", "C"), ("C", "D")]);
    for of in &stretches {
        let [low, high] = [of.from, of.to].map(|level| &leg.landmarks[level]);
        let change = high.girth_tape_mm - low.girth_tape_mm;
        let length = high.along_axis_mm - low.along_axis_mm;
        assert_eq!((of.girth_change_mm, of.length_mm), (change, length));
        assert!((of.per_length - change.abs() / length).abs() < 1e-12 && !of.is_jump);
        assert!(of.per_length_sd.is_some_and(|sd| sd > 0.0 && sd < 0.1), "{of:?}");
    }
    assert!(
        stretches[2].girth_change_mm < 0.0,
        "below the knee the leg is thinner than at the calf"
    );
}

#[test]
fn the_local_slope_is_no_calibre_jump() {
    let mut steep = RECORD.clone();
    for leg in &mut steep.legs {
        leg.girth_curve.slope.iter_mut().for_each(|slope| *slope = Some(1.25));
    }
    assert_eq!(of_right(&steep), of_right(&RECORD));
}

#[test]
fn a_jump_has_its_place_and_number_and_levels_set_by_hand_count() {
    let c = &RECORD.leg(Side::Right).unwrap().landmarks["C"];
    let b1 = &RECORD.leg(Side::Right).unwrap().landmarks["B1"];
    let length = c.along_axis_mm - b1.along_axis_mm;
    let swollen = measured(&RECORD, "C", Some(b1.girth_tape_mm + 1.2 * length), None);
    let jumps: Vec<Stretch> = of_right(&swollen).into_iter().filter(|of| of.is_jump).collect();
    let [up, down] = jumps.as_slice() else { panic!("{jumps:?}") };
    assert_eq!((up.from, up.to, down.from, down.to), ("B1", "C", "C", "D"));
    assert!((up.per_length - 1.2).abs() < 1e-6);
    let lower = measured(&RECORD, "C", None, Some(b1.height_mm + 20.0));
    let near = &of_right(&lower)[1];
    assert!((near.length_mm - 20.0).abs() < 1.0 && near.per_length_sd.is_none(), "{near:?}");
}

#[test]
fn a_level_that_is_not_given_is_left_out_and_the_stretch_goes_on() {
    let places: Vec<_> =
        of_right(&with_doubt("B1", "flat")).iter().map(|of| (of.from, of.to)).collect();
    assert_eq!(places, [("B", "C"), ("C", "D")]);
    let thigh = stretches(&RECORD, &Garment::named("AG").unwrap());
    let to_g = thigh.iter().find(|of| of.to == Level::G.name()).unwrap();
    assert_eq!(to_g.from, "D", "E and F are estimates");
}
