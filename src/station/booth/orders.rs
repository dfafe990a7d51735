//! Orders of practice software: files that name the patient of the next scan.
//!
//! An order names its patient at most once. It is noted as applied before it is applied, and removed
//! afterwards. So after any interruption, no old order is applied again while another patient stands in the
//! booth. [`gaiter_flow::orders`] decides which file is a new order. An order that cannot be read is set
//! aside with its reason and reported to the operator.

mod aside;
mod known;
mod list_orders;
mod read;
mod removal;
mod take;

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use gaiter_flow::booth::PortEvent;
use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::{Group, Look, LookTime, Settled, Settling, Stamp};
use gaiter_record::gdt::{Order, OrderFault, order};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use crate::config::OrdersConfig;
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::journal::JournalError;
use crate::station::runtime::{Heartbeat, Stop, chain, random_unit};
use crate::station::share::stall::{DEADLINE, StepCounter, patiently};
use take::{Before, Taken, take};

/// Alarm: the station had lost its journal.
const JOURNAL_REBUILT: &str = "journal-rebuilt";

/// Alarm: the folder of orders cannot be listed.
const OUT_OF_REACH: &str = "orders-out-of-reach";

/// The folder of orders as a source of names.
const SOURCE: &str = "orders";

/// Alarm: an order could not be read and was set aside.
const REFUSED: &str = "order-refused";

/// Alarm: an order came again with the same content.
const REPEATED: &str = "order-repeated";

/// Alarm: an order was read and cannot be deleted.
const NOT_REMOVED: &str = "order-not-removed";

/// Why an order could not be dealt with now.
#[derive(Debug, thiserror::Error)]
enum TakeFault {
    /// I/O failed at the folder of orders, or where refused orders are set aside.
    #[error("{what} failed")]
    Io {
        what: &'static str,
        #[source]
        source: io::Error,
    },
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
}

/// The orders of one folder that are to be applied.
struct Orders {
    settling: Settling,
    /// Orders that could not be applied: they could not be read, or the journal failed.
    unapplied: BTreeMap<PathBuf, Before>,
    /// The files that the last look found.
    lying: BTreeMap<PathBuf, Lying>,
    /// When the last look began that could list the folder.
    last_look: Option<Duration>,
}

/// Since when an order may have lain in the folder: a press since then may be its patient's.
#[derive(Debug, Clone, Copy)]
struct Lying {
    /// When the last look began that did not find it; `None` if there was none before.
    absent: Option<Duration>,
    /// The state in which it was dealt with; in another state it is another order.
    done: Option<Stamp>,
}

/// Looks for orders until it is asked to stop.
///
/// # Errors
/// If one of its own steps panicked.
pub async fn worker(
    booth: Arc<Booth>,
    config: OrdersConfig,
    beat: Heartbeat,
    mut stop: Stop,
) -> Result<(), JoinError> {
    let (core, config) = (Arc::clone(booth.core()), Arc::new(config));
    let settling = Settling::new(config.quiet, config.quiet, config.max_age);
    let mut orders = Orders::new(settling);
    let is_any_unread = Arc::new(AtomicBool::new(false));
    let mut looks = booth.looks();
    let mut forgotten = core.board.facts().alarms.contains_key(JOURNAL_REBUILT);
    while !stop.is_requested() {
        let alive = || beat.beat();
        let (theirs, of) = (Arc::clone(&config), Arc::clone(&booth));
        let was_any_unread = Arc::clone(&is_any_unread);
        let look = move |counter: &StepCounter| {
            let began = of.core().now();
            let found = looked(of.core(), &theirs, forgotten, counter);
            let look = believed(&of, &was_any_unread, found);
            (look, LookTime { began, ended: of.core().now() })
        };
        let looked = patiently(DEADLINE, &mut stop, look, alive, || stalled(&booth)).await?;
        let Some((look, when)) = looked else { break };
        forgotten &= look == Look::OutOfReach;
        for settled in orders.due(look, when) {
            alive();
            let (theirs, of, order) = (Arc::clone(&config), Arc::clone(&booth), settled.clone());
            let before = orders.unapplied.get(&settled.path).cloned();
            let absent = orders.absent(&settled.path);
            let taking = move |counter: &StepCounter| {
                let is_first = before.is_none();
                let taken = take(&of, &theirs, &order, before, absent, counter);
                if is_first && matches!(taken, Err(TakeFault::Io { .. })) {
                    // Its patient may be the one at the booth.
                    of.receive(&PortEvent::UnreadOrder { absent });
                }
                taken
            };
            let taken = patiently(DEADLINE, &mut stop, taking, alive, || stalled(&booth)).await?;
            let Some(taken) = taken else { return Ok(()) };
            if let Err(fault) = &taken {
                warn!(event = "order-put-off", error = chain(fault));
                if let TakeFault::Journal(error) = fault {
                    core.check_corruption(error);
                }
            }
            orders.taken(&settled, taken, core.now());
        }
        let rest = beat.during(sleep(config.quiet));
        // A press asks for a look at once: an order that was not there then came after it.
        tokio::select! {
            () = stop.requested() => {}
            _ = looks.changed() => {}
            () = rest => {}
        }
    }
    Ok(())
}

