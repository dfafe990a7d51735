//! `gaiter sizes`: what makers' size tables say about a record, and whether tables are sound.

mod check;
mod tables;
mod text;

use std::io;

use gaiter_record::SUMS;
use gaiter_record::schema::NOT_VOUCHED;
use gaiter_record::sizing::{SizeChoice, SizeVerdicts};
use gaiter_sizes::Garment;
use jiff::Zoned;

use super::args::{SizesArgs, SizesOf, SizesVerb, usual_config};
use super::terminal::{paint, screen};
use super::{Exit, complain, explain_config, print, report, shown};
use crate::config::{self, ConfigError};
pub use check::in_words as remark_in_words;
pub use tables::tables;

/// Checks tables, or judges a record.
pub fn sizes(args: &SizesArgs) -> Exit {
    match &args.verb {
        Some(SizesVerb::Check(args)) => check::check(args),
        None => judged(&args.of).map_or_else(|exit| exit, |()| Exit::Done),
    }
}

/// Judges a record and prints what the tables say.
fn judged(args: &SizesOf) -> Result<(), Exit> {
    // clap asks for a record where no other verb is named.
    let path = args.record.as_ref().ok_or(Exit::Usage)?;
    let configured = Configured::of(args)?;
    let garment = args.garment.chosen(&configured.garments, &configured.garment)?;
    let tables = match args.tables.as_slice() {
        [] => configured.sizes.tables,
        paths => tables(paths)?,
    };
    let record = report::record_at(path).map_err(|fault| {
        complain(format_args!("gaiter: {fault}"));
        fault.exit()
    })?;
    if record.has_finding(NOT_VOUCHED) {
        complain(format_args!(
            "gaiter: {}: nothing vouches for its figures, because no {SUMS} is beside it",
            shown(path.display())
        ));
    }
    let language = args.language.unwrap_or(configured.language);
    let choice = SizeChoice { tables, today: Zoned::now().date(), ..configured.sizes };
    let verdicts = SizeVerdicts::of(&record, &garment, &choice);
    let printed = match args.json {
        true => serde_json::to_string_pretty(&verdicts)
            .map_err(io::Error::other)
            .and_then(|json| print(json + "\n")),
        false => paint::print(text::of(&verdicts, &garment, language, screen::columns())),
    };
    printed.map_err(|error| {
        complain(format_args!("gaiter: the sizes cannot be printed: {error}"));
        Exit::Io
    })
}

/// What the configuration of a station says about sizes; the defaults on a machine without one.
struct Configured {
    garments: Vec<Garment>,
    garment: Garment,
    language: gaiter_language::Language,
    sizes: SizeChoice,
}

impl Configured {
    fn of(args: &SizesOf) -> Result<Configured, Exit> {
        match config::read(&args.config) {
            Ok(config) => Ok(Configured {
                sizes: config.report_choice(Zoned::now().date()).sizes,
                garments: config.garments,
                garment: config.garment,
                language: config.language,
            }),
            Err(ConfigError::Unreadable { source, .. })
                if source.kind() == io::ErrorKind::NotFound && args.config == usual_config() =>
            {
                Ok(Configured {
                    garments: Garment::shipped().to_vec(),
                    garment: Garment::default(),
                    language: Default::default(),
                    sizes: SizeChoice::default(),
                })
            }
            Err(error) => Err(explain_config(&error)),
        }
    }
}
