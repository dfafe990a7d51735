//! The surface through a grid of points.
//!
//! | file | what it holds |
//! |---|---|
//! | `given` | [`fit_grid`]: least squares in given bases |
//! | `fit` | [`fit_grid_by`]: the same, with automatic knots |
//! | `chord` | [`mean_chord_parameters`] for points that have none |
//! | `bridge` | its gaps |
//! | `distinct` | checks that rows and columns differ |

mod bridge;
mod chord;
mod distinct;
mod fit;
mod given;

pub use chord::mean_chord_parameters;
pub use fit::{GridMethod, fit_grid_by};
pub use given::{GridData, SurfaceFit, fit_grid};
