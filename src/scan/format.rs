//! The formats of scans, by file-name ending.

use super::ScanFault;

/// A scan format that gaiter reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, text: a mesh, or points alone.
    Obj,
    /// Polygon File Format of Stanford, text or binary of either byte order: a mesh or points.
    Ply,
    /// Stereolithography, text or binary: triangles.
    Stl,
    /// VRML 1 and VRML 2 (97), text: a scene of meshes or points.
    Wrl,
    /// Plain points, a line each, text.
    Xyz,
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
            "ply" => Ok(Format::Ply),
            "stl" => Ok(Format::Stl),
            "wrl" => Ok(Format::Wrl),
            "xyz" | "asc" | "txt" => Ok(Format::Xyz),
            _ => Err(ScanFault::UnknownEnding { ending: ending.to_owned() }),
        }
    }

    /// The usual ending of files of this format, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Stl => "stl",
            Format::Wrl => "wrl",
            Format::Xyz => "xyz",
        }
    }

    /// The format's name with its article, for a question.
    pub(super) fn in_full(self) -> &'static str {
        match self {
            Format::Obj => "a Wavefront OBJ",
            Format::Ply => "a PLY",
            Format::Stl => "an STL",
            Format::Wrl => "a VRML scene",
            Format::Xyz => "a list of points",
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(match self {
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Stl => "STL",
            Format::Wrl => "VRML",
            Format::Xyz => "XYZ",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ending_names_its_format_in_any_letter_case() {
        let endings = [
            ("a.obj", Format::Obj),
            ("4711_a.PLY", Format::Ply),
            ("a.b.Stl", Format::Stl),
            ("a.WRL", Format::Wrl),
            ("a.xyz", Format::Xyz),
            ("a.ASC", Format::Xyz),
            ("a.txt", Format::Xyz),
        ];
        for (name, format) in endings {
            assert_eq!(Format::of_file_name(name), Ok(format));
        }
        for name in ["a", "a.obj.part", "a.x3d", "obj"] {
            assert!(Format::of_file_name(name).is_err(), "{name}");
        }
    }

    #[test]
    fn the_usual_ending_leads_back_to_the_format() {
        for format in [Format::Obj, Format::Ply, Format::Stl, Format::Wrl, Format::Xyz] {
            assert_eq!(Format::of_file_name(&format!("scan.{}", format.ending())), Ok(format));
        }
    }
}
