//! How far the overlapping shells of a leg are apart: the front's and the back's, or those of single cameras.
//!
//! Where two shells overlap, both show the same skin. A shell that is moved by a small distance lies further outside
//! by what of it points along the skin's normal. So the distances between the two skins, over all directions of the
//! normal, give the shift; their growth along the leg gives a turn. Even a shift along the skin shows, because the
//! overlap is some degrees wide.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix2x4, Matrix4, Vector4};

use crate::frame::union_find::DisjointSets;
use crate::sections::placed::Placed;
use crate::statistics::median;

/// The part of the legs that is looked at, as shares of the stature: above the ankle bones, below the groin.
pub const SPAN_SHARE: [f64; 2] = [0.06, 0.44];

/// A shell has at least this share of the leg's points; less is a fragment.
const SHELL_MIN_SHARE: f64 = 0.04;

/// The skins are compared over cells of this height, mm, and this many around: in 8 mm, skin departs from the
/// fit by little.
const CELL_MM: f64 = 8.0;
const CELLS_AROUND: usize = 36;

/// Shells that share fewer cells do not overlap: 5 mm of overlap along the legs fill 60.
const CELLS_MIN: usize = 30;

/// … nor if they do in less than this share of the rows of cells: shells of body parts meet at one height.
const ROWS_MIN_SHARE: f64 = 0.5;

/// A point further from the fitted skin belongs to neither, mm.
const OUTSIDE_MAX_MM: f64 = 10.0;

/// A shift counts in a direction in which it exceeds this many standard errors.
const CERTAIN_SDS: f64 = 4.0;

/// The variance of a shift is this many times that of independent cells: noise is not quite independent, and the shells
/// end in the cells.
const DEPENDENCE: f64 = 2.0;

/// Least scatter of a cell's distance for one point of each shell, mm.
const SCATTER_MIN_MM: f64 = 0.05;

/// Cells that are off by more than this many times their scatter count nothing (Tukey's biweight).
const BIWEIGHT: f64 = 5.0;

/// Rounds of weighting.
const ROUNDS: usize = 4;

/// Keeps a direction that no normal has from dividing by nothing.
const RIDGE: f64 = 1e-6;

/// What one shell has in a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    points: f64,
    outside_mm: f64,
    front: f64,
    left: f64,
    height_mm: f64,
}

/// Where two shells show the same skin.
struct Shared {
    /// To the front and to the left: the normal, and the normal times the height, −1 at the lower end of the legs and
    /// 1 at the upper.
    normal: Vector4<f64>,
    /// How far the first lies outside the second, mm.
    apart_mm: f64,
    /// Inverse of the variance in units of that of one point.
    weight: f64,
}

/// The largest distance between two shells of a leg that is beyond doubt, mm; `None` if no two overlap. The stature
/// gives the part of the leg that is looked at.
pub fn apart_mm(placed: &[Option<Placed>], edges: &[[u32; 2]], stature_mm: f64) -> Option<f64> {
    let shells = shells(placed, edges, stature_mm);
    let pairs = shells.iter().enumerate().flat_map(|(index, a)| {
        shells[index + 1..].iter().filter_map(move |b| shift(&shared(a, b, stature_mm)?))
    });
    pairs.map(|(shift, covariance)| certain_mm(&shift, &covariance)).reduce(f64::max)
}

