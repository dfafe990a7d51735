//! What the journal knows about the orders in their folder. Every look updates it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gaiter_flow::OrderState;
use gaiter_flow::orders::{Unlisted, unlisted};
use tracing::warn;

use super::list_orders::{Found, is_meant};
use super::read;
use crate::config::OrdersConfig;
use crate::station::core::Core;
use crate::station::journal::JournalError;
use crate::station::share::stall::StepCounter;
use crate::store::durable;

/// Notes all orders as applied, because only the lost journal knew which of them had been. Applying one twice
/// could give one patient another patient's scan, so none of them is applied.
///
/// # Errors
/// See [`JournalError`]; what was not noted must not be applied.
pub fn pass_over(core: &Core, found: &Found, counter: &StepCounter) -> Result<(), JournalError> {
    for (path, order) in &found.orders {
        let stamp = order.stamp;
        let unread =
            || OrderState { size: stamp.size, mtime_ns: stamp.mtime_ns, digest: String::new() };
        let read = read::read(path, stamp, counter).ok().flatten();
        let state = read.map_or_else(unread, |read| read.state);
        core.custody.journal().order_handled(path, &state)?;
    }
    warn!(event = "orders-passed-over", count = found.orders.len());
    Ok(())
}

/// Updates what is known after a look. If a known order was linked or renamed, it is known under its
/// other names too. Orders that are gone are forgotten: a file that comes under their names is new,
/// even with the same content.
///
/// # Errors
/// See [`JournalError`]; a link may then be taken for a new order.
pub fn update(
    core: &Core,
    config: &OrdersConfig,
    found: &Found,
    counter: &StepCounter,
) -> Result<(), JournalError> {
    let journal = core.custody.journal();
    let known = journal.orders_known(&config.path)?;
    for (path, state) in other_names(found, &known, counter) {
        journal.order_handled(path, &state)?;
    }
    let is_there = |path: &Path| found.orders.contains_key(path);
    let lists = known.is_empty() || known.keys().any(|path| is_there(path));
    match unlisted(journal.orders_folder()?, found.folder, lists) {
        Unlisted::Nothing => Ok(()),
        Unlisted::TheirFolder => journal.orders_seen_in(found.folder),
        Unlisted::Gone => {
            let is_gone = |path: &&Path| {
                // A name that the mask no longer matches was not looked for.
                let looked_for = is_meant(path, &config.files);
                looked_for && !is_there(path) && !found.unexamined.contains(*path)
            };
            let gone: Vec<&Path> = known.keys().map(AsRef::as_ref).filter(is_gone).collect();
            // A power cut must not bring back a forgotten name.
            match gone.is_empty() || durable::sync_folder(&config.path).is_ok() {
                true => journal.forget_orders(&gone),
                false => Ok(()),
            }
        }
    }
}

/// Files with unknown names whose content and times are those of a known order.
fn other_names<'a>(
    found: &'a Found,
    known: &BTreeMap<PathBuf, OrderState>,
    counter: &StepCounter,
) -> Vec<(&'a Path, OrderState)> {
    let mut names = Vec::new();
    for (path, order) in found.orders.iter().filter(|(path, _)| !known.contains_key(*path)) {
        let (size, mtime_ns) = (order.stamp.size, order.stamp.mtime_ns);
        if !known.values().any(|known| (known.size, known.mtime_ns) == (size, mtime_ns)) {
            continue;
        }
        let read = read::read(path, order.stamp, counter).ok().flatten();
        let same = read.filter(|read| known.values().any(|known| *known == read.state));
        names.extend(same.map(|read| (path.as_path(), read.state)));
    }
    names
}
