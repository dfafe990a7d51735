//! The surface through a grid of points.
//!
//! | file | what it holds |
//! |---|---|
//! | `given` | [`fit_grid`]: least squares in given bases |
//! | `fit` | [`fit_grid_by`]: the same with knots, smoothing and outliers found by itself |
//! | `chord` | [`mean_chord_parameters`] of points that have none |
//! | `bridge`, `outliers`, `cross_validation` | its gaps, its outliers, its noise |
//! | `distinct`, `least_squares` | whether rows and columns differ; the equations of one direction |

mod bridge;
mod chord;
mod cross_validation;
mod distinct;
pub(super) mod fit;
pub(super) mod given;
pub(super) mod least_squares;
mod outliers;

pub use chord::mean_chord_parameters;
pub use fit::{GridDomain, GridMethod, GridSmoothing, fit_grid_by};
pub use given::{GridData, SurfaceFit, fit_grid};
