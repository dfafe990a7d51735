//! The report of a record for people: its content as data, and the pages it is printed on.

pub mod content;
mod figure;
mod html;
mod pdf;
mod print;
mod viewer;
mod words;

pub use content::Content;
pub use figure::{Figure, Mark};
pub use html::page;
pub use pdf::{PdfFault, paper};
pub use print::{Paper, Print};
pub use viewer::{VIEWER, viewer};
