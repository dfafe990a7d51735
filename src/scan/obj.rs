//! Wavefront OBJ, decoded by tobj behind checks of our own.
//!
//! tobj never panics, but it accepts NaN and infinity, a cut face line, and a file without faces,
//! and it refuses a whole file for one Latin-1 letter in an object's name. So only the statements
//! that carry geometry are handed on, and what tobj lets through is checked here.

use std::ops::Range;

use nalgebra::Point3;

use super::{CutSign, Scan, ScanFault};

/// Statements of the OBJ format (Wavefront specification, version 3.0) and the usual extensions.
/// A file whose first statement is none of these is no OBJ.
const STATEMENTS: [&str; 30] = [
    "v",
    "vt",
    "vn",
    "vp",
    "f",
    "fo",
    "l",
    "p",
    "o",
    "g",
    "s",
    "mg",
    "mtllib",
    "usemtl",
    "usemap",
    "maplib",
    "lod",
    "deg",
    "bmat",
    "step",
    "cstype",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "end",
    "shadow_obj",
    "trace_obj",
];

/// More unused points than this share of all means that the face list was cut off. Every known
/// export of a whole surface uses all of its points. A test body cut at
/// 90 % of its bytes leaves 1.6 % unused and lacks a leg, so no more than a few stray points are
/// let through: 57 of 57 000.
const UNUSED_POINTS_MAX_SHARE: f64 = 0.001;

/// What some editors and exporters put before UTF-8 text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Longest piece of a faulty statement that an error repeats, characters.
const EXCERPT_CHARS: usize = 40;

/// Decodes an OBJ file.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line.
pub fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    completeness(bytes)?;
    let bytes = without_mark(bytes);
    let statements = Statements::of(bytes)?;
    if statements.points == 0 {
        return Err(ScanFault::NoPoints);
    }
    if statements.faces == 0 {
        return Err(ScanFault::NoFaces { points: statements.points });
    }
    let scan = decode(&statements.geometry).map_err(|what| match first_bad_line(bytes) {
        Some(fault) => fault,
        None => ScanFault::Malformed { line: 0, what },
    })?;
    if scan.points.iter().any(|p| !p.iter().all(|c| c.is_finite())) {
        let unplaced = ScanFault::NotFinite { line: 0, found: "overflow".to_owned() };
        return Err(first_bad_line(bytes).unwrap_or(unplaced));
    }
    if scan.triangles.is_empty() {
        return Err(ScanFault::NoFaces { points: statements.points });
    }
    let unused = statements.points.saturating_sub(scan.points.len());
    if unused as f64 > UNUSED_POINTS_MAX_SHARE * statements.points as f64 {
        let what = CutSign::UnusedPoints { unused, points: statements.points };
        return Err(ScanFault::CutShort { what });
    }
    Ok(scan)
}

/// Whether the text ends where a text may end.
///
/// # Errors
/// [`ScanFault::Empty`], [`ScanFault::CutShort`] where the last line has no line end.
pub fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    if without_mark(bytes).iter().all(u8::is_ascii_whitespace) {
        return Err(ScanFault::Empty);
    }
    if let Some(at) = bytes.iter().position(|&b| is_binary(b)) {
        return Err(ScanFault::Binary { at, value: bytes[at] });
    }
    if !bytes.ends_with(b"\n") && !bytes.ends_with(b"\r") {
        let line = lines(bytes).count();
        return Err(ScanFault::CutShort { what: CutSign::NoLineEnd { line } });
    }
    Ok(())
}

fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// The lines of a text without their ends, which are LF, CR LF or, as old Macs wrote, CR alone.
fn lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = text;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
        let (line, after) = rest.split_at(end);
        rest = after.strip_prefix(b"\r\n").unwrap_or(after.get(1..).unwrap_or_default());
        Some(line)
    })
}

/// Control characters that no text export holds; a Ctrl-Z end mark of old systems is let through.
fn is_binary(byte: u8) -> bool {
    const CTRL_Z: u8 = 0x1a;
    (byte < b' ' && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0b | 0x0c | CTRL_Z)) || byte == 0x7f
}

/// The statements of a file that carry geometry, copied out, and how many there are.
struct Statements {
    /// `v`, `vt`, `vn` and `f` lines.
    geometry: Vec<u8>,
    /// Number of `v` lines.
    points: usize,
    /// Number of `f` lines.
    faces: usize,
}

