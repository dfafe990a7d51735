//! The header of a PLY file: its elements, their counts and their properties.

use super::super::fault::{CutSign, ScanFault, cut_short, malformed};
use super::super::format::Format;
use super::super::text::{excerpt, whole, words};

/// Maximum number of elements and properties together. Scanners write some ten; more means that
/// this is not a header.
const ENTRIES_MAX: usize = 1000;

/// The encoding of the elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_word(word: &[u8]) -> Option<Scalar> {
        Some(match word {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    /// Size in a binary file, bytes.
    pub(super) fn bytes(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    fn is_whole(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }
}

/// One number, or a list of numbers preceded by their count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

/// The meaning of a property for this reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meaning {
    /// The coordinate of a vertex along axis 0, 1 or 2.
    Axis(usize),
    /// The vertices of a face or strip.
    Corners,
    /// Anything else.
    Other,
}

/// A property of an element.
#[derive(Debug)]
pub(super) struct Property {
    /// Its name, printable characters only.
    name: String,
    /// Its 1-based line.
    line: usize,
    pub shape: Shape,
    pub meaning: Meaning,
}

/// The meaning of an element for this reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Vertex,
    Face,
    Strip,
    Other,
}

impl Kind {
    /// The name of one such element, and of several.
    pub(super) fn names(self) -> [&'static str; 2] {
        match self {
            Kind::Vertex => ["vertex", "vertices"],
            Kind::Face => ["face", "faces"],
            Kind::Strip => ["strip", "strips"],
            Kind::Other => ["element", "elements"],
        }
    }

    fn meaning(self, name: &[u8], shape: Shape) -> Meaning {
        match (self, name, shape) {
            (Kind::Vertex, b"x", Shape::One(_)) => Meaning::Axis(0),
            (Kind::Vertex, b"y", Shape::One(_)) => Meaning::Axis(1),
            (Kind::Vertex, b"z", Shape::One(_)) => Meaning::Axis(2),
            (
                Kind::Face | Kind::Strip,
                b"vertex_indices" | b"vertex_index",
                Shape::List { item, .. },
            ) if item.is_whole() => Meaning::Corners,
            _ => Meaning::Other,
        }
    }

    fn has_corners(self) -> bool {
        matches!(self, Kind::Face | Kind::Strip)
    }
}

/// An element: a number of records with the same properties.
#[derive(Debug)]
pub(super) struct Element {
    /// Its name, printable characters only.
    name: String,
    pub kind: Kind,
    /// The number of records that the header announces; they may not be present.
    pub count: usize,
    pub properties: Vec<Property>,
}

impl Element {
    /// The fault of a file that has only this many of its records.
    pub(super) fn missing(&self, has: usize) -> ScanFault {
        let [_, what] = self.kind.names();
        cut_short(CutSign::Missing { what, has, of: self.count })
    }
}

/// A header that was read successfully.
#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Offset of the elements, bytes.
    pub end: usize,
    /// Number of lines of the header.
    pub line_count: usize,
}

impl Header {
    /// Reads the header. Where its first line ends in CR alone, all lines do, so that a binary body that
    /// begins with a line feed does not count as part of it.
    ///
    /// # Errors
    /// [`ScanFault::CutShort`] if `end_header` is missing, [`ScanFault::Malformed`] with the line.
    pub(super) fn read(bytes: &[u8]) -> Result<Header, ScanFault> {
        let mut at = opening(bytes)?;
        let ends_in_cr = bytes[..at].ends_with(b"\r");
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut line_count = 1;
        let mut entries = 0;
        loop {
            let (line, length) = first_line(&bytes[at..], ends_in_cr).ok_or_else(no_end)?;
            at += length;
            line_count += 1;
            let mut rest = words(line);
            match rest.next().unwrap_or_default() {
                b"end_header" => break,
                b"format" => encoding = Some(encoding_of(rest.next(), line_count)?),
                b"comment" | b"obj_info" | b"" => continue,
                b"element" => elements.push(element(&mut rest, line, line_count)?),
                b"property" => {
                    let element = elements.last_mut();
                    let element = element.ok_or_else(|| unreadable(line, line_count))?;
                    let property = property(element.kind, &mut rest, line, line_count)?;
                    element.properties.push(property);
                }
                _ => return Err(unreadable(line, line_count)),
            }
            entries += 1;
            if entries > ENTRIES_MAX {
                return Err(malformed(line_count, format!("more than {ENTRIES_MAX} entries")));
            }
        }
        let encoding = encoding.ok_or_else(|| malformed(line_count, "no format is named"))?;
        let header = Header { encoding, elements, end: at, line_count };
        header.refuse_without_geometry()?;
        header.refuse_other_faces()?;
        Ok(header)
    }

    /// Number of records that take up space in the file: those of elements with properties.
    pub(super) fn record_count(&self) -> usize {
        let elements = self.elements.iter().filter(|element| !element.properties.is_empty());
        elements.fold(0, |sum, element| sum.saturating_add(element.count))
    }

