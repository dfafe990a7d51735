//! The cloud of the reference: scattered points of the closed-form test leg, noisy, some outliers.

// Each user takes its own part.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use crate::chance::Chance;
use crate::test_leg;

/// Radius that no place of the leg reaches, mm: points are taken as densely as r over this.
const DENSEST_MM: f64 = 115.0;

/// The least and the largest way of an outlier outward, mm.
const OUTWARD_MM: [f64; 2] = [5.0, 20.0];

/// What is wrong with the points of a cloud.
#[derive(Debug, Clone, Copy)]
pub struct Faults {
    /// Standard deviation along the normal, mm.
    pub sigma_mm: f64,
    /// Share of points that lie [`OUTWARD_MM`] outside besides.
    pub outliers: f64,
}

/// A cloud and which of its points are outliers.
pub struct Cloud {
    /// The points.
    pub points: Vec<Point3<f64>>,
    /// Whether each is an outlier.
    pub outlier: Vec<bool>,
}

/// `count` points of the test leg. A point that noise moves beyond an end is drawn again.
pub fn cloud(count: usize, faults: Faults, seed: u64) -> Cloud {
    let mut chance = Chance(seed);
    // A small seed says little at first.
    (0..50).for_each(|_| _ = chance.even(1.0));
    let mut cloud = Cloud { points: Vec::new(), outlier: Vec::new() };
    while cloud.points.len() < count {
        let mut unit = || 0.5 * (1.0 + chance.even(1.0));
        let (theta, z) = (TAU * unit(), test_leg::HEIGHT_MM * unit());
        if unit() >= test_leg::radius_mm(theta, z) / DENSEST_MM {
            continue;
        }
        let outlier = unit() < faults.outliers;
        let way = OUTWARD_MM[0] + (OUTWARD_MM[1] - OUTWARD_MM[0]) * unit();
        let outward = faults.sigma_mm * chance.normal() + if outlier { way } else { 0.0 };
        let point = test_leg::point(theta, z);
        let point = point + outward * normal(&point);
        if (0.0..=test_leg::HEIGHT_MM).contains(&point.z) {
            cloud.points.push(point);
            cloud.outlier.push(outlier);
        }
    }
    cloud
}

/// The outward unit normal of the skin, by central differences.
fn normal(point: &Point3<f64>) -> Vector3<f64> {
    let h = 1e-4;
    let slope = |axis: Vector3<f64>| {
        test_leg::outside_mm(&(point + h * axis)) - test_leg::outside_mm(&(point - h * axis))
    };
    Vector3::new(slope(Vector3::x()), slope(Vector3::y()), slope(Vector3::z())).normalize()
}