impl Statements {
    /// Drops comments, names, groups and materials: with them gone tobj gives one mesh with one
    /// index space, and names in any encoding do no harm. Colours after a point's coordinates go
    /// too, because tobj refuses a file where only some points have them.
    fn of(bytes: &[u8]) -> Result<Statements, ScanFault> {
        let mut found =
            Statements { geometry: Vec::with_capacity(bytes.len()), points: 0, faces: 0 };
        let mut first = true;
        for (index, line) in lines(bytes).enumerate() {
            let line = line.trim_ascii();
            let keyword = line.split(u8::is_ascii_whitespace).next().unwrap_or_default();
            if keyword.is_empty() || keyword.starts_with(b"#") {
                continue;
            }
            if first && !STATEMENTS.iter().any(|known| known.as_bytes() == keyword) {
                return Err(ScanFault::NotThisFormat { line: index + 1, found: excerpt(line) });
            }
            first = false;
            match keyword {
                b"v" => {
                    found.points += 1;
                    found.geometry.extend_from_slice(&line[..end_of_token(line, 4)]);
                }
                b"f" => {
                    found.faces += 1;
                    found.geometry.extend_from_slice(line);
                }
                b"vt" | b"vn" => found.geometry.extend_from_slice(line),
                _ => continue,
            }
            found.geometry.push(b'\n');
        }
        Ok(found)
    }
}

/// Where the `count`-th token of a trimmed line ends.
fn end_of_token(line: &[u8], count: usize) -> usize {
    let mut seen = 0;
    let mut within = false;
    for (at, byte) in line.iter().enumerate() {
        if byte.is_ascii_whitespace() {
            within = false;
            if seen == count {
                return at;
            }
        } else if !within {
            within = true;
            seen += 1;
        }
    }
    line.len()
}

/// Points and triangles by tobj; polygons become fans, degenerate triangles are left out.
fn decode(geometry: &[u8]) -> Result<Scan, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut &*geometry, &options, no_materials)
        .map_err(|fault| fault.to_string())?;
    let mut scan = Scan { points: Vec::new(), triangles: Vec::new() };
    for model in models {
        let first = scan.points.len() as u32;
        let corners = model.mesh.positions.chunks_exact(3);
        scan.points.extend(corners.map(|c| Point3::new(c[0], c[1], c[2])));
        let faces = model.mesh.indices.chunks_exact(3).map(|f| [f[0], f[1], f[2]]);
        let proper = faces.filter(|[a, b, c]| a != b && b != c && c != a);
        scan.triangles.extend(proper.map(|t| t.map(|corner| corner + first)));
    }
    Ok(scan)
}

/// Finds the line that made decoding fail, by reading the lines once more with a plain parser.
fn first_bad_line(bytes: &[u8]) -> Option<ScanFault> {
    let points = lines(bytes).filter(|l| tokens(l).next() == Some("v")).count();
    for (index, line) in lines(bytes).enumerate() {
        let line_number = index + 1;
        let mut words = tokens(line);
        match words.next() {
            Some("v") => {
                let numbers: Vec<&str> = words.take(3).collect();
                for &number in &numbers {
                    match number.parse::<f64>() {
                        Ok(value) if value.is_finite() => {}
                        Ok(_) => {
                            let found = excerpt(number.as_bytes());
                            return Some(ScanFault::NotFinite { line: line_number, found });
                        }
                        Err(_) => return Some(malformed(line_number, "no number", number)),
                    }
                }
                if numbers.len() < 3 {
                    return Some(malformed(line_number, "fewer than three coordinates", ""));
                }
            }
            Some("f") => {
                if let Some(word) = words.find(|word| !is_corner(word, 0..points)) {
                    return Some(malformed(line_number, "no corner of a face", word));
                }
            }
            _ => {}
        }
    }
    None
}

/// Words of a line; empty where the line is no UTF-8, which no geometry line is allowed to be.
fn tokens(line: &[u8]) -> std::str::SplitAsciiWhitespace<'_> {
    std::str::from_utf8(line).unwrap_or_default().split_ascii_whitespace()
}

/// Whether a word such as `3`, `-1`, `3/1` or `3//2` names an existing point.
fn is_corner(word: &str, points: Range<usize>) -> bool {
    let position = word.split('/').next().and_then(|index| index.parse::<i64>().ok());
    match position {
        Some(index @ 1..) => points.contains(&(index as usize - 1)),
        Some(index @ ..=-1) => index.unsigned_abs() as usize <= points.end,
        _ => false,
    }
}

fn malformed(line: usize, what: &str, word: &str) -> ScanFault {
    let what = match word {
        "" => what.to_owned(),
        word => format!("\"{}\" is {what}", excerpt(word.as_bytes())),
    };
    ScanFault::Malformed { line, what }
}

/// The beginning of a statement, printable ASCII only, so that no log can be written through it.
fn excerpt(bytes: &[u8]) -> String {
    let printable = |&b: &u8| if b.is_ascii_graphic() || b == b' ' { b as char } else { '?' };
    bytes.iter().take(EXCERPT_CHARS).map(printable).collect()
}

#[cfg(test)]
mod tests;
