//! Decoders: the same body in every format, and what each makes of files by hand.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod cases;
mod dialects;
mod fingerprint;
mod formats;
mod loose_points;
