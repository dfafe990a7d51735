//! The formats of scans, by file-name ending.

use super::ScanFault;

/// A scan format that gaiter reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, text.
    Obj,
}

impl Format {
    /// The format of a file name, by its ending, letter case aside.
    ///
    /// # Errors
    /// [`ScanFault::UnknownEnding`] where the ending is none of ours.
    pub fn of_file_name(name: &str) -> Result<Format, ScanFault> {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        match ending.to_ascii_lowercase().as_str() {
            "obj" => Ok(Format::Obj),
            _ => Err(ScanFault::UnknownEnding { ending: ending.to_owned() }),
        }
    }

    /// The ending that files of this format carry, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Obj => "obj",
        }
    }
}
