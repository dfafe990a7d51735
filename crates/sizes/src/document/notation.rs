//! What a line that is no TOML was meant to be: people enter tables by hand, from paper.

use crate::fault::Slip;
use crate::point::Point;

/// What the parser says of a key that stands twice.
const TWICE: &str = "duplicate key";

/// The slip in a line, of which the parser gives this message.
pub(super) fn slip(line: &str, message: &str) -> Slip {
    let is_odd_space = |letter: char| letter.is_whitespace() && !letter.is_ascii();
    if message == TWICE {
        return Slip::Twice;
    }
    if line.contains(is_odd_space) {
        return Slip::Space;
    }
    let Some((key, value)) = line.split_once('=') else {
        return Slip::Other(message.to_owned());
    };
    let value = value.trim();
    let is_bare = value.starts_with(|letter: char| letter.is_alphabetic() || is_quote(letter));
    match key.trim() {
        key if Point::of(key).is_some() => Slip::Range,
        _ if is_day(value) => Slip::Day,
        _ if is_bare => Slip::Quotes,
        _ => Slip::Other(message.to_owned()),
    }
}

/// Quotation marks as word processors set them.
fn is_quote(letter: char) -> bool {
    matches!(letter, '\u{2018}'..='\u{201f}' | '«' | '»' | '‹' | '›' | '´' | '`')
}

/// A date as people write it: 31.12.2027, 31/12/2027.
fn is_day(value: &str) -> bool {
    let parts: Vec<&str> = value.split(['.', '/', '-']).map(str::trim).collect();
    let is_number =
        |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    parts.len() == 3 && parts.iter().all(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_taken_for_what_its_writer_meant() {
        for (line, expected) in [
            ("cB = 18-20.5", Slip::Range),
            ("cB = [18 – 20,5]", Slip::Range),
            ("valid_until = 31.12.2027", Slip::Day),
            ("maker = „Muster“", Slip::Quotes),
            ("maker = Muster", Slip::Quotes),
            ("cC\u{a0}= [28, 34]", Slip::Space),
            ("status", Slip::Other("m".to_owned())),
            ("status = 1.1.1.1", Slip::Other("m".to_owned())),
        ] {
            assert_eq!(slip(line, "m"), expected, "{line}");
        }
        assert_eq!(slip("cB = [18, 20]", "duplicate key"), Slip::Twice);
    }
}
