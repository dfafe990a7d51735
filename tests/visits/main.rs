//! Visits of one patient: what a comparison finds, and what it does not invent.

mod stance;
