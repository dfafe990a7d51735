//! Bytes → [`Scan`]: points and triangles as the scanner wrote them, in the export's own unit.
//!
//! One decoder per format. The file-name ending says the format; the content must agree with it.
//! A decoder also says when a file is cut short, so that the station can wait for the rest.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod format;
pub mod obj;
pub mod ord;

use nalgebra::Point3;

pub use format::Format;

/// One export of the scanner, undecorated: no unit, no up axis, no order that means anything.
///
/// Invariants, held by the decoders: every coordinate is finite; every triangle index is within
/// `points`; no triangle uses a point twice; there is at least one triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// Points in the export's own unit and axes.
    pub points: Vec<Point3<f64>>,
    /// Triangles as indices into `points`; their orientation is not relied upon.
    pub triangles: Vec<[u32; 3]>,
}

/// Why bytes are not a scan. `code` is stable and goes into `reason.json`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScanFault {
    /// The file has no bytes or only white space.
    #[error("the file is empty; export it again")]
    Empty,
    /// The file-name ending is none that gaiter reads.
    #[error("the ending {ending:?} is no scan format that gaiter reads (it reads .obj)")]
    UnknownEnding {
        /// The ending as found, without the dot; empty when the name has none.
        ending: String,
    },
    /// The content is not what the ending says.
    #[error("line {line}: \"{found}\" is not OBJ; is this file really a Wavefront OBJ?")]
    NotThisFormat {
        /// 1-based line of the first statement that does not belong.
        line: usize,
        /// That statement's beginning, printable characters only.
        found: String,
    },
    /// The bytes hold characters that no text format holds.
    #[error("byte {at} is {value:#04x}: the file is binary, not the text its ending says")]
    Binary {
        /// 0-based offset of the first such byte.
        at: usize,
        /// The byte.
        value: u8,
    },
    /// The file stops in the middle: more is expected.
    #[error("the file is cut short: {what}")]
    CutShort {
        /// What shows it, with figures.
        what: CutSign,
    },
    /// A coordinate is not a finite number.
    #[error("{}the coordinate \"{found}\" is not a finite number", place(*line))]
    NotFinite {
        /// 1-based line, 0 where the reader does not say.
        line: usize,
        /// The text of the coordinate.
        found: String,
    },
    /// Statements but not one point.
    #[error("the file holds not one point: there is no body in it; scan and export again")]
    NoPoints,
    /// Points but not one triangle.
    #[error("{points} points but no faces: a bare point cloud cannot be measured")]
    NoFaces {
        /// Number of points read.
        points: usize,
    },
    /// The reader of the format refused the file.
    #[error("{}{what}", place(*line))]
    Malformed {
        /// 1-based line, 0 where the reader does not say.
        line: usize,
        /// What the reader said.
        what: String,
    },
}

/// The place of a fault as a message begins with it; nothing where it is not known.
fn place(line: usize) -> String {
    if line == 0 { String::new() } else { format!("line {line}: ") }
}

/// What shows that a file was cut short.
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
    /// Points that no face uses: the face list was cut.
    #[error("{unused} of {points} points belong to no face; export it again")]
    UnusedPoints {
        /// Number of points that no face uses.
        unused: usize,
        /// Number of points.
        points: usize,
    },
}

impl ScanFault {
    /// The stable code of this fault, for `reason.json` and programs.
    pub fn code(&self) -> &'static str {
        match self {
            ScanFault::Empty => "scan-empty",
            ScanFault::UnknownEnding { .. } => "scan-unknown-ending",
            ScanFault::NotThisFormat { .. } => "scan-not-this-format",
            ScanFault::Binary { .. } => "scan-binary",
            ScanFault::CutShort { .. } => "scan-cut-short",
            ScanFault::NotFinite { .. } => "scan-not-finite",
            ScanFault::NoPoints => "scan-no-points",
            ScanFault::NoFaces { .. } => "scan-no-faces",
            ScanFault::Malformed { .. } => "scan-malformed",
        }
    }

    /// Whether more bytes could still mend the file, so that waiting makes sense.
    pub fn may_be_mended_by_waiting(&self) -> bool {
        matches!(self, ScanFault::Empty | ScanFault::CutShort { .. })
    }
}

/// Decodes the bytes of one export.
///
/// # Errors
/// The first fault found, with its place; see [`ScanFault`].
pub fn read(bytes: &[u8], format: Format) -> Result<Scan, ScanFault> {
    match format {
        Format::Obj => obj::read(bytes),
    }
}

/// Says whether bytes are cut short, without decoding them whole; cheap enough for every look.
///
/// # Errors
/// [`ScanFault::Empty`] or [`ScanFault::CutShort`]; other faults are left to [`read`].
pub fn completeness(bytes: &[u8], format: Format) -> Result<(), ScanFault> {
    match format {
        Format::Obj => obj::completeness(bytes),
    }
}