/// Looks at the folder, and updates the journal before any order is applied. Blocks.
///
/// # Errors
/// If the folder cannot be listed or the journal fails. Then no order may be applied.
fn looked(
    core: &Core,
    config: &OrdersConfig,
    forgotten: bool,
    counter: &StepCounter,
) -> io::Result<list_orders::Found> {
    let found = list_orders::look(&config.path, &config.files, counter)?;
    let noted = match forgotten {
        true => known::pass_over(core, &found, counter),
        false => known::update(core, config, &found, counter),
    };
    noted.map_err(|error| {
        core.check_corruption(&error);
        io::Error::other(chain(&error))
    })?;
    Ok(found)
}

impl Orders {
    /// Nothing seen yet.
    fn new(settling: Settling) -> Orders {
        let (unapplied, lying, last_look) = (BTreeMap::new(), BTreeMap::new(), None);
        Orders { settling, unapplied, lying, last_look }
    }

    /// The orders to be dealt with after a look, oldest first: of two that came at once, the later one
    /// names the patient.
    fn due(&mut self, look: Look, when: LookTime) -> Vec<Settled> {
        if let Look::Seen(there) = &look {
            self.unapplied.retain(|path, _| there.contains_key(path));
            self.found(there, when.began);
        }
        let mut due = self.settling.observe(look, when);
        due.sort_by_key(|settled| settled.group.stamp.mtime_ns);
        due
    }

    /// Notes which files a look found that began then.
    fn found(&mut self, there: &BTreeMap<PathBuf, Group>, began: Duration) {
        let absent = self.last_look.replace(began);
        self.lying.retain(|path, _| there.contains_key(path));
        for (path, group) in there {
            let known = self.lying.get(path);
            let is_known = known.is_some_and(|it| it.done.is_none_or(|done| done == group.stamp));
            if !is_known {
                self.lying.insert(path.clone(), Lying { absent, done: None });
            }
        }
    }

    /// When a look last showed that this order was not there yet.
    fn absent(&self, path: &Path) -> Option<Duration> {
        self.lying.get(path).and_then(|lying| lying.absent)
    }

    fn taken(&mut self, settled: &Settled, taken: Result<Taken, TakeFault>, now: Duration) {
        match taken {
            Ok(Taken::Done) => {
                self.unapplied.remove(&settled.path);
                let lying = self.lying.get_mut(&settled.path).map(|lying| {
                    lying.done = Some(settled.group.stamp);
                    Lying { done: None, ..*lying }
                });
                // One that was put back under its own name is no younger for that.
                if let (Some(lying), Some(name)) = (lying, removal::original(&settled.path)) {
                    self.lying.entry(name).or_insert(lying);
                }
                self.settling.taken(settled);
            }
            Ok(Taken::Changed) => self.settling.changed(settled, now),
            Ok(Taken::Unheard(known)) => {
                self.unapplied.insert(settled.path.clone(), Before::Noted(known));
                self.settling.failed(settled, now, random_unit());
            }
            Ok(Taken::Later) => {
                self.unapplied.remove(&settled.path);
                self.settling.failed(settled, now, random_unit());
            }
            Err(_) => {
                self.unapplied.entry(settled.path.clone()).or_insert(Before::Unnoted);
                self.settling.failed(settled, now, random_unit());
            }
        }
    }
}

/// Converts the result of a look, before any order that it found is applied: while the folder is out of reach, or holds
/// files that cannot be examined (`is_any_unread`), orders may come and go unnoticed. Blocks.
fn believed(
    booth: &Booth,
    is_any_unread: &AtomicBool,
    found: io::Result<list_orders::Found>,
) -> Look {
    match found {
        Ok(found) => {
            if booth.core().board.clear(OUT_OF_REACH) {
                info!(event = "orders-in-reach");
                booth.missed_name(SOURCE);
            }
            // Their patients may be at the booth.
            let is_any = !found.unexamined.is_empty();
            if is_any_unread.swap(is_any, Ordering::Relaxed) != is_any {
                warn!(event = "orders-unexamined", count = found.unexamined.len());
                booth.missed_name(SOURCE);
            }
            Look::Seen(found.orders)
        }
        Err(error) => {
            if is_newly_lost(booth, &Cause::of_system(&error)) {
                booth.missed_name(SOURCE);
            }
            Look::OutOfReach
        }
    }
}

/// The folder does not answer. Does not block.
fn stalled(booth: &Arc<Booth>) {
    if is_newly_lost(booth, &Cause::known("no-answer", [])) {
        let booth = Arc::clone(booth);
        drop(spawn_blocking(move || booth.missed_name(SOURCE)));
    }
}

/// Notes that the folder is out of reach. Logs it if it was in reach before; returns whether it was.
fn is_newly_lost(booth: &Booth, why: &Cause) -> bool {
    let is_new = booth.core().board.raise(OUT_OF_REACH, ComplaintFigures::why(why));
    if is_new {
        warn!(event = "orders-out-of-reach", error = why.to_string());
    }
    is_new
}

/// Reads an order that a client hands in. An order that cannot be read puts the waiting name in doubt.
/// Blocks.
///
/// # Errors
/// Why the bytes are not an order.
pub fn brought(booth: &Booth, bytes: &[u8]) -> Result<Order, OrderFault> {
    let config = &booth.core().config;
    let lenient = config.patient.orders.as_ref().is_some_and(|orders| orders.lenient);
    let order = order::read(bytes, config.store.gdt_product.charset(), lenient);
    match &order {
        Ok(_) => take::report_taken(booth.core()),
        // It is meant for another program.
        Err(OrderFault::OtherKind { .. }) => {}
        Err(_) => {
            booth.receive(&PortEvent::UnreadOrder { absent: Some(booth.core().now()) });
        }
    }
    order
}

#[cfg(test)]
mod tests;