    fn refuse_without_geometry(&self) -> Result<(), ScanFault> {
        let fault = |what: &str| Err(malformed(self.line_count, what));
        let of_kind = |kind: Kind| self.elements.iter().filter(move |e| e.kind == kind);
        let has = |element: &Element, meaning: Meaning| {
            element.properties.iter().filter(|property| property.meaning == meaning).count() == 1
        };
        if of_kind(Kind::Vertex).count() != 1 {
            return fault("the header must name one element \"vertex\"");
        }
        if !of_kind(Kind::Vertex).all(|e| (0..3).all(|axis| has(e, Meaning::Axis(axis)))) {
            return fault("the vertices must have one x, one y and one z");
        }
        let mut with_corners = of_kind(Kind::Face).chain(of_kind(Kind::Strip));
        if !with_corners.all(|element| element.count == 0 || has(element, Meaning::Corners)) {
            return fault("the faces must have one list \"vertex_indices\" of whole numbers");
        }
        Ok(())
    }

    /// Refuses lists that may be faces under another name: without them, a mesh would be read as bare points,
    /// or in part. Where there are faces, or under the vertices, only the list's name decides.
    fn refuse_other_faces(&self) -> Result<(), ScanFault> {
        let present = || self.elements.iter().filter(|element| element.count > 0);
        let has_faces = present().any(|element| element.kind.has_corners());
        for element in present().filter(|element| !element.kind.has_corners()) {
            let may_be_any = element.kind == Kind::Other && !has_faces;
            let may_be_faces = |property: &&Property| match property.shape {
                Shape::List { item, .. } => {
                    matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
                        || (may_be_any && item.is_whole())
                }
                Shape::One(_) => false,
            };
            if let Some(list) = element.properties.iter().find(may_be_faces) {
                let what = format!(
                    "the list \"{}\" of the element \"{}\" may be the mesh, which is read under the \
                     name \"face\" only; export it so, or in another format",
                    list.name, element.name
                );
                return Err(malformed(list.line, what));
            }
        }
        Ok(())
    }
}

/// Whether a text begins with the first line of a PLY file and continues after it.
pub(in super::super) fn opens(text: &[u8]) -> bool {
    first_line(text, false).is_some_and(|(line, end)| is_opening(line) && end < text.len())
}

fn is_opening(line: &[u8]) -> bool {
    line.trim_ascii_end().eq_ignore_ascii_case(b"ply")
}

/// The offset of the header's second line.
fn opening(bytes: &[u8]) -> Result<usize, ScanFault> {
    let (line, end) = match first_line(bytes, false) {
        Some((line, end)) => (line, Some(end)),
        None => (bytes, None),
    };
    let begins = b"ply".get(..line.len()).is_some_and(|part| part.eq_ignore_ascii_case(line));
    match end {
        Some(end) if is_opening(line) => Ok(end),
        None if is_opening(line) || begins => Err(no_end()),
        _ => Err(ScanFault::NotThisFormat { format: Format::Ply, line: 1, found: excerpt(line) }),
    }
}

/// The first line, and its length with its line end: LF, CR, or CR LF unless lines end in CR alone.
fn first_line(text: &[u8], ends_in_cr: bool) -> Option<(&[u8], usize)> {
    let length = text.iter().position(|byte| matches!(byte, b'\n' | b'\r'))?;
    let (line, rest) = text.split_at(length);
    let has_two = !ends_in_cr && rest.starts_with(b"\r\n");
    Some((line, length + if has_two { 2 } else { 1 }))
}

fn no_end() -> ScanFault {
    cut_short(CutSign::NoEnd { mark: "\"end_header\"" })
}

fn unreadable(line: &[u8], number: usize) -> ScanFault {
    malformed(number, format!("\"{}\" is no line of a PLY header", excerpt(line)))
}

fn encoding_of(word: Option<&[u8]>, line: usize) -> Result<Encoding, ScanFault> {
    match word.unwrap_or_default() {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        other => Err(malformed(line, format!("\"{}\" is no PLY encoding", excerpt(other)))),
    }
}

fn element<'a>(
    words: &mut impl Iterator<Item = &'a [u8]>,
    line: &[u8],
    number: usize,
) -> Result<Element, ScanFault> {
    let name = words.next().ok_or_else(|| unreadable(line, number))?;
    let kind = match name {
        b"vertex" => Kind::Vertex,
        b"face" => Kind::Face,
        b"tristrips" => Kind::Strip,
        _ => Kind::Other,
    };
    let count = words.next().and_then(whole).ok_or_else(|| unreadable(line, number))?;
    Ok(Element { name: excerpt(name), kind, count, properties: Vec::new() })
}

fn property<'a>(
    kind: Kind,
    words: &mut impl Iterator<Item = &'a [u8]>,
    line: &[u8],
    number: usize,
) -> Result<Property, ScanFault> {
    let scalar = |word: Option<&[u8]>| word.and_then(Scalar::from_word);
    let first = words.next();
    let shape = if first == Some(b"list") {
        let count = scalar(words.next()).filter(|count| count.is_whole());
        count.zip(scalar(words.next())).map(|(count, item)| Shape::List { count, item })
    } else {
        scalar(first).map(Shape::One)
    };
    let (Some(shape), Some(name)) = (shape, words.next()) else {
        return Err(unreadable(line, number));
    };
    Ok(Property { name: excerpt(name), line: number, shape, meaning: kind.meaning(name, shape) })
}
