//! The places in a text that are filled in: `{name}`, or `{name:form}` for a figure of a form.

/// A piece of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Piece<'a> {
    /// Words that stay as they are.
    Words(&'a str),
    /// A place that is filled in.
    Place {
        name: &'a str,
        /// What follows the colon: the number of decimals, `*` for all of them, `cm` for a length in mm that
        /// is shown in whole cm, `around` for an angle that is shown as a part of the leg; empty without one.
        form: &'a str,
    },
}

/// The pieces of a text, in order.
pub fn pieces(text: &str) -> impl Iterator<Item = Piece<'_>> {
    text.split_inclusive(['{', '}']).map(|piece| match piece.strip_suffix('}') {
        Some(place) => {
            let (name, form) = place.split_once(':').unwrap_or((place, ""));
            Piece::Place { name, form }
        }
        None => Piece::Words(piece.trim_end_matches('{')),
    })
}

/// A text with its places filled in by `words`, from the name and the form of each. `None` if there are
/// no words for one of them.
pub fn fill(text: &str, words: impl Fn(&str, &str) -> Option<String>) -> Option<String> {
    let filled = |piece| match piece {
        Piece::Words(words) => Some(words.to_owned()),
        Piece::Place { name, form } => words(name, form),
    };
    pieces(text).map(filled).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_parted_at_its_places() {
        let found: Vec<Piece<'_>> = pieces("from {low} to {high_mm:1} mm").collect();
        assert_eq!(
            found,
            [
                Piece::Words("from "),
                Piece::Place { name: "low", form: "" },
                Piece::Words(" to "),
                Piece::Place { name: "high_mm", form: "1" },
                Piece::Words(" mm"),
            ]
        );
        assert_eq!(pieces("plain").collect::<Vec<_>>(), [Piece::Words("plain")]);
    }

    #[test]
    fn a_text_is_filled_in_only_as_a_whole() {
        let words = |name: &str, form: &str| (name == "a").then(|| format!("<{form}>"));
        assert_eq!(fill("{a}, {a:2} and no more", words).as_deref(), Some("<>, <2> and no more"));
        assert_eq!(fill("{a}{b}", words), None);
        assert_eq!(fill("", words).as_deref(), Some(""));
    }
}
