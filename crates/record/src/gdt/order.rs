//! An order for an examination (6302), which names the patient of the next scan. Names and birth dates
//! are skipped and not kept.

use std::fmt::Display;

use gaiter_language::Language;

use super::charset::{Charset, Unreadable};
use super::line::{self, KIND, Line, LineFault, TOTAL};

/// The byte order marks of UTF-16.
const UTF_16: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];

/// The kind of message for an order of an examination.
const ORDER: &[u8] = b"6302";

/// The patient's id.
const PATIENT: u16 = 3000;

/// The largest order, bytes. Real ones have a few hundred.
pub const ORDER_MOST: u64 = 12 * 1024;

/// The content of an order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    /// The patient's id in the practice software (3000).
    pub patient: String,
    /// The order's own number (8310), if it has one.
    pub request: Option<String>,
    /// The requested procedure (8402), if given.
    pub procedure: Option<String>,
    /// The receiver (8315).
    pub receiver: Option<String>,
    /// The sender (8316).
    pub sender: Option<String>,
}

/// Why bytes are not an order. No text quotes their content except digits of GDT itself.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.in_words(Language::En))]
pub enum OrderFault {
    /// It is too large for an order.
    TooLarge {
        /// Its size, bytes.
        bytes: u64,
    },
    /// It is written in UTF-16.
    Utf16,
    /// Its lines are wrong.
    Lines(LineFault),
    /// It does not begin like a GDT message.
    NotGdt,
    /// It is another kind of message.
    OtherKind {
        /// The kind, four digits.
        found: String,
    },
    /// The length of the whole message is missing.
    NoTotal,
    /// The length of the whole message is wrong.
    Total {
        /// Length according to the message, bytes.
        said: u64,
        /// Actual length, bytes.
        found: u64,
    },
    /// The character set is unknown to gaiter.
    Charset,
    /// A required field cannot be decoded.
    Text {
        /// Number of the line.
        line: usize,
        /// The byte that cannot be decoded.
        why: Unreadable,
    },
    /// The patient's line is the last one and has no line end.
    PatientCut,
    /// No patient is named.
    NoPatient,
    /// Two patients are named.
    TwoPatients {
        /// Line that names one of them.
        first: usize,
        /// Line that names the other.
        second: usize,
    },
}

impl OrderFault {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            OrderFault::TooLarge { .. } => "order-too-large",
            OrderFault::Lines(LineFault::Empty) => "order-empty",
            OrderFault::Lines(_) => "order-line-malformed",
            OrderFault::NotGdt => "order-not-gdt",
            OrderFault::OtherKind { .. } => "order-other-kind",
            OrderFault::NoTotal | OrderFault::Total { .. } => "order-length-wrong",
            OrderFault::Utf16 | OrderFault::Charset | OrderFault::Text { .. } => "order-charset",
            OrderFault::PatientCut => "order-cut-short",
            OrderFault::NoPatient => "order-without-patient",
            OrderFault::TwoPatients { .. } => "order-two-patients",
        }
    }

    /// The key of its text in the table `cause` of each language, and what fills the places of the text.
    pub fn says(&self) -> (&'static str, Vec<(&'static str, String)>) {
        match self {
            OrderFault::TooLarge { bytes } => {
                let most = ("most", ORDER_MOST.to_string());
                (self.code(), vec![("bytes", bytes.to_string()), most])
            }
            OrderFault::Utf16 => ("order-utf-16", Vec::new()),
            OrderFault::Lines(LineFault::Frame { line }) => {
                ("order-frame", vec![("line", line.to_string())])
            }
            OrderFault::Lines(LineFault::Length { line, said, found }) => {
                let names = [("line", line), ("said", said), ("found", found)];
                let names = names.map(|(name, count)| (name, count.to_string()));
                ("order-line-length", names.to_vec())
            }
            OrderFault::OtherKind { found } => (self.code(), vec![("found", found.clone())]),
            OrderFault::NoTotal => ("order-no-total", Vec::new()),
            OrderFault::Total { said, found } => {
                (self.code(), vec![("said", said.to_string()), ("found", found.to_string())])
            }
            OrderFault::Text { line, why } => {
                let at = ("at", why.at.to_string());
                let charset = ("charset", why.charset.name().to_owned());
                ("order-text", vec![("line", line.to_string()), at, charset])
            }
            OrderFault::TwoPatients { first, second } => {
                (self.code(), vec![("first", first.to_string()), ("second", second.to_string())])
            }
            _ => (self.code(), Vec::new()),
        }
    }

    /// The fault in words that follow a colon.
    pub fn in_words(&self, language: Language) -> String {
        let (is, names) = self.says();
        let words: Vec<(&str, &dyn Display)> =
            names.iter().map(|(name, word)| (*name, word as &dyn Display)).collect();
        language.filled_word("cause", is, &words)
    }
}

