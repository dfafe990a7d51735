//! Orders of practice software: files that name the patient of the next scan.
//!
//! An order names its patient at most once. It is noted as seen before it is heard, and removed
//! after: whatever cuts that off, no old order is heard again when another patient stands in the
//! booth. An order that cannot be read is set aside with its reason and named to a person.

mod aside;
mod look;

use std::io;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use tokio::task::JoinError;
use tokio::time::sleep;
use tracing::{info, warn};

use super::assembly::Station;
use super::beat::Beat;
use super::chance;
use super::error::chain;
use super::journal::JournalError;
use super::patience::{DEADLINE, LOOK_UP, Pulse, patiently};
use super::source;
use super::stop::Stop;
use crate::config::{AfterOrder, OrdersConfig};
use crate::flow::booth::Heard;
use crate::flow::facts::Alarm;
use crate::flow::{Look, LookTime, Settled, Settling};
use crate::record::SourceKind;
use crate::record::gdt::order::{self, ORDER_MOST};
use crate::record::gdt::{Charset, Order, OrderFault};

/// The alarm of a station that had lost its journal.
const JOURNAL_REBUILT: &str = "journal-rebuilt";

/// Alarm: the folder of orders cannot be listed.
const OUT_OF_REACH: &str = "orders-out-of-reach";

/// Alarm: an order could not be read and was set aside.
const REFUSED: &str = "order-refused";

/// Alarm: an order was read and cannot be deleted.
const NOT_REMOVED: &str = "order-not-removed";

/// Why an order could not be dealt with now.
#[derive(Debug, thiserror::Error)]
enum TakeFault {
    /// At the folder of orders, or where refused ones are set aside.
    #[error("{what} failed")]
    Io {
        /// What was tried.
        what: &'static str,
        /// How it failed.
        #[source]
        source: io::Error,
    },
    /// The journal failed.
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
}

/// What became of an order.
enum Taken {
    /// It was dealt with in this state.
    Done,
    /// It changed while it was read.
    Changed,
}

/// Looks for orders until it is asked to stop.
///
/// # Errors
/// Where a step of its own panicked.
pub async fn worker(
    station: Arc<Station>,
    config: OrdersConfig,
    beat: Beat,
    mut stop: Stop,
) -> Result<(), JoinError> {
    let config = Arc::new(config);
    let mut settling = Settling::new(config.quiet, config.quiet, config.max_age);
    let mut in_reach = true;
    let mut forgotten = station.board.facts().alarms.contains_key(JOURNAL_REBUILT);
    while !stop.is_requested() {
        let alive = || beat.beat(station.now());
        let stalled = || out_of_reach(&station, "it does not answer");
        let (theirs, of) = (Arc::clone(&config), Arc::clone(&station));
        let look = move |pulse: &Pulse| {
            let began = of.now();
            let found = look::look(&theirs.path, &theirs.files, pulse);
            if forgotten && let Ok(orders) = &found {
                pass_over(&of, orders);
            }
            (found, LookTime { began, ended: of.now() })
        };
        let looked = patiently(DEADLINE, &mut stop, look, alive, stalled).await?;
        let Some((found, when)) = looked else { break };
        forgotten &= found.is_err();
        let look = told(&station, found, &mut in_reach);
        let mut due = settling.observe(look, when);
        // Of two that came at once, the later one names the patient.
        due.sort_by_key(|settled| settled.stamp.mtime_ns);
        for settled in due {
            let (theirs, of, order) = (Arc::clone(&config), Arc::clone(&station), settled.clone());
            let taking = move |pulse: &Pulse| take(&of, &theirs, &order, pulse);
            let stalled = || out_of_reach(&station, "it does not answer");
            let taken = patiently(DEADLINE, &mut stop, taking, alive, stalled).await?;
            let now = station.now();
            match taken {
                None => return Ok(()),
                Some(Ok(Taken::Done)) => settling.taken(&settled),
                Some(Ok(Taken::Changed)) => settling.changed(&settled, now),
                Some(Err(fault)) => {
                    warn!(event = "order-put-off", error = chain(&fault));
                    if let TakeFault::Journal(error) = &fault {
                        station.mind(error);
                    }
                    settling.failed(&settled, now, chance::unit());
                }
            }
        }
        rest(&config, &station, &beat, &mut stop).await;
    }
    Ok(())
}

/// A journal that was lost knew which of these had been heard. To hear one twice may give one patient
/// another's scan; so none of them is.
fn pass_over(station: &Station, orders: &look::Orders) {
    for (path, order) in orders {
        if let Err(error) = station.custody.journal().sighted(path, order.stamp, None) {
            station.mind(&error);
        }
    }
    warn!(event = "orders-passed-over", count = orders.len());
}

/// Waits for the next look, and beats meanwhile.
async fn rest(config: &OrdersConfig, station: &Station, beat: &Beat, stop: &mut Stop) {
    let until = station.now() + config.rescan;
    loop {
        beat.beat(station.now());
        let left = until.saturating_sub(station.now()).min(LOOK_UP);
        if left == Duration::ZERO {
            return;
        }
        tokio::select! {
            () = stop.requested() => return,
            () = sleep(left) => {}
        }
    }
}

/// What a look found; a change of the folder's reach is told.
fn told(station: &Station, found: io::Result<look::Orders>, in_reach: &mut bool) -> Look {
    match found {
        Ok(orders) => {
            if !std::mem::replace(in_reach, true) {
                info!(event = "orders-in-reach");
            }
            station.board.note(|facts| drop(facts.alarms.remove(OUT_OF_REACH)));
            Look::Seen(orders)
        }
        Err(error) => {
            if std::mem::replace(in_reach, false) {
                warn!(event = "orders-out-of-reach", error = %error);
            }
            out_of_reach(station, &error.to_string());
            Look::OutOfReach
        }
    }
}

