//! `gaiter patient disclose`.

use std::path::Path;

use gaiter_flow::patient::person::{Person, WhoseScan};
use gaiter_language::Language;
use serde_json::json;

use super::files::Bundle;
use super::overview;
use super::reach::{PersonFault, Reached};
use crate::cli::args::DiscloseArgs;
use crate::cli::{Exit, complain, print, terminal_safe};

/// What the station notes of a scan that comes in: it also names others to whom the scan might have belonged.
const INTAKE: &str = "intake.json";

pub(super) fn disclosed(args: &DiscloseArgs) -> Result<Exit, PersonFault> {
    let (reached, person) = Reached::find(&args.ask.config)?;
    let language = reached.language;
    let bundle = Bundle::begin(&args.out)?;
    write(&bundle, &person, language)?;
    reached.disclosed(&person.patient)?;
    let files = bundle.finish(&args.out)?;
    let away: Vec<&str> =
        person.stores.iter().filter(|of| of.fault.is_some()).map(|of| of.store.as_str()).collect();
    let place = terminal_safe(args.out.display());
    let text = match args.ask.json {
        true => format!("{:#}\n", json!({ "folder": args.out, "files": files, "missing": away })),
        false => {
            let sentence =
                language.filled("person.written", &[("files", &files), ("place", &place)]);
            format!("{sentence}\n")
        }
    };
    print(text).map_err(PersonFault::Print)?;
    if away.is_empty() {
        return Ok(Exit::Done);
    }
    complain(format_args!(
        "gaiter: {}",
        language.filled("person.incomplete", &[("stores", &away.join(", "))])
    ));
    Ok(Exit::Io)
}

fn write(bundle: &Bundle, person: &Person, language: Language) -> Result<(), PersonFault> {
    for of in &person.stores {
        for record in &of.records {
            bundle.copy(&record.folder, &format!("records/{}", of.store), |_| true)?;
        }
        for path in &of.others {
            bundle.copy(path, &format!("others/{}", of.store), |_| true)?;
        }
    }
    for scan in &person.scans {
        // What may be another's, or was found to be, is not given away.
        if matches!(scan.whose, WhoseScan::Uncertain | WhoseScan::TakenBack) {
            continue;
        }
        for folder in &scan.kept {
            let within = folder.parent().and_then(Path::file_name).unwrap_or_default();
            let within = format!("scans/{}", within.to_string_lossy());
            bundle.copy(folder, &within, |name| name != INTAKE)?;
        }
    }
    for folder in &person.orders {
        bundle.copy(folder, "orders", |_| true)?;
    }
    let mut facts = serde_json::to_string_pretty(person).unwrap_or_default();
    facts.push('\n');
    bundle.write("person.json", facts.as_bytes())?;
    bundle.write("index.html", overview::page(person, language).as_bytes())
}
