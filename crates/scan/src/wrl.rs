//! VRML 1 and VRML 2 (97) scenes, as text.
//!
//! Reads `IndexedFaceSet` and `PointSet` with their `Coordinate` or `Coordinate3`, anywhere in groups and
//! transforms, once for every `USE`. Of a `Switch` it reads the chosen child, of an `LOD` the first, which is
//! the finest. Everything that only colours, lights or moves the scene is skipped, including `ROUTE`; so are
//! lines, text and the primitive solids. Faces are turned round where `ccw` or, in VRML 1, `vertexOrdering`
//! declares them clockwise. Refuses everything that could hide a part of the body: `PROTO`, `EXTERNPROTO`,
//! `Inline`, `WWWInline`, and points within a node that gaiter does not know.

mod placement;
mod reader;
mod scene;
mod walk;
mod words;

use super::fault::{ScanFault, malformed};
use super::format::Format;
use super::weld::welded;
use super::{Scan, text};

/// The version of VRML, which determines the meaning of nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    /// 1.0: nodes change a state that applies to later nodes.
    One,
    /// 2.0, also called VRML 97: nodes contain each other in fields.
    Two,
}

/// Decodes a complete VRML scene.
///
/// # Errors
/// See [`ScanFault`]; the first fault found, with its line.
pub(super) fn read(bytes: &[u8]) -> Result<Scan, ScanFault> {
    let bytes = text::without_mark(bytes);
    let version = version(bytes)?;
    Ok(welded(walk::geometry(&reader::nodes(bytes, version)?)?))
}

/// Checks that every bracket is closed and that the scene ends after one.
///
/// # Errors
/// [`ScanFault::CutShort`] if a bracket is open, [`ScanFault::Binary`].
pub(super) fn completeness(bytes: &[u8]) -> Result<(), ScanFault> {
    text::refuse_binary(bytes)?;
    if words::is_closed(text::without_mark(bytes)) {
        return Ok(());
    }
    Err(reader::no_end())
}

/// The version in the first line, which is mandatory.
fn version(bytes: &[u8]) -> Result<Version, ScanFault> {
    let first = text::lines(bytes).next().unwrap_or_default();
    let mut words = text::words(first);
    match (words.next(), words.next()) {
        (Some(b"#VRML"), Some(b"V1.0")) => Ok(Version::One),
        (Some(b"#VRML"), Some(b"V2.0")) => Ok(Version::Two),
        (Some(b"#VRML"), Some(other)) => {
            let what = format!("VRML {} is not read; export VRML 2", text::excerpt(other));
            Err(malformed(1, what))
        }
        _ => {
            let found = text::excerpt(first);
            Err(ScanFault::NotThisFormat { format: Format::Wrl, line: 1, found })
        }
    }
}
