//! What the files of this crate have in common: their slips of notation, and their unknown keys.

use gaiter_toml::nearest;

use super::fault::{DocumentFault, RANGE, What};
use super::point::Point;

pub(super) use gaiter_toml::{Value, number};

/// A section of a file, which notes its faults.
pub(super) type Section<'s, 't> = gaiter_toml::Section<'s, 't, What>;

/// The longest file that is read, bytes: hundreds of sizes with their codes have less.
pub const BYTES_MAX: usize = 256 * 1024;

/// Reads a file whose first key is its format, the `expected` one, which the line `example` sets.
pub(super) fn read<T>(
    bytes: &[u8],
    expected: &'static str,
    example: &'static str,
    read: impl FnOnce(Section<'_, '_>) -> Option<T>,
) -> Result<T, Vec<DocumentFault>> {
    gaiter_toml::read::<T, What>(bytes, BYTES_MAX, slip, |whole| {
        let found = whole.required_text("format", example)?;
        if found != expected {
            let at = whole.get("format")?.span();
            whole.note(&at, "format", What::Format { found, expected });
            return None;
        }
        read(whole)
    })
}

#[derive(Debug, Clone, Copy)]
pub(super) struct SectionKeys {
    /// The names of those of this section. `note_…` stands for any that begins so.
    pub words: &'static str,
    /// That points are keys, too, in words that follow the names; empty if they are not.
    pub points: &'static str,
    /// Those of the whole file, which stand above the first section; empty for the whole file.
    pub above: &'static str,
}

impl SectionKeys {
    /// The keys of a section without points, and without others above it.
    pub fn here(words: &'static str) -> SectionKeys {
        SectionKeys { words, points: "", above: "" }
    }

    /// Notes every other key of a section.
    pub fn only(self, section: Section<'_, '_>) {
        for (name, _) in section.pairs().filter(|(name, _)| !self.has(name.get_ref())) {
            section.note(&name.span(), section.key(name.get_ref()), self.fault(name.get_ref()));
        }
    }

    fn has(self, name: &str) -> bool {
        self.words.split_whitespace().any(|word| match word {
            "note_…" => name.starts_with("note_"),
            word => word == name,
        }) || !self.points.is_empty() && Point::named(name).is_some()
    }

    /// The fault of an unknown key, with what it was probably meant to be.
    fn fault(self, name: &str) -> What {
        let upper = name.to_uppercase();
        let points = [format!("c{upper}"), format!("l{upper}")];
        let cased = name.get(1..).map(|rest| name[..1].to_lowercase() + &rest.to_uppercase());
        let is_point = |of: &String| Point::named(of).is_some() && self.has(of);
        let point = cased.into_iter().chain(points).find(is_point);
        if point.is_none() && self.above.split_whitespace().any(|word| word == name) {
            return What::OfTheWholeFile;
        }
        let words = self.words.split_whitespace().filter(|word| Point::named(word).is_none());
        let similar = point.or_else(|| nearest(name, words).map(str::to_owned));
        let known = [self.words, self.points].join(" ").trim_end().to_owned();
        gaiter_toml::What::Unknown { similar, known: vec![known] }.into()
    }
}

/// What a line that is no TOML was meant to be: people enter tables by hand, from paper.
fn slip(line: &str) -> Option<(&'static str, &'static str)> {
    let is_odd_space = |letter: char| letter.is_whitespace() && !letter.is_ascii();
    if line.contains(is_odd_space) {
        let hint = "delete the spaces of this line and type them again";
        return Some(("a space in this line is not an ordinary one", hint));
    }
    let (key, value) = line.split_once('=')?;
    if Point::named(key.trim()).is_some() {
        return Some(("these are not two limits in [ ]", RANGE));
    }
    let hint = "write year-month-day without quotes: 2027-01-31";
    is_day(value.trim()).then_some(("this is no date that can be read", hint))
}

/// A date as people write it: 31.12.2027, 31/12/2027.
fn is_day(value: &str) -> bool {
    let parts: Vec<&str> = value.split(['.', '/', '-']).map(str::trim).collect();
    let is_number =
        |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    parts.len() == 3 && parts.iter().all(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_taken_for_what_its_writer_meant() {
        for (line, expected) in [
            ("cB = 18-20.5", "two limits"),
            ("cB = [18 – 20,5]", "two limits"),
            ("valid_until = 31.12.2027", "date"),
            ("cC\u{a0}= [28, 34]", "space"),
        ] {
            assert!(slip(line).unwrap().0.contains(expected), "{line}");
        }
        for line in ["maker = „Muster“", "status", "status = 1.1.1.1"] {
            assert_eq!(slip(line), None, "{line}");
        }
    }
}
