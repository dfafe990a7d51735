//! A scan taken again: the same skin, other noise; and its feature points found again.

// Each user takes its own part.

use std::f64::consts::TAU;

use gaiter_leg::features::feature::Feature;
use gaiter_leg::sections::section::Section;
use gaiter_scan::Scan;
use nalgebra::Vector3;

use crate::solids::Chance;

/// Points further apart than this along the skin are not the same one, mm.
pub const REACH_MM: f64 = 15.0;

/// Sides of the polygon that tells lengths along a section.
const SIDES: usize = 720;

/// The scan with normal noise of this standard deviation, in its own unit, added along its
/// vertices' normals.
pub fn roughened(scan: &Scan, sigma: f64, seed: u64) -> Scan {
    let mut normals = vec![Vector3::zeros(); scan.points.len()];
    for triangle in &scan.triangles {
        let [a, b, c] = triangle.map(|corner| scan.points[corner as usize]);
        let normal = (b - a).cross(&(c - a));
        triangle.iter().for_each(|&corner| normals[corner as usize] += normal);
    }
    let mut chance = Chance(seed);
    let roughen = |(point, normal): (_, &Vector3<f64>)| {
        let out = normal.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        point + out * (sigma * chance.normal())
    };
    let points = scan.points.iter().zip(&normals).map(roughen).collect();
    Scan { points, triangles: scan.triangles.clone() }
}

/// What became of feature points between two measurements of the same sections.
#[derive(Debug, Clone, Default)]
pub struct Fate {
    /// Points before and after.
    pub counts: [usize; 2],
    /// How far each point that was found again moved along the skin, mm.
    pub moved_mm: Vec<f64>,
    /// … in units of the standard errors of both places.
    pub moved_sd: Vec<f64>,
    /// Sections whose points are the same under the same labels, and all sections.
    pub labels: [usize; 2],
}

impl Fate {
    /// Follows the points of one section, `before`, to where they are `after`: those of one kind,
    /// the nearest pairs first, none over more than [`REACH_MM`].
    pub fn add(&mut self, section: &Section, before: &[Feature], after: &[Feature]) {
        let along = Along::from_section(section);
        let mut pairs = Vec::new();
        for (i, from) in before.iter().enumerate() {
            for (j, to) in after.iter().enumerate().filter(|(_, to)| to.kind == from.kind) {
                let moved_mm = along.between(from.angle_deg, to.angle_deg);
                pairs.push((moved_mm, i, j));
            }
        }
        pairs.retain(|(moved_mm, ..)| *moved_mm <= REACH_MM);
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut from_used, mut to_used) = (vec![false; before.len()], vec![false; after.len()]);
        let mut same_labels = before.len() == after.len();
        let mut found = 0;
        for (moved_mm, i, j) in pairs {
            if !from_used[i] && !to_used[j] {
                (from_used[i], to_used[j]) = (true, true);
                let sd = before[i].position_sd_mm.hypot(after[j].position_sd_mm);
                self.moved_mm.push(moved_mm);
                self.moved_sd.push(moved_mm / sd);
                same_labels &= i == j;
                found += 1;
            }
        }
        same_labels &= found == before.len();
        self.counts[0] += before.len();
        self.counts[1] += after.len();
        self.labels[0] += usize::from(same_labels);
        self.labels[1] += 1;
    }

    /// Adds what became of other points.
    pub fn join(&mut self, other: &Fate) {
        self.moved_mm.extend(&other.moved_mm);
        self.moved_sd.extend(&other.moved_sd);
        (0..2).for_each(|i| self.counts[i] += other.counts[i]);
        (0..2).for_each(|i| self.labels[i] += other.labels[i]);
    }

    /// Share of the points before that are not found after.
    pub fn vanished(&self) -> f64 {
        1.0 - self.moved_mm.len() as f64 / self.counts[0] as f64
    }

    /// Share of the points after that were not there before.
    pub fn invented(&self) -> f64 {
        1.0 - self.moved_mm.len() as f64 / self.counts[1] as f64
    }
}

/// The value below which this share of the values lies; NaN where there are none.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let index = (share * sorted.len() as f64) as usize;
    sorted.get(index.min(sorted.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
}

/// Lengths along a section.
struct Along(Vec<f64>);

impl Along {
    fn from_section(section: &Section) -> Along {
        let points = section.curve.points(SIDES);
        let mut lengths = vec![0.0];
        for (index, point) in points.iter().enumerate() {
            lengths.push(lengths[index] + (points[(index + 1) % SIDES] - point).norm());
        }
        Along(lengths)
    }

    /// Length from −180° to an angle.
    fn to(&self, angle_deg: f64) -> f64 {
        let place = (angle_deg.to_radians() / TAU + 0.5).rem_euclid(1.0) * SIDES as f64;
        let index = (place as usize).min(SIDES - 1);
        self.0[index] + (place - index as f64) * (self.0[index + 1] - self.0[index])
    }

    /// The shorter way between two angles.
    fn between(&self, from_deg: f64, to_deg: f64) -> f64 {
        let way = (self.to(from_deg) - self.to(to_deg)).abs();
        way.min(self.0[SIDES] - way)
    }
}
