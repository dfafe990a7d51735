//! Simulated years of visits: known swelling, the noise of girths, a scanner that drifts and a floor that is
//! found a little higher or lower.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter_leg::{Method, Side};
use gaiter_record::{Acquired, AcquiredFrom, Record};
use gaiter_visits::{Comparison, Course, Shown};
use jiff::ToSpan;
use support::chance::Chance;
use support::noise::roughened;
use support::records::record_of;

use crate::stance::{CHOICE, NOISE_MM, scan_of};
use support::mesh::Mesh;
use support::recorded::obj;

/// A body, scanned with the noise of a good scanner; without its shape, which no comparison of figures needs.
static BODY: LazyLock<Record> = LazyLock::new(|| {
    let scan = scan_of(Mesh::body("m_average_clean"));
    let mut record = record_of(&obj(&roughened(&scan, NOISE_MM, 1)), &Method::default()).1;
    record.legs.iter_mut().for_each(|leg| leg.shape = None);
    record
});

/// How many years are simulated. Of so many, a share of 0.95 is found to 0.5 percentage points.
const YEARS: u64 = 2000;

/// Visits of a year.
const VISITS: usize = 7;

/// The standard error of all girths of a scan in common, mm, and how much of it is left at the next visit.
const DRIFT_MM: f64 = 1.0;
const KEPT: f64 = 0.5;

/// By how much the floor is found higher or lower from scan to scan, mm; see docs/visits.md.
const FLOOR_MM: f64 = 0.3;

/// The visits of a year. At each, all girths of the left leg are larger by a part of the final `growth_mm`.
fn year(seed: u64, growth_mm: f64) -> Vec<Record> {
    let mut chance = Chance(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let mut drift_mm = DRIFT_MM * chance.normal();
    let visit = |number: usize| {
        let mut record = BODY.clone();
        let share = number as f64 / (VISITS - 1) as f64;
        let floor_mm = FLOOR_MM * chance.normal();
        for leg in &mut record.legs {
            let own: Vec<Option<f64>> = leg.along.iter().map(|at| at.girth_tape_mm).collect();
            let more_mm = if leg.side == "left" { share * growth_mm } else { 0.0 };
            for (index, at) in leg.along.iter_mut().enumerate() {
                let (Some(girth_mm), Some(sd_mm)) = (own[index], at.girth_sd_mm) else { continue };
                let next = own.get(index + 1).copied().flatten().unwrap_or(girth_mm);
                let raised_mm = (next - girth_mm) * floor_mm / 40.0;
                let random_mm = sd_mm * chance.normal();
                at.girth_tape_mm = Some(girth_mm + more_mm + raised_mm + random_mm + drift_mm);
            }
        }
        drift_mm = KEPT * drift_mm + DRIFT_MM * (1.0 - KEPT * KEPT).sqrt() * chance.normal();
        let first = "2026-01-08T09:00:00Z".parse::<jiff::Timestamp>().unwrap();
        let at = first + (number as i64 * 52 * 24).hours();
        record.acquired =
            Some(Acquired { utc_offset_min: Some(60), ..Acquired::new(at, AcquiredFrom::Press) });
        record.scan.sha256 = format!("{number:064x}");
        record
    };
    (0..VISITS).map(visit).collect()
}

/// The last visit of a year compared with the first.
fn whole_year(seed: u64, growth_mm: f64) -> Comparison {
    let course = Course::comparable(&year(seed, growth_mm), CHOICE).unwrap();
    course.last_compared(&course.groups[0]).remove(0)
}

fn share(years: impl Iterator<Item = bool>) -> f64 {
    let all: Vec<bool> = years.collect();
    all.iter().filter(|holds| **holds).count() as f64 / all.len() as f64
}

#[test]
fn the_detectable_change_is_at_most_one_and_a_half_percent_of_an_average_leg() {
    let compared = whole_year(1, 0.0);
    for side in Side::BOTH {
        let percent =
            compared.legs.get(side).as_ref().unwrap().volume.unwrap().detectable_percent();
        assert!(percent <= 1.5, "{side:?}: {percent} %");
        // The reference's estimate: 2.8 times 0.5 % for a common millimetre.
        assert!(percent > 1.3, "{side:?}: {percent} %");
    }
}

#[test]
fn twice_the_detectable_change_is_found_in_95_of_100_years() {
    let of = whole_year(1, 0.0);
    let detectable_ml = of.legs.left.as_ref().unwrap().volume.unwrap().detectable();
    // A swelling in proportion: one millimetre of all girths, scaled to twice the detectable change.
    let one = whole_year(1, 1.0).legs.left.unwrap().volume.unwrap().by;
    let none = of.legs.left.as_ref().unwrap().volume.unwrap().by;
    let growth_mm = 2.0 * detectable_ml / (one - none);
    let found = share((0..YEARS).map(|seed| {
        let volume = whole_year(seed, growth_mm).legs.left.unwrap().volume.unwrap();
        volume.shown() == Shown::Larger
    }));
    assert!(found >= 0.95, "{found}");
}

#[test]
fn no_change_is_invented_in_95_of_100_years() {
    let years: Vec<Comparison> = (0..YEARS).map(|seed| whole_year(seed, 0.0)).collect();
    let none = share(
        years
            .iter()
            .map(|of| of.legs.right.as_ref().unwrap().volume.unwrap().shown() == Shown::NoChange),
    );
    assert!(none >= 0.95, "volume: {none}");
    let none = share(years.iter().map(|of| {
        let mut places =
            Side::BOTH.into_iter().flat_map(|side| &of.legs.get(side).as_ref().unwrap().girths);
        places.all(|place| place.change.shown() == Shown::NoChange)
    }));
    assert!(none >= 0.95, "girths of both legs: {none}");
    let none = share(years.iter().map(|of| {
        let mut slices =
            Side::BOTH.into_iter().flat_map(|side| &of.legs.get(side).as_ref().unwrap().pieces);
        slices.all(|slice| slice.change.shown() == Shown::NoChange)
    }));
    assert!(none >= 0.95, "slices of both legs: {none}");
}

#[test]
fn a_swelling_of_one_leg_is_found_sooner_in_the_excess_which_no_drift_changes() {
    let of = whole_year(3, 2.0);
    let excess = of.excess.unwrap_or_else(|| {
        let records = year(3, 2.0);
        let choice = gaiter_visits::Choice {
            affected: Some(gaiter_visits::Affected::One(Side::Left)),
            ..CHOICE
        };
        let course = Course::comparable(&records, choice).unwrap();
        course.last_compared(&course.groups[0]).remove(0).excess.unwrap()
    });
    let volume = of.legs.left.unwrap().volume.unwrap();
    assert!(excess.change.detectable() < 0.2 * volume.detectable(), "{excess:?} {volume:?}");
    assert_eq!(excess.change.shown(), Shown::Larger);
}
