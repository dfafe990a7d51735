//! A mask that selects files: a name in which `*` stands for anything and `?` for one character. Case is
//! ignored, because the files come from machines that ignore it.

use regex::Regex;

/// A mask of file names.
#[derive(Debug, Clone)]
pub struct Mask(Regex);

impl Mask {
    /// A mask; `None` if it contains something that no file name can.
    pub fn new(text: &str) -> Option<Mask> {
        let is_one = !text.is_empty() && !text.contains('/') && !text.contains(char::is_control);
        let expression = regex::escape(text).replace(r"\*", ".*").replace(r"\?", ".");
        Regex::new(&format!(r"\A(?is:{expression})\z")).ok().filter(|_| is_one).map(Mask)
    }

    /// Whether it matches a file of this name. Hidden files never match.
    pub fn means(&self, name: &str) -> bool {
        !name.starts_with('.') && self.0.is_match(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_is_anything_and_a_question_mark_one_character() {
        for (mask, name, means) in [
            ("*.gdt", "PRAXLEGS.GDT", true),
            ("*.gdt", "a.gdt.tmp", false),
            ("*.gdt", ".gdt", false),
            ("LEGSPRAX.*", "legsprax.001", true),
            ("LEGS????.0?1", "LEGSPRAX.001", true),
            ("LEGS????.0?1", "LEGSPRAX.011x", false),
            ("*a*b", "xaxbxab", true),
            ("*a*b", "xaxbxa", false),
            ("*", "anything", true),
        ] {
            assert_eq!(Mask::new(mask).unwrap().means(name), means, "{mask} {name}");
        }
        assert!(Mask::new("").is_none() && Mask::new("a/b").is_none());
    }
}
