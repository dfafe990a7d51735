//! Detects the content of a file from its head, regardless of its name.

use super::format::{Content, Format};
use super::{ply, stl, text, xyz};

/// Number of bytes at the head of a file that are examined.
const HEAD_BYTES: usize = 4096;

/// Statements that can begin an OBJ file. Each needs a word after it.
const OBJ_OPENINGS: [&[u8]; 8] = [b"v", b"vn", b"vt", b"f", b"o", b"g", b"mtllib", b"usemtl"];

/// The detected content; `None` if the head is inconclusive.
pub(super) fn detect(bytes: &[u8]) -> Option<Content> {
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
    if ply::opens(head) {
        return Some(Content::Scan(Format::Ply));
    }
    if head.strip_prefix(b"#VRML ").is_some_and(|rest| !rest.is_empty()) {
        return Some(Content::Scan(Format::Wrl));
    }
    // The header of a binary STL may be any text, so its length is checked first.
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
