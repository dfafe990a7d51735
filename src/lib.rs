//! gaiter: measures both legs from a whole-body scan, unattended.
//!
//! ```
//! use gaiter_leg::{Level, Method, extract};
//! use gaiter_scan::Format;
//!
//! # use std::io::Read;
//! # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/scans/m_average_clean.obj.gz");
//! # let mut bytes = Vec::new();
//! # flate2::read::GzDecoder::new(std::fs::File::open(path)?).read_to_end(&mut bytes)?;
//! // `bytes` are those of a scan in the scanner's OBJ format.
//! let extraction = extract(&bytes, Format::Obj, &Method::default())?;
//! for finding in &extraction.findings {
//!     eprintln!("{finding}");
//! }
//! for leg in &extraction.legs {
//!     let calf = leg.landmarks.iter().find(|landmark| landmark.level == Level::C);
//!     let girth_mm = calf.map(|calf| calf.girth_tape_mm);
//!     println!("{}: the calf's girth is {girth_mm:.0?} mm", leg.side.word());
//!     # assert!(girth_mm.is_some_and(|girth_mm| (300.0..450.0).contains(&girth_mm)));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With `default-features = false` gaiter is this library: language, scan, spline, leg, cad, sizes, record
//! and visits.
//! The feature `station` adds the program.
//!
//! Data goes one way, top to bottom; a layer uses only layers above it.
//!
//! | layer | kind | what it knows |
//! |---|---|---|
//! | [`language`] | pure | the texts for people in each language, by keys; one file per language |
//! | [`scan`] | pure | bytes → [`scan::Scan`]: one decoder per format |
//! | [`spline`] | pure | bases, fits, solvers, curves and surfaces; knows no legs |
//! | [`leg`] | pure | scan → leg reports: the paper, a stage per file |
//! | [`cad`] | pure | surface → CAD files and meshes, as bytes |
//! | [`sizes`] | pure | garments and size tables, and what a table says about a leg; knows no records |
//! | [`record`] | pure | reports → record: JSON, CSV, pictures, the report people read, as bytes |
//! | [`visits`] | pure | records of one patient → what changed between visits |
//! | [`flow`] | pure | the station's decisions as functions of state and `now` |
//! | [`store`] | effects | record stores; idempotent `put` |
//! | [`station`] | effects | watch, spool, journal, work, deliver |
//! | [`cli`] | effects | one file per verb |
//!
//! Pure means: no files, clock, environment, threads of its own, async, logging, unseeded
//! randomness or hash-map order. Bytes, numbers and `now` come in as arguments; findings come out
//! as data. `rayon` is allowed in `scan`, `spline` and `leg` where results do not depend on order.
//! `clippy.toml` and `tests/house/layering.rs` hold these rules.
//!
//! What each layer may import besides `std` and the layers above it:
//!
//! | layer | crates |
//! |---|---|
//! | `language` | toml (the files of texts) |
//! | `scan` | nalgebra, rayon, thiserror, tobj (the OBJ reader) |
//! | `spline` | nalgebra, rayon, thiserror |
//! | `leg` | nalgebra, rayon, thiserror |
//! | `cad` | nalgebra, thiserror, zmij (numbers as text) |
//! | `sizes` | jiff (calendar only), libm (the error function), serde, sha2, thiserror, toml (the files) |
//! | `record` | base64, `encoding_rs` (code page 1252), flate2 (packing), jiff (calendar only), nalgebra, `pdf_writer`, serde, `serde_json`, sha2, subsetter (fonts), thiserror, `tiny_skia` (pixels) |
//! | `visits` | jiff (calendar only), nalgebra, serde, thiserror |
//! | `flow` | regex, serde, thiserror, jiff (calendar only) |

pub mod cli;
pub mod config;
pub mod station;
pub mod store;
