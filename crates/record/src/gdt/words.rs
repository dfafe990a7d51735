//! The words of a result, which are German like the format.

use gaiter_leg::Side;

use super::charset::Charset;

/// The remark at a figure that a person set, and the meaning of its mark.
pub(super) const BY_HAND: &str = "von Hand eingetragen";

/// The side as it is written in names.
pub(super) const fn side(side: Side) -> &'static str {
    match side {
        Side::Left => "links",
        Side::Right => "rechts",
    }
}

/// A German text as a character set can write it: 7 bit has no umlauts.
pub(super) fn written(text: &str, charset: Charset) -> String {
    if charset != Charset::Ascii {
        return text.to_owned();
    }
    let spelled = [
        ("ä", "ae"),
        ("ö", "oe"),
        ("ü", "ue"),
        ("Ä", "Ae"),
        ("Ö", "Oe"),
        ("Ü", "Ue"),
        ("ß", "ss"),
        ("–", "-"),
        ("·", "/"),
    ];
    spelled.iter().fold(text.to_owned(), |text, (letter, as_ascii)| text.replace(letter, as_ascii))
}

/// Wraps a text into lines of at most this many characters, at blanks if there are any.
pub(super) fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let mut rest = word;
        while !rest.is_empty() {
            let cut = rest.char_indices().nth(most).map_or(rest.len(), |(at, _)| at);
            let (piece, later) = rest.split_at(cut);
            rest = later;
            let room = |line: &String| line.chars().count() + 1 + piece.chars().count() <= most;
            match lines.last_mut().filter(|line| room(line)) {
                Some(line) => line.extend([" ", piece]),
                None => lines.push(piece.to_owned()),
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_seven_bits_spell_umlauts_out() {
        assert_eq!(written("Höhe, Größe – Übergang", Charset::Ascii), "Hoehe, Groesse - Uebergang");
        assert_eq!(written("Höhe", Charset::Cp437), "Höhe");
    }

    #[test]
    fn a_text_is_parted_at_blanks_and_loses_nothing() {
        assert_eq!(wrapped("ab cd  efg", 5), ["ab cd", "efg"]);
        assert_eq!(wrapped("äöüß-äöüß x", 4), ["äöüß", "-äöü", "ß x"]);
        assert_eq!(wrapped(" ", 4), [""; 0]);
    }
}
