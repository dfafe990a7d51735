//! Text from outside in a form that is safe to show to people.

use std::iter;

/// The longest line of another program, characters.
const LINE_MOST: usize = 200;

/// This much of another program's text is read, characters.
const READ_MOST: usize = 100 * LINE_MOST;

/// An id with nothing hidden in it. Characters that are invisible, or that change the text direction,
/// are replaced by their code points, so that no id is mistaken for another.
pub fn id(text: &str) -> String {
    let shown = |letter: char| match is_hidden(letter) {
        true => format!("[U+{:04X}]", u32::from(letter)),
        false => letter.to_string(),
    };
    text.chars().map(shown).collect()
}

/// A text for the content of an element of HTML or XML, and for an attribute between `"`.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A text of another program as part of a line for people and logs: without what nobody sees or what turns the
/// direction of letters, without these words in capital or small letters, which must not get into a log, and at most
/// 200 characters long.
pub fn in_a_line(text: &str, without: &[&str]) -> String {
    let mut line: String = seen(text).take(READ_MOST).collect();
    let words = without.iter().map(|word| seen(word).collect::<String>());
    for word in words.filter(|word| !word.is_empty()) {
        line = masked(&line, &word);
    }
    line.chars().take(LINE_MOST).collect()
}

/// A text with a sign in the place of each of these words, in whatever capital and small letters.
fn masked(text: &str, word: &str) -> String {
    let small = |letters: &str| letters.chars().flat_map(char::to_lowercase).collect::<String>();
    let (word, letters) = (small(word), text.chars().collect::<Vec<char>>());
    let (mut masked, mut at) = (String::new(), 0);
    while at < letters.len() {
        let (mut found, mut end) = (String::new(), at);
        while end < letters.len() && found.len() < word.len() {
            found.extend(letters[end].to_lowercase());
            end += 1;
        }
        match found == word {
            true => {
                masked.push('…');
                at = end;
            }
            false => {
                masked.push(letters[at]);
                at += 1;
            }
        }
    }
    masked
}

/// What people see of a text, with single blanks.
fn seen(text: &str) -> impl Iterator<Item = char> {
    let words = text.split_whitespace().filter(|word| !word.chars().all(is_hidden));
    let letters = words.flat_map(|word| iter::once(' ').chain(word.chars()));
    letters.filter(|letter| !is_hidden(*letter)).skip(1)
}

/// Control characters, blanks other than the plain one, format characters, including those that change
/// the text direction, private-use characters, and fillers of other scripts.
fn is_hidden(letter: char) -> bool {
    let is_blank = letter.is_whitespace() && letter != ' ';
    let is_format = matches!(u32::from(letter),
        0x00AD | 0x034F | 0x061C | 0x115F | 0x1160 | 0x17B4 | 0x17B5 | 0x180B..=0x180F
        | 0x200B..=0x200F | 0x202A..=0x202E | 0x2060..=0x206F | 0x3164 | 0xFE00..=0xFE0F | 0xFEFF
        | 0xFFA0 | 0xFFF9..=0xFFFB | 0xE000..=0xF8FF | 0xE0000..=0xE0FFF | 0xF0000..=0x10_FFFF);
    letter.is_control() || is_blank || is_format
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_hides_or_turns_letters_is_shown_and_letters_stay() {
        assert_eq!(id("P12 <b>\"Müller\" שלום"), "P12 <b>\"Müller\" שלום");
        assert_eq!(id("1\u{202E}32\u{0}\u{200B}\n"), "1[U+202E]32[U+0000][U+200B][U+000A]");
    }

    #[test]
    fn a_line_of_another_program_is_short_and_has_no_secret_however_it_is_hidden() {
        let line = |text: &str| in_a_line(text, &["4711", ""]);
        assert_eq!(line("no\r\n  Patient/4711 \u{1b} here"), "no Patient/… here");
        assert_eq!(line("47\u{200B}11 47\u{0}11 4\u{202E}711 47111"), "… … … …1");
        assert_eq!(line(&"4711".repeat(300)), "…".repeat(200));
        assert_eq!(in_a_line("of P\u{A0}17", &["P 17"]), "of …");
        assert_eq!(in_a_line("no ÄB1, äb1 or Äb12", &["äB1"]), "no …, … or …2");
        assert_eq!(in_a_line("İ/p4711 and P471", &["P4711"]), "İ/… and P471");
        assert_eq!(line(""), "");
    }

    #[test]
    fn every_kind_of_letter_that_nobody_sees_is_shown() {
        let hidden = [
            // Blanks, and marks that are only visible at the end of a line.
            "\u{A0}\u{2003}\u{2028}\u{3000}\u{AD}\u{34F}",
            // Changes of text direction, and their ends.
            "\u{61C}\u{200E}\u{200F}\u{202A}\u{202E}\u{2066}\u{2069}",
            // Joiners, variation selectors, fillers, and marks at the beginning of a text.
            "\u{200B}\u{200D}\u{2060}\u{FE00}\u{FE0F}\u{FEFF}\u{115F}\u{1160}\u{17B4}\u{180B}",
            "\u{3164}\u{FFA0}\u{FFF9}\u{FFFB}",
            // Private use, tags, more variation selectors, controls.
            "\u{E000}\u{F8FF}\u{E0001}\u{E0FFF}\u{F0000}\u{10FFFF}\u{7F}\u{85}",
        ];
        for letter in hidden.concat().chars() {
            let shown = format!("1[U+{:04X}]2", u32::from(letter));
            assert_eq!(id(&format!("1{letter}2")), shown);
        }
    }
}
