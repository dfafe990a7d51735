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
//! | [`curvature`], [`measure`] | Gauss and mean curvature; area, volume, girths |
//! | [`surface_fit`] | least-squares surface through a grid of points, in given bases |
//! | [`grid_fit`] | the same with knots, smoothing and outliers found by itself |
//! | `chord` | parameters of points that have none |
//! | `knots`, `polish`, `marks` | where knots lie: where data bend, where the residual is least, where the caller wants them |
//! | `knot_choice` | which of these are used, and what instead |
//! | `schoenberg_whitney` | whether data determine a basis |
//! | `bridge`, `outliers`, `cross_validation` | gaps, outliers and noise of a grid |
//! | `profiles`, `least_squares`, `marquardt` | a grid as data of one direction; its linear and nonlinear equations |
//! | [`middle`] | [`Middle`]: the middle line of a cloud, and so the points' places around |
//! | [`cloud_fit`] | robust smoothing surface through scattered points |
//! | `cells`, `cloud_equations`, `banded` | its equations: points summed cell by cell, and their solution |
//! | `cloud_penalty`, `cloud_weights` | its choice of smoothing; what outliers count for |
//! | `cloud_adaptive` | [`fit_cloud_by`]: the same with knots found in a first fit |
//!
//! Everything is of degree 3. Bases are clamped (functions on an interval) or periodic (closed
//! curves, C2 at the seam by construction). Nothing here depends on the unit of the abscissa.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

mod banded;
pub mod basis;
mod bridge;
mod cells;
mod chord;
mod cloud_adaptive;
mod cloud_equations;
pub mod cloud_fit;
mod cloud_penalty;
mod cloud_weights;
mod cross_validation;
pub mod curvature;
mod distinct;
pub mod fit;
pub mod foot;
mod gauss;
pub mod grid_fit;
mod knot_choice;
mod knots;
mod kronecker;
mod least_squares;
mod marks;
mod marquardt;
pub mod measure;
pub mod middle;
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
pub use cloud_adaptive::{CloudKnots, fit_cloud_by};
pub use cloud_fit::{CloudData, CloudFit, CloudMethod, CloudSmoothing, fit_cloud};
pub use curvature::Curvatures;
pub use fit::{FitFault, Smoothing, Spline, fit};
pub use foot::Foot;
pub use grid_fit::{GridDomain, GridMethod, GridSmoothing, fit_grid_by};
pub use knot_choice::{Knots, KnotsUsed};
pub use middle::Middle;
pub use robust::{Robust, robust_fit};
pub use schoenberg_whitney::{Undetermined, determines};
pub use surface::{Derivatives, Surface, SurfaceFault};
pub use surface_fit::{GridData, SurfaceFit, fit_grid};
pub use tensor::Tensor;
pub use tensor_fit::{Scatter, TensorFit, fit_scatter};
