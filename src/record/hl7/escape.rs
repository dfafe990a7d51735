//! Texts in fields: the signs that separate parts are escaped.

/// A text as a field or component.
pub(super) fn escaped(text: &str) -> String {
    let mut told = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' => told.push_str(r"\E\"),
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

/// A field or component as text.
pub(super) fn unescaped(field: &str) -> String {
    let mut parts = field.split('\\');
    let mut told = parts.next().unwrap_or_default().to_owned();
    // Between two backslashes stands an escape; behind it comes plain text.
    while let Some(code) = parts.next() {
        match code {
            "E" => told.push('\\'),
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

    proptest! {
        #[test]
        fn what_was_escaped_is_read_back(text in "[|^&~\\\\a-zäß .]{0,40}") {
            let field = escaped(&text);
            prop_assert!(!field.contains(['|', '^', '&', '~']));
            prop_assert_eq!(unescaped(&field), text);
        }
    }
}
