//! The verbs about all that a station holds of one person.

use std::ffi::OsString;
use std::path::PathBuf;

use super::AskArgs;

/// `gaiter patient affected`
#[derive(Debug, clap::Args)]
pub struct AffectedArgs {
    /// The affected leg, both or none of them; not-named takes it back
    #[arg(value_name = "LEG", value_parser = ["left", "right", "both", "none", "not-named"])]
    pub leg: String,
    /// A patient's id that does not belong here: it is only taken to say so.
    #[arg(hide = true)]
    pub stray: Option<OsString>,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}

/// `gaiter patient disclose`
#[derive(Debug, clap::Args)]
pub struct DiscloseArgs {
    /// A patient's id that does not belong here: it is only taken to say so.
    #[arg(hide = true)]
    pub stray: Option<OsString>,
    /// The folder to write; there must be none of this name
    #[arg(long, value_name = "DIR", default_value = "disclosure")]
    pub out: PathBuf,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}

/// `gaiter patient erase`
#[derive(Debug, clap::Args)]
pub struct EraseArgs {
    /// A patient's id that does not belong here: it is only taken to say so.
    #[arg(hide = true)]
    pub stray: Option<OsString>,
    /// Do not wait for servers where records are still to be taken back or corrected: they stay there as they are,
    /// and STATE/erasures lists them
    #[arg(long)]
    pub leave_at_servers: bool,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}
