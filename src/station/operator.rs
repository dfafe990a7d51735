//! What people and monitors ask of the station, and what operators decide: command line, page, metrics.

pub mod act;
pub mod control;
pub(in crate::station) mod http;
pub(in crate::station) mod metrics;
pub(in crate::station) mod page;
