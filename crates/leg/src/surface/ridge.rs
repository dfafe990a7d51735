//! Ridges: curvature peaks that continue from section to section, such as the tibial crest, the
//! Achilles tendon and the heads of the calf muscle.

use std::f64::consts::TAU;

use crate::features::feature::{Angles, peaks};
use crate::sections::section::{SPACING_MM, Section};

/// A ridge moves by at most this along the skin from one section to the next, mm: it runs within
/// 45° of the leg's direction.
const STEP_MM: f64 = SPACING_MM;

/// A peak may be missing in this many consecutive sections; after a longer gap a new ridge begins.
const MISSING_MAX: usize = 2;

/// Minimum length of a ridge, mm: longer than a malleolus or a patella, which are bumps.
const LENGTH_MIN_MM: f64 = 100.0;

/// A line of curvature peaks along the leg: one point per section, upwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Ridge {
    /// Its peaks; at least two.
    pub places: Vec<RidgePlace>,
}

/// A peak of a ridge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RidgePlace {
    /// Index of the section, counted from the lowest.
    row: usize,
    /// Distance of its section along the axis, mm.
    pub along_mm: f64,
    /// Its angle around the section's centre, radians; continuous from point to point, so it may
    /// leave (−π, π].
    pub angle: f64,
}

impl Ridge {
    /// The mean of its angles, radians.
    pub fn angle(&self) -> f64 {
        self.places.iter().map(|place| place.angle).sum::<f64>() / self.places.len() as f64
    }

    fn last(&self) -> &RidgePlace {
        &self.places[self.places.len() - 1]
    }

    fn length_mm(&self) -> f64 {
        self.last().along_mm - self.places[0].along_mm
    }
}

/// The ridges of a leg's sections (which ascend).
pub fn ridges(sections: &[&Section]) -> Vec<Ridge> {
    let Some(angles) = sections.first().map(|section| Angles::from_section(section)) else {
        return Vec::new();
    };
    let mut ridges: Vec<Ridge> = Vec::new();
    for (row, section) in sections.iter().enumerate() {
        let mut peaks = peaks(section, &angles);
        let radius_mm = section.girth.contour_mm / TAU;
        while let Some((ridge, peak)) = nearest(&ridges, &peaks, row, radius_mm) {
            let last = ridges[ridge].last().angle;
            let angle = last + turned(peaks.swap_remove(peak) - last);
            ridges[ridge].places.push(RidgePlace { row, along_mm: section.along_mm, angle });
        }
        let begun = peaks.into_iter().map(|angle| Ridge {
            places: vec![RidgePlace { row, along_mm: section.along_mm, angle }],
        });
        ridges.extend(begun);
    }
    ridges.retain(|ridge| ridge.length_mm() >= LENGTH_MIN_MM);
    ridges
}

/// The ridge and the peak that are closest to each other, if the peak continues the ridge.
fn nearest(ridges: &[Ridge], peaks: &[f64], row: usize, radius_mm: f64) -> Option<(usize, usize)> {
    let open = ridges.iter().enumerate().filter(|(_, ridge)| {
        let last = ridge.last().row;
        last < row && row - last <= MISSING_MAX + 1
    });
    let pairs = open.flat_map(|(index, ridge)| {
        let last = ridge.last();
        let reach_mm = STEP_MM * (row - last.row) as f64;
        let far = move |peak: &f64| radius_mm * turned(peak - last.angle).abs();
        let peaks = peaks.iter().enumerate();
        peaks.map(move |(peak, angle)| (far(angle), index, peak)).filter(move |p| p.0 <= reach_mm)
    });
    pairs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, ridge, peak)| (ridge, peak))
}

/// The equivalent angle in [−π, π].
fn turned(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}
