//! The station: effects around the decisions of [`crate::flow`].
//!
//! ```text
//! export folder ─ look ─▶ settle ─ take ─▶ custody (spool, journal) ─ work ─▶ store
//!       ▲                   │                  │
//!     watch (hint)      awaited, again     held, quarantine
//! ```
//!
//! What holds, whatever happens: the export folder is only read; a scan is known by its hash, so
//! nothing is delivered twice; its bytes are in the spool before the journal knows them and until
//! the store has given its receipt; every look and every attempt is repeated until it succeeds or
//! the scan itself is refused, and no scan waits for another. An event of the watch changes no
//! decision, it only makes the next look come sooner.
//!
//! Logs speak of scans by the first digits of their id, never of patients, file names or folders.

pub mod act;
pub mod assembly;
pub mod board;
pub mod booth;
pub mod control;
pub mod custody;
pub mod decisions;
pub mod error;
pub mod event;
mod export_locks;
pub mod file_system;
mod folders;
pub mod journal;
mod lasting;
pub mod measure;
mod measuring;
pub mod overview;
pub mod preview;
pub mod quarantine;
pub mod run;
pub mod simulated_button;
pub mod simulated_scanner;
pub mod spool;
pub mod trigger;

mod beat;
pub(crate) mod caught;
mod chance;
mod delivery;
mod gate;
mod housekeeping;
mod http;
mod intake;
pub(crate) mod look;
mod metrics;
mod orders;
mod page;
pub(crate) mod patience;
mod rebuild;
mod service;
mod source;
mod stop;
mod suspicion;
mod take;
mod timekeeper;
mod watch;
mod work;
mod workers;

pub use error::{StationError, Worker};
pub use event::StationEvent;
pub use run::{Orders, Reload, run};
