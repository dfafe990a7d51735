//! The words of a result. They avoid umlauts where possible, so that every character set can write
//! them.

use super::charset::Charset;
use crate::leg::Side;

/// The side as it is written in names.
pub(super) const fn side(side: Side) -> &'static str {
    match side {
        Side::Left => "links",
        Side::Right => "rechts",
    }
}

/// The height of a level above the floor.
pub(super) fn height(charset: Charset) -> &'static str {
    if charset == Charset::Ascii { "Hoehe" } else { "Höhe" }
}

/// A doubt in words by its code, or the code itself if there are no words for it.
pub(super) fn doubt(code: &str) -> &str {
    match code {
        "shallow" => "Extremum nur schwach",
        "flat" => "Umfang dort gleichbleibend, Lage unsicher",
        "double" => "eine zweite Stelle ist ebenso gut",
        "edge" => "am Rand des Messbereichs",
        "gap" => "Haut dort nur teilweise gesehen",
        "scatter" => "Punkte streuen dort: Stoff oder Bewegung",
        "folds" => "Haut dort gefaltet",
        "not-seen" => "Haut dort nicht gesehen",
        "below-d" => "Knie unter D nach Proportion",
        "sole-not-seen" => "Sohle nicht gesehen",
        other => other,
    }
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
    fn a_text_is_parted_at_blanks_and_loses_nothing() {
        assert_eq!(wrapped("ab cd  efg", 5), ["ab cd", "efg"]);
        assert_eq!(wrapped("äöüß-äöüß x", 4), ["äöüß", "-äöü", "ß x"]);
        assert_eq!(wrapped(" ", 4), [""; 0]);
    }
}
