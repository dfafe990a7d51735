//! The placement of a surface's knots.
//!
//! | file | what it holds |
//! |---|---|
//! | `adaptive` | placement where the data bend |
//! | `marks` | placement at positions requested by the caller |
//! | `schoenberg_whitney` | [`undetermined`]: the functions of a basis that data do not determine |
//! | `choice` | [`KnotsUsed`]: which placement is used, and the fallback |
//! | `request` | [`Knots`], [`GridDomain`]: the request for each direction |
//! | `profiles` | the data of one direction |

mod adaptive;
pub(super) mod choice;
mod marks;
pub(super) mod profiles;
pub(super) mod request;
mod schoenberg_whitney;

pub use choice::KnotsUsed;
pub use request::{GridDomain, Knots};
pub use schoenberg_whitney::undetermined;
