//! Where the knots of a surface lie.
//!
//! | file | what it holds |
//! |---|---|
//! | `adaptive` | where the data bend |
//! | `polish`, `marquardt` | where the residual is least, by variable projection |
//! | `marks` | where the caller wants them |
//! | `schoenberg_whitney` | [`determines`]: whether data determine a basis |
//! | `choice` | [`KnotsUsed`]: which of these are used, and what instead |
//! | `request` | [`Knots`], [`GridDomain`]: what is asked of either direction |
//! | `profiles` | the data of one direction |

pub(super) mod adaptive;
pub(super) mod choice;
mod marks;
mod marquardt;
mod polish;
pub(super) mod profiles;
pub(super) mod request;
mod schoenberg_whitney;

pub use choice::KnotsUsed;
pub use request::{GridDomain, Knots};
pub use schoenberg_whitney::{Undetermined, determines};