fn out_of_reach(station: &Station, why: &str) {
    alarm(station, OUT_OF_REACH, format!("the folder of orders cannot be listed: {why}"));
}

fn alarm(station: &Station, code: &'static str, message: String) {
    station.board.note(|facts| {
        let known = facts.alarms.get(code).map(|known| known.since);
        let since = known.unwrap_or_else(Timestamp::now);
        facts.alarms.insert(code, Alarm { message, since });
    });
}

/// Deals with one order. Blocks.
fn take(
    station: &Station,
    config: &OrdersConfig,
    settled: &Settled,
    pulse: &Pulse,
) -> Result<Taken, TakeFault> {
    let journal = station.custody.journal();
    if journal.was_sighted(&settled.path, settled.stamp)? {
        // It is to stay, or is no order; or the last run ended before it was removed.
        if config.after == AfterOrder::Delete && is_order(settled, config, pulse) {
            remove(station, settled);
        }
        return Ok(Taken::Done);
    }
    if settled.stamp.size > ORDER_MOST {
        let fault = OrderFault::TooLarge { bytes: settled.stamp.size };
        journal.sighted(&settled.path, settled.stamp, None)?;
        refused(station, fault.code(), &fault.to_string(), "it was left where it lies");
        return Ok(Taken::Done);
    }
    let read = source::bytes(&settled.path, settled.stamp, pulse);
    let read = read.map_err(|source| TakeFault::Io { what: "reading an order", source })?;
    let Some(bytes) = read else { return Ok(Taken::Changed) };
    let order = order::read(&bytes, config.charset, config.lenient);
    match order {
        Err(OrderFault::OtherKind { found }) => {
            // Results and orders may share a folder: this one is for another program.
            journal.sighted(&settled.path, settled.stamp, None)?;
            info!(event = "order-passed-over", kind = found);
            return Ok(Taken::Done);
        }
        Err(fault) => {
            set_aside(station, &bytes, fault.code(), &fault.to_string())?;
            journal.sighted(&settled.path, settled.stamp, None)?;
            refused(station, fault.code(), &fault.to_string(), "it lies in orders-refused");
        }
        Ok(_) if is_old(settled, config.max_age) => {
            let message = "it is older than patient.orders.max_age and names nobody any more";
            set_aside(station, &bytes, "order-too-old", message)?;
            journal.sighted(&settled.path, settled.stamp, None)?;
            refused(station, "order-too-old", message, "it lies in orders-refused");
        }
        Ok(order) => {
            journal.sighted(&settled.path, settled.stamp, None)?;
            hear(station, order);
        }
    }
    if config.after == AfterOrder::Delete {
        remove(station, settled);
    }
    Ok(Taken::Done)
}

/// Whether a file that was seen before is an order or was set aside as one, and not another
/// program's.
fn is_order(settled: &Settled, config: &OrdersConfig, pulse: &Pulse) -> bool {
    let is_small = settled.stamp.size <= ORDER_MOST;
    let read = is_small.then(|| source::bytes(&settled.path, settled.stamp, pulse));
    let Some(Ok(Some(bytes))) = read else { return false };
    let order = order::read(&bytes, config.charset, config.lenient);
    !matches!(order, Err(OrderFault::OtherKind { .. }))
}

/// Reads an order that somebody brings.
///
/// # Errors
/// Why it is none.
pub fn brought(station: &Station, bytes: &[u8]) -> Result<Order, OrderFault> {
    let config = station.config.patient.orders.as_ref();
    let (charset, lenient) =
        config.map_or((Charset::Cp1252, false), |config| (config.charset, config.lenient));
    let order = order::read(bytes, charset, lenient)?;
    info!(event = "order-taken");
    Ok(order)
}

fn hear(station: &Station, order: Order) {
    info!(event = "order-taken");
    station.board.note(|facts| drop(facts.alarms.remove(REFUSED)));
    station.hear(&Heard::Named { id: order.patient, by: SourceKind::Order });
}

fn set_aside(station: &Station, bytes: &[u8], code: &str, message: &str) -> Result<(), TakeFault> {
    let kept = aside::keep(&station.config.station.state_dir, bytes, code, message);
    kept.map_err(|source| TakeFault::Io { what: "setting an order aside", source })
}

fn refused(station: &Station, code: &str, message: &str, place: &str) {
    warn!(event = "order-refused", code);
    let message = format!("an order of the practice software was refused ({code}): {message}");
    alarm(station, REFUSED, format!("{message}; {place}"));
}

/// By the file's own time; a clock that lies ahead makes none old.
fn is_old(settled: &Settled, max_age: Duration) -> bool {
    let age_ns = Timestamp::now().as_nanosecond() - settled.stamp.mtime_ns;
    u128::try_from(age_ns).is_ok_and(|age_ns| age_ns > max_age.as_nanos())
}

/// Removes an order if it is still the one that was read. Where that fails it is told and the order
/// is not heard again.
fn remove(station: &Station, settled: &Settled) {
    match look::remove(&settled.path, settled.stamp) {
        Ok(()) => station.board.note(|facts| drop(facts.alarms.remove(NOT_REMOVED))),
        Err(error) => {
            warn!(event = "order-not-removed", error = %error);
            let message = "an order was read and cannot be deleted from its folder".to_owned();
            alarm(station, NOT_REMOVED, format!("{message}: {error}"));
        }
    }
}

#[cfg(test)]
mod tests;
