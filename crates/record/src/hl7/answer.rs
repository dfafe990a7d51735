//! The answer of a receiver (ACK): accepted, or not and why.

use super::escape::{ESCAPE, unescaped};
use crate::shown::in_a_line;

/// Codes of errors (HL7 table 0357) that may be over later: the record is locked, or the application failed by
/// itself.
const LATER: [&str; 2] = ["206", "207"];

/// The longest unknown code that is reported, characters.
const CODE_MOST: usize = 8;

/// What a receiver answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Acknowledgment {
    /// AA or CA: it has the message.
    Accepted,
    /// AE, AR, CE or CR: it does not take it.
    Refused {
        /// The code of MSA-1.
        code: String,
        /// The receiver's text about it, in a line.
        why: String,
        /// Whether the same message may be taken later.
        is_passing: bool,
    },
}

/// Why an answer is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AcknowledgmentFault {
    /// It does not begin with MSH, or has no MSA.
    #[error("the answer is no acknowledgement")]
    NoAnswer,
    /// It answers another message.
    #[error("the answer is for another message")]
    OtherMessage,
    /// Its code is not one of HL7.
    #[error("the answer has the unknown code {0:?}")]
    UnknownCode(String),
}

/// Reads the answer to the message of this control id, without these words, which must not get into a log.
///
/// # Errors
/// See [`AcknowledgmentFault`].
pub fn acknowledgment(
    bytes: &[u8],
    control: &str,
    secret: &[&str],
) -> Result<Acknowledgment, AcknowledgmentFault> {
    let text = decoded(bytes);
    let mut lines = text.split(['\r', '\n']).filter(|line| !line.is_empty());
    let signs = lines.next().and_then(Signs::from_head).ok_or(AcknowledgmentFault::NoAnswer)?;
    let segments: Vec<Vec<&str>> = lines.map(|line| line.split(signs.field).collect()).collect();
    let of = |name: &str| segments.iter().find(|fields| fields.first() == Some(&name));
    let msa = of("MSA").ok_or(AcknowledgmentFault::NoAnswer)?;
    if msa.get(2).copied() != Some(control) {
        return Err(AcknowledgmentFault::OtherMessage);
    }
    let code = msa.get(1).copied().unwrap_or_default();
    match code {
        "AA" | "CA" => Ok(Acknowledgment::Accepted),
        "AE" | "AR" | "CE" | "CR" => {
            let err = of("ERR");
            let in_err = |at: usize| err.and_then(|err| err.get(at)).copied().unwrap_or_default();
            let in_msa = |at: usize| msa.get(at).copied().unwrap_or_default();
            // Error and texts (ERR-3, ERR-7, ERR-8); before version 2.5 text and error (MSA-3, MSA-6).
            let words = [in_err(3), in_err(7), in_err(8), in_msa(3), in_msa(6)];
            let errors = [in_err(3), in_msa(6)].map(|error| error.split(signs.component).next());
            let is_passing = errors.iter().flatten().any(|error| LATER.contains(error));
            let why = in_a_line(&signs.joined(&words), secret);
            Ok(Acknowledgment::Refused { code: code.to_owned(), why, is_passing })
        }
        code => {
            let code = in_a_line(code, secret);
            Err(AcknowledgmentFault::UnknownCode(code.chars().take(CODE_MOST).collect()))
        }
    }
}

/// UTF-8, or else ISO 8859-1, in which every byte is a letter.
fn decoded(bytes: &[u8]) -> String {
    let letters = || bytes.iter().copied().map(char::from).collect();
    std::str::from_utf8(bytes).map_or_else(|_| letters(), str::to_owned)
}

/// The signs that separate the parts of a message; the message declares them.
struct Signs {
    field: char,
    component: char,
    escape: char,
}

impl Signs {
    /// Those of a head, `MSH|^~\&|…`; `None` if it is none.
    fn from_head(head: &str) -> Option<Signs> {
        let mut letters = head.strip_prefix("MSH")?.chars();
        let field = letters.next()?;
        let others: Vec<char> = letters.take_while(|letter| *letter != field).take(3).collect();
        let component = *others.first()?;
        Some(Signs { field, component, escape: others.get(2).copied().unwrap_or(ESCAPE) })
    }

