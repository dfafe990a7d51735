//! `gaiter order`.

use std::path::PathBuf;

use gaiter_language::Language;

use super::{GarmentArgs, of_words, usual_config};
use crate::config::words::{LANGUAGES, Words};

/// `gaiter order`
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct OrderArgs {
    /// Check mappings, or write an order.
    #[command(subcommand)]
    pub verb: Option<OrderVerb>,
    /// What is ordered.
    #[command(flatten)]
    pub of: OrderOf,
}

/// `gaiter order RECORD`
#[derive(Debug, clap::Args)]
pub struct OrderOf {
    /// A record folder, a record.json, or a patient's folder, whose newest record is taken
    #[arg(value_name = "RECORD", required = true)]
    pub record: Option<PathBuf>,
    /// The garment that is ordered
    #[command(flatten)]
    pub garment: GarmentArgs,
    /// Write the file that this mapping describes, instead of the tables order.csv and order-spreadsheet.csv
    #[arg(long, value_name = "FILE")]
    pub mapping: Option<PathBuf>,
    /// The reference by which shop and maker know the order; never a patient's id or name
    #[arg(long = "ref", value_name = "TEXT")]
    pub order_ref: Option<String>,
    /// Order again: exactly as the last time, or with the changes since then
    #[arg(long, value_parser = of_words(REPEATS), requires = "last")]
    pub reorder: Option<Repeat>,
    /// The order.json of the last order, for --reorder
    #[arg(long, value_name = "ORDER.json", requires = "reorder")]
    pub last: Option<PathBuf>,
    /// Write the files to this folder; otherwise the order is printed
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace files that already exist
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Print the order as JSON; with --out, the paths of the files
    #[arg(long)]
    pub json: bool,
    /// The language of the text, and of order-spreadsheet.csv [default: en, or that of the configuration]
    #[arg(long, visible_alias = "lang", value_parser = of_words(LANGUAGES))]
    pub language: Option<Language>,
    /// The configuration with garment, language and scanner; the variable GAITER_CONFIG names another default
    #[arg(long, value_name = "FILE", default_value_os_t = usual_config())]
    pub config: PathBuf,
}

/// How an order is repeated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Repeat {
    /// With the figures of the last one.
    Exact,
    /// With the figures of another scan beside them.
    Changes,
}

/// `--reorder`
const REPEATS: Words<Repeat> = &[("exact", Repeat::Exact), ("changes", Repeat::Changes)];

/// `gaiter order …`
#[derive(Debug, clap::Subcommand)]
pub enum OrderVerb {
    /// Check mapping files: names every fault with its line
    ///
    /// A mapping with a fault is never used. Exits with 65 if one has a fault.
    Check(OrderCheckArgs),
}

/// `gaiter order check`
#[derive(Debug, clap::Args)]
pub struct OrderCheckArgs {
    /// Mapping files (gaiter-order-mapping/1), or folders of them
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Print the result as JSON, for programs
    #[arg(long)]
    pub json: bool,
}
