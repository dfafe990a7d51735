//! `gaiter compare` and `gaiter patient visits`.

use std::ffi::OsString;
use std::path::PathBuf;

use gaiter_language::Language;
use gaiter_leg::comparison::tape_volume::VolumeBy;
use gaiter_record::report::Paper;
use gaiter_visits::Affected;

use super::{of_words, usual_config};
use crate::config::words::{AFFECTED, LANGUAGES, PAPERS, VOLUMES};

/// `gaiter compare`
#[derive(Debug, clap::Args)]
pub struct CompareArgs {
    /// Record folders or record.json files, in any order; or a patient's folder, of which the last scan of
    /// each day counts
    #[arg(value_name = "RECORD", required = true)]
    pub records: Vec<PathBuf>,
    /// How they are compared, and what becomes of it.
    #[command(flatten)]
    pub how: CompareChoice,
}

/// `gaiter patient visits`
#[derive(Debug, clap::Args)]
pub struct VisitsArgs {
    /// A patient's id that does not belong here: it is only taken to say so.
    #[arg(hide = true)]
    pub stray: Option<OsString>,
    /// How they are compared, and what becomes of it.
    #[command(flatten)]
    pub how: CompareChoice,
}

/// How visits are compared, and what becomes of the comparison.
#[derive(Debug, clap::Args)]
pub struct CompareChoice {
    /// How all volumes are made of girths [default: as the records say]
    #[arg(long, value_parser = of_words(VOLUMES))]
    pub volume: Option<VolumeBy>,
    /// The affected leg, of which the excess volume is told [default: as `gaiter patient affected` named it; none is
    /// guessed]
    #[arg(long, value_name = "LEG", value_parser = of_words(AFFECTED))]
    pub affected: Option<Affected>,
    /// Write visits.html, visits.pdf and visits.json into this folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files that are already in it
    #[arg(long, requires = "out")]
    pub force: bool,
    /// The paper of the PDF, and of what a browser prints
    #[arg(long, value_parser = of_words(PAPERS), default_value = "A4")]
    pub paper: Paper,
    /// Print the comparison as JSON, for programs
    #[arg(long)]
    pub json: bool,
    /// The language of the text [default: en, or that of the configuration]
    #[arg(long, visible_alias = "lang", value_parser = of_words(LANGUAGES))]
    pub language: Option<Language>,
    /// The configuration with language, thresholds and the scanner's error; the variable GAITER_CONFIG
    /// names another default
    #[arg(long, value_name = "FILE", default_value_os_t = usual_config())]
    pub config: PathBuf,
}
