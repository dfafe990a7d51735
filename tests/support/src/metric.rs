//! How well a surface matches the closed-form test leg, and the parameters of its grid.

use gaiter_spline::Surface;
use nalgebra::{Point3, Vector3, distance};

use crate::test_leg;

/// Height over 800 for the rows; mean chord lengths for the columns.
pub fn parameters(points: &[Point3<f64>]) -> (Vec<f64>, Vec<f64>) {
    let rows = points.chunks_exact(test_leg::GRID_COLUMNS);
    let along = rows.map(|row| row[0].z / test_leg::HEIGHT_MM).collect();
    (along, mean_chord_parameters(points, test_leg::GRID_COLUMNS))
}

/// The parameter of each column of closed sections, 0 for the first, below 1, ascending: the share of
/// the section's length up to the column, measured along the chords and averaged over the sections;
/// NaN if a section has no length. `points` are row-major, whole rows of `columns`. Source: The NURBS
/// Book, equations 9.5 and 9.8.
pub fn mean_chord_parameters(points: &[Point3<f64>], columns: usize) -> Vec<f64> {
    let rows = (points.len() / columns) as f64;
    let mut shares = vec![0.0; columns];
    for section in points.chunks_exact(columns) {
        let chords = || section.iter().zip(section.iter().cycle().skip(1));
        let length: f64 = chords().map(|(a, b)| distance(a, b)).sum();
        let mut walked = 0.0;
        for (share, (a, b)) in shares.iter_mut().zip(chords()) {
            *share += walked / (length * rows);
            walked += distance(a, b);
        }
    }
    shares
}

/// The metric of the reference: area-weighted mean, RMS and largest distance to the true leg in mm,
/// and the mean of distance over radius in percent. Parameters run over [0, 1] along and have period
/// 1 around.
pub fn true_error(surface: &Surface) -> [f64; 4] {
    let (heights, around) = (251, 200);
    let at = |i: usize, j: usize| {
        surface.point(i as f64 / (heights - 1) as f64, (j % around) as f64 / around as f64)
    };
    let (mut area, mut mean, mut square, mut largest, mut relative) = (0.0, 0.0, 0.0, 0.0_f64, 0.0);
    for i in 0..heights {
        for j in 0..around {
            let here = at(i, j);
            let (below, above) = (at(i.max(1) - 1, j), at((i + 1).min(heights - 1), j));
            let steps = if i == 0 || i == heights - 1 { 1.0 } else { 2.0 };
            let weight = (at(i, j + 1) - here).cross(&((above - below) / steps)).norm();
            let distance = distance_to_leg(&here);
            let (cx, cy) = test_leg::center(here.z);
            area += weight;
            mean += weight * distance;
            square += weight * distance * distance;
            largest = largest.max(distance);
            relative += weight * distance / (here.x - cx).hypot(here.y - cy);
        }
    }
    [mean / area, (square / area).sqrt(), largest, 100.0 * relative / area]
}

/// Distance of a point near the skin: two Newton steps to the foot.
fn distance_to_leg(point: &Point3<f64>) -> f64 {
    let mut foot = *point;
    for _ in 0..2 {
        let h = 1e-4;
        let slope = |axis: Vector3<f64>| {
            let step = h * axis;
            (test_leg::outside_mm(&(foot + step)) - test_leg::outside_mm(&(foot - step)))
                / (2.0 * h)
        };
        let gradient = Vector3::new(slope(Vector3::x()), slope(Vector3::y()), slope(Vector3::z()));
        let outside = test_leg::outside_mm(&foot) + (point - foot).dot(&gradient);
        foot = point - outside / gradient.norm_squared() * gradient;
    }
    (point - foot).norm()
}
