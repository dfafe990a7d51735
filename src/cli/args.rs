//! The command line as types, with the help texts a technician reads.

mod amend;
mod asking;
mod calibrate;
mod compare;
mod examples;
mod extract;
mod garment;
mod groups;
mod order;
mod person;
mod reextract;
mod report;
mod sizes;

use std::env;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Command, CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_complete::Shell;

use crate::config::words::{self, Words};
use crate::station::measure::VERB;
pub use amend::AmendArgs;
pub use asking::{
    AskArgs, AssignArgs, ExplainArgs, GdtOrderArgs, Named, OneArgs, ScansArgs, SetArgs,
    UnassignArgs,
};
pub use calibrate::CalibrateArgs;
pub use compare::{CompareArgs, CompareChoice, VisitsArgs};
pub use extract::ExtractArgs;
pub use garment::GarmentArgs;
pub use order::{OrderArgs, OrderCheckArgs, OrderOf, OrderVerb, Repeat};
pub use person::{AffectedArgs, DiscloseArgs, EraseArgs};
pub use reextract::ReextractArgs;
pub use report::ReportArgs;
pub use sizes::{SizesArgs, SizesCheckArgs, SizesOf, SizesVerb};

/// The station's configuration if neither `--config` nor the environment names one.
pub const DEFAULT_CONFIG: &str = "/etc/gaiter/station.toml";

/// The variable of the environment that names the station's configuration.
pub const CONFIG_VARIABLE: &str = "GAITER_CONFIG";

/// The station's configuration if `--config` does not name one.
pub fn usual_config() -> PathBuf {
    let named = env::var_os(CONFIG_VARIABLE).filter(|path| !path.is_empty());
    named.map_or_else(|| PathBuf::from(DEFAULT_CONFIG), PathBuf::from)
}

/// Measures both legs from a body scan.
///
/// gaiter runs beside a body scanner. It takes every scan that the scanner exports, and writes girths
/// and heights at B, B1, C and D, a surface and a report of both legs to the patient's folder.
#[derive(Debug, Parser)]
#[command(name = "gaiter", version)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

const EXIT_CODES: &str = "Exit codes: 0 done, 64 wrong command line, 65 a scan cannot be measured, \
66 no such file, 70 internal error, 74 reading or writing failed, 78 fault in the configuration.";

/// The whole command line, with examples and with its verbs in groups.
pub fn command() -> Command {
    let command = examples::with_examples(Args::command());
    let examples = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    groups::with_groups(command.after_help(format!("{examples}\n\n{EXIT_CODES}")))
}

impl Args {
    /// The arguments of this process.
    ///
    /// # Errors
    /// clap's, with the text to print; also for the help and the version.
    pub fn of_process() -> Result<Args, clap::Error> {
        Args::from_arg_matches(&command().try_get_matches()?)
    }
}

