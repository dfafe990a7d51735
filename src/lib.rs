//! The program gaiter: a station beside a body scanner, which measures both legs of every scan unattended.
//!
//! This package has what needs files, a clock, ports and the network: [`config`] (`station.toml`),
//! [`store`] (where records go), [`station`] (watch, spool, journal, work, deliver) and [`cli`] (the
//! verbs). What can be computed is in crates of its own, which a program of your own can use, too. Data
//! goes one way, top to bottom; a crate uses only crates above it.
//!
//! | crate | what it knows |
//! |---|---|
//! | [`gaiter_language`] | the texts that people read, one file per language |
//! | [`gaiter_scan`] | bytes → points and triangles, one decoder per format |
//! | `gaiter_spline` | bases, fits, solvers, curves and surfaces; no legs |
//! | [`gaiter_leg`] | scan → leg reports: the paper, a folder per step |
//! | [`gaiter_cad`] | surface → CAD files and meshes |
//! | [`gaiter_toml`] | what people write in TOML → values, or every fault with its place |
//! | [`gaiter_sizes`] | garments, size tables and their verdicts on a leg; no records |
//! | [`gaiter_record`] | reports → record: JSON, CSV, pictures, the report that people read |
//! | [`gaiter_visits`] | records of one patient → what changed between visits |
//! | [`gaiter_flow`] | the station's decisions as functions of state and `now` |
//! | `gaiter_confined` | effects: processes that read what nobody vouches for |
//! | [`gaiter_https`] | effects: the client of servers, certificates, secrets |
//!
//! All others are pure: no files, clock, environment, threads of their own, async, logging, unseeded
//! randomness or hash-map order. Bytes, numbers and `now` come in as arguments; findings come out as data.
//! `rayon` is allowed in `gaiter_leg` where results do not depend on order. Their `Cargo.toml` and
//! `crates/clippy.toml` hold these rules.

pub mod cli;
pub mod config;
pub mod station;
pub mod store;
