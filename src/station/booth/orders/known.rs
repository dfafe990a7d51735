//! What the journal knows of the orders that lie in their folder, brought up to date by each look.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use tracing::warn;

use super::list_orders::{Found, is_meant};
use super::read;
use crate::config::OrdersConfig;
use crate::flow::OrderState;
use crate::flow::order_news::{Unlisted, unlisted};
use crate::station::assembly::Station;
use crate::station::journal::JournalError;
use crate::station::stall::Pulse;
use crate::store::durable;

/// A journal that was lost knew which of these had been heard. To hear one twice may give one patient
/// another's scan; so none of them is.
///
/// # Errors
/// See [`JournalError`]; what was not noted must not be heard.
pub fn pass_over(station: &Station, found: &Found, pulse: &Pulse) -> Result<(), JournalError> {
    for (path, order) in &found.orders {
        let stamp = order.stamp;
        let unread =
            || OrderState { size: stamp.size, mtime_ns: stamp.mtime_ns, digest: String::new() };
        let read = read::read(path, stamp, pulse).ok().flatten();
        let state = read.map_or_else(unread, |read| read.state);
        station.custody.journal().order_heard(path, &state)?;
    }
    warn!(event = "orders-passed-over", count = found.orders.len());
    Ok(())
}

/// Brings what is known up to date with a look. A known order is known under its other names too,
/// where it was linked or renamed. Orders that are gone are forgotten: what comes under their names is
/// new, even with the same words.
///
/// # Errors
/// See [`JournalError`]; a link may pass for a new order then.
pub fn update(
    station: &Station,
    config: &OrdersConfig,
    found: &Found,
    pulse: &Pulse,
) -> Result<(), JournalError> {
    let journal = station.custody.journal();
    let known = journal.orders_known(&config.path)?;
    for (path, state) in other_names(found, &known, pulse) {
        journal.order_heard(path, &state)?;
    }
    let is_there = |path: &Path| found.orders.contains_key(path);
    let lists = known.is_empty() || known.keys().any(|path| is_there(path));
    match unlisted(journal.orders_folder()?, found.folder, lists) {
        Unlisted::Nothing => Ok(()),
        Unlisted::TheirFolder => journal.orders_seen_in(found.folder),
        Unlisted::Gone => {
            let is_gone = |path: &&Path| {
                // A name that the mask does not mean any more was not looked for.
                let looked_for = is_meant(path, &config.files);
                looked_for && !is_there(path) && !found.unexamined.contains(*path)
            };
            let gone: Vec<&Path> = known.keys().map(AsRef::as_ref).filter(is_gone).collect();
            // A power cut must not bring back a name that is forgotten.
            match gone.is_empty() || durable::sync_folder(&config.path).is_ok() {
                true => journal.forget_orders(&gone),
                false => Ok(()),
            }
        }
    }
}

/// Files that are not known by their names and are, word for word and by their times, a known order.
fn other_names<'a>(
    found: &'a Found,
    known: &BTreeMap<PathBuf, OrderState>,
    pulse: &Pulse,
) -> Vec<(&'a Path, OrderState)> {
    let mut names = Vec::new();
    for (path, order) in found.orders.iter().filter(|(path, _)| !known.contains_key(*path)) {
        let (size, mtime_ns) = (order.stamp.size, order.stamp.mtime_ns);
        if !known.values().any(|known| (known.size, known.mtime_ns) == (size, mtime_ns)) {
            continue;
        }
        let read = read::read(path, order.stamp, pulse).ok().flatten();
        let same = read.filter(|read| known.values().any(|known| *known == read.state));
        names.extend(same.map(|read| (path.as_path(), read.state)));
    }
    names
}
