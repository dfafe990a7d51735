//! A line of a reader of barcodes or cards → an id.

/// What a reader puts around an id: characters and control signs, such as STX and ETX.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Codes {
    /// Before it.
    pub prefix: String,
    /// After it.
    pub suffix: String,
}

/// What a line from a reader means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CodeReading {
    Id(String),
    /// An id that cannot be understood: the text in its place is empty or not plain text, or there are
    /// control signs where the reader puts none.
    Unread,
    /// Not for us: it lacks the prefix or suffix of an id.
    Nothing,
}

impl Codes {
    /// The control sign that ends a line on a serial port, as carriage return and line feed do: readers
    /// that frame an id by control signs may send neither.
    pub fn end(&self) -> Option<u8> {
        let (end, before) = self.suffix.as_bytes().split_last()?;
        let is_only = !before.contains(end) && !self.prefix.as_bytes().contains(end);
        (end.is_ascii_control() && is_only).then_some(*end)
    }

    /// What a line means.
    pub fn reading(&self, line: &[u8]) -> CodeReading {
        let inside = line.strip_prefix(self.prefix.as_bytes());
        let inside = inside.and_then(|rest| rest.strip_suffix(self.suffix.as_bytes()));
        let Some(inside) = inside else {
            // Part of a frame, or two of them in one: the rest may have been lost.
            let has_control = line.iter().any(u8::is_ascii_control);
            return if has_control { CodeReading::Unread } else { CodeReading::Nothing };
        };
        let is_plain = inside.iter().all(|byte| byte.is_ascii_graphic() || *byte == b' ');
        match str::from_utf8(inside).map(|id| id.trim_matches(' ')) {
            Ok(id) if is_plain && !id.is_empty() => CodeReading::Id(id.to_owned()),
            _ => CodeReading::Unread,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_stands_between_prefix_and_suffix_and_is_plain_text() {
        let codes = Codes { prefix: "]C1".into(), suffix: "%".into() };
        assert_eq!(codes.reading(b"]C14711%"), CodeReading::Id("4711".into()));
        for line in ["4711", "]C14711", "4711%", "]C1", "x]C14711%", "]c14711%"] {
            assert_eq!(codes.reading(line.as_bytes()), CodeReading::Nothing, "{line:?}");
        }
        for line in ["]C1%", "]C1 %", "]C147\u{1}11%", "]C1ü%"] {
            assert_eq!(codes.reading(line.as_bytes()), CodeReading::Unread, "{line:?}");
        }
        assert_eq!(codes.reading(b"]C1\xff4711%"), CodeReading::Unread);
        assert_eq!(Codes::default().reading(b"\xff4711"), CodeReading::Unread);
        assert_eq!(Codes::default().reading(b" P4711 "), CodeReading::Id("P4711".into()));
    }

    #[test]
    fn control_signs_stand_where_they_were_set_and_nowhere_else() {
        let codes = Codes { prefix: "\u{2}".into(), suffix: "\u{3}".into() };
        assert_eq!(codes.reading(b"\x024711\x03"), CodeReading::Id("4711".into()));
        assert_eq!(codes.reading(b"4711"), CodeReading::Nothing);
        for line in [
            &b"\x024711"[..],
            b"4711\x03",
            b"\x02\x03",
            b"\x0247\x024711\x03",
            b"47\x024711\x03",
            b"\x0247\x1d11\x03",
            b"\x024711\t\x03",
            b"\x7f\x024711\x03",
        ] {
            assert_eq!(codes.reading(line), CodeReading::Unread, "{}", line.escape_ascii());
        }
        for line in [&b"\x024711\x03"[..], b"4711\t", b"\t4711", b"4711\0"] {
            assert_eq!(
                Codes::default().reading(line),
                CodeReading::Unread,
                "{}",
                line.escape_ascii()
            );
        }
        let tab = Codes { suffix: "\t".into(), ..Codes::default() };
        assert_eq!(tab.reading(b"4711\t"), CodeReading::Id("4711".into()));
    }

    #[test]
    fn a_control_sign_that_stands_only_at_the_end_ends_the_line() {
        let end = |prefix: &str, suffix: &str| {
            Codes { prefix: prefix.into(), suffix: suffix.into() }.end()
        };
        assert_eq!(end("\u{2}", "\u{3}"), Some(3));
        assert_eq!(end("", "%\t"), Some(b'\t'));
        for (prefix, suffix) in [("", ""), ("\u{2}", ""), ("", "%"), ("\u{3}", "\u{3}")] {
            assert_eq!(end(prefix, suffix), None, "{prefix:?} {suffix:?}");
        }
        assert_eq!(end("", "\u{3}\u{3}"), None);
    }
}
