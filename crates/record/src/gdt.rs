//! GDT 2.1, the text files that German practice software and devices exchange: orders (6302) in,
//! results (6310) out.
//!
//! A message consists of lines of `LLL FFFF content CR LF` without the blanks: the line's length in
//! bytes, including these three digits and the line end; the field; its content. The first line holds
//! the kind of message, the second the length of the whole message.

pub mod charset;
pub mod line;
pub mod order;
pub mod result;
pub mod rules;
mod table;
mod words;

pub use charset::Charset;
pub use line::{WriteFault, message};
pub use order::{Order, OrderFault};
pub use result::{Attachment, ResultFault, result};
pub use rules::{AttachmentFields, GdtRules, Product, Reference};
