//! How results are written for a practice's software: what products differ in, field numbers and
//! the names of files.

use super::charset::Charset;

/// A practice software whose habits are known. Everything it stands for can be set by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// GDT 2.1 as written.
    Default,
    /// MEDISTAR: as written.
    Medistar,
    /// TURBOMED: names its version 02.00.
    Turbomed,
    /// tomedo: UTF-8.
    Tomedo,
}

impl Product {
    /// What field 9218 says.
    pub const fn version(self) -> &'static str {
        match self {
            Product::Turbomed => "02.00",
            Product::Default | Product::Medistar | Product::Tomedo => "02.10",
        }
    }

    /// In what it reads and writes.
    pub const fn charset(self) -> Charset {
        match self {
            Product::Tomedo => Charset::Utf8,
            Product::Default | Product::Medistar | Product::Turbomed => Charset::Cp1252,
        }
    }
}

/// Which fields tell of an attachment; none leaves that out. Products differ here, and a wrong one
/// is the commonest reason for which nothing is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AttachmentFields {
    /// Its name or number in an archive.
    pub name: Option<u16>,
    /// Its format, `SVG` say.
    pub format: Option<u16>,
    /// What it is.
    pub description: Option<u16>,
    /// Where it lies.
    pub path: Option<u16>,
}

impl Default for AttachmentFields {
    fn default() -> AttachmentFields {
        let [name, format, description, path] = [6302, 6303, 6304, 6305].map(Some);
        AttachmentFields { name, format, description, path }
    }
}

/// How a result says where an attachment lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// From the root on, as the practice software sees it.
    Full,
    /// From the exchange folder on.
    Relative,
    /// By the file's name alone.
    Name,
}

/// How results are written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GdtRules {
    /// Short name of the practice software (8315).
    pub receiver: String,
    /// Short name of this station (8316).
    pub sender: String,
    /// Version of GDT (9218).
    pub version: String,
    /// In what messages are written.
    pub charset: Charset,
    /// The examination (8402), by which the practice software knows what to do with it.
    pub procedure: String,
    /// Which fields tell of attachments.
    pub attachment_fields: AttachmentFields,
}

/// How many letters of a short name stand in file names.
const SHORT: usize = 4;

/// Stands for a number of three digits.
const COUNTER: &str = "{counter}";

/// The largest number.
pub const COUNTER_MOST: u16 = 999;

/// How the files of results are called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileName {
    text: String,
}

impl FileName {
    /// By a text in which `{receiver}` and `{sender}` stand for the first four letters of the short
    /// names and `{counter}` for a number; none where that is no file name.
    pub fn new(text: &str, receiver: &str, sender: &str) -> Option<FileName> {
        let short = |name: &str| name.chars().take(SHORT).collect::<String>();
        let text = text.replace("{receiver}", &short(receiver));
        let name = FileName { text: text.replace("{sender}", &short(sender)) };
        let allowed = |c: char| c.is_ascii_graphic() && !r#"/\:*?"<>|{}"#.contains(c);
        let sample = name.of(1);
        let is_one = !sample.is_empty() && !sample.starts_with('.') && sample.chars().all(allowed);
        is_one.then_some(name)
    }

    /// Whether each file has a number, so that several may wait to be fetched.
    pub fn counts(&self) -> bool {
        self.text.contains(COUNTER)
    }

    /// The name of the file of this number.
    pub fn of(&self, number: u16) -> String {
        self.text.replace(COUNTER, &format!("{number:03}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(text: &str) -> Option<FileName> {
        FileName::new(text, "PRAX_EDV", "LEGSCAN1")
    }

    #[test]
    fn files_are_called_by_short_names_and_number() {
        let counted = name("{sender}{receiver}.{counter}").unwrap();
        assert_eq!((counted.counts(), counted.of(7).as_str()), (true, "LEGSPRAX.007"));
        let fixed = name("{receiver}{sender}.GDT").unwrap();
        assert_eq!((fixed.counts(), fixed.of(7).as_str()), (false, "PRAXLEGS.GDT"));
    }

    #[test]
    fn what_leaves_the_folder_or_no_windows_takes_is_no_name() {
        for text in ["", "a/b.gdt", r"a\b.gdt", ".gdt", "a:b", "{patient}.gdt", "ä.gdt", "a b.gdt"]
        {
            assert_eq!(name(text), None, "{text}");
        }
    }
}
