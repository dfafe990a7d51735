//! The report that people read of a record: what it says, as data, and the page it is printed on.

pub mod content;
mod figure;
mod html;
mod pdf;
mod viewer;
mod words;

pub use content::Content;
pub use figure::{Figure, Mark};
pub use html::page;
pub use pdf::{PdfFault, paper};
pub use viewer::VIEWER;
