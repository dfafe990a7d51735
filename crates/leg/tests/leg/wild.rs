//! Bodies as booths, their software and life deliver them: kinds, of which each test draws many.

#![allow(clippy::unwrap_used, clippy::panic)]

mod amputations;
mod bystanders;
mod cameras;
mod children;
mod cloth;
mod coarse;
mod decimated;
mod filled;
mod floors;
mod heads;
mod holes;
mod poses;
mod smoothed;
mod soles;
mod thighs;
mod unseen;
mod untouched;

use std::sync::LazyLock;

use gaiter_leg::{Extraction, Landmark, Level, Method, Side};
use support::chance::Chance;
use support::mesh::Mesh;
use support::recorded::extract_scan;

/// A body without noise and what is measured on it, which is true to 0.2 mm.
struct Sample {
    mesh: Mesh,
    truth: Extraction,
}

impl Sample {
    fn named(name: &str) -> Sample {
        let mesh = Mesh::body(name);
        let truth = measured(&mesh);
        Sample { mesh, truth }
    }
}

/// A woman and a man, exported in mm with y up and the toes to +z.
static SAMPLES: LazyLock<[Sample; 2]> =
    LazyLock::new(|| ["f_average_clean", "m_average_clean"].map(Sample::named));

fn measured(mesh: &Mesh) -> Extraction {
    extract_scan(&mesh.scan(), &Method::default()).unwrap()
}

/// Whether a scan has a finding about itself or a whole leg.
fn is_told(found: &Extraction, code: &str) -> bool {
    found.findings.iter().any(|finding| finding.level.is_none() && finding.code() == code)
}

/// Levels that both have, as found and as they truly are.
fn pairs(found: &Extraction, truth: &Extraction, levels: &[Level]) -> Vec<[Landmark; 2]> {
    let of = |extraction: &Extraction, side: Side, level: Level| {
        let leg = extraction.legs.iter().find(|leg| leg.side == side)?;
        leg.landmarks.iter().find(|landmark| landmark.level == level).cloned()
    };
    let legs = found.legs.iter();
    let all = legs.flat_map(|leg| levels.iter().map(move |level| (leg.side, *level)));
    all.filter_map(|(side, level)| Some([of(found, side, level)?, of(truth, side, level)?]))
        .collect()
}

/// The levels B, C and D that are off by more than 2 mm and three stated standard errors without a doubt.
fn quietly_wrong(found: &Extraction, truth: &Extraction) -> Vec<(Side, Level, f64)> {
    let mut wrong = Vec::new();
    for (leg, level) in
        found.legs.iter().flat_map(|leg| [Level::B, Level::C, Level::D].map(|l| (leg, l)))
    {
        let of = |extraction: &Extraction| {
            let leg = extraction.legs.iter().find(|other| other.side == leg.side)?;
            leg.landmarks.iter().find(|landmark| landmark.level == level).cloned()
        };
        let (Some(own), Some(truth)) = (of(found), of(truth)) else { continue };
        let off_mm = own.girth_tape_mm - truth.girth_tape_mm;
        if off_mm.abs() > 2.0 + 3.0 * own.girth_of_level_sd_mm && own.doubts.is_empty() {
            wrong.push((leg.side, level, off_mm));
        }
    }
    wrong
}

/// A mesh whose points are moved along their normals by so much.
fn grown(mesh: &Mesh, mut by_mm: impl FnMut(usize, [f64; 3]) -> f64) -> Mesh {
    let normals = mesh.normals();
    let mut mesh = mesh.clone();
    for (index, (point, normal)) in mesh.points.iter_mut().zip(&normals).enumerate() {
        let by_mm = by_mm(index, *point);
        (0..3).for_each(|axis| point[axis] += by_mm * normal[axis]);
    }
    mesh
}

/// A mesh with noise along its normals.
fn noisy(mesh: &Mesh, noise_mm: f64, chance: &mut Chance) -> Mesh {
    grown(mesh, |_, _| noise_mm * chance.normal())
}

/// The middle of a leg at a height: x, z, of the leg on the positive or the negative side of x.
fn middle_of_leg(mesh: &Mesh, y_mm: f64, sign: f64) -> [f64; 2] {
    let near = mesh.points.iter().filter(|p| p[0] * sign > 5.0 && (p[1] - y_mm).abs() < 6.0);
    let near: Vec<[f64; 2]> = near.filter(|p| p[0].abs() < 230.0).map(|p| [p[0], p[2]]).collect();
    [0, 1].map(|axis| {
        let of = near.iter().map(|point| point[axis]);
        let [low, high] =
            [of.clone().fold(f64::INFINITY, f64::min), of.fold(f64::NEG_INFINITY, f64::max)];
        (low + high) / 2.0
    })
}
