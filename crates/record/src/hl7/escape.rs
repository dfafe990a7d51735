//! Texts in fields: the signs that separate parts are escaped.

/// What begins and ends an escape, as messages of this project declare it in MSH-2.
pub(super) const ESCAPE: char = '\\';

/// A text as a field or component.
pub(super) fn escaped(text: &str) -> String {
    let mut told = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            ESCAPE => told.push_str(r"\E\"),
            '|' => told.push_str(r"\F\"),
            '^' => told.push_str(r"\S\"),
            '&' => told.push_str(r"\T\"),
            '~' => told.push_str(r"\R\"),
            letter if letter.is_control() => told.push(' '),
            letter => told.push(letter),
        }
    }
    told
}

/// A field or component as text, with what begins and ends an escape in it.
pub(super) fn unescaped(field: &str, escape: char) -> String {
    let mut parts = field.split(escape);
    let mut told = parts.next().unwrap_or_default().to_owned();
    // Between two signs stands an escape; behind it comes plain text.
    while let Some(code) = parts.next() {
        match code {
            "E" => told.push(escape),
            "F" => told.push('|'),
            "S" => told.push('^'),
            "T" => told.push('&'),
            "R" => told.push('~'),
            _ => told.push(' '),
        }
        told.push_str(parts.next().unwrap_or_default());
    }
    told
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn separators_are_escaped() {
        assert_eq!(escaped(r"a|b^c&d~e\f"), r"a\F\b\S\c\T\d\R\e\E\f");
        assert_eq!(escaped("a\rb\nc\u{b}"), "a b c ");
    }

    #[test]
    fn an_escape_of_layout_is_a_blank_and_one_that_is_cut_off_does_no_harm() {
        assert_eq!(unescaped(r"no patient\.br\here", ESCAPE), "no patient here");
        assert_eq!(unescaped("a!F!b", '!'), "a|b");
        assert_eq!(unescaped(r"a\F", ESCAPE), "a|");
        assert_eq!(unescaped(r"a\", ESCAPE), "a ");
    }

    proptest! {
        #[test]
        fn what_was_escaped_is_read_back(text in "[|^&~\\\\a-zäß .]{0,40}") {
            let field = escaped(&text);
            prop_assert!(!field.contains(['|', '^', '&', '~']));
            prop_assert_eq!(unescaped(&field, ESCAPE), text);
        }
    }
}
