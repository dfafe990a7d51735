//! What a file's content looks like, whatever its name says.

use super::format::Format;
use super::{stl, text, xyz};

/// Bytes at the head of a file that are looked at to tell what it is.
const HEAD_BYTES: usize = 4096;

/// Statements that an OBJ file begins with. Each needs a word after it.
const OBJ_OPENINGS: [&[u8]; 8] = [b"v", b"vn", b"vt", b"f", b"o", b"g", b"mtllib", b"usemtl"];

/// What a content looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A scan format that gaiter reads.
    Scan(Format),
    /// Text in UTF-16, with its byte order mark.
    Utf16,
    /// A ZIP archive.
    Zip,
    /// A gzip archive, which VRML scenes are at times.
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
    /// What to do about such a content.
    pub(super) fn advice(self) -> &'static str {
        match self {
            Content::Scan(_) => "rename the file or mend the exporter",
            Content::Utf16 => "export as ASCII or UTF-8",
            Content::Zip | Content::Gzip => "let the exporter write it unpacked",
        }
    }
}

/// What the bytes plainly are; `None` where their head does not tell.
pub(super) fn of(bytes: &[u8]) -> Option<Content> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Some(Content::Utf16);
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return Some(Content::Zip);
    }
    if bytes.starts_with(b"\x1f\x8b") {
        return Some(Content::Gzip);
    }
    let head = text::without_mark(bytes);
    let head = &head[..head.len().min(HEAD_BYTES)];
    let opens = |word: &[u8]| head.strip_prefix(word).is_some_and(|rest| !rest.is_empty());
    if opens(b"ply\n") || opens(b"ply\r") {
        return Some(Content::Scan(Format::Ply));
    }
    if opens(b"#VRML ") {
        return Some(Content::Scan(Format::Wrl));
    }
    // The header of a binary STL may be any text, so its length speaks first.
    if stl::is_binary_by_length(bytes) {
        return Some(Content::Scan(Format::Stl));
    }
    if head.iter().any(|&b| text::is_binary(b)) {
        return None;
    }
    opening(head).map(Content::Scan)
}

/// The format that the first statement of a text belongs to.
fn opening(head: &[u8]) -> Option<Format> {
    let (_, line) = text::numbered(head).find(|(_, line)| !xyz::is_comment(line))?;
    let mut words = text::words(line);
    let first = words.next()?;
    if OBJ_OPENINGS.contains(&first) && words.next().is_some() {
        return Some(Format::Obj);
    }
    if first.eq_ignore_ascii_case(b"solid") {
        return Some(Format::Stl);
    }
    xyz::is_point(line).then_some(Format::Xyz)
}
