//! The command line as the real program: check, asking, manual, reextract, sizes, terminal.

mod amend;
mod asking;
mod calibrate;
mod check;
mod compare;
mod config_faults;
mod manual;
mod reextract;
mod report;
mod sizes;
mod terminal;