    /// Fields as text.
    fn joined(&self, fields: &[&str]) -> String {
        let parts = fields.iter().flat_map(|field| field.split(self.component));
        let parts = parts.map(|part| unescaped(part, self.escape));
        let parts: Vec<String> = parts.filter(|part| !part.trim().is_empty()).collect();
        parts.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const HEAD: &str = "MSH|^~\\&|KIS|HOUSE|GAITER|BOOTH|20261126||ACK^R01^ACK|7|P|2.5";

    fn read(rest: &str) -> Result<Acknowledgment, AcknowledgmentFault> {
        acknowledgment(format!("{HEAD}\r{rest}\r").as_bytes(), "abc", &["4711"])
    }

    fn refused(
        code: &str,
        why: &str,
        is_passing: bool,
    ) -> Result<Acknowledgment, AcknowledgmentFault> {
        Ok(Acknowledgment::Refused { code: code.to_owned(), why: why.to_owned(), is_passing })
    }

    #[test]
    fn an_accepted_message_is_told_from_one_that_is_not() {
        assert_eq!(read("MSA|AA|abc"), Ok(Acknowledgment::Accepted));
        assert_eq!(read("MSA|CA|abc"), Ok(Acknowledgment::Accepted));
        assert_eq!(
            read("MSA|AE|abc|no such patient 4711\rERR||PID^1^3|204^Unknown key^HL70357|E"),
            refused("AE", "204, Unknown key, HL70357, no such patient …", false)
        );
        assert_eq!(read("MSA|CE|abc"), refused("CE", "", false));
    }

    #[test]
    fn an_error_that_passes_is_one_in_every_version() {
        assert_eq!(read("MSA|AR|abc\rERR|||207|E"), refused("AR", "207", true));
        assert_eq!(
            read("MSA|AE|abc|later|||206^Application record locked"),
            refused("AE", "later, 206, Application record locked", true)
        );
        assert_eq!(read("MSA|CR|abc\rERR|||2060|E"), refused("CR", "2060", false));
    }

    #[test]
    fn an_answer_is_read_with_its_own_signs_and_letters() {
        let bytes = b"\nMSH#!~/%#KIS\nMSA#AE#abc#F\xe4lle!kein /F/ Fall\n";
        assert_eq!(acknowledgment(bytes, "abc", &[]), refused("AE", "Fälle, kein | Fall", false));
        assert_eq!(
            acknowledgment("MSH|^\rMSA|AE|abc|Fälle".as_bytes(), "abc", &[]),
            refused("AE", "Fälle", false)
        );
    }

    #[test]
    fn what_is_no_answer_to_the_message_is_told_so() {
        assert_eq!(read("MSA|AA|abd"), Err(AcknowledgmentFault::OtherMessage));
        assert_eq!(read("MSA|AA"), Err(AcknowledgmentFault::OtherMessage));
        assert_eq!(read("MSA|OK|abc"), Err(AcknowledgmentFault::UnknownCode("OK".to_owned())));
        assert_eq!(
            read("MSA|4711 was not taken|abc"),
            Err(AcknowledgmentFault::UnknownCode("… was no".to_owned()))
        );
        assert_eq!(read("ERR|||207|E"), Err(AcknowledgmentFault::NoAnswer));
        for bytes in [&b""[..], b"MSH", b"HTTP/1.1 200 OK\r\n\r\n", b"\xff\xfe", b"MSH|^~\\&|\r"] {
            assert_eq!(acknowledgment(bytes, "abc", &[]), Err(AcknowledgmentFault::NoAnswer));
        }
        assert_eq!(acknowledgment(b"MSA|AA|abc\r", "abc", &[]), Err(AcknowledgmentFault::NoAnswer));
    }

    /// What is true of any answer.
    fn holds(bytes: &[u8]) -> Result<(), TestCaseError> {
        let told = acknowledgment(bytes, "abc", &["4711"]);
        if told.is_ok() {
            let control = bytes.windows(3).any(|part| part == b"abc");
            prop_assert!(control, "an answer to another message was taken for that to this one");
        }
        if let Ok(Acknowledgment::Refused { why: said, .. })
        | Err(AcknowledgmentFault::UnknownCode(said)) = &told
        {
            prop_assert!(said.chars().count() <= 200);
            prop_assert!(!said.contains("4711") && !said.chars().any(char::is_control), "{said:?}");
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            holds(&bytes)?;
            let told = [b"MSH|^~\\&|KIS\rMSA|AE|abc|".as_slice(), &bytes].concat();
            holds(&told)?;
        }

        #[test]
        fn any_pieces_of_answers_are_read_or_refused(pieces in prop::collection::vec(piece(), 0..40)) {
            holds(pieces.concat().as_bytes())?;
        }
    }

    fn piece() -> impl Strategy<Value = &'static str> {
        prop::sample::select(vec![
            "MSH",
            "MSA",
            "ERR",
            "|",
            "|",
            "^",
            "~",
            "\\",
            "&",
            "\r",
            "\n",
            "AA",
            "AE",
            "206",
            "abc",
            "4711",
            "47\u{0}11",
            "MSH|^~\\&|",
            "\rMSA|AE|abc|",
            "\rERR|||",
            "ü",
            "\u{202e}",
        ])
    }
}
