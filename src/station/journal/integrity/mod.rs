//! Seals and checks that show whether the journal is intact.

pub(in crate::station::journal) mod check;
pub(in crate::station::journal) mod seal;
pub(in crate::station) mod suspicion;
