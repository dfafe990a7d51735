//! The station: effects around the decisions of [`gaiter_flow`].
//!
//! ```text
//! export folder ─ look ─▶ settle ─ ingest ─▶ custody (spool, journal) ─ work ─▶ store
//!       ▲                   │                    │
//!     watch (hint)      awaited, again       held, quarantine
//! ```
//!
//! | folder | what it does |
//! |---|---|
//! | [`intake`] | looks at export folders, waits until files are complete, takes them in |
//! | [`custody`], [`journal`] | keeps bytes, decisions and the state of each scan |
//! | [`delivery`] | measures scans in processes of their own and puts records into stores |
//! | [`booth`] | button, readers, orders, worklist, captures, light |
//! | [`operator`] | command socket, page, metrics, operators' decisions |
//! | [`persons`] | what the station has of a person: disclosed, erased |
//! | [`demo`] | the simulated scanner and button |
//!
//! These hold whatever happens. The export folder is only read. A scan is identified by its hash, so
//! nothing is delivered twice. Its bytes are in the spool before the journal knows them and until the
//! store has given its receipt. Every look and every attempt is repeated until it succeeds or the scan
//! itself is refused, and no scan waits for another. An event of the watch changes no decision; it only
//! makes the next look come sooner.
//!
//! Logs refer to scans by the first digits of their id, never to patients, file names or folders.

pub mod assembly;
pub mod board;
pub mod booth;
pub mod core;
pub mod custody;
pub mod delivery;
pub mod demo;
pub mod error;
pub mod event;
mod fleet;
mod housekeeping;
pub mod intake;
pub mod journal;
pub mod measure;
pub mod operator;
mod overview;
pub mod persons;
mod rebuild;
pub mod run;
pub(crate) mod runtime;
mod service;
pub(crate) mod share;
mod state_dir;
pub(crate) mod stores;
mod workers;

pub use error::{StationError, Worker};
pub use event::StationEvent;
pub use run::{Orders, Reload, run};
