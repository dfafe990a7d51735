//! `gaiter order check`: the faults of mapping files.

use std::path::Path;

use gaiter_flow::health::counted;
use gaiter_sizes::mapping::parse;
use gaiter_sizes::{DocumentFault, Mapping};
use serde_json::{Value, json};

use crate::cli::args::OrderCheckArgs;
use crate::cli::sizes::{files_at, of_paths, read_all};
use crate::cli::{Exit, complain, exit_of_printing, print, print_json, terminal_safe};
use crate::config::sizes::beside::TextFile;

/// Name and number of the schema of the result as JSON.
const SCHEMA: &str = "gaiter.order-check/1";

/// Checks the mappings and prints what was found.
pub fn check(args: &OrderCheckArgs) -> Exit {
    let (files, mut worst) = of_paths(&args.files, files_at);
    let checked: Vec<Checked> = files.into_iter().map(Checked::check).collect();
    if checked.iter().any(|of| of.found.is_err()) {
        worst = worst.max(Exit::Unmeasurable);
    }
    let printed = match args.json {
        true => {
            let files: Vec<Value> = checked.iter().map(Checked::json).collect();
            print_json(&json!({ "schema": SCHEMA, "files": files }))
        }
        false => print(checked.iter().map(Checked::text).collect::<String>()),
    };
    worst.max(exit_of_printing("the result", printed))
}

/// The mapping of a file.
///
/// # Errors
/// The exit of the verb if it cannot be read or has faults, or if the path is a folder; all are printed.
pub fn mapping(path: &Path) -> Result<Mapping, Exit> {
    let mut mappings = read_all(path, parse)?;
    let (Some(mapping), true) = (mappings.pop(), mappings.is_empty()) else {
        complain("gaiter: --mapping names several files; name one of them");
        return Err(Exit::Usage);
    };
    Ok(mapping)
}

/// A file, and what was found in it.
struct Checked {
    path: String,
    found: Result<Mapping, Vec<DocumentFault>>,
}

impl Checked {
    fn check(file: TextFile) -> Checked {
        let path = file.path.display().to_string();
        Checked { path, found: parse(file.text.as_bytes()) }
    }

    fn text(&self) -> String {
        let path = terminal_safe(&self.path);
        match &self.found {
            Ok(Mapping { id, columns, .. }) => {
                format!("{path}: {}: no fault, {} columns\n", terminal_safe(id), columns.len())
            }
            Err(faults) => {
                let lines: String = faults.iter().map(|fault| format!("  {fault}\n")).collect();
                format!("{path}: {}\n{lines}", counted(faults.len(), "fault"))
            }
        }
    }

    fn json(&self) -> Value {
        let faults: &[DocumentFault] = self.found.as_ref().err().map_or(&[], Vec::as_slice);
        let id = self.found.as_ref().ok().map(|mapping| &mapping.id);
        json!({ "path": self.path, "id": id, "faults": faults })
    }
}