/// The verbs of gaiter.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Show a whole station at work, with a simulated scanner
    ///
    /// Needs no configuration. Starts a real station in the new folder ./demo, lets a simulated scanner
    /// export a few scans into it, and shows the measures and where the records are. Takes less than a
    /// minute.
    Demo(DemoArgs),
    /// Run the station: wait for scans and write records to the stores
    ///
    /// Runs until it is stopped (Ctrl-C or SIGTERM). Usually systemd starts it. Check the configuration
    /// with `gaiter check` first.
    Run(RunArgs),
    /// Measure scan files now, without a station
    ///
    /// Prints a table of both legs for each scan, and for several scans a summary with one row each.
    /// For a folder, measures all scans in it except hidden files, in the order of their names.
    Extract(ExtractArgs),
    /// Measure a body of known girths to check scanner and method
    ///
    /// Says how far off they are: compares the girths of a cylinder, a cone or another body with the known
    /// ones. Changes nothing; a station keeps a series of such checks by itself if `phantom.girths` is
    /// configured. Exits with 65 also if a girth is beyond the tolerance.
    Calibrate(CalibrateArgs),
    /// Measure the scans of a record store again
    ///
    /// Uses the current method. If the result differs from the record, writes a new revision beside it, in
    /// a folder of the same name with _r2, _r3 …; never changes the old one. Prints at the end what changed
    /// and by how much. A station may run at the same time. A second run adds nothing.
    Reextract(ReextractArgs),
    /// Write the report of a record again, in English or German
    ///
    /// Uses only record.json; the scan is not needed, and nothing is measured. The record is not
    /// changed, because its folder's SHA256SUMS would then be wrong.
    Report(ReportArgs),
    /// Say which sizes of makers' tables fit, or check such tables
    ///
    /// Shows every size that the deciding point allows, with each point's margins to its limits and the
    /// probability that it lies inside; several tables side by side. Never chooses a size. Also names
    /// calibre jumps: where the girth changes by more than the length.
    Sizes(SizesArgs),
    /// Compare the visits of a patient
    ///
    /// Compares girths at the same lengths along the leg, and volumes made of them, with the uncertainty that
    /// every difference has. Says larger, smaller or no change shown. Refuses records whose figures mean
    /// different things, and records of different patients.
    Compare(CompareArgs),
    /// Write an order from a record, or check files that say how
    ///
    /// Writes the boxes of the garment's form with their uncertainty, what a person set beside what the scan
    /// says, and which boxes are open: as a table, as JSON, or as a mapping file of a maker or shop system says.
    /// Names no patient. Orders again with --reorder: exactly, or with the changes since the last order. Exits
    /// with 65 if a mapping or the last order has a fault.
    Order(OrderArgs),
    /// Measure one scan on standard input; the station runs this itself
    #[command(name = VERB, hide = true)]
    Measure(MeasureArgs),
    /// Check the configuration and the folders it names
    ///
    /// Names all faults in the configuration file at once, each with its line and a hint. If the file
    /// has none, tries the folders: whether exports can be read and records can be written. Run it as
    /// the station's user.
    Check(CheckArgs),
    /// Show whether the station is ready, or what to do
    ///
    /// Shows the state of the running station and, if it is not ready, what is wrong. Exits with 0 when the
    /// station is ready and with 74 when it is not, or when no station runs. Shows no patient's id and no
    /// file name. Run it as root or as the station's user.
    Status(AskArgs),
    /// List the station's scans, newest first
    ///
    /// Shows no patient's id and no file name; `gaiter show ID` shows the id.
    Scans(ScansArgs),
    /// Show one scan with its deliveries and the patient's id
    ///
    /// For a held scan, also shows the patients it may belong to and the folder with pictures of its
    /// legs. Make sure that no other person can see the screen.
    Show(OneArgs),
    /// Explain why a file or a scan is where it is
    Explain(ExplainArgs),
    /// Try a refused scan again, or a waiting one at once
    ///
    /// For a refused scan, once the cause is fixed: for example after a change of the configuration or
    /// with a new version of gaiter.
    Retry(OneArgs),
    /// Deliver a held scan to the patient it came in for
    ///
    /// A scan is held when it is not certain whose it is, or when the button was not pressed for it.
    /// Look at it first: `gaiter show ID` shows why it is held and whose it may be. If it did not come
    /// in for exactly one patient, use `gaiter assign ID`.
    Release(OneArgs),
    /// Assign an unassigned or held scan to a patient
    ///
    /// Asks for the patient's id, or reads it from standard input. It is never an argument, because
    /// every user of the machine can read those.
    Assign(AssignArgs),
    /// Take a scan back from its patient
    ///
    /// Its record leaves the patient's folder and goes to _unassigned; a scan that belongs to more than one
    /// patient stays with the others. Notes that people put into the record's folder go with it. Delete
    /// results that the practice software already has in that software.
    Unassign(UnassignArgs),
    /// Close a scan that needs no decision any more
    ///
    /// For a scan that was refused, is held, or is stored without a patient. The station no longer asks
    /// about it. A record that is stored stays where it is. `retention` in the configuration sets how long its
    /// bytes are kept; until then it can still be tried again or assigned.
    GiveUp(OneArgs),
    /// Set a girth, height or length of a record by hand
    ///
    /// Notes what a person measured, or that it cannot be measured, with reason and name, in a new revision
    /// beside the earlier ones. The scan's value stays and is printed with it. With the id of a scan, the
    /// running station does so and gives the revision to all its stores, the practice software too; with a
    /// folder, only this record is amended.
    Amend(AmendArgs),
    /// Set, clear or show the patient of the next scan
    #[command(subcommand)]
    Patient(PatientVerb),
    /// Hand an order of the practice software (GDT 6302) to the station
    ///
    /// For practice software that can start a program with the order's file. The order names the
    /// patient of the next scan. gaiter only reads the file; the practice software removes it.
    GdtOrder(GdtOrderArgs),
    /// Print the link to the operator's page, for decisions
    ///
    /// The link holds the token; without the token the page is read-only. Everybody who has the link can decide
    /// about scans: open it on the station's machine, and send it to no one. The browser keeps the token.
    Page(AskArgs),
    /// Take in and deliver no scans until `gaiter resume`
    ///
    /// A restart does not end the pause.
    Pause(AskArgs),
    /// Take in and deliver scans again after `gaiter pause`
    Resume(AskArgs),
    /// Print the JSON Schema of record.json, or of order.json
    Schema(SchemaArgs),
    /// Print completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page, or write a page for each verb to a folder
    Man(ManArgs),
}

