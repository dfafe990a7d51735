//! GDT 2.1, the text files by which German practice software and devices talk: orders (6302) in,
//! results (6310) out.
//!
//! A message is lines of `LLL FFFF content CR LF` without the blanks: the line's length in bytes,
//! these three digits and the line's end included; the field; its content. The first line says what
//! kind of message it is, the second how long the whole is.

pub mod charset;
pub mod line;
pub mod order;
pub mod result;
pub mod rules;
mod words;

pub use charset::Charset;
pub use line::{WriteFault, message};
pub use order::{Order, OrderFault};
pub use result::{Attachment, ResultFault, result};
pub use rules::{AttachmentFields, GdtRules, Product, Reference};
