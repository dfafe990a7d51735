//! The middle line of a tube of points that stands along z; nurbs.md 6.1.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Point3};

use super::basis::Basis;
use super::fit::{FitFault, Smoothing, Spline, fit};

/// Slabs of equal height in which the middle is found.
const SLABS: usize = 60;

/// Sectors of a slab. Each counts alike however many points it holds, so that a side that is seen
/// better draws the middle no nearer.
const SECTORS: usize = 36;

/// Rounds of finding the sectors about the middle and the middle from the sectors.
const ROUNDS: usize = 3;

/// Pieces of the line: enough for a leg's bends, too few for one slab's errors.
const INTERVALS: usize = 8;

/// Sectors that must hold points for a slab to count: half a turn and more, or the middle would lie
/// towards the side that is seen.
const SECTORS_MIN: usize = 24;

/// The middle line of a tube, over z.
#[derive(Debug, Clone)]
pub struct Middle {
    x: Spline,
    y: Spline,
}

impl Middle {
    /// The middle line of points between their lowest and highest z. Points may be unevenly spread,
    /// noisy, and up to a third of each sector's outliers.
    ///
    /// # Errors
    /// A [`FitFault`]: a point not finite, or fewer than 4 slabs (of 60) that are seen from most
    /// sides.
    pub fn of(points: &[Point3<f64>]) -> Result<Middle, FitFault> {
        let unusable = |point: &Point3<f64>| !point.iter().all(|value| value.is_finite());
        if let Some(index) = points.iter().position(unusable) {
            return Err(FitFault::NotFinite { index });
        }
        let ends = points.iter().map(|point| point.z);
        let (low, high) = ends
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        let mut slabs = vec![Vec::new(); SLABS];
        for point in points {
            let slab = (SLABS as f64 * (point.z - low) / (high - low)) as usize;
            slabs[slab.min(SLABS - 1)].push(point.xy());
        }
        let height = |slab: usize| low + (high - low) * (slab as f64 + 0.5) / SLABS as f64;
        let centres = slabs.iter().enumerate();
        let centres = centres.filter_map(|(slab, points)| Some((height(slab), centre(points)?)));
        let centres: Vec<(f64, Point2<f64>)> = centres.collect();
        let (found, needed) = (centres.len(), super::DEGREE + 1);
        if found < needed || low >= high {
            return Err(FitFault::TooFewPlaces { found, needed });
        }
        let basis = Basis::uniform_clamped(low, high, INTERVALS)?;
        let heights: Vec<f64> = centres.iter().map(|(height, _)| *height).collect();
        let weights = vec![1.0; heights.len()];
        let line = |axis: usize| {
            let values: Vec<f64> = centres.iter().map(|(_, centre)| centre[axis]).collect();
            fit(&basis, &heights, &values, &weights, Smoothing::None)
        };
        Ok(Middle { x: line(0)?, y: line(1)? })
    }

    /// The middle at height `z`, that of the nearer end beyond the points.
    pub fn at(&self, z: f64) -> Point2<f64> {
        let row = self.x.basis.row(z);
        Point2::new(row.dot(&self.x.coefficients), row.dot(&self.y.coefficients))
    }

    /// The direction of each point from the middle at its height, turns from +x towards +y, 0 to 1:
    /// a place around.
    pub fn turns(&self, points: &[Point3<f64>]) -> Vec<f64> {
        let turn = |point: &Point3<f64>| {
            let arm = point.xy() - self.at(point.z);
            (arm.y.atan2(arm.x) / TAU).rem_euclid(1.0)
        };
        points.iter().map(turn).collect()
    }
}

/// The mean of the sectors' medians; none where too few sectors hold points.
fn centre(points: &[Point2<f64>]) -> Option<Point2<f64>> {
    let mut centre = median(points.to_vec())?;
    for _ in 0..ROUNDS {
        let mut sectors = vec![Vec::new(); SECTORS];
        for point in points {
            let arm = point - centre;
            let sector = (SECTORS as f64 * (arm.y.atan2(arm.x) + PI) / TAU) as usize;
            sectors[sector.min(SECTORS - 1)].push(*point);
        }
        let medians: Vec<Point2<f64>> = sectors.into_iter().filter_map(median).collect();
        if medians.len() < SECTORS_MIN {
            return None;
        }
        let sum = medians.iter().fold(Point2::origin(), |sum, median| sum + median.coords);
        centre = sum / medians.len() as f64;
    }
    Some(centre)
}

/// The median of x and of y.
fn median(mut points: Vec<Point2<f64>>) -> Option<Point2<f64>> {
    let middle = points.len() / 2;
    let mut of = |axis: usize| {
        let order = |a: &Point2<f64>, b: &Point2<f64>| a[axis].total_cmp(&b[axis]);
        let found = points.get_mut(..).filter(|points| !points.is_empty())?;
        Some(found.select_nth_unstable_by(middle, order).1[axis])
    };
    Some(Point2::new(of(0)?, of(1)?))
}
