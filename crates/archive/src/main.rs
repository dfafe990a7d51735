//! The archive of many stations: index, workers and questions on PostgreSQL and object storage.
//!
#![doc = include_str!("../README.md")]

mod check;
mod config;
mod database;
mod export;
mod fault;
mod figures;
mod index;
mod measure;
mod objects;
mod query;
mod reextract;
mod status;
mod work;

use std::fmt::Display;
use std::io::{self, Write};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use fault::ArchiveFault;

/// The command line is wrong.
const EXIT_USAGE: u8 = 64;

/// The archive of many stations.
#[derive(Debug, Parser)]
#[command(version)]
struct Args {
    #[arg(long, global = true, default_value = "/etc/gaiter/archive.toml")]
    config: PathBuf,
    /// What to do.
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Indexes what stations announce, and what they say of themselves; continues until it is stopped.
    Index {
        /// Make a lost database again from the objects, first.
        #[arg(long)]
        reconcile: bool,
        /// End when all that is there is indexed.
        #[arg(long)]
        once: bool,
    },
    /// Measures what is to be measured; continues until it is stopped. SIGTERM hands back what it has claimed, and it
    /// ends with 75.
    Work {
        /// End when nothing is left to be measured.
        #[arg(long)]
        until_empty: bool,
    },
    /// What the archive holds, what to do, how the stations are.
    Status {
        /// For programs.
        #[arg(long)]
        json: bool,
        /// Serve it at this address instead, as a page and, under /metrics, for Prometheus.
        #[arg(long, conflicts_with = "json")]
        listen: Option<SocketAddr>,
    },
    /// Answers a question, as CSV.
    Query {
        /// calf-by-stature, repeatability, phantom-drift, or a statement in SQL.
        question: String,
        #[arg(long)]
        json: bool,
    },
    /// Writes the figures of all scans as Parquet, a file for each method and month; replaces those of before.
    Export { folder: PathBuf },
    /// Tries out configuration, database, bucket and confinement.
    Check,
    /// Measures all scans by the method of this version: a sample first, then, with --go, all others.
    Reextract(reextract::Choice),
    /// Writes the manual to a folder, a page for each verb.
    Man { folder: PathBuf },
    /// The worker's measuring process.
    #[command(name = measure::VERB, hide = true)]
    Measure,
}

fn main() -> ExitCode {
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(said) => {
            let _ = said.print();
            return ExitCode::from(if said.use_stderr() { EXIT_USAGE } else { 0 });
        }
    };
    match run(args) {
        Ok(code) => code,
        Err(fault) => {
            note(format_args!("gaiter-archive: {}", fault::chain(&fault)));
            ExitCode::from(fault.exit_code())
        }
    }
}

fn run(args: Args) -> Result<ExitCode, ArchiveFault> {
    let config = || config::read(&args.config);
    match args.verb {
        // It gets no configuration, and reads no file.
        Verb::Measure => measure::serve(io::stdin().lock(), io::stdout().lock())?,
        Verb::Man { folder } => clap_mangen::generate_to(Args::command(), folder)?,
        Verb::Index { reconcile, once } => index::index(&config()?, reconcile, once)?,
        Verb::Work { until_empty } => return work::work(&config()?, until_empty),
        Verb::Status { listen: Some(address), .. } => status::serve::serve(&config()?, address)?,
        Verb::Status { json, listen: None } => print(status::status(&config()?, json)?)?,
        Verb::Query { question, json } => query::query(&config()?, &question, json)?,
        Verb::Export { folder } => export::export(&config()?, &folder)?,
        Verb::Check => return check::check(&config()?),
        Verb::Reextract(choice) => return reextract::reextract(&config()?, &choice),
    }
    Ok(ExitCode::SUCCESS)
}

/// A line in the log.
fn note(text: impl Display) {
    // Nobody is left to be told that the log has gone.
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// What was asked for.
fn print(text: impl Display) -> io::Result<()> {
    writeln!(io::stdout().lock(), "{text}")
}
