//! Reports for people: their content as blocks, a page and a PDF.

pub mod age;
mod blocks;
pub mod content;
pub mod document;
mod figure;
mod head;
mod held;
mod html;
mod pdf;
mod words;

pub use age::AgeMax;
pub use content::ReportContent;
pub use document::{Document, Paper, Print};
pub use figure::{Reliability, ReportFigure};
pub use head::Head;
pub use html::{VIEWER, page, viewer};
pub use pdf::{PdfFault, paper};
pub use words::grouped;
pub(crate) use words::title;
