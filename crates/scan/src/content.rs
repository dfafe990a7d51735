//! The apparent type of a file's content, regardless of its name.

use super::format::Format;

/// The apparent type of a content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A scan format that gaiter reads.
    Scan(Format),
    /// Text in UTF-16, with its byte order mark.
    Utf16,
    /// A ZIP archive.
    Zip,
    /// A gzip archive, as sometimes used for VRML scenes.
    Gzip,
}

impl std::fmt::Display for Content {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Content::Scan(format) => format.fmt(out),
            Content::Utf16 => out.write_str("UTF-16 text"),
            Content::Zip => out.write_str("a ZIP archive"),
            Content::Gzip => out.write_str("a gzip archive"),
        }
    }
}

impl Content {
    /// The recommended action for such a content.
    pub(super) fn advice(self) -> &'static str {
        match self {
            Content::Scan(_) => "rename the file or mend the exporter",
            Content::Utf16 => "export as ASCII or UTF-8",
            Content::Zip | Content::Gzip => "let the exporter write it unpacked",
        }
    }
}
