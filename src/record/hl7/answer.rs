//! The answer of a receiver (ACK): accepted, or not and why.

use super::escape::unescaped;

/// The longest text of a receiver that is told, characters.
const TEXT_MOST: usize = 200;

/// Codes of errors (ERR-3, HL7 table 0357) that may be over later: the record is locked, or the application
/// failed by itself.
const LATER: [&str; 2] = ["206", "207"];

/// What a receiver answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// AA or CA: it has the message.
    Accepted,
    /// AE, AR, CE or CR: it does not take it.
    Refused {
        /// The code of MSA-1.
        code: String,
        /// What the receiver says about it, in a line.
        why: String,
        /// Whether the same message may be taken later.
        is_passing: bool,
    },
}

/// Why an answer is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AnswerFault {
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
/// See [`AnswerFault`].
pub fn answer(bytes: &[u8], control: &str, secret: &[&str]) -> Result<Answer, AnswerFault> {
    let text = String::from_utf8_lossy(bytes);
    let mut segments = text.split(['\r', '\n']).filter(|segment| !segment.is_empty());
    let head = segments.next().filter(|head| head.starts_with("MSH") && head.len() > 8);
    let separator = head.and_then(|head| head.chars().nth(3)).ok_or(AnswerFault::NoAnswer)?;
    let segments: Vec<Vec<&str>> =
        segments.map(|segment| segment.split(separator).collect()).collect();
    let of = |name: &str| segments.iter().find(|fields| fields.first() == Some(&name));
    let msa = of("MSA").ok_or(AnswerFault::NoAnswer)?;
    if msa.get(2).copied() != Some(control) {
        return Err(AnswerFault::OtherMessage);
    }
    let code = msa.get(1).copied().unwrap_or_default();
    match code {
        "AA" | "CA" => Ok(Answer::Accepted),
        "AE" | "AR" | "CE" | "CR" => {
            let err = of("ERR");
            let field = |at: usize| err.and_then(|err| err.get(at)).copied().unwrap_or_default();
            // ERR-3 is a code with its words, ERR-7 and ERR-8 are texts; MSA-3 is that of older versions.
            let error = field(3).split('^').next().unwrap_or_default().to_owned();
            let words = [field(3), field(7), field(8), msa.get(3).copied().unwrap_or_default()];
            let is_passing = LATER.contains(&error.as_str());
            Ok(Answer::Refused { code: code.to_owned(), why: told(&words, secret), is_passing })
        }
        code => Err(AnswerFault::UnknownCode(code.chars().take(8).collect())),
    }
}

/// Fields as a line of text.
fn told(fields: &[&str], secret: &[&str]) -> String {
    let parts = fields.iter().flat_map(|field| field.split('^')).map(unescaped);
    let parts: Vec<String> = parts.filter(|part| !part.trim().is_empty()).collect();
    let mut line = parts.join(", ");
    for secret in secret.iter().filter(|secret| !secret.is_empty()) {
        line = line.replace(secret, "…");
    }
    line.chars().filter(|letter| !letter.is_control()).take(TEXT_MOST).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "MSH|^~\\&|KIS|HOUSE|GAITER|BOOTH|20261126||ACK^R01^ACK|7|P|2.5";

    fn read(rest: &str) -> Result<Answer, AnswerFault> {
        answer(format!("{HEAD}\r{rest}\r").as_bytes(), "abc", &["4711"])
    }

    #[test]
    fn an_accepted_message_is_told_from_one_that_is_not() {
        assert_eq!(read("MSA|AA|abc"), Ok(Answer::Accepted));
        assert_eq!(read("MSA|CA|abc"), Ok(Answer::Accepted));
        let refused =
            read("MSA|AE|abc|no such patient 4711\rERR||PID^1^3|204^Unknown key^HL70357|E")
                .unwrap();
        let why = "204, Unknown key, HL70357, no such patient …".to_owned();
        assert_eq!(refused, Answer::Refused { code: "AE".to_owned(), why, is_passing: false });
        let Answer::Refused { is_passing, .. } = read("MSA|AR|abc\rERR|||207|E").unwrap() else {
            panic!("it is refused")
        };
        assert!(is_passing);
    }

    #[test]
    fn what_is_no_answer_to_the_message_is_told_so() {
        assert_eq!(read("MSA|AA|abd"), Err(AnswerFault::OtherMessage));
        assert_eq!(read("MSA|OK|abc"), Err(AnswerFault::UnknownCode("OK".to_owned())));
        assert_eq!(read("ERR|||207|E"), Err(AnswerFault::NoAnswer));
        for bytes in [&b""[..], b"MSH", b"HTTP/1.1 200 OK\r\n\r\n", b"\xff\xfe", b"MSH|^~\\&|\r"] {
            assert_eq!(answer(bytes, "abc", &[]), Err(AnswerFault::NoAnswer));
        }
    }
}
