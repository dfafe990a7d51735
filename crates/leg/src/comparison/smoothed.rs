//! Meshes that the scanner's software smoothed by moving each point towards the mean of its neighbours (umbrella or
//! Laplace smoothing; Taubin, A signal processing approach to fair surface design, 1995): every round makes a leg
//! thinner, by half a millimetre of girth where points are 5 mm apart, and removes the noise that would show it.
//!
//! It also moves points along the skin, which shows. The points of a scan lie unevenly: the distance of each to the mean
//! of its neighbours, along the skin, has nothing to do with that of its neighbours. Smoothing evens it out like heat, so
//! that it is nearly the same from point to point, the more rounds the nearer.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::sections::slice::{Around, Mesh};

/// The points that are looked at, as shares of stature: those of the shanks, where nothing is sharp.
const SPAN_SHARE: [f64; 2] = [0.06, 0.28];

/// The distance to the mean of neighbours differs from theirs by this many times its size on average: 0.99 to 1.17 in
/// scans, thinned, decimated, with noise or without. One round leaves 0.6 to 0.9 of it, two 0.3 to 0.7, ten less than 0.25.
const SMOOTHED_MAX: f64 = 0.75;

/// Rounds, in which points move half the way, are this divided by it: on three bodies 1.4 to 1.8, up to 20 rounds. In
/// meshes most of whose points have six neighbours they are two to three times fewer.
const ROUNDS: f64 = 1.7;

/// More rounds than this cannot be distinguished.
const ROUNDS_MAX: f64 = 100.0;

/// A point goes this share of the way to the mean of its neighbours in a round.
const WAY: f64 = 0.5;

/// Standard error of a girth, as a share of what it is likely to have lost. Of 112 girths of eleven bodies after 2 to 29
/// rounds, nine in ten were off by less than two; after more rounds the ratio hardly falls, and up to five.
const SD_SHARE: f64 = 0.8;

/// Where fewer or more points than these shares have other than six neighbours, the mesh is a grid, whose points lie
/// evenly by themselves: its corners are all alike, or every second one is.
const IRREGULAR_SHARE: [f64; 2] = [0.02, 0.8];

/// This many points give the ratio to one or two hundredths.
const POINTS_MIN: f64 = 300.0;

/// Sums over the points of the legs.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    points: f64,
    irregular: f64,
    /// Distances along the skin to the mean of neighbours, squared, mm².
    aside_mm2: f64,
    /// Differences between these and those of neighbours, squared, mm².
    change_mm2: f64,
    /// Distances across the skin to the mean of neighbours, mm.
    across_mm: f64,
}

/// The standard error that girths have because the meshes of the legs were smoothed, mm: all are too small. `None` if they
/// were not, or if that cannot be determined: for point clouds and grids.
pub fn smoothing_sd_mm(legs: &[&Mesh], stature_mm: f64) -> Option<f64> {
    let span_mm = SPAN_SHARE.map(|share| share * stature_mm);
    let mut sums = Sums::default();
    legs.iter().for_each(|mesh| sums.add(mesh, span_mm));
    let [least, most] = IRREGULAR_SHARE.map(|share| share * sums.points);
    if sums.points < POINTS_MIN || !(least..=most).contains(&sums.irregular) {
        return None;
    }
    let ratio = (sums.change_mm2 / sums.aside_mm2).sqrt();
    let rounds = (ROUNDS / ratio).min(ROUNDS_MAX);
    let lost_mm = TAU * WAY * rounds * sums.across_mm / sums.points;
    (ratio < SMOOTHED_MAX).then_some(SD_SHARE * lost_mm)
}

impl Sums {
    fn add(&mut self, mesh: &Mesh, [low_mm, high_mm]: [f64; 2]) {
        let around = mesh.around();
        let inner = inner(mesh, &around, 2);
        let arms = to_mean(mesh, &around, mesh.points().iter().map(|point| point.coords));
        let normals = (0..).map(|index| mesh.normal(index));
        let across: Vec<f64> =
            arms.iter().zip(normals.clone()).map(|(arm, normal)| arm.dot(&normal)).collect();
        let aside: Vec<Vector3<f64>> = arms
            .iter()
            .zip(normals.clone().zip(&across))
            .map(|(arm, (normal, across))| arm - normal * *across)
            .collect();
        let change = to_mean(mesh, &around, aside.iter().copied());
        for (index, normal) in normals.take(inner.len()).enumerate() {
            if !inner[index] || !(low_mm..high_mm).contains(&mesh.points()[index].z) {
                continue;
            }
            let change = change[index] - normal * normal.dot(&change[index]);
            self.points += 1.0;
            self.irregular += f64::from(u8::from(around[index].facets != 6));
            self.aside_mm2 += aside[index].norm_squared();
            self.change_mm2 += change.norm_squared();
            self.across_mm += across[index].abs();
        }
    }
}

/// From the value at each point to the mean of those at its neighbours.
fn to_mean(
    mesh: &Mesh,
    around: &[Around],
    values: impl Iterator<Item = Vector3<f64>>,
) -> Vec<Vector3<f64>> {
    let values: Vec<Vector3<f64>> = values.collect();
    let mut sums = vec![Vector3::zeros(); values.len()];
    for &[a, b] in mesh.edges() {
        let [a, b] = [a as usize, b as usize];
        sums[a] += values[b];
        sums[b] += values[a];
    }
    let mean = |((sum, around), value): ((Vector3<f64>, &Around), Vector3<f64>)| {
        sum / f64::from(around.edges.max(1)) - value
    };
    sums.into_iter().zip(around).zip(values).map(mean).collect()
}

/// The points that facets surround, and whose neighbours are such points up to this many edges away.
fn inner(mesh: &Mesh, around: &[Around], edges_away: usize) -> Vec<bool> {
    let mut inner: Vec<bool> = around.iter().map(Around::is_surrounded).collect();
    for _ in 0..edges_away {
        let before = inner.clone();
        for &[a, b] in mesh.edges() {
            let [a, b] = [a as usize, b as usize];
            inner[a] &= before[b];
            inner[b] &= before[a];
        }
    }
    inner
}
