//! The middle line of a tube of points along z.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Point2, Point3, Vector2, Vector3};

use crate::basis::Basis;
use crate::fit::{FitFault, Smoothing, Spline, fit};

/// Slabs of equal height in which the middle is determined.
const SLABS: usize = 60;

/// Sectors of a slab. All count equally, however many points they hold, so that a better visible
/// side does not attract the middle.
const SECTORS: usize = 36;

/// Rounds of finding the sectors around the middle, and the middle from the sectors.
const ROUNDS: usize = 4;

/// Pieces of the line: enough for a leg's bends, too few to follow the errors of one slab.
const INTERVALS: usize = 8;

/// Minimum number of sectors with points for a slab to count: two thirds of a turn.
const SECTORS_MIN: usize = 24;

/// The middle line of a tube, over z.
#[derive(Debug, Clone)]
pub struct Middle {
    x: Spline,
    y: Spline,
}

impl Middle {
    /// The middle line of points between their lowest and highest z. Points may be unevenly spread
    /// and noisy, and up to a third of each sector may be outliers.
    ///
    /// # Errors
    /// A [`FitFault`]: a point that is not finite, or fewer than 4 slabs (of 60) that were seen
    /// from most sides.
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
        let (found, needed) = (centres.len(), crate::DEGREE + 1);
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

    /// The middle at height `z`; beyond the points, that of the nearer end.
    pub fn at(&self, z: f64) -> Point2<f64> {
        let row = self.x.basis.row(z);
        Point2::new(row.dot(&self.x.coefficients), row.dot(&self.y.coefficients))
    }

    /// The direction of each point from the middle at its height, in turns from +x towards +y, 0 to
    /// 1: a position around.
    pub fn turns(&self, points: &[Point3<f64>]) -> Vec<f64> {
        let turn = |point: &Point3<f64>| {
            let arm = point.xy() - self.at(point.z);
            (arm.y.atan2(arm.x) / TAU).rem_euclid(1.0)
        };
        points.iter().map(turn).collect()
    }
}

/// The point around which the sectors' median radii do not oscillate; `None` if too few sectors
/// hold points.
fn centre(points: &[Point2<f64>]) -> Option<Point2<f64>> {
    let of = |axis: usize| median(&mut points.iter().map(|point| point[axis]).collect::<Vec<_>>());
    let mut centre = Point2::new(of(0)?, of(1)?);
    for _ in 0..ROUNDS {
        let mut sectors = vec![Vec::new(); SECTORS];
        for point in points {
            let arm = point - centre;
            let sector = (SECTORS as f64 * (arm.y.atan2(arm.x) + PI) / TAU) as usize;
            sectors[sector.min(SECTORS - 1)].push(arm.norm());
        }
        // Around an off-centre point, the radius of a circle oscillates once per turn, in the
        // direction and by the amount of the offset. Unlike a mean of positions, the least-squares
        // oscillation is not disturbed by an empty sector.
        let (mut gram, mut moments, mut seen) = (Matrix3::zeros(), Vector3::zeros(), 0);
        for (sector, radii) in sectors.iter_mut().enumerate() {
            let angle = TAU * (sector as f64 + 0.5) / SECTORS as f64 - PI;
            let row = Vector3::new(1.0, angle.cos(), angle.sin());
            if let Some(radius) = median(radii) {
                gram += row * row.transpose();
                moments += radius * row;
                seen += 1;
            }
        }
        if seen < SECTORS_MIN {
            return None;
        }
        let swing = gram.cholesky()?.solve(&moments);
        centre += Vector2::new(swing.y, swing.z);
    }
    Some(centre)
}

/// The median; the mean of the middle two if the number is even; `None` if there are no values.
fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    let (below, upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let upper = *upper;
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some(if values.len().is_multiple_of(2) { 0.5 * (lower + upper) } else { upper })
}
