//! A mask that selects files: a name in which `*` stands for anything and `?` for one character. Case is
//! ignored, because the files come from machines that ignore it.

/// A mask of file names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask(Vec<char>);

impl Mask {
    /// A mask; `None` if it contains something that no file name can.
    pub fn new(text: &str) -> Option<Mask> {
        let is_one = !text.is_empty() && !text.contains('/') && !text.contains(char::is_control);
        is_one.then(|| Mask(text.to_lowercase().chars().collect()))
    }

    /// Whether it matches a file of this name. Hidden files never match.
    pub fn means(&self, name: &str) -> bool {
        let name: Vec<char> = name.to_lowercase().chars().collect();
        name.first() != Some(&'.') && matches(&self.0, &name)
    }
}

/// Goes back to the last star only: what was matched before it needs no second try.
fn matches(mask: &[char], name: &[char]) -> bool {
    let (mut m, mut n) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        match mask.get(m) {
            Some('*') => {
                star = Some((m, n));
                m += 1;
            }
            Some(c) if *c == '?' || *c == name[n] => (m, n) = (m + 1, n + 1),
            _ => {
                let Some((at, taken)) = star else { return false };
                star = Some((at, taken + 1));
                (m, n) = (at + 1, taken + 1);
            }
        }
    }
    mask[m..].iter().all(|c| *c == '*')
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
