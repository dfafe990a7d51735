//! The reader of the configuration, with faults of its own.

pub(super) use gaiter_toml::{Absent, Found};

/// Reads the keys of `station.toml`.
pub(super) type Reader<'t> = gaiter_toml::Reader<'t, super::fault::What>;
