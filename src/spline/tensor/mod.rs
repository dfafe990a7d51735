//! A scalar function of two variables, fitted to scattered data.
//!
//! | file | what it holds |
//! |---|---|
//! | `function` | [`Tensor`] |
//! | `scatter` | [`Scatter`], the data |
//! | `fit` | [`fit_scatter`]: robust, smoothing by cross-validation |
//! | `equations` | the equations of the data, solved by conjugate gradients |
//! | `neighbours` | what the residuals of neighbours share: ridges are no outliers |
//! | `kronecker` | smoothing on a full grid of cells |

mod equations;
mod fit;
mod function;
mod kronecker;
mod neighbours;
mod scatter;

pub use fit::{TensorFit, fit_scatter};
pub use function::Tensor;
pub use scatter::Scatter;
