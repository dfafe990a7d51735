//! Tries the folders and disks that a configuration names in the way the station uses them.

use std::fs::{self, File};
use std::io::{self, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use gaiter_flow::FileSystem;
use gaiter_flow::confinement::Confine;
use gaiter_flow::export::mount::MountGuard;

use super::names;
use super::row::{Row, Verdict};
use crate::config::{Config, WatchConfig, nested};
use crate::station::measure;
use crate::station::runtime::chain;
use crate::station::share::file_system;
use crate::store::OTHERS;

/// Runs every check of the environment, along the path of a scan: exports, state, records.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let (state, store) = (&config.station.state_dir, &config.store.folder.path);
    let exports = &config.scanner.export_dirs;
    let mut rows: Vec<Row> = exports
        .iter()
        .map(|folder| Row::from_attempt("export folder", folder, readable(folder)))
        .collect();
    rows.extend(exports.iter().filter_map(|folder| mounted(folder, &config.scanner.watch)));
    rows.extend(names::rows(config));
    let record_store = Row::from_attempt("record store", store, writable(store));
    for (row, folder) in [(state_folder(state), state), (record_store, store)] {
        rows.push(row);
        rows.push(room(folder, config.scanner.max_scan_bytes));
    }
    let gdt = config.store.gdt.as_ref().map(|gdt| &gdt.path);
    rows.extend(gdt.map(|folder| Row::from_attempt("exchange folder", folder, writable(folder))));
    let orders = config.patient.orders.as_ref().map(|orders| &orders.path);
    rows.extend(orders.map(|folder| Row::from_attempt("order folder", folder, readable(folder))));
    rows.push(local(state));
    rows.extend(linked_into_one_another(exports, state, store));
    rows.extend(slow_rescan(config));
    rows.push(guards(config));
    if rustix::process::geteuid().is_root() {
        let detail = "checked as root, who has more rights; check again as the station's own user";
        rows.push(Row::at("user", "root", Verdict::Warn, detail));
    }
    rows
}

/// Checks that an export folder exists and can be listed. The station only ever reads it.
fn readable(folder: &Path) -> io::Result<String> {
    let entries = fs::read_dir(folder)?;
    let count = entries.collect::<io::Result<Vec<_>>>()?.len();
    let files = if count == 1 { "entry" } else { "entries" };
    Ok(match network(folder) {
        Some(kind) => format!("can be read, {count} {files}; on {kind}: found by the rescan"),
        None => format!("can be read, {count} {files}"),
    })
}

/// Checks whether the station would trust what it sees in an export folder. If the folder cannot be
/// read, the previous check reports that.
fn mounted(folder: &Path, config: &WatchConfig) -> Option<Row> {
    config.marker.as_ref()?;
    let seen = file_system::mount(folder, config).ok()?;
    let check = "export mounted";
    Some(match MountGuard::default().check(seen) {
        Ok(()) => Row::ok(check, folder, format!("as configured, on {}", seen.file_system)),
        Err(why) => {
            Row::at(check, folder.display(), Verdict::Fail, format!("the export folder {why}"))
        }
    })
}

/// The folder itself, or its nearest existing ancestor, in which it can be created.
fn footing(folder: &Path) -> io::Result<&Path> {
    for place in folder.ancestors() {
        match fs::metadata(place) {
            Ok(found) if found.is_dir() => return Ok(place),
            Ok(_) => {
                let message = format!("{} is not a folder", place.display());
                return Err(io::Error::new(io::ErrorKind::NotADirectory, message));
            }
            // A dangling link exists, and no folder can be created in its place.
            Err(error) if error.kind() != io::ErrorKind::NotFound || place.is_symlink() => {
                return Err(io::Error::new(error.kind(), format!("{}: {error}", place.display())));
            }
            Err(_) => {}
        }
    }
    Err(io::ErrorKind::NotFound.into())
}

/// Does what the station does with a record, in a trial folder that it removes afterwards. It does not
/// create a missing folder, because that would belong to the user who checks and not to the station.
pub(super) fn writable(folder: &Path) -> io::Result<String> {
    let place = footing(folder)?;
    let trial = place.join(format!(".gaiter-check-{}", std::process::id()));
    fs::create_dir(&trial).map_err(|error| {
        io::Error::new(error.kind(), format!("cannot write in {}: {error}", place.display()))
    })?;
    let tried = write_sync_rename(&trial);
    let removed = fs::remove_dir_all(&trial);
    tried.and(removed)?;
    Ok(if place == folder {
        "can be written, synced and renamed in".into()
    } else {
        format!("does not exist yet; can be made in {}", place.display())
    })
}

