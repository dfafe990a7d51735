//! Integrals over the intervals of a basis: Gauss-Legendre quadrature, and roughness matrices, the integrals of
//! products of the basis functions' derivatives.

use super::basis::Basis;
use super::solve::Skyline;

/// Nodes and weights on [−1, 1], exact up to degree 9. Source: Abramowitz, Stegun, table 25.4.
const NODES: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// The nodes of each interval between ascending breakpoints, with their weights.
pub fn composite(breakpoints: &[f64]) -> Vec<(f64, f64)> {
    let nodes = |pair: &[f64]| {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        NODES.map(|(node, weight)| (middle + half * node, half * weight))
    };
    breakpoints.windows(2).flat_map(nodes).collect()
}

/// The Gram matrix of the functions' derivatives of `order` 2 or 3 over the domain: for
/// coefficients c the integral of the squared derivative is cᵀ R c.
///
/// Two Gauss-Legendre nodes per interval are exact, because the integrand is at most quadratic.
pub fn roughness(basis: &Basis, order: usize) -> Skyline {
    let mut matrix = Skyline::zero(basis);
    for pair in basis.breakpoints().windows(2) {
        let half = 0.5 * (pair[1] - pair[0]);
        let middle = 0.5 * (pair[0] + pair[1]);
        let offset = half / 3.0_f64.sqrt();
        for node in [middle - offset, middle + offset] {
            matrix.add_square(&basis.rows(node)[order], half);
        }
    }
    matrix
}

/// The Gram matrix of the functions themselves over the domain: for coefficients c the integral of
/// the squared spline is cᵀ M c.
#[cfg(test)]
pub fn mass(basis: &Basis) -> Skyline {
    let mut matrix = Skyline::zero(basis);
    for (node, weight) in composite(basis.breakpoints()) {
        matrix.add_square(&basis.row(node), weight);
    }
    matrix
}
