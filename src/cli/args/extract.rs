//! The arguments of `gaiter extract`.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;

use gaiter_cad::FileKind;
use gaiter_language::Language;
use gaiter_leg::method::{FacingChoice, Posture, Scope, UnitChoice, Up, Winding};

use super::{GarmentArgs, of_words};
use crate::config::words::{
    self, FACINGS, FILES, HEIGHTS_CM, LANGUAGES, POSTURES, SCOPES, UNITS, UPS, WINDINGS,
};

/// `gaiter extract`; a choice that was not made is `None`, so that the configuration can make it.
#[derive(Debug, clap::Args)]
pub struct ExtractArgs {
    /// The scan files, as the scanner exported them (.obj, .ply, .stl, .wrl, .xyz, .asc, .txt), or
    /// folders of them
    #[arg(value_name = "SCAN", required = true)]
    pub scans: Vec<PathBuf>,
    /// Also look for scans in folders within folders
    #[arg(long)]
    pub recursive: bool,
    /// Number of scans to process at a time [default: number of processors]
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Print one JSON record per scan and line, for programs
    #[arg(long)]
    pub json: bool,
    /// Also write a record folder for every scan: DIR/NAME-OF-SCAN/
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// CAD files and meshes to make of each leg, with --out: --files step,iges,stl
    #[arg(
        long,
        value_name = "KIND,…",
        value_delimiter = ',',
        value_parser = of_words(FILES),
        requires = "out"
    )]
    pub files: Option<Vec<FileKind>>,
    /// Also write each figure of the report as an SVG file of its own, with --out
    #[arg(long, requires = "out")]
    pub figures: bool,
    /// The language of the report, with --out [default: en, or that of --config]
    #[arg(long, value_parser = of_words(LANGUAGES), requires = "out")]
    pub language: Option<Language>,
    /// The garment that is ordered: the sheet says which of its measures are missing
    #[command(flatten)]
    pub garment: GarmentArgs,
    /// What the scan contains: a whole body, or one leg with its foot; the scan does not show its side
    #[arg(long, value_parser = of_words(SCOPES))]
    pub scope: Option<Scope>,
    /// The unit of the scan's coordinates; auto finds it from the height of the body
    #[arg(long, value_parser = of_words(UNITS))]
    pub unit: Option<UnitChoice>,
    /// The axis of the scan that points up [default: y]
    #[arg(long, value_parser = of_words(UPS))]
    pub up: Option<Up>,
    /// The axis of the scan that the toes point along; auto finds it from the feet
    #[arg(long, value_parser = of_words(FACINGS), allow_hyphen_values = true)]
    pub facing: Option<FacingChoice>,
    /// Which way round the scan's triangles are wound [default: outward]
    #[arg(long, value_parser = of_words(WINDINGS))]
    pub winding: Option<Winding>,
    /// How the patient holds the legs; it stands in the record, and only scans of one posture are compared
    /// without a warning [default: both-legs]
    #[arg(long, value_parser = of_words(POSTURES))]
    pub posture: Option<Posture>,
    /// Heights above the floor at which girths are also measured, in cm: --at 10,20,30.5
    #[arg(long, value_name = "CM,…", value_delimiter = ',', value_parser = height_mm)]
    pub at: Option<Vec<f64>>,
    /// Take scope, unit, up, facing, method, output and language from this configuration, unless an
    /// option overrides them
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

/// Parses a height in cm and returns it in mm.
fn height_mm(text: &str) -> Result<f64, String> {
    let Range { start, end } = HEIGHTS_CM;
    words::height_mm(text)
        .ok_or_else(|| format!("a height in cm is more than {start} and less than {end}"))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::{ExtractArgs, FILES, words};
    use crate::cli::args::{Args, Verb};
    use gaiter_leg::method::{Axis, FacingChoice, Unit, UnitChoice, Up};

    fn extract(words: &[&str]) -> ExtractArgs {
        let line = ["gaiter", "extract"].iter().chain(words);
        match Args::try_parse_from(line).unwrap().verb {
            Verb::Extract(args) => args,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_negative_facing_is_a_value_and_not_an_option() {
        for words in [["a.obj", "--facing", "-x"], ["--facing", "-x", "a.obj"]] {
            let args = extract(&words);
            assert_eq!(args.facing, Some(FacingChoice::Declared(Axis::MinusX)));
            assert_eq!(args.scans.len(), 1);
        }
        let args = extract(&["a.obj", "--facing=+z"]);
        assert_eq!(args.facing, Some(FacingChoice::Declared(Axis::PlusZ)));
    }

    #[test]
    fn a_choice_that_was_not_made_is_left_open() {
        let args = extract(&["a.obj", "b.obj", "--json"]);
        assert_eq!((args.unit, args.up, args.facing), (None, None, None));
        assert_eq!(args.scans.len(), 2);
        assert!(args.json);
        let args = extract(&["a.obj", "--unit", "in", "--up", "z"]);
        assert_eq!(args.unit, Some(UnitChoice::Declared(Unit::In)));
        assert_eq!(args.up, Some(Up::Z));
    }

    #[test]
    fn heights_are_centimetres_with_or_without_decimals() {
        assert_eq!(extract(&["a.obj"]).at, None);
        for words in [["a.obj", "--at", "10,20,30.5"], ["--json", "--at=10,20,30.5", "a.obj"]] {
            let args = extract(&words);
            assert_eq!(args.at, Some(vec![100.0, 200.0, 305.0]));
            assert_eq!(args.scans.len(), 1);
        }
    }

    #[test]
    fn files_are_words_with_commas_between_and_need_a_place() {
        assert_eq!(extract(&["a.obj"]).files, None);
        let args = extract(&["a.obj", "--out", "d", "--files", "step,stl-solid"]);
        let kinds = ["step", "stl-solid"].map(|word| words::meaning(FILES, word).unwrap());
        assert_eq!(args.files.as_deref(), Some(kinds.as_slice()));
        let none = ["gaiter", "extract", "a.obj", "--files", "step"];
        assert!(Args::try_parse_from(none).is_err(), "there is no folder to put them into");
    }

    #[test]
    fn a_word_that_is_not_known_is_refused() {
        for words in
            [["--unit", "ft"], ["--up", "-y"], ["--facing", "x"], ["--at", "10,"], ["--at", "0"]]
                .into_iter()
                .chain(["step,dxf", "STEP", "step,", ""].map(|kinds| ["--files", kinds]))
                .chain(["200", "-5", "nan", "inf", "ten", "10;20", ""].map(|cm| ["--at", cm]))
        {
            let line = ["gaiter", "extract", "a.obj", "--out", "d"].iter().chain(&words);
            assert!(Args::try_parse_from(line).is_err(), "{words:?}");
        }
    }
}