/// The cells of each large shell, if there are several.
fn shells(placed: &[Option<Placed>], edges: &[[u32; 2]], stature_mm: f64) -> Vec<Vec<Cell>> {
    let mut sets = DisjointSets::new(placed.len());
    edges.iter().for_each(|&[a, b]| sets.join(a, b));
    let [low_mm, high_mm] = SPAN_SHARE.map(|share| share * stature_mm);
    let is_inside = |point: &&Placed| {
        (low_mm..high_mm).contains(&point.height_mm) && point.outside_mm.abs() < OUTSIDE_MAX_MM
    };
    let mut counts = vec![0_usize; placed.len()];
    let mut points: Vec<(u32, &Placed)> = Vec::new();
    for (index, point) in (0..).zip(placed) {
        if let Some(point) = point.as_ref().filter(is_inside) {
            let shell = sets.root(index);
            counts[shell as usize] += 1;
            points.push((shell, point));
        }
    }
    let least = SHELL_MIN_SHARE * points.len() as f64;
    let large = (0..).zip(&counts).filter(|(_, count)| **count as f64 > least);
    let large: Vec<u32> = large.map(|(shell, _)| shell).collect();
    if large.len() < 2 {
        return Vec::new();
    }
    let rows = ((high_mm - low_mm) / CELL_MM) as usize + 1;
    let mut cells = vec![vec![Cell::default(); rows * CELLS_AROUND]; large.len()];
    for (shell, point) in points {
        let Ok(shell) = large.binary_search(&shell) else { continue };
        let row = ((point.height_mm - low_mm) / CELL_MM) as usize;
        let share = (point.angle + PI).rem_euclid(TAU) / TAU;
        let column = ((share * CELLS_AROUND as f64) as usize).min(CELLS_AROUND - 1);
        let cell = &mut cells[shell][row * CELLS_AROUND + column];
        cell.points += 1.0;
        cell.outside_mm += point.outside_mm;
        cell.front += point.direction.cos();
        cell.left += point.direction.sin();
        cell.height_mm += point.height_mm;
    }
    cells
}

/// The cells in which both shells have points; `None` if they do not overlap along the leg.
fn shared(a: &[Cell], b: &[Cell], stature_mm: f64) -> Option<Vec<Shared>> {
    let [low, high] = SPAN_SHARE.map(|share| share * stature_mm);
    let is_shared = |(a, b): &(&Cell, &Cell)| a.points > 0.0 && b.points > 0.0;
    let rows = a.chunks(CELLS_AROUND).zip(b.chunks(CELLS_AROUND));
    let rows = rows.filter(|(a, b)| a.iter().zip(*b).any(|cells| is_shared(&cells))).count();
    let both = a.iter().zip(b).filter(is_shared);
    let cells = both.clone().count();
    let least = ROWS_MIN_SHARE * (a.len() / CELLS_AROUND) as f64;
    if cells < CELLS_MIN || (rows as f64) < least {
        return None;
    }
    let one = |(a, b): (&Cell, &Cell)| {
        let points = a.points + b.points;
        let (front, left) = (a.front + b.front, a.left + b.left);
        let length = front.hypot(left).max(f64::MIN_POSITIVE);
        let (front, left) = (front / length, left / length);
        let height_mm = (a.height_mm + b.height_mm) / points;
        let up = (2.0 * height_mm - low - high) / (high - low);
        Shared {
            normal: Vector4::new(front, left, up * front, up * left),
            apart_mm: a.outside_mm / a.points - b.outside_mm / b.points,
            weight: a.points * b.points / points,
        }
    };
    Some(both.map(one).collect())
}

/// The shift of one shell against another, to the front and to the left in the middle of the legs, and what it gains
/// towards their upper end, mm, with its covariance.
fn shift(shared: &[Shared]) -> Option<(Vector4<f64>, Matrix4<f64>)> {
    let mut weights: Vec<f64> = shared.iter().map(|cell| cell.weight).collect();
    let mut found = None;
    for _ in 0..ROUNDS {
        let (mut square, mut right) = (Matrix4::identity() * RIDGE, Vector4::zeros());
        for (cell, weight) in shared.iter().zip(&weights) {
            square += cell.normal * cell.normal.transpose() * *weight;
            right += cell.normal * (cell.apart_mm * weight);
        }
        let inverse = square.try_inverse()?;
        let shift = inverse * right;
        let off: Vec<f64> = shared
            .iter()
            .map(|cell| (cell.apart_mm - cell.normal.dot(&shift)) * cell.weight.sqrt())
            .collect();
        let scatter_mm = scatter(&off);
        for ((weight, cell), off) in weights.iter_mut().zip(shared).zip(&off) {
            let far = (off / (BIWEIGHT * scatter_mm)).powi(2);
            *weight = cell.weight * (1.0 - far).max(0.0).powi(2);
        }
        found = Some((shift, inverse * (DEPENDENCE * scatter_mm * scatter_mm)));
    }
    found
}

