//! What another stance, other noise and a common error do to volumes and girths: the table of docs/visits.md.
//!
//! `cargo run --release --example visits`

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

use std::io::{self, Write};

use gaiter_leg::{Method, Side};
use gaiter_record::Record;
use gaiter_scan::Scan;
use gaiter_visits::{Choice, Course, GIRTH_COMMON_MM};
use support::mesh::Mesh;
use support::noise::roughened;
use support::recorded::truth;
use support::records::record_of_scan;
use support::stance::Stance;

/// The noise of a good scanner, mm.
const NOISE_MM: f64 = 0.5;

/// Half the length around the knee whose girths stand in a column of their own, mm.
const KNEE_MM: f64 = 80.0;

/// Height of the knee as a share of the stature.
const KNEE_SHARE: f64 = 0.285;

/// The bodies that are scanned.
const BODIES: [&str; 2] = ["f_average_clean", "m_average_clean"];

/// Legs apart and knees bent, degrees.
const STANCES: [[f64; 2]; 11] = [
    [0.0, 0.0],
    [0.0, 0.0],
    [-2.0, 0.0],
    [-1.0, 0.0],
    [1.0, 0.0],
    [2.0, 0.0],
    [3.0, 0.0],
    [0.0, 2.0],
    [0.0, 4.0],
    [0.0, 6.0],
    [0.0, 8.0],
];

fn main() -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "| body | legs apart | knees bent | volume | girths away from the knee | at the knee | shown from |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|---|")?;
    for name in BODIES {
        let first = standing(name, Stance::default(), 1);
        for (seed, [apart_deg, bent_deg]) in STANCES.into_iter().enumerate() {
            let later = standing(name, Stance { apart_deg, bent_deg }, 50 + seed as u64);
            row(&mut out, name, [apart_deg, bent_deg], [first.clone(), later])?;
        }
    }
    Ok(())
}

/// The largest differences of both legs.
fn row(
    out: &mut impl Write,
    name: &str,
    [apart, bent]: [f64; 2],
    records: [Record; 2],
) -> io::Result<()> {
    let knee_mm = KNEE_SHARE * records[0].body.stature_mm.unwrap_or_default();
    let choice = Choice { volume: None, affected: None, girth_common_mm: GIRTH_COMMON_MM };
    let Ok(course) = Course::comparable(&records, choice) else {
        return writeln!(out, "| {name} | {apart} | {bent} | not compared | | | |");
    };
    let group = &course.groups[0];
    let of = course.last_compared(group).remove(0);
    let larger = |one: f64, other: f64| if other.abs() > one.abs() { other } else { one };
    let (mut volume, mut detectable, mut away, mut at_knee) = (0.0, 0.0_f64, 0.0, 0.0);
    for side in Side::BOTH {
        if let Some(change) = of.legs.get(side).as_ref().and_then(|leg| leg.volume) {
            volume = larger(volume, change.percent);
            detectable = detectable.max(change.detectable_percent());
        }
        let legs = [0, 1].map(|visit| course.visits[visit].legs.get(side).as_ref());
        let [Some(before), Some(after)] = legs else { continue };
        for (step, place) in before.places.iter().filter(|(step, _)| **step >= 3) {
            let Some(later) = after.places.get(step) else { continue };
            let by_mm = later.girth_mm - place.girth_mm;
            match (40.0 * f64::from(*step) - knee_mm).abs() < KNEE_MM {
                true => at_knee = larger(at_knee, by_mm),
                false => away = larger(away, by_mm),
            }
        }
    }
    writeln!(
        out,
        "| {name} | {apart:+}° | {bent}° | {volume:+.2} % | {away:+.1} mm | {at_knee:+.1} mm | {detectable:.2} % |"
    )
}

/// The record of a body in a stance, with noise of its own.
fn standing(name: &str, stance: Stance, seed: u64) -> Record {
    let crotch_mm = truth(name)["crotch_height_mm"].as_f64().unwrap_or_default();
    let mesh = stance.of(Mesh::body(name), crotch_mm);
    let points = mesh.points.iter().map(|p| (*p).into()).collect();
    let triangles = mesh.triangles.iter().map(|t| t.map(|corner| corner as u32)).collect();
    let scan = Scan { points, triangles };
    record_of_scan(&roughened(&scan, NOISE_MM, seed), &Method::default())
}
