//! The format given by the ending of a file name.

use super::fault::ScanFault;
use super::format::Format;

impl Format {
    /// All endings of file names that have a format, in lower case.
    pub const ENDINGS: [&str; 7] = ["obj", "ply", "stl", "wrl", "xyz", "asc", "txt"];

    /// The format of a file name, by its ending; upper and lower case are equal.
    ///
    /// # Errors
    /// [`ScanFault::UnknownEnding`] if the ending is not supported.
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
    fn every_ending_has_a_format() {
        for ending in Format::ENDINGS {
            assert!(Format::of_file_name(&format!("a.{ending}")).is_ok(), "{ending}");
        }
    }

    #[test]
    fn the_usual_ending_leads_back_to_the_format() {
        for format in [Format::Obj, Format::Ply, Format::Stl, Format::Wrl, Format::Xyz] {
            assert_eq!(Format::of_file_name(&format!("scan.{}", format.ending())), Ok(format));
        }
    }
}
