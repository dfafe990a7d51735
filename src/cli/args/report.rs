//! `gaiter report`.

use std::path::PathBuf;

use gaiter_language::Language;
use gaiter_record::report::Paper;

use super::{GarmentArgs, of_words};
use crate::config::words::{LANGUAGES, PAPERS};

/// `gaiter report`
#[derive(Debug, clap::Args)]
pub struct ReportArgs {
    /// A record folder, or a record.json
    #[arg(value_name = "RECORD")]
    pub record: PathBuf,
    /// The language of the report
    #[arg(long, value_parser = of_words(LANGUAGES), default_value = "en")]
    pub language: Language,
    /// The garment that is ordered: the sheet says which of its measures are missing
    #[command(flatten)]
    pub garment: GarmentArgs,
    /// A size table whose sizes the report shows, or a folder of them; may be repeated
    #[arg(long = "table", value_name = "FILE")]
    pub tables: Vec<PathBuf>,
    /// The paper of the PDF, and of what a browser prints
    #[arg(long, value_parser = of_words(PAPERS), default_value = "A4")]
    pub paper: Paper,
    /// End the PDF with the engineering figures: the fit of the surface, and every figure in mm
    #[arg(long)]
    pub appendix: bool,
    /// Folder for the report [default: the current folder]
    #[arg(long, value_name = "DIR", default_value = ".", hide_default_value = true)]
    pub out: PathBuf,
    /// Replace a report that already exists
    #[arg(long)]
    pub force: bool,
    /// Print the paths of the files as one JSON object, for programs
    #[arg(long)]
    pub json: bool,
}
