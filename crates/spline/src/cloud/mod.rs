//! The surface through a cloud of points.
//!
//! | file | what it holds |
//! |---|---|
//! | `fit` | [`fit_cloud`]: robust, smoothing, in given bases |
//! | `cells`, `equations`, `banded` | sums over the points by cell; their equations and solution |
//! | `penalty`, `weights` | the choice of smoothing; the weights of outliers |

mod banded;
mod cells;
mod equations;
mod fit;
mod penalty;
mod weights;

pub use fit::{CloudData, CloudFit, CloudMethod, CloudSmoothing, fit_cloud};
