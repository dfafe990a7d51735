//! Roughness matrices: integrals of products of the basis functions' derivatives.

use super::basis::Basis;
use super::solve::Skyline;

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
    for (node, weight) in super::gauss::composite(basis.breakpoints()) {
        matrix.add_square(&basis.row(node), weight);
    }
    matrix
}