/// `gaiter patient …`
#[derive(Debug, clap::Subcommand)]
pub enum PatientVerb {
    /// Name the patient of the next scan
    ///
    /// Asks for the patient's id, or reads it from standard input. It is never an argument, because
    /// every user of the machine can read those. The name waits for the next press of the button, or
    /// without a button for the next export. It is used once, and replaces a name that waits.
    Set(SetArgs),
    /// Drop the waiting name and the presses whose export has not come
    Clear(AskArgs),
    /// Show who is next and whose exports are expected; shows patients' ids
    Show(AskArgs),
    /// Compare the visits of a patient in the station's store
    ///
    /// Asks for the patient's id, or reads it from standard input. Reads the records of the patient's folder in
    /// the first store; of each day, the last scan counts. Needs no running station. Where figures mean
    /// something else than before, the curve breaks. Otherwise as `gaiter compare`.
    Visits(VisitsArgs),
    /// Name the affected leg of a patient
    ///
    /// Asks for the patient's id, or reads it from standard input. The comparison of the patient's visits, at the
    /// terminal and on the page, then tells the excess volume of this leg over the other one. No leg is guessed:
    /// without a name, with both or with none, it tells the difference left minus right. Kept with the patient
    /// until it is named anew or the person is erased.
    Affected(AffectedArgs),
    /// Write all that the station holds of a person into a folder
    ///
    /// For the right of access (GDPR, Article 15). Asks for the patient's id, or reads it from standard input.
    /// Copies every record with its scan and all revisions, scans without a record, and says what was delivered
    /// where and what the journal knows, on a page for people. Names no other patient. The station may run or
    /// be stopped; its history notes the disclosure.
    Disclose(DiscloseArgs),
    /// Erase all that the station holds of a person
    ///
    /// Asks for the patient's id, shows what will be removed and what cannot be, and asks for the id again; on
    /// standard input the id stands on two lines. Removes records in all folder stores, scans, quarantine,
    /// decisions, and the id from the journal; keeps only hashes, so that a scan that still lies at the scanner
    /// is not taken in again. A store that is out of reach is cleared once it is back. Records may have to be
    /// kept by law: read what it says.
    Erase(EraseArgs),
}

/// `gaiter demo`
#[derive(Debug, clap::Args)]
pub struct DemoArgs {
    /// Print only the records, as one JSON object at the end, for programs
    #[arg(long)]
    pub json: bool,
}

/// `gaiter schema`
#[derive(Debug, clap::Args)]
pub struct SchemaArgs {
    /// Of which file
    #[arg(value_name = "FILE", value_parser = of_words(SCHEMAS), default_value = "record")]
    pub schema: &'static str,
}

/// The files that have a schema, with it.
const SCHEMAS: Words<&str> =
    &[("record", gaiter_record::schema::JSON_SCHEMA), ("order", gaiter_record::order::JSON_SCHEMA)];

/// `gaiter completions`
#[derive(Debug, clap::Args)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL", value_parser = of_words(SHELLS))]
    pub shell: Shell,
}

/// `gaiter man`
#[derive(Debug, clap::Args)]
pub struct ManArgs {
    /// The folder for gaiter.1, gaiter-run.1 and so on; it must exist
    #[arg(value_name = "DIR")]
    pub dir: Option<PathBuf>,
}

/// The shells whose completions are tested.
const SHELLS: Words<Shell> = &[("bash", Shell::Bash), ("zsh", Shell::Zsh), ("fish", Shell::Fish)];

/// `gaiter run`
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// The configuration of the station; the variable GAITER_CONFIG names another default
    #[arg(long, value_name = "FILE", default_value_os_t = usual_config())]
    pub config: PathBuf,
}

/// `gaiter measure`
#[derive(Debug, clap::Args)]
pub struct MeasureArgs {
    /// The scan's hash, which its bytes must have
    pub hash: Option<String>,
}

/// `gaiter check`
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    /// The configuration to check; the variable GAITER_CONFIG names another default
    #[arg(long, value_name = "FILE", default_value_os_t = usual_config())]
    pub config: PathBuf,
    /// Print the result as JSON, for programs
    #[arg(long)]
    pub json: bool,
}

/// A parser for the words of a table that the configuration uses too.
fn of_words<T: Copy + Send + Sync + 'static>(table: Words<T>) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(table.iter().map(|(word, _)| *word))
        .try_map(move |text| words::meaning(table, &text).ok_or("no such word"))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_command_line_is_consistent() {
        super::command().debug_assert();
    }
}
