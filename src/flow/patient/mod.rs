//! To whom a scan belongs: ids and their rules, what file names say, how folders are named.

pub mod check_digit;
pub mod identity;
pub mod name_check;
pub mod naming;
