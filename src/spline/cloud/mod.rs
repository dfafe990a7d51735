//! The surface through a cloud of points.
//!
//! | file | what it holds |
//! |---|---|
//! | `fit` | [`fit_cloud`]: robust, smoothing, in given bases |
//! | `adaptive` | [`fit_cloud_by`]: the same with knots found in a first fit |
//! | `middle` | [`Middle`]: the middle line of a cloud, and so its points' places around |
//! | `cells`, `equations`, `banded` | the points summed cell by cell; their equations and solution |
//! | `penalty`, `weights` | the choice of smoothing; what outliers count for |

mod adaptive;
mod banded;
mod cells;
mod equations;
mod fit;
mod middle;
mod penalty;
mod weights;

pub use adaptive::{CloudKnots, fit_cloud_by};
pub use fit::{CloudData, CloudFit, CloudMethod, CloudSmoothing, fit_cloud};
pub use middle::Middle;
