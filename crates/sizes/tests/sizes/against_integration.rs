//! Ten thousand legs: what a table says against an evaluation of another kind. Limits are read with the TOML
//! crate alone, probabilities are sums over the normal density, and sizes are found by a walk over rows.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use gaiter_sizes::verdict::{Fit, Given, NotGiven, Reading, leg_verdict};
use gaiter_sizes::{Garment, Point, parse};
use support::chance::Chance;
use toml::{Table, Value};

const LEGS: usize = 10_000;

/// Steps of the sum over a density; Simpson's rule is then off by less than 1e-9.
const STEPS: usize = 400;

/// The tables: the example that is shipped, eight sizes with overlaps, and open limits with gaps of which only
/// some points are required.
const TABLES: [&str; 3] = [
    include_str!("../../../../config/sizes/invented-example.toml"),
    include_str!("../../../../fixtures/cases/sizes/unattributed_8_sizes.toml"),
    include_str!("../../../../fixtures/cases/sizes/open_limits_and_required_points.toml"),
];

/// The points that each garment's form has, of those that these tables name.
const FORMS: [(&str, &[&str]); 3] = [
    ("AD", &["cB", "cC", "lD"]),
    ("AF", &["cB", "cC", "cF", "lD", "lF"]),
    ("AG", &["cB", "cC", "cF", "cG", "lD", "lF", "lG"]),
];

/// A leg: value and standard uncertainty of its points, mm. A point without an entry is not given; one with an
/// uncertainty of 0 has an unknown one.
type Leg = BTreeMap<&'static str, (f64, f64)>;

/// The share of a normal density between two limits, by Simpson's rule over at most ten deviations each way.
fn share(value: f64, sd: f64, low: f64, high: f64) -> f64 {
    let from = ((low - value) / sd).clamp(-10.0, 10.0);
    let to = ((high - value) / sd).clamp(-10.0, 10.0);
    let step = (to - from) / STEPS as f64;
    let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let weight = |index: usize| match index {
        0 | STEPS => 1.0,
        odd if odd % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = (0..=STEPS).map(|i| weight(i) * density(from + step * i as f64)).sum();
    sum * step / 3.0
}

/// The share of one range, as the rule has it: a word and the probability.
fn point_says(
    leg: &Leg,
    name: &str,
    limits: [f64; 2],
    is_open: bool,
) -> (&'static str, Option<f64>) {
    let Some((value, sd)) = leg.get(name).copied() else { return ("open", None) };
    let on_a_limit = limits.contains(&value);
    let inside = (limits[0] < value && value < limits[1]) || (on_a_limit && !is_open);
    if sd == 0.0 {
        return (if inside { "yes" } else { "no" }, None);
    }
    let share = share(value, sd, limits[0], limits[1]);
    let word = match share {
        sure if sure >= 0.95 => "yes",
        unlikely if unlikely <= 0.05 && !inside => "no",
        _ => "perhaps",
    };
    (word, Some(share))
}

/// The worst of several words.
fn worst(words: &[&'static str]) -> &'static str {
    ["no", "open", "perhaps", "yes"].into_iter().find(|word| words.contains(word)).unwrap()
}

fn limits(value: &Value) -> Option<[f64; 2]> {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|of| of as f64));
    match value.as_array()?.as_slice() {
        [low, high] => Some([10.0 * number(low)?, 10.0 * number(high)?]),
        _ => None,
    }
}

/// A row of a table: what it is called, and its ranges.
type Row = (String, Vec<(String, [f64; 2])>);

/// Every row of a table for a garment.
fn rows(table: &Table, garment: &str) -> Vec<Row> {
    let ranges = |of: &Table| -> Vec<(String, [f64; 2])> {
        of.iter().filter_map(|(name, value)| Some((name.clone(), limits(value)?))).collect()
    };
    let empty = Vec::new();
    let list = |name: &str| table.get(name).and_then(Value::as_array).unwrap_or(&empty).clone();
    let mut rows = Vec::new();
    for size in list("size") {
        let size = size.as_table().unwrap();
        let name = size["name"].as_str().unwrap();
        let own = ranges(size);
        rows.push((name.to_owned(), own.clone()));
        for variant in list("variant") {
            let variant_name = variant["name"].as_str().unwrap();
            let applies = variant["applies_to"].as_array().unwrap();
            let its = size.get("variant").and_then(|of| of.get(variant_name));
            if let Some(its) = its.filter(|_| applies.iter().any(|of| of.as_str() == Some(garment)))
            {
                let replaced: BTreeMap<String, [f64; 2]> =
                    ranges(its.as_table().unwrap()).into_iter().collect();
                let with = own.iter().map(|(point, mm)| {
                    (point.clone(), replaced.get(point).copied().unwrap_or(*mm))
                });
                rows.push((format!("{name}/{variant_name}"), with.collect()));
            }
        }
    }
    for length in list("length") {
        let length = length.as_table().unwrap();
        if length["garment"].as_str() == Some(garment) {
            rows.push((format!("length {}", length["name"].as_str().unwrap()), ranges(length)));
        }
    }
    rows
}

/// A leg as no body has it, but near limits more often than not: values in mm, some with a digit on a limit.
fn drawn(chance: &mut Chance) -> Leg {
    let mut leg = Leg::new();
    for (name, middle, reach) in [
        ("cB", 230.0, 80.0),
        ("cC", 370.0, 120.0),
        ("cF", 560.0, 160.0),
        ("cG", 640.0, 200.0),
        ("lD", 390.0, 120.0),
        ("lG", 740.0, 140.0),
    ] {
        let value = middle + chance.even(reach);
        let value = match chance.below(4) {
            0 => (value / 10.0).round() * 10.0,
            1 => (value / 5.0).round() * 5.0,
            _ => value,
        };
        let sd = if chance.below(8) == 0 { 0.0 } else { 0.2 + 6.0 * chance.unit() };
        if chance.below(12) > 0 {
            leg.insert(name, (value, sd));
        }
    }
    leg
}

fn reading(leg: &Leg, point: Point) -> Reading {
    match leg.get(point.to_string().as_str()) {
        None => Reading::NotGiven { why: NotGiven::NotFound },
        Some((mm, sd)) => {
            let uncertainty_mm = (*sd > 0.0).then_some(*sd);
            Reading::Given(Given { mm: *mm, uncertainty_mm, is_by_hand: false })
        }
    }
}

fn word(fit: Fit) -> &'static str {
    match fit {
        Fit::Fits => "yes",
        Fit::FitsWithinUncertainty => "perhaps",
        Fit::NotDecided => "open",
        Fit::DoesNotFit => "no",
    }
}

