//! `gaiter sizes`: the verdicts of makers' size tables on a record, and whether tables are sound.

mod check;
mod tables;
mod text;

use gaiter_record::sizing::{SizeChoice, SizeVerdicts};
use jiff::Zoned;

use super::args::{SizesArgs, SizesOf, SizesVerb};
use super::terminal::{self, screen};
use super::{Exit, config_if_any, exit_of_printing, failed, print_json, report, report_choice};
pub use check::remark_in_words;
pub use tables::{files_at, of_paths, read_all, tables};

/// Checks tables, or judges a record.
pub fn sizes(args: &SizesArgs) -> Result<Exit, Exit> {
    match &args.verb {
        Some(SizesVerb::Check(args)) => check::check(args),
        None => print_verdicts(&args.of),
    }
}

/// Judges a record and prints the tables' verdicts.
fn print_verdicts(args: &SizesOf) -> Result<Exit, Exit> {
    // clap asks for a record where no other verb is named.
    let path = args.record.as_ref().ok_or(Exit::Usage)?;
    let config = config_if_any(&args.config)?;
    let (configured, garments) = report_choice(config.as_ref());
    let garment = args.garment.chosen(&garments, &configured.garment)?;
    let tables = match args.tables.as_slice() {
        [] => configured.sizes.tables,
        paths => tables(paths)?,
    };
    let record = report::checked_record_at(path).map_err(|fault| failed(&fault))?;
    let language = args.language.unwrap_or(configured.language);
    let choice = SizeChoice { tables, today: Zoned::now().date(), ..configured.sizes };
    let verdicts = SizeVerdicts::new(&record, &garment, &choice);
    let printed = match args.json {
        true => print_json(&verdicts),
        false => {
            terminal::print_painted(text::render(&verdicts, &garment, language, screen::columns()))
        }
    };
    Ok(exit_of_printing("the sizes", printed))
}
