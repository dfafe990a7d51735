//! The files of size tables, garments and mappings that a command line names.

use std::path::{Path, PathBuf};

use gaiter_sizes::{DocumentFault, SizeTable, parse};

use crate::cli::{Exit, complain, terminal_safe};
use crate::config::sizes::beside::{TextFile, on_disk};

/// The file at a path, or the files of a folder there.
///
/// # Errors
/// The exit of the verb if there are none, or if one cannot be read; it is printed.
pub fn files_at(path: &Path) -> Result<Vec<TextFile>, Exit> {
    on_disk(path).map_err(|why| {
        complain(format_args!("gaiter: {}", terminal_safe(&why)));
        Exit::from(&why)
    })
}

/// The content of the files at a path.
///
/// # Errors
/// The exit of the verb if one of them cannot be read or has faults; all of them are printed.
pub fn read_all<T>(
    path: &Path,
    read: impl Fn(&[u8]) -> Result<T, Vec<DocumentFault>>,
) -> Result<Vec<T>, Exit> {
    let (mut all, mut exit) = (Vec::new(), Exit::Done);
    for TextFile { path, text } in files_at(path)? {
        match read(text.as_bytes()) {
            Ok(one) => all.push(one),
            Err(faults) => {
                for fault in faults {
                    complain(format_args!("{}:{fault}", terminal_safe(path.display())));
                }
                exit = Exit::Unmeasurable;
            }
        }
    }
    if exit == Exit::Done { Ok(all) } else { Err(exit) }
}

/// What is read at these paths, in their order, and the worst exit of those at which it cannot be.
pub fn of_paths<T>(
    paths: &[PathBuf],
    read: impl Fn(&Path) -> Result<Vec<T>, Exit>,
) -> (Vec<T>, Exit) {
    let (mut all, mut worst) = (Vec::new(), Exit::Done);
    for path in paths {
        match read(path) {
            Ok(found) => all.extend(found),
            Err(exit) => worst = worst.max(exit),
        }
    }
    (all, worst)
}

/// The tables of these files and folders, in their order.
///
/// # Errors
/// The exit of the verb if one of them cannot be read or has faults; all of them are printed.
pub fn tables(paths: &[PathBuf]) -> Result<Vec<SizeTable>, Exit> {
    let (tables, worst) = of_paths(paths, |path| read_all(path, parse));
    if worst == Exit::Done { Ok(tables) } else { Err(worst) }
}
