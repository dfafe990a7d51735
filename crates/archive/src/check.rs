//! Tries out all that the archive stands on.

use std::process::ExitCode;

use gaiter_flow::confinement::Confinement;
use gaiter_record::archive::ObjectKey;

use crate::config::ArchiveConfig;
use crate::fault::{ArchiveFault, EXIT_IO, chain};
use crate::objects::bucket;
use crate::{database, print};

/// Tries out database, bucket and confinement, and says a line of each.
///
/// # Errors
/// If the lines cannot be written.
pub fn check(config: &ArchiveConfig) -> Result<ExitCode, ArchiveFault> {
    let database = database::connect(&config.database)
        .and_then(|mut client| database::check_schema(&mut client))
        .map(|()| "its tables are those of this version".to_owned());
    let objects = bucket(config).list(ObjectKey::INBOX, "").map_err(ArchiveFault::from);
    let objects = objects.map(|page| {
        let more = if page.is_more { "more than " } else { "" };
        format!("{more}{} in the inbox", page.objects.len())
    });
    let confined = gaiter_confined::tried().map(|found: Confinement| found.words().to_owned());
    let mut all_well = true;
    for (name, tried) in [
        ("database", database.map_err(|fault| chain(&fault))),
        ("objects", objects.map_err(|fault| chain(&fault))),
        ("confinement", confined.map_err(|fault| chain(&fault))),
    ] {
        all_well &= tried.is_ok();
        match tried {
            Ok(said) => print(format_args!("ok    {name}: {said}"))?,
            Err(said) => print(format_args!("FAULT {name}: {said}"))?,
        }
    }
    Ok(if all_well { ExitCode::SUCCESS } else { ExitCode::from(EXIT_IO) })
}
