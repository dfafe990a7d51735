//! Whether the journal can be relied upon: seals, checks, and the rebuilding of one that is lost.

pub(in crate::station::journal) mod check;
pub(in crate::station) mod rebuild;
pub(in crate::station::journal) mod seal;
pub(in crate::station) mod suspicion;
