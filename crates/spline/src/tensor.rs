//! A scalar function of two variables, fitted to scattered data.
//!
//! | file | what it holds |
//! |---|---|
//! | `function` | [`Tensor`] |
//! | `scatter` | [`Scatter`], the data |
//! | `fit` | [`fit_scatter`]: robust, smoothing by cross-validation |
//! | `equations` | the equations of the data, solved by conjugate gradients |
//! | `stencil` | their matrix, and its product with coefficients |
//! | `preconditioner` | what they would be if the data were spread evenly around |
//! | `circle` | the direction around, and the waves around |
//! | `neighbours` | what the residuals of neighbours share: ridges are no outliers |
//! | `kronecker` | smoothing on a full grid of cells |

mod circle;
mod equations;
mod fit;
mod function;
mod kronecker;
mod neighbours;
mod preconditioner;
mod scatter;
mod stencil;

pub use fit::{TensorFit, fit_scatter};
pub use function::Tensor;
pub use scatter::Scatter;
