//! A scalar function of two variables, fitted to scattered data.
//!
//! | file | what it holds |
//! |---|---|
//! | `function` | [`Tensor`] |
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
mod stencil;

pub use fit::{TensorFit, fit_scatter};
pub use function::Tensor;

/// Scattered data of a function of two variables; all slices have the same length.
#[derive(Debug, Clone, Copy)]
pub struct Scatter<'a> {
    /// Positions along, within the clamped basis.
    pub u: &'a [f64],
    /// Positions around, wrapped.
    pub v: &'a [f64],
    /// Values.
    pub value: &'a [f64],
}

/// The interval of ascending breakpoints that contains `x`, or the nearest one.
fn place(breakpoints: &[f64], x: f64) -> usize {
    let last = breakpoints.len() - 2;
    breakpoints.partition_point(|breakpoint| *breakpoint <= x).saturating_sub(1).min(last)
}
