//! `gaiter patient disclose` and `gaiter patient erase`: all that a station holds of one person.

mod disclose;
mod erase;
mod files;
mod overview;
mod preview;
mod reach;
mod watch;

pub use disclose::disclose;
pub use erase::erase;
