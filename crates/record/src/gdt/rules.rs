//! How results are written for a practice's software: field numbers and file names, in which products
//! differ.

use super::charset::Charset;

/// A practice software with known settings: those of GDT 2.1 unless stated otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// GDT 2.1 as specified.
    Default,
    /// MEDISTAR: GDT 2.1 as specified.
    Medistar,
    /// TURBOMED: names version 02.00.
    Turbomed,
    /// tomedo: uses UTF-8.
    Tomedo,
    /// Software that reads an attachment's format first, as GDT2DICOM writes it.
    FormatFirst,
}

impl Product {
    /// The value of field 9218.
    pub const fn version(self) -> &'static str {
        match self {
            Product::Turbomed => "02.00",
            _ => "02.10",
        }
    }

    /// How its results are named, in the form of [`FileName::new`].
    pub const fn file_name(self) -> &'static str {
        match self {
            // It fetches numbered files only if it is set to.
            Product::Turbomed => "{receiver}{sender}.GDT",
            _ => "{receiver}{sender}.{counter}",
        }
    }

    /// The character set it reads and writes.
    pub const fn charset(self) -> Charset {
        match self {
            Product::Tomedo => Charset::Utf8,
            _ => Charset::Cp1252,
        }
    }

    /// The fields in which it looks for an attachment.
    pub fn attachment_fields(self) -> AttachmentFields {
        match self {
            Product::FormatFirst => {
                let [format, description, path] = [6302, 6304, 6303].map(Some);
                AttachmentFields { name: None, format, description, path }
            }
            _ => AttachmentFields::default(),
        }
    }
}

/// The fields that describe an attachment; `None` leaves that part out. Products differ here, and a
/// wrong field is the most common reason why an attachment is not shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AttachmentFields {
    /// Its name or number in an archive.
    pub name: Option<u16>,
    /// Its format, such as `SVG`.
    pub format: Option<u16>,
    /// What it contains.
    pub description: Option<u16>,
    /// Its path.
    pub path: Option<u16>,
}

impl Default for AttachmentFields {
    fn default() -> AttachmentFields {
        let [name, format, description, path] = [6302, 6303, 6304, 6305].map(Some);
        AttachmentFields { name, format, description, path }
    }
}

/// How a result refers to the place of an attachment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// By the full path, as the practice software sees it.
    Full,
    /// By the path relative to the exchange folder.
    Relative,
    /// By the file name alone.
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
    /// The character set of messages.
    pub charset: Charset,
    /// The examination (8402), by which the practice software knows how to handle the result.
    pub procedure: String,
    /// The fields that describe attachments.
    pub attachment_fields: AttachmentFields,
}

/// How many letters of a short name are used in file names.
const SHORT: usize = 4;

/// The placeholder for a number of three digits.
const COUNTER: &str = "{counter}";

/// The largest number.
pub const COUNTER_MOST: u16 = 999;

/// The name pattern of result files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileName {
    text: String,
}

impl FileName {
    /// A pattern from a text in which `{receiver}` and `{sender}` stand for the first four letters of
    /// the short names and `{counter}` for a number. `None` if it gives no valid file name.
    pub fn new(text: &str, receiver: &str, sender: &str) -> Option<FileName> {
        let short = |name: &str| name.chars().take(SHORT).collect::<String>();
        let text = text.replace("{receiver}", &short(receiver));
        let name = FileName { text: text.replace("{sender}", &short(sender)) };
        let allowed = |c: char| c.is_ascii_graphic() && !r#"/\:*?"<>|{}"#.contains(c);
        let sample = name.of(1);
        let is_one = !sample.is_empty() && !sample.starts_with('.') && sample.chars().all(allowed);
        is_one.then_some(name)
    }

    /// Whether each file gets a number, so that several can wait to be fetched.
    pub fn counts(&self) -> bool {
        self.text.contains(COUNTER)
    }

    /// The file name with this number.
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
