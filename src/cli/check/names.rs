//! Applies `scanner.file_name` to the names in the export folders. No file is opened.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::name_check::{self, Taken};
use gaiter_flow::{Group, Identity, StatedPatient};

use super::row::{Example, Row, Verdict};
use crate::config::Config;
use crate::station::intake::scan_dir::{self, Found};
use crate::station::share::stall::StepCounter;

/// The check's name in the table.
const CHECK: &str = "file names";

/// The most names that are read, newest first. Exports of other years show nothing about today's names.
const NAMES_MAX: usize = 2000;

/// The most examples that are shown: enough to see the rule, few enough to read.
const EXAMPLES_MAX: usize = 5;

/// What the names in each export folder contain, and what the operator should look at. If a folder
/// cannot be listed, another check reports that.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    if config.scanner.file_name.is_none() {
        let detail = "is not set: file names identify no patient";
        return vec![Row::at(CHECK, "scanner.file_name", Verdict::Ok, detail)];
    }
    let (scanner, patient) = (&config.scanner, &config.patient);
    let expression = scanner.file_name.clone();
    let identity = Identity::new(expression, None, &patient.pattern, patient.check_digit);
    // The pattern was already compiled when the configuration was read.
    let Ok(identity) = identity else { return Vec::new() };
    let look = |folder: &PathBuf| {
        let found = scan_dir::look(folder, &scanner.watch, &StepCounter::default()).ok()?;
        Some(of_folder(folder, found, &identity))
    };
    scanner.export_dirs.iter().filter_map(look).flatten().collect()
}

fn of_folder(folder: &Path, found: Found, identity: &Identity) -> Vec<Row> {
    let there = found.scans.len();
    let names = newest(found);
    let stated: Vec<(&str, StatedPatient)> =
        names.iter().map(|name| (name.as_str(), identity.of_file_name(name))).collect();
    let named = stated.iter().filter_map(|(name, stated)| match stated {
        StatedPatient::Patient(patient) => Some(Taken { name, patient: &patient.id }),
        StatedPatient::Nothing | StatedPatient::NotAnId => None,
    });
    let mut taken: Vec<Taken> = named.collect();
    let not_ids = stated.iter().filter(|(_, stated)| *stated == StatedPatient::NotAnId).count();
    let (all, named) = (stated.len(), taken.len());
    let newest = if all < there { format!("the newest {all} of ") } else { String::new() };
    let names = if there == 1 { "name" } else { "names" };
    let without = all - named - not_ids;
    let detail = format!(
        "{newest}{there} {names}: {named} with a patient's id, {without} without, {not_ids} \
         with an id that is not allowed"
    );
    let examples = taken
        .iter()
        .take(EXAMPLES_MAX)
        .map(|taken| Example { name: taken.name.to_owned(), patient: taken.patient.to_owned() });
    let examples = examples.collect();
    taken.reverse();
    let findings = name_check::findings(&taken).into_iter().map(|finding| {
        let detail = format!("{finding} [{}]", finding.code());
        Row::at(CHECK, folder.display(), Verdict::Warn, detail)
    });
    let counts = Row { examples, ..Row::ok(CHECK, folder, detail) };
    std::iter::once(counts).chain(findings).collect()
}

/// The names of the newest exports, newest first.
fn newest(found: Found) -> Vec<String> {
    let mut files: Vec<(PathBuf, Group)> = found.scans.into_iter().collect();
    files.sort_by(|(a, of_a), (b, of_b)| (of_b.stamp.mtime_ns, b).cmp(&(of_a.stamp.mtime_ns, a)));
    let name = |path: &Path| path.file_name().map(OsStr::to_string_lossy).map(Into::into);
    files.iter().take(NAMES_MAX).filter_map(|(path, _)| name(path)).collect()
}
