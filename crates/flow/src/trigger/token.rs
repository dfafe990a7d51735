//! The lines that are presses: exact matches only.

use crate::booth::Press;

/// The lines by which a button reports a press.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tokens {
    /// The lines of a short press.
    pub short: Vec<String>,
    /// The lines of a long press.
    pub long: Vec<String>,
}

impl Tokens {
    /// The press that a line means; `None` for any other line.
    pub fn press(&self, line: &[u8]) -> Option<Press> {
        let among = |tokens: &[String]| tokens.iter().any(|token| token.as_bytes() == line);
        if among(&self.short) {
            Some(Press::Short)
        } else {
            among(&self.long).then_some(Press::Long)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_exact_line_is_a_press() {
        let tokens = Tokens { short: vec!["PRESS".into()], long: vec!["HOLD".into()] };
        assert_eq!(tokens.press(b"PRESS"), Some(Press::Short));
        assert_eq!(tokens.press(b"HOLD"), Some(Press::Long));
        for line in ["", "press", "PRESS ", " PRESS", "PRESSPRESS", "PRES", "AT", "\0PRESS"] {
            assert_eq!(tokens.press(line.as_bytes()), None, "{line:?}");
        }
    }
}