/// The standard deviation of normally distributed values, from the median of their sizes.
fn scatter(values: &[f64]) -> f64 {
    const NORMAL: f64 = 1.4826;
    let sizes = values.iter().map(|value| value.abs()).collect();
    NORMAL * median(sizes).unwrap_or_default() + SCATTER_MIN_MM
}

/// What of a shift is certain, at the height where it is most, mm.
fn certain_mm(shift: &Vector4<f64>, covariance: &Matrix4<f64>) -> f64 {
    let at = |up: f64| {
        let here = Matrix2x4::new(1.0, 0.0, up, 0.0, 0.0, 1.0, 0.0, up);
        let spread = (here * covariance * here.transpose()).symmetric_eigen();
        let parts = spread.eigenvectors.transpose() * (here * shift);
        let parts = parts.iter().map(|part| part * part).zip(spread.eigenvalues.iter());
        let certain = parts.filter(|(square, variance)| *square > CERTAIN_SDS.powi(2) * *variance);
        certain.map(|(square, _)| square).sum::<f64>().sqrt()
    };
    [-1.0, 0.0, 1.0].map(at).into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]

    use super::*;

    const STATURE_MM: f64 = 1600.0;

    /// Two shells of a leg, a front and a back that overlap by 20°, the front one moved to the front and to the left;
    /// in it what is higher is moved by more. Points are 4 mm apart with ±0.5 mm of noise.
    fn shifted(by_mm: [f64; 2], turn: f64) -> f64 {
        let (mut placed, mut edges) = (Vec::new(), Vec::new());
        for (shell, middle) in [(0.0, 0.0), (1.0, PI)] {
            let first = placed.len() as u32;
            for index in 0..150 * 44 {
                let (row, column) = (index / 44, index % 44);
                let height_mm = 100.0 + 4.0 * f64::from(row);
                let angle = middle + (f64::from(column) - 21.5) / 43.0 * 200.0_f64.to_radians();
                let moved = (1.0 - shell) * (1.0 + turn * (height_mm - 400.0));
                let noise_mm = f64::from((index * 7919 + first as i32) % 101) / 100.0 - 0.5;
                placed.push(Some(Placed {
                    height_mm,
                    place: nalgebra::Vector2::zeros(),
                    angle,
                    direction: angle,
                    outside_mm: moved * (by_mm[0] * angle.cos() + by_mm[1] * angle.sin())
                        + noise_mm,
                }));
                if index > 0 {
                    edges.push([first + index as u32 - 1, first + index as u32]);
                }
            }
        }
        apart_mm(&placed, &edges, STATURE_MM).unwrap()
    }

    #[test]
    fn shells_that_meet_are_not_apart() {
        assert!(shifted([0.0, 0.0], 0.0) < 0.4);
    }

    #[test]
    fn a_shift_along_the_skin_of_the_seams_is_seen_like_one_across() {
        for by_mm in [[3.0, 0.0], [0.0, 3.0], [2.0, -2.0]] {
            let apart_mm = shifted(by_mm, 0.0);
            let true_mm = by_mm[0].hypot(by_mm[1]);
            assert!((apart_mm - true_mm).abs() < 0.7, "{by_mm:?}: {apart_mm}");
        }
    }

    #[test]
    fn a_turn_counts_where_it_moves_most() {
        let apart_mm = shifted([0.0, 2.0], 1.0 / 400.0);
        assert!(apart_mm > 3.0, "{apart_mm}");
    }

    #[test]
    fn one_shell_is_not_apart_from_itself() {
        let point = Placed {
            height_mm: 300.0,
            place: nalgebra::Vector2::zeros(),
            angle: 0.0,
            direction: 0.0,
            outside_mm: 0.0,
        };
        let edges: Vec<[u32; 2]> = (1..500).map(|index| [index - 1, index]).collect();
        assert_eq!(apart_mm(&[Some(point); 500], &edges, STATURE_MM), None);
    }
}
