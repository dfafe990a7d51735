//! A record as HL7 v2: a result (ORU^R01) with the figures of the sheet and the report's PDF, its withdrawal, and the
//! answers of the receiver.

mod answer;
mod escape;
mod message;

use gaiter_language::Language;
use gaiter_sizes::Garment;

pub use answer::{Acknowledgment, AcknowledgmentFault, acknowledgment};
pub use message::{control_id, observed, result, withdrawal};

/// How messages are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Hl7Rules {
    /// MSH-3 and MSH-4: application and facility that send.
    pub sender: [String; 2],
    /// MSH-5 and MSH-6: application and facility that receive.
    pub receiver: [String; 2],
    /// MSH-11: `P` for production, `T` for training.
    pub processing: char,
    /// MSH-12: the version.
    pub version: String,
    /// PID-3.4: who assigns the patients' ids.
    pub authority: String,
    /// The name of gaiter's own coding system.
    pub coding: String,
    /// How the PDF is sent.
    pub pdf: PdfForm,
    /// The character set.
    pub charset: Charset,
    /// The language of texts.
    pub language: Language,
    /// The garment whose measures an order needs.
    pub garment: Garment,
}

/// How the PDF of the report is sent, as encapsulated data (ED). Receivers differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PdfForm {
    /// `^application^pdf^Base64^…`, by the tables of HL7 for media types.
    MediaType,
    /// `^PDF^^Base64^…`, as older receivers want it.
    Plain,
    /// Not at all.
    None,
}

/// The character set of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Charset {
    /// UTF-8.
    Utf8,
    /// ISO 8859-1; a letter that it lacks becomes a question mark. A message about a patient whose id it cannot
    /// write is in UTF-8, and declares it: an id with a question mark may be another's.
    Latin1,
}

impl Charset {
    /// Its name in MSH-18 (HL7 table 0211).
    fn name(self) -> &'static str {
        match self {
            Charset::Utf8 => "UNICODE UTF-8",
            Charset::Latin1 => "8859/1",
        }
    }

    /// This one, or UTF-8 for a text that it cannot write.
    fn that_writes(self, text: &str) -> Charset {
        match text.chars().all(|letter| u8::try_from(letter).is_ok()) {
            true => self,
            false => Charset::Utf8,
        }
    }

    fn encoded(self, text: &str) -> Vec<u8> {
        match self {
            Charset::Utf8 => text.as_bytes().to_vec(),
            Charset::Latin1 => {
                text.chars().map(|letter| u8::try_from(letter).unwrap_or(b'?')).collect()
            }
        }
    }
}
