//! Texts in fields: the signs that separate parts are escaped.

/// What begins and ends an escape, as messages of this project declare it in MSH-2.
pub(super) const ESCAPE: char = '\\';

/// A text as a field or component.
pub(super) fn escaped(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            ESCAPE => written.push_str(r"\E\"),
            '|' => written.push_str(r"\F\"),
            '^' => written.push_str(r"\S\"),
            '&' => written.push_str(r"\T\"),
            '~' => written.push_str(r"\R\"),
            letter if letter.is_control() => written.push(' '),
            letter => written.push(letter),
        }
    }
    written
}

/// A field or component as text, with what begins and ends an escape in it.
pub(super) fn unescaped(field: &str, escape: char) -> String {
    let mut parts = field.split(escape);
    let mut read = parts.next().unwrap_or_default().to_owned();
    // Between two signs stands an escape; behind it comes plain text.
    while let Some(code) = parts.next() {
        match code {
            "E" => read.push(escape),
            "F" => read.push('|'),
            "S" => read.push('^'),
            "T" => read.push('&'),
            "R" => read.push('~'),
            _ => read.push(' '),
        }
        read.push_str(parts.next().unwrap_or_default());
    }
    read
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
