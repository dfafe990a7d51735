//! Computes parameters for points that have none.

use nalgebra::{Point3, distance};

use crate::fit::FitFault;

/// The parameter of each column of closed sections, 0 for the first, below 1, ascending: the share
/// of the section's length up to the column, measured along the chords (including the closing one)
/// and averaged over the sections. `points` are row-major, rows of `columns`. Source: The
/// NURBS Book, equations 9.5 and 9.8.
///
/// # Errors
/// [`FitFault::NoGrid`] unless there are complete rows, [`FitFault::NotFinite`],
/// [`FitFault::NoLength`] if all points of a section coincide.
pub fn mean_chord_parameters(points: &[Point3<f64>], columns: usize) -> Result<Vec<f64>, FitFault> {
    let rows = points.len().checked_div(columns).unwrap_or(0);
    if rows == 0 || rows * columns != points.len() {
        return Err(FitFault::NoGrid { points: points.len(), along: rows, around: columns });
    }
    if let Some(index) = points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        return Err(FitFault::NotFinite { index });
    }
    let mut shares = vec![0.0; columns];
    for (row, section) in points.chunks_exact(columns).enumerate() {
        let chords = || section.iter().zip(section.iter().cycle().skip(1));
        let length: f64 = chords().map(|(a, b)| distance(a, b)).sum();
        if length <= 0.0 {
            return Err(FitFault::NoLength { row });
        }
        let mut walked = 0.0;
        for (share, (a, b)) in shares.iter_mut().zip(chords()) {
            *share += walked / (length * rows as f64);
            walked += distance(a, b);
        }
    }
    Ok(shares)
}
