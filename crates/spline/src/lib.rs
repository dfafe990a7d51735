//! Data → [`Spline`], [`Tensor`], [`Surface`].
//!
#![doc = include_str!("../README.md")]
//!
//! | file | what it holds |
//! |---|---|
//! | [`basis`] | [`Basis`]: knots, values and derivatives of the basis functions |
//! | [`solve`] | Cholesky factors of the matrices of such bases |
//! | `integrals` | roughness matrices, the integrals of squared derivatives; quadrature |
//! | [`mod@fit`] | [`Spline`]: smoothing fit of a scalar function, with standard errors |
//! | `least_squares` | the same for many right-hand sides at fixed positions |
//! | `normal` | the normal equations behind it and the choice of lambda by GCV |
//! | `robust` | [`robust_fit`]: the same with outliers down-weighted |
//! | [`tensor`] | [`Tensor`]: a function of two variables, fitted to scattered data |
//! | [`surface`] | [`Surface`]: clamped along, periodic around |
//! | [`foot`] | the nearest point of a surface, downhill from an initial guess |
//! | [`measure`] | area, volume, girths |
//! | [`tessellate`] | [`Facets`]: triangles that approximate a surface within a tolerance |
//! | [`grid`] | the surface through a grid of points |
//! | [`knots`] | the placement of its knots |
//!
//! All splines have degree 3. Nothing in this crate depends on the unit of the abscissa.

#![warn(missing_docs)]

pub mod basis;
pub mod fit;
pub mod foot;
pub mod grid;
mod integrals;
pub mod knots;
mod least_squares;
pub mod measure;
mod normal;
mod robust;
pub mod solve;
pub mod surface;
pub mod tensor;
pub mod tessellate;

pub use basis::{Basis, BasisFault, DEGREE, Row};
pub use fit::{FitFault, Smoothing, Spline, fit, r2};
pub use foot::Foot;
pub use grid::{GridData, GridMethod, SurfaceFit, fit_grid, fit_grid_by};
pub use knots::{GridDomain, Knots, KnotsUsed, undetermined};
pub use robust::{Robust, robust_fit};
pub use surface::{Derivatives, Surface, SurfaceFault};
pub use tensor::{Scatter, Tensor, TensorFit, fit_scatter};
pub use tessellate::{Corner, Ends, Facets, TessellationFault, facets};
