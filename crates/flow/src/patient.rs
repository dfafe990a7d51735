//! To whom a scan belongs: ids and their rules, what file names state, how folders are named, what is known
//! about a patient's records and about a person, and how all of that is erased.

pub mod check_digit;
pub mod erasure;
pub mod identity;
pub mod name_check;
pub mod naming;
pub mod person;
