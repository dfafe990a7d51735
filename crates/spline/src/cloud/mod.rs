//! The surface through a cloud of points.
//!
//! | file | what it holds |
//! |---|---|
//! | `fit` | [`fit_cloud`]: robust, smoothing, in given bases |
//! | `adaptive` | [`fit_cloud_by`]: the same, with knots from a first fit |
//! | `middle` | [`Middle`]: the middle line of a cloud, and so its points' positions around |
//! | `cells`, `equations`, `banded` | sums over the points by cell; their equations and solution |
//! | `penalty`, `weights` | the choice of smoothing; the weights of outliers |

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
