//! `gaiter sizes`.

use std::path::PathBuf;

use gaiter_language::Language;

use super::{GarmentArgs, of_words, usual_config};
use crate::config::words::LANGUAGES;

/// `gaiter sizes`
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct SizesArgs {
    /// Check tables, or judge a record.
    #[command(subcommand)]
    pub verb: Option<SizesVerb>,
    /// What is judged.
    #[command(flatten)]
    pub of: SizesOf,
}

/// `gaiter sizes RECORD`
#[derive(Debug, clap::Args)]
pub struct SizesOf {
    /// A record folder, or a record.json
    #[arg(value_name = "RECORD", required = true)]
    pub record: Option<PathBuf>,
    /// A size table, or a folder of them; may be repeated [default: those of the configuration]
    #[arg(long = "table", value_name = "FILE")]
    pub tables: Vec<PathBuf>,
    /// The garment that is ordered
    #[command(flatten)]
    pub garment: GarmentArgs,
    /// Print the verdicts as JSON, for programs
    #[arg(long)]
    pub json: bool,
    /// The language of the text [default: en, or that of the configuration]
    #[arg(long, visible_alias = "lang", value_parser = of_words(LANGUAGES))]
    pub language: Option<Language>,
    /// The configuration with tables, garment and language; the variable GAITER_CONFIG names another
    /// default
    #[arg(long, value_name = "FILE", default_value_os_t = usual_config())]
    pub config: PathBuf,
}

/// `gaiter sizes …`
#[derive(Debug, clap::Subcommand)]
pub enum SizesVerb {
    /// Check size tables: faults, gaps, overlaps, missing names, age
    ///
    /// Names every fault of a file with its line; a table with a fault is never used. Of a table without
    /// faults, names what a person should know: gaps and overlaps between neighbours, touching limits, a
    /// table that is expired, not signed by two persons, a draft or only for tests. Exits with 65 if a
    /// table has a fault, with 0 if there are only remarks.
    Check(SizesCheckArgs),
}

/// `gaiter sizes check`
#[derive(Debug, clap::Args)]
pub struct SizesCheckArgs {
    /// Size tables, or folders of them
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// A file with a garment of your own, which the tables name, or a folder of them
    #[arg(long, value_name = "FILE")]
    pub garment_file: Option<PathBuf>,
    /// Print the result as JSON, for programs
    #[arg(long)]
    pub json: bool,
    /// The language of the remarks; faults are told in English
    #[arg(long, visible_alias = "lang", value_parser = of_words(LANGUAGES), default_value = "en")]
    pub language: Language,
}
