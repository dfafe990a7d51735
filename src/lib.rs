//! gaiter: measures both legs from a whole-body scan, unattended.
//!
//! Data goes one way, top to bottom; a layer uses only layers above it.
//!
//! | layer | kind | what it knows |
//! |---|---|---|
//! | [`scan`] | pure | bytes → [`scan::Scan`]: one decoder per format |
//! | [`spline`] | pure | bases, fits, solvers, curves and surfaces; knows no legs |
//! | [`leg`] | pure | scan → leg reports: the paper, a stage per file |
//! | [`cad`] | pure | surface → CAD files and meshes, as bytes |
//! | [`record`] | pure | reports → record: JSON, CSV, pictures, the report people read, as bytes |
//! | [`flow`] | pure | the station's decisions as functions of state and `now` |
//! | [`store`] | effects | record stores; idempotent `put` |
//! | [`station`] | effects | watch, spool, journal, work, deliver |
//! | [`cli`] | effects | one file per verb |
//!
//! Pure means: no files, clock, environment, threads of its own, async, logging, unseeded
//! randomness or hash-map order. Bytes, numbers and `now` come in as arguments; findings come out
//! as data. `rayon` is allowed in `spline` and `leg` where results do not depend on order.
//! `clippy.toml` and `tests/house/layering.rs` hold these rules.
//!
//! What each layer may import besides `std` and the layers above it:
//!
//! | layer | crates |
//! |---|---|
//! | `scan` | nalgebra, thiserror, tobj (the OBJ reader) |
//! | `spline` | nalgebra, rayon, thiserror |
//! | `leg` | nalgebra, rayon, thiserror |
//! | `cad` | nalgebra, thiserror |
//! | `record` | base64, `encoding_rs` (code page 1252), flate2 (packing), jiff (calendar only), nalgebra, `pdf_writer`, serde, `serde_json`, sha2, subsetter (fonts), thiserror, `tiny_skia` (pixels) |
//! | `flow` | regex, serde, thiserror, jiff (calendar only) |

pub mod cad;
pub mod cli;
pub mod config;
pub mod flow;
pub mod leg;
pub mod record;
pub mod scan;
pub mod spline;
pub mod station;
pub mod store;
