//! The geometry of a scan as written in its file: coordinates and faces, without comments.
//!
//! Two exports of the same scan may differ only in a comment with the time. Numbers are compared as
//! text, so a scan written with different digits is a different scan.

use std::ops::Range;

use super::Format;

/// The length of the comment at the beginning of a binary STL, bytes.
const STL_COMMENT: usize = 80;

/// The parts of a file that contain its coordinates and faces, in order. No part is empty; the list
/// is empty if the file has no geometry.
pub fn geometry(bytes: &[u8], format: Format) -> Vec<Range<usize>> {
    let mut parts = match format {
        Format::Obj => lines(bytes, |line| is_word(line, b"v") || is_word(line, b"f")),
        Format::Ply => {
            let body = ply_body(bytes);
            let counts = |line: &[u8]| !is_word(line, b"comment") && !is_word(line, b"obj_info");
            let mut parts = lines(&bytes[..body], counts);
            parts.push(body..bytes.len());
            parts
        }
        Format::Stl if is_text_stl(bytes) => {
            lines(bytes, |line| is_word(line.trim_ascii_start(), b"vertex"))
        }
        Format::Stl => std::iter::once(STL_COMMENT.min(bytes.len())..bytes.len()).collect(),
        Format::Wrl | Format::Xyz => lines(bytes, |line| {
            let text = line.trim_ascii_start();
            !text.is_empty() && !text.starts_with(b"#") && !text.starts_with(b"//")
        }),
    };
    parts.retain(|part| !part.is_empty());
    parts
}

/// The runs of lines that count, each line with its line end, except at the end of the last one.
fn lines(bytes: &[u8], counts: impl Fn(&[u8]) -> bool) -> Vec<Range<usize>> {
    let (mut runs, mut run, mut at) = (Vec::new(), 0..0, 0);
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let end = at + line.len();
        if counts(line) {
            if run.end != at {
                runs.push(std::mem::replace(&mut run, at..at));
            }
            run.end = end;
        }
        at = end;
    }
    // The last line may lack its line end.
    run.end = run.start + bytes[run.clone()].trim_ascii_end().len();
    runs.push(run);
    runs
}

/// Whether a line begins with a word.
fn is_word(line: &[u8], word: &[u8]) -> bool {
    let rest = line.strip_prefix(word);
    rest.is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// Offset of the body of a PLY; the end of the file if there is no body.
fn ply_body(bytes: &[u8]) -> usize {
    let mut at = 0;
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        at += line.len();
        if line.trim_ascii() == b"end_header" {
            return at;
        }
    }
    bytes.len()
}

/// Whether an STL is text: its first lines contain a facet.
fn is_text_stl(bytes: &[u8]) -> bool {
    let beginning = &bytes[..bytes.len().min(1024)];
    beginning.starts_with(b"solid") && beginning.windows(5).any(|word| word == b"facet")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The geometry of a file; `None` if it has none.
    fn geometry(bytes: &[u8], format: Format) -> Option<Vec<u8>> {
        let parts = super::geometry(bytes, format);
        let of = |part: std::ops::Range<usize>| bytes[part].to_vec();
        (!parts.is_empty()).then(|| parts.into_iter().flat_map(of).collect())
    }

    fn obj(text: &str) -> Option<Vec<u8>> {
        geometry(text.as_bytes(), Format::Obj)
    }

    #[test]
    fn comments_names_and_materials_do_not_count() {
        let bare = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let dressed = "# 22.11.2026 09:15\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\n# half\nv 0 1 0\nvn 0 0 1\ng x\nf 1 2 3";
        assert!(bare.is_some());
        assert_eq!(obj(dressed), bare);
    }

    #[test]
    fn another_coordinate_or_face_is_another_geometry() {
        let texts = [
            "v 0 0 0\nv 1 0 0\nf 1 2 1\n",
            "v 0 0 1\nv 1 0 0\nf 1 2 1\n",
            "v 0 0 0\nv 1 0 0\nf 2 1 2\n",
            "v 0 0 0\nv 1 0 0\n",
        ];
        let mut found: Vec<_> = texts.iter().map(|text| obj(text)).collect();
        found.sort();
        found.dedup();
        assert_eq!(found.len(), texts.len());
    }

    #[test]
    fn a_file_without_geometry_has_none() {
        assert_eq!(obj("# nothing\nmtllib v.mtl\n"), None);
        assert_eq!(geometry(b"", Format::Ply), None);
        assert_eq!(geometry(&[b' '; 80], Format::Stl), None);
    }

    #[test]
    fn each_format_has_its_own_comments() {
        let ply = |comment: &str| {
            let text =
                format!("ply\nformat ascii 1.0\n{comment}element vertex 1\nend_header\n1 2 3\n");
            geometry(text.as_bytes(), Format::Ply)
        };
        assert_eq!(ply(""), ply("comment made at nine\nobj_info x\n"));
        let stl = |first: u8| {
            geometry(&[[first; 80].as_slice(), &[1, 0, 0, 0], &[7; 50]].concat(), Format::Stl)
        };
        assert_eq!(stl(b'a'), stl(b'b'));
        let text = |name: &str| {
            let text = format!("solid {name}\nfacet normal 0 0 1\nouter loop\n vertex 0 0 0\n");
            geometry(text.as_bytes(), Format::Stl)
        };
        assert!(text("a").is_some() && text("a") == text("b"));
        for format in [Format::Xyz, Format::Wrl] {
            let of = |text: &str| geometry(text.as_bytes(), format);
            assert!(of("1 2 3\n").is_some() && of("1 2 3\n") == of("# nine\n1 2 3\n"));
            assert_ne!(of("1 2 3\n"), of("1 2 4\n"));
        }
    }
}
