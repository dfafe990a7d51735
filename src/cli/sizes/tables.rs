//! The size tables that a command line names.

use std::path::PathBuf;

use gaiter_sizes::{SizeTable, parse};

use crate::cli::{Exit, complain, shown};
use crate::config::sizes::beside::on_disk;

/// The tables of these files and folders, in their order.
///
/// # Errors
/// The exit of the verb if one of them cannot be read or has faults; all of them are told.
pub fn tables(paths: &[PathBuf]) -> Result<Vec<SizeTable>, Exit> {
    let (mut tables, mut worst) = (Vec::new(), Exit::Done);
    for path in paths {
        let found = match on_disk(path) {
            Ok(found) => found,
            Err(why) => {
                complain(format_args!("gaiter: {}", shown(&why)));
                worst = worst.max(Exit::from(&why));
                continue;
            }
        };
        for file in &found {
            match parse(file.text.as_bytes()) {
                Ok(table) => tables.push(table),
                Err(faults) => {
                    for fault in faults {
                        complain(format_args!("{}:{fault}", shown(file.path.display())));
                    }
                    worst = worst.max(Exit::Unmeasurable);
                }
            }
        }
    }
    if worst == Exit::Done { Ok(tables) } else { Err(worst) }
}
