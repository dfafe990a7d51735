//! Why bytes are not a scan: the fault, its place and its details.

use super::format::{Content, Format};

/// Why bytes are not a scan. `code` is stable and goes into `reason.json`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScanFault {
    /// The file is empty or contains only white space.
    #[error("the file is empty; export it again")]
    Empty,
    /// The file-name ending is not one that gaiter reads.
    #[error(
        "the ending {ending:?} is not a scan format that gaiter reads (it reads .obj, .ply, .stl, \
         .wrl, .xyz, .asc and .txt)"
    )]
    UnknownEnding {
        /// The ending as found, without the dot; empty if the name has none.
        ending: String,
    },
    /// The content clearly contradicts the file-name ending.
    #[error("the content looks like {content}, not {format}; {}", content.advice())]
    LooksLike {
        /// The detected content.
        content: Content,
        /// The format given by the ending.
        format: Format,
    },
    /// The content does not match the ending, and is not anything else that gaiter knows.
    #[error("line {line}: \"{found}\" is not {format}; is this file really {}?", format.in_full())]
    NotThisFormat {
        /// The format given by the ending.
        format: Format,
        /// 1-based line of the first statement that does not belong to the format.
        line: usize,
        /// The beginning of that statement, printable characters only.
        found: String,
    },
    /// The bytes include characters that do not occur in any text format.
    #[error("byte {at} is {value:#04x}: the file is binary, not the text its ending says")]
    Binary {
        /// 0-based offset of the first such byte.
        at: usize,
        /// The byte.
        value: u8,
    },
    /// The file stops in the middle.
    #[error("the file is cut short: {what}")]
    CutShort {
        /// The evidence, with details.
        what: CutSign,
    },
    /// The file is longer than it declares.
    #[error("the file has {has} {what} but states {says}; export it again")]
    TooLong {
        /// The unit of the counts: bytes, lines, points.
        what: &'static str,
        /// The actual number.
        has: usize,
        /// The declared number.
        says: usize,
    },
    /// A coordinate is not a finite number.
    #[error("{place}the coordinate \"{found}\" is not a finite number")]
    NotFinite {
        /// Its place.
        place: SourcePosition,
        /// The text of the coordinate.
        found: String,
    },
    /// The file has statements but no points.
    #[error("the file holds no points: there is no body in it; scan and export again")]
    NoPoints,
    /// The file violates the format.
    #[error("{place}{what}")]
    Malformed {
        /// Its place.
        place: SourcePosition,
        /// What is wrong, what was found and how to correct it.
        what: String,
    },
}

/// The place of a fault in a file. Displayed as the beginning of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourcePosition {
    /// Unknown.
    Unknown,
    /// A 1-based line of a text file.
    Line(usize),
    /// One record of a binary file.
    Record {
        /// The kind of record: vertex, face, triangle.
        name: &'static str,
        /// Its 1-based number.
        number: usize,
        /// 0-based offset of the first wrong byte.
        byte: usize,
    },
}

impl std::fmt::Display for SourcePosition {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SourcePosition::Unknown => Ok(()),
            SourcePosition::Line(line) => write!(out, "line {line}: "),
            SourcePosition::Record { name, number, byte } => {
                write!(out, "{name} {number}, byte {byte}: ")
            }
        }
    }
}

/// Evidence that a file was cut short.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CutSign {
    /// The last line has no line end.
    #[error(
        "line {line}, the last, has no line end; export it again (if your exporter never writes \
         a last line end, tell us)"
    )]
    NoLineEnd {
        /// 1-based number of that line.
        line: usize,
    },
    /// Points of the skin that no face uses, so the face list was cut.
    #[error("{unused} of {points} points belong to no face; export it again")]
    UnusedPoints {
        /// Number of these points.
        unused: usize,
        /// Number of points.
        points: usize,
    },
    /// Fewer records than declared.
    #[error("{has} of {of} {what}; export it again")]
    Missing {
        /// The kind of record.
        what: &'static str,
        /// The number of complete records.
        has: usize,
        /// The declared number.
        of: usize,
    },
    /// The mark that ends every file of this format is missing.
    #[error("its end, {mark}, is missing; export it again")]
    NoEnd {
        /// The mark, as the operator would search for it.
        mark: &'static str,
    },
    /// Space that was reserved but not written yet.
    #[error("its last {bytes} bytes are zero, reserved but not written; export it again")]
    Unwritten {
        /// Number of zero bytes at the end.
        bytes: usize,
    },
    /// Like [`CutSign::Unwritten`], but in the middle of a text.
    #[error("{bytes} bytes from byte {at} on are zero, not written yet; export it again")]
    Hole {
        /// 0-based offset of the first zero byte.
        at: usize,
        /// Number of zero bytes.
        bytes: usize,
    },
}

impl ScanFault {
    /// The stable code of this fault, for `reason.json` and programs.
    pub fn code(&self) -> &'static str {
        match self {
            ScanFault::Empty => "scan-empty",
            ScanFault::UnknownEnding { .. } => "scan-unknown-ending",
            ScanFault::LooksLike { .. } | ScanFault::NotThisFormat { .. } => "scan-not-this-format",
            ScanFault::Binary { .. } => "scan-binary",
            ScanFault::CutShort { .. } => "scan-cut-short",
            ScanFault::TooLong { .. } => "scan-too-long",
            ScanFault::NotFinite { .. } => "scan-not-finite",
            ScanFault::NoPoints => "scan-no-points",
            ScanFault::Malformed { .. } => "scan-malformed",
        }
    }

    /// Whether more bytes could still complete the file, so that waiting makes sense.
    pub fn may_be_mended_by_waiting(&self) -> bool {
        matches!(self, ScanFault::Empty | ScanFault::CutShort { .. })
    }
}

/// Creates a [`ScanFault::CutShort`] from its evidence.
pub(super) fn cut_short(what: CutSign) -> ScanFault {
    ScanFault::CutShort { what }
}

/// Creates a [`ScanFault::Malformed`] for a line of text.
pub(super) fn malformed(line: usize, what: impl Into<String>) -> ScanFault {
    ScanFault::Malformed { place: SourcePosition::Line(line), what: what.into() }
}
