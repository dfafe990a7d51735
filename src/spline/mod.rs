//! Cubic B-splines: bases, solvers, fits and surfaces. Knows no legs.
//!
//! | file | what it holds |
//! |---|---|
//! | [`basis`] | [`Basis`]: knots, values and derivatives of the basis functions |
//! | [`solve`] | Cholesky factors of the matrices that such bases give |
//! | `penalty` | roughness matrices, the integrals of squared derivatives |
//! | [`mod@fit`] | [`Spline`]: smoothing fit of a scalar function, with standard errors |
//! | `normal` | the normal equations behind it and the choice of lambda by GCV |
//! | [`robust_fit`] | the same with outliers weighed down |
//! | [`surface`] | [`Surface`]: clamped along, periodic around |
//! | [`foot`] | the nearest point of a surface |
//! | [`surface_fit`] | least-squares surface through a grid of points, in given bases |
//! | [`grid_fit`] | the same with knots, smoothing and outliers found by itself |
//! | `chord` | parameters of points that have none |
//! | `knots`, `polish`, `marks` | where knots lie: where data bend, where the residual is least, where the caller wants them |
//! | `knot_choice` | which of these are used, and what instead |
//! | `schoenberg_whitney` | whether data determine a basis |
//! | `bridge`, `outliers`, `cross_validation` | gaps, outliers and noise of a grid |
//! | `profiles`, `least_squares`, `marquardt` | a grid as data of one direction; its linear and nonlinear equations |
//!
//! Everything is of degree 3. Bases are clamped (functions on an interval) or periodic (closed
//! curves, C2 at the seam by construction). Nothing here depends on the unit of the abscissa.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod basis;
mod bridge;
mod chord;
mod cross_validation;
mod distinct;
pub mod fit;
pub mod foot;
pub mod grid_fit;
mod knot_choice;
mod knots;
mod kronecker;
mod least_squares;
mod marks;
mod marquardt;
mod normal;
mod outliers;
mod penalty;
mod polish;
mod profiles;
mod robust;
mod schoenberg_whitney;
pub mod solve;
pub mod surface;
pub mod surface_fit;
mod tensor;
mod tensor_equations;
mod tensor_fit;

pub use basis::{Basis, BasisFault, DEGREE, Row};
pub use chord::mean_chord_parameters;
pub use fit::{FitFault, Smoothing, Spline, fit};
pub use foot::Foot;
pub use grid_fit::{GridDomain, GridMethod, GridSmoothing, fit_grid_by};
pub use knot_choice::{Knots, KnotsUsed};
pub use robust::{Robust, robust_fit};
pub use schoenberg_whitney::{Undetermined, determines};
pub use surface::{Derivatives, Surface, SurfaceFault};
pub use surface_fit::{GridData, SurfaceFit, fit_grid};
pub use tensor::Tensor;
pub use tensor_fit::{Scatter, TensorFit, fit_scatter};
