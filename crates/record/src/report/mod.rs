//! The report of a record for people: its content as data, and the pages it is printed on.

pub mod age;
pub mod content;
pub mod document;
mod figure;
mod head;
mod held;
mod html;
mod pdf;
mod print;
mod viewer;
mod words;

pub use age::AgeMax;
pub use content::Content;
pub use document::Document;
pub use figure::{Figure, Mark};
pub use head::Head;
pub use html::{document_page, page};
pub use pdf::{PdfFault, document_paper, paper};
pub use print::{Paper, Print};
pub use viewer::{VIEWER, viewer};
