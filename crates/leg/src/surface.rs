//! The quasi-grid, whose columns follow ridges, and the NURBS surface through it (paper 2), with
//! its error, its holes and its shape for pictures.

pub(super) mod cylindrical;
pub mod error_map;
pub mod fit_error;
pub mod foot_skin;
pub mod hole;
pub mod nurbs;
pub mod ridge;
pub mod ridge_parametrization;
pub mod shape;
