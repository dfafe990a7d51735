//! The figures of all scans as Parquet, for DuckDB, Spark and pandas: `method=…/month=…/part.parquet`, as Hive names
//! folders. Each export writes all files again, so that what was deleted from the archive goes from there, too.

mod part;

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use postgres::Transaction;
use postgres::fallible_iterator::FallibleIterator;

use crate::config::ArchiveConfig;
use crate::database;
use crate::fault::ArchiveFault;
use crate::query::as_reader;
use part::Part;

/// The file of a method and a month.
const PART: &str = "part.parquet";

/// The columns of a part, as [`part::SCHEMA`] has them: those of the view `visit_level`.
const ROWS: &str = "\
    select station, encode(scan, 'hex'), (extract(epoch from first_seen) * 1000000)::bigint, encode(patient, 'hex'),
        outcome, stature_mm, crotch_height_mm, side, level, height_mm, girth_mm, girth_sd_mm
    from visit_level
    where method = $1 and first_seen >= $2::text::timestamptz
        and first_seen < ($2::text::timestamp + interval '1 month') at time zone 'UTC'
    order by first_seen, scan, station, side, level";

/// Writes all files, and removes those of months that are no longer there.
///
/// # Errors
/// Those of the database and of the folder.
pub fn export(config: &ArchiveConfig, folder: &Path) -> Result<(), ArchiveFault> {
    let mut client = database::connect(&config.database)?;
    let mut transaction = as_reader(&mut client)?;
    let methods = words(&mut transaction, "select distinct method from scan_result order by 1")?;
    let months =
        "select distinct to_char(first_seen at time zone 'UTC', 'YYYY-MM') from visit order by 1";
    let months = words(&mut transaction, months)?;
    let mut written = BTreeSet::new();
    for method in &methods {
        for month in &months {
            let path = folder.join(format!("method={method}/month={month}")).join(PART);
            if write(&mut transaction, method, month, &path)? {
                written.insert(path);
            }
        }
    }
    for path in parts(folder)?.into_iter().filter(|path| !written.contains(path)) {
        fs::remove_file(path)?;
    }
    Ok(())
}

/// The first column of what is asked.
fn words(transaction: &mut Transaction<'_>, statement: &str) -> Result<Vec<String>, ArchiveFault> {
    Ok(transaction.query(statement, &[])?.iter().map(|row| row.get(0)).collect())
}

/// Writes the file of a method and a month; returns whether there is one.
fn write(
    transaction: &mut Transaction<'_>,
    method: &str,
    month: &str,
    path: &Path,
) -> Result<bool, ArchiveFault> {
    let first = format!("{month}-01 00:00:00Z");
    let mut rows = transaction.query_raw(ROWS, [method, first.as_str()])?;
    let Some(first) = rows.next()? else { return Ok(false) };
    let mut part = Part::create(path)?;
    part.push(&first)?;
    while let Some(row) = rows.next()? {
        part.push(&row)?;
    }
    part.finish()?;
    Ok(true)
}

/// The files of an export that is there.
fn parts(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut parts = Vec::new();
    for method in folders(folder, "method=")? {
        let months = folders(&method, "month=")?.into_iter();
        parts.extend(months.map(|month| month.join(PART)).filter(|part| part.exists()));
    }
    Ok(parts)
}

/// The folders in a folder whose names begin so; none if it is not there.
fn folders(folder: &Path, beginning: &str) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut folders = Vec::new();
    for entry in entries {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with(beginning) {
            folders.push(entry.path());
        }
    }
    Ok(folders)
}