/// Reads an order. `charset` is used for orders that name no character set. An order with the byte order
/// mark of UTF-8 is written in it, whatever it names. A lenient reader ignores lengths, for programs that
/// count characters or leave them out.
///
/// # Errors
/// See [`OrderFault`].
pub fn read(bytes: &[u8], charset: Charset, lenient: bool) -> Result<Order, OrderFault> {
    let size = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    if size > ORDER_MOST {
        return Err(OrderFault::TooLarge { bytes: size });
    }
    if UTF_16.iter().any(|mark| bytes.starts_with(mark)) {
        return Err(OrderFault::Utf16);
    }
    // Checked first: a message that is not an order may be meant for another program and is left alone.
    if let Some(found) = kind(bytes).filter(|kind| *kind != ORDER) {
        let found = String::from_utf8_lossy(found).into_owned();
        return Err(OrderFault::OtherKind { found });
    }
    let lines = line::read(bytes, !lenient).map_err(OrderFault::Lines)?;
    if lines.first().is_none_or(|line| line.field != KIND || line.content != ORDER) {
        return Err(OrderFault::NotGdt);
    }
    if !lenient {
        total(&lines, bytes)?;
    } else if lines.last().is_some_and(|line| line.field == PATIENT) && !bytes.ends_with(b"\n") {
        // Half an id may be another patient's, and a lenient reader does not check the length.
        return Err(OrderFault::PatientCut);
    }
    let (mark, _) = line::unmarked(bytes);
    let charset = charset_of(&lines, if mark > 0 { Charset::Utf8 } else { charset })?;
    let text = |field: u16| text(&lines, field, charset);
    Ok(Order {
        patient: patient(&lines, charset)?,
        request: text(8310)?,
        procedure: text(8402)?,
        receiver: text(8315)?,
        sender: text(8316)?,
    })
}

/// The four digits of the kind of message; `None` if the bytes do not begin like a message.
fn kind(bytes: &[u8]) -> Option<&[u8]> {
    let (mark, bytes) = line::unmarked(bytes);
    let counted = bytes.strip_prefix(b"0168000").filter(|_| mark > 0);
    let kind = counted.or(bytes.strip_prefix(b"0138000"))?.get(..4)?;
    kind.iter().all(u8::is_ascii_digit).then_some(kind)
}

fn total(lines: &[Line<'_>], bytes: &[u8]) -> Result<(), OrderFault> {
    let line = lines.get(1).filter(|line| line.field == TOTAL).ok_or(OrderFault::NoTotal)?;
    let digits = std::str::from_utf8(line.content).ok();
    let said = digits.and_then(|digits| digits.trim().parse::<u64>().ok());
    let said = said.ok_or(OrderFault::NoTotal)?;
    // Excludes a DOS end mark. A line end that the last line lacks may be counted or not, and so may a
    // byte order mark.
    let bytes = bytes.strip_suffix(&[0x1a]).unwrap_or(bytes);
    let found = bytes.len() as u64;
    let end = if bytes.ends_with(b"\r\n") { 0 } else { 2 };
    let mark = line::unmarked(bytes).0 as u64;
    let counted = [found, found + end, found - mark, found - mark + end];
    if counted.contains(&said) {
        return Ok(());
    }
    Err(OrderFault::Total { said, found })
}

fn charset_of(lines: &[Line<'_>], configured: Charset) -> Result<Charset, OrderFault> {
    let Some(named) = lines.iter().find(|line| line.field == 9206) else { return Ok(configured) };
    // Programs that write UTF-8 have no number for it and may write any number.
    if configured == Charset::Utf8 {
        return Ok(configured);
    }
    Charset::of_number(named.content.trim_ascii()).ok_or(OrderFault::Charset)
}

fn decoded(line: &Line<'_>, charset: Charset) -> Result<String, OrderFault> {
    let text = charset.decode(line.content.trim_ascii());
    text.map_err(|why| OrderFault::Text { line: line.number, why })
}

/// The text of a field; `None` if it is missing or empty.
fn text(lines: &[Line<'_>], field: u16, charset: Charset) -> Result<Option<String>, OrderFault> {
    let line = lines.iter().find(|line| line.field == field);
    let text = line.map(|line| decoded(line, charset)).transpose()?;
    Ok(text.filter(|text| !text.is_empty()))
}

/// The one patient that all fields 3000 name.
fn patient(lines: &[Line<'_>], charset: Charset) -> Result<String, OrderFault> {
    let mut named: Option<(usize, String)> = None;
    for line in lines.iter().filter(|line| line.field == PATIENT) {
        let id = decoded(line, charset)?;
        match &named {
            _ if id.is_empty() => {}
            Some((_, known)) if *known == id => {}
            Some((first, _)) => {
                return Err(OrderFault::TwoPatients { first: *first, second: line.number });
            }
            None => named = Some((line.number, id)),
        }
    }
    named.map(|(_, id)| id).ok_or(OrderFault::NoPatient)
}
