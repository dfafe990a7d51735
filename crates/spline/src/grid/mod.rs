//! The surface through a grid of points.
//!
//! | file | what it holds |
//! |---|---|
//! | `given` | [`fit_grid`]: least squares in given bases |
//! | `fit` | [`fit_grid_by`]: the same, with automatic knots, smoothing and outlier detection |
//! | `chord` | [`mean_chord_parameters`] for points that have none |
//! | `bridge`, `outliers`, `cross_validation` | its gaps, its outliers, its noise |
//! | `distinct` | checks that rows and columns differ |

mod bridge;
mod chord;
mod cross_validation;
mod distinct;
mod fit;
mod given;
mod outliers;

pub use chord::mean_chord_parameters;
pub use fit::{GridMethod, GridSmoothing, fit_grid_by};
pub use given::{GridData, SurfaceFit, fit_grid};
