//! The command line as the real program: check, manual, reextract, terminal.

mod calibrate;
mod check;
mod config_faults;
mod manual;
mod reextract;
mod terminal;