/// As any folder that is written; and nobody but the station's user may have rights in it. Run as root, the
/// check does not know who that is.
fn state_folder(folder: &Path) -> Row {
    let check = "state folder";
    let row = Row::from_attempt(check, folder, writable(folder));
    let found = match fs::metadata(folder) {
        Ok(found) if row.verdict == Verdict::Ok => found,
        _ => return row,
    };
    let user = rustix::process::geteuid();
    if !user.is_root() && found.uid() != user.as_raw() {
        let detail = "belongs to another user; the station does not start in it";
        return Row::at(check, folder.display(), Verdict::Fail, detail);
    }
    if found.mode() & OTHERS == 0 {
        return row;
    }
    let detail = format!(
        "others have rights in it (mode {:04o}); the station takes them away when it starts, or now: \
         chmod 700 {}",
        found.mode() & 0o7777,
        folder.display()
    );
    Row::at(check, folder.display(), Verdict::Warn, detail)
}

fn write_sync_rename(trial: &Path) -> io::Result<()> {
    let part = trial.join("trial.part");
    let mut file = File::create_new(&part)?;
    file.write_all(b"gaiter check\n")?;
    file.sync_all()?;
    fs::rename(&part, trial.join("trial"))?;
    File::open(trial)?.sync_all()
}

/// The station needs room for one more scan. With room for fewer than ten the operator is warned.
fn room(folder: &Path, max_scan: u64) -> Row {
    let check = "free space";
    match footing(folder).and_then(file_system::free_bytes) {
        Err(error) => Row::at(check, folder.display(), Verdict::Fail, error.to_string()),
        Ok(free) => {
            let detail = format!("{} free; a scan may have up to {}", spelt(free), spelt(max_scan));
            let verdict = if free < max_scan {
                Verdict::Fail
            } else if free < max_scan.saturating_mul(10) {
                Verdict::Warn
            } else {
                Verdict::Ok
            };
            Row::at(check, folder.display(), verdict, detail)
        }
    }
}

/// Formats bytes as decimal megabytes, as on disk labels, or as gigabytes with one decimal.
fn spelt(bytes: u64) -> String {
    let megabytes = bytes / 1_000_000;
    if megabytes < 1000 {
        format!("{megabytes} MB")
    } else {
        format!("{}.{} GB", megabytes / 1000, megabytes % 1000 / 100)
    }
}

/// The journal relies on locks and syncs, which network file systems promise but may not keep.
fn local(state: &Path) -> Row {
    match network(state) {
        _ if file_system(state).is_some_and(FileSystem::is_memory) => {
            let detail = "held in memory; a power loss deletes everything that is not delivered";
            Row::at("local disk", state.display(), Verdict::Warn, detail)
        }
        Some(kind) => {
            let detail = format!("on {kind}; the journal is only safe on a local disk");
            Row::at("local disk", state.display(), Verdict::Warn, detail)
        }
        None => Row::ok("local disk", state, "not on a network share"),
    }
}

/// The kind of network file system a folder is or would be on. `None` for a local one, and if the kind
/// is unknown, which another check reports.
fn network(folder: &Path) -> Option<FileSystem> {
    file_system(folder).filter(|kind| kind.is_network())
}

fn file_system(folder: &Path) -> Option<FileSystem> {
    file_system::detect(footing(folder).ok()?).ok()
}

/// Links can lead one folder into another even though their paths differ.
fn linked_into_one_another(exports: &[PathBuf], state: &Path, store: &Path) -> Vec<Row> {
    let pairs = exports.iter().flat_map(|export| [(state, &**export), (store, &**export)]);
    pairs
        .chain([(store, state)])
        .filter_map(|(a, b)| {
            nested(&real(a)?, &real(b)?)?;
            let detail = format!("is the same place as {}, through a link", b.display());
            Some(Row::at("folders apart", a.display(), Verdict::Fail, detail))
        })
        .collect()
}

/// The path of a folder that exists, or will exist, with all links resolved.
fn real(folder: &Path) -> Option<PathBuf> {
    let place = footing(folder).ok()?;
    let rest = folder.strip_prefix(place).ok()?;
    Some(fs::canonicalize(place).ok()?.join(rest))
}

/// What blocks files, network and system calls for the processes that read what the scanner wrote.
fn guards(config: &Config) -> Row {
    let row = |verdict, detail| Row::at("confinement", "measure.confine", verdict, detail);
    let lacking = match config.measure.confine {
        Confine::WherePossible => Verdict::Warn,
        Confine::Required => Verdict::Fail,
    };
    match measure::tried() {
        Ok(found) => match found.missing() {
            None => row(Verdict::Ok, format!("by {}", found.words())),
            Some(missing) => row(lacking, format!("this machine's kernel has no {missing}")),
        },
        Err(fault) => row(Verdict::Fail, chain(&fault)),
    }
}

/// This is allowed, but usually means that the two values were swapped.
fn slow_rescan(config: &Config) -> Option<Row> {
    let (quiet, rescan) = (config.scanner.quiet, config.scanner.rescan);
    let detail = format!("{quiet:?} is longer than scanner.rescan, {rescan:?}; is that meant?");
    (quiet > rescan).then(|| Row::at("timing", "scanner.quiet", Verdict::Warn, detail))
}