#[test]
fn ten_thousand_legs_are_judged_as_a_sum_over_the_density_judges_them() {
    let mut chance = Chance(20_261_125);
    let (mut judgements, mut seen) = (0, BTreeMap::<&str, usize>::new());
    for index in 0..LEGS {
        let leg = drawn(&mut chance);
        let text = TABLES[index % TABLES.len()];
        let (garment, form) = FORMS[index / TABLES.len() % FORMS.len()];
        let raw: Table = text.parse().unwrap();
        let table = parse(text.as_bytes()).unwrap();
        let of =
            leg_verdict(&table, &Garment::named(garment).unwrap(), |point| reading(&leg, point))
                .unwrap();
        let mut said = BTreeMap::new();
        for size in &of.sizes {
            let name =
                size.variant.iter().fold(size.size.clone(), |name, of| format!("{name}/{of}"));
            said.insert(name, (word(size.fit), size.points.clone(), Some(size.is_candidate)));
        }
        for length in &of.lengths {
            let name = format!("length {}", length.length);
            said.insert(name, (word(length.fit), length.points.clone(), None));
        }
        let rows = rows(&raw, garment);
        let is_open = raw["limits"].as_str() == Some("open");
        let required: Option<Vec<&str>> = raw
            .get("required")
            .map(|list| list.as_array().unwrap().iter().filter_map(Value::as_str).collect());
        assert_eq!(said.len(), rows.len(), "leg {index}");
        for (name, ranges) in rows {
            let is_length = name.starts_with("length ");
            let asked =
                ranges.iter().filter(|(point, _)| is_length || form.contains(&point.as_str()));
            let each: Vec<_> =
                asked.map(|(point, mm)| (point, point_says(&leg, point, *mm, is_open))).collect();
            let counts = |point: &str| {
                is_length || required.as_ref().is_none_or(|names| names.contains(&point))
            };
            let counted = each.iter().filter(|(point, _)| counts(point));
            let words: Vec<&'static str> = counted.map(|(_, (word, _))| *word).collect();
            let (fit, points, is_candidate) = &said[&name];
            assert_eq!(*fit, worst(&words), "leg {index}, {garment}, {name}: {leg:?}");
            assert_eq!(points.len(), each.len(), "leg {index}, {garment}, {name}");
            for (point, (_, share)) in &each {
                let told = points.iter().find(|of| of.point.to_string() == **point).unwrap();
                match (told.probability, share) {
                    (Some(told), Some(share)) => {
                        assert!(
                            (told - share).abs() < 1e-7,
                            "leg {index}, {name}, {point}: {told}"
                        );
                    }
                    (told, share) => assert_eq!(told, *share, "leg {index}, {name}, {point}"),
                }
            }
            if let Some(is_candidate) = is_candidate {
                let ankle = each.iter().find(|(point, _)| *point == "cB").unwrap().1.0;
                assert_eq!(*is_candidate, ankle != "no", "leg {index}, {name}");
            }
            *seen.entry(fit).or_default() += 1;
            judgements += 1;
        }
    }
    assert!(judgements > 5 * LEGS, "{judgements}");
    // A draw that never meets one of the verdicts proves nothing.
    assert!(["yes", "perhaps", "open", "no"].iter().all(|word| seen[word] > 500), "{seen:?}");
}
