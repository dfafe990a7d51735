//! Where the knots of a surface lie.
//!
//! | file | what it holds |
//! |---|---|
//! | `adaptive` | where the data bend |
//! | `polish`, `marquardt` | where the residual is least, by variable projection |
//! | `marks` | where the caller wants them |
//! | `schoenberg_whitney` | [`determines`]: whether data determine a basis |
//! | `choice` | [`KnotsUsed`]: which of these are used, and what instead |
//! | `wish` | [`Knots`], [`GridDomain`]: what is asked of either direction |
//! | `profiles` | the data of one direction |

pub(super) mod adaptive;
pub(super) mod choice;
mod marks;
mod marquardt;
mod polish;
pub(super) mod profiles;
mod schoenberg_whitney;
pub(super) mod wish;

pub use choice::KnotsUsed;
pub use schoenberg_whitney::{Undetermined, determines};
pub use wish::{GridDomain, Knots};
