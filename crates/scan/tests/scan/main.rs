//! Decoders: the same body in every format, and what each makes of files by hand.

mod cases;
mod formats;
