//! The station: effects around the decisions of [`crate::flow`].
//!
//! ```text
//! export folder ─ look ─▶ settle ─ ingest ─▶ custody (spool, journal) ─ work ─▶ store
//!       ▲                   │                    │
//!     watch (hint)      awaited, again       held, quarantine
//! ```
//!
//! | folder | what it does |
//! |---|---|
//! | [`intake`] | looks at export folders, waits until files are whole, takes them in |
//! | [`custody`], [`journal`] | keeps bytes, decisions and the state of each scan |
//! | [`delivery`] | measures scans in processes of their own and puts records into stores |
//! | [`booth`] | button, readers, orders, captures, light |
//! | [`operator`] | command socket, page, metrics, what people decide |
//! | [`demo`] | the simulated scanner and button |
//!
//! What holds, whatever happens: the export folder is only read; a scan is known by its hash, so
//! nothing is delivered twice; its bytes are in the spool before the journal knows them and until
//! the store has given its receipt; every look and every attempt is repeated until it succeeds or
//! the scan itself is refused, and no scan waits for another. An event of the watch changes no
//! decision, it only makes the next look come sooner.
//!
//! Logs speak of scans by the first digits of their id, never of patients, file names or folders.

pub mod assembly;
mod beat;
pub mod board;
pub mod booth;
pub(crate) mod caught;
pub mod custody;
pub mod delivery;
pub mod demo;
pub mod error;
pub mod event;
pub mod intake;
mod jitter;
pub mod journal;
mod lasting;
pub mod operator;
pub mod run;
mod service;
pub(crate) mod stall;
mod stop;
mod workers;

pub use error::{StationError, Worker};
pub use event::StationEvent;
pub use run::{Orders, Reload, run};
