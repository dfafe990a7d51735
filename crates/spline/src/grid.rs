//! The surface through a grid of points.
//!
//! | file | what it holds |
//! |---|---|
//! | `given` | [`fit_grid`]: least squares in given bases |
//! | `fit` | [`fit_grid_by`]: the same, with automatic knots |
//! | `bridge` | its gaps |
//! | `distinct` | checks that rows and columns differ |

mod bridge;
mod distinct;
mod fit;
mod given;

pub use fit::{GridMethod, fit_grid_by};
pub use given::{GridData, SurfaceFit, fit_grid};
