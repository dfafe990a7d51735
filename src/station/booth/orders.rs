//! Orders of practice software: files that name the patient of the next scan.
//!
//! An order names its patient at most once. It is noted as heard before it is heard, and removed
//! after: whatever cuts that off, no old order is heard again when another patient stands in the
//! booth. Which file is a new order is decided by [`crate::flow::order_news`]. One that cannot be read
//! is set aside with its reason and named to a person.

mod aside;
mod known;
mod list_orders;
mod read;
mod removal;
mod take;

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use tokio::task::JoinError;
use tokio::time::sleep;
use tracing::{info, warn};

use crate::config::OrdersConfig;
use crate::flow::booth::Heard;
use crate::flow::facts::Alarm;
use crate::flow::{Look, LookTime, Settled, Settling};
use crate::record::SourceKind;
use crate::record::gdt::{Charset, Order, OrderFault, order};
use crate::station::assembly::Station;
use crate::station::beat::Beat;
use crate::station::error::chain;
use crate::station::jitter;
use crate::station::journal::JournalError;
use crate::station::stall::{DEADLINE, LOOK_UP, Pulse, patiently};
use crate::station::stop::Stop;
use take::{Before, Taken, take};

/// The alarm of a station that had lost its journal.
const JOURNAL_REBUILT: &str = "journal-rebuilt";

/// Alarm: the folder of orders cannot be listed.
const OUT_OF_REACH: &str = "orders-out-of-reach";

/// Alarm: an order could not be read and was set aside.
const REFUSED: &str = "order-refused";

/// Alarm: an order came again with the same words.
const REPEATED: &str = "order-repeated";

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

/// The orders of one folder on their way to being heard.
struct Orders {
    settling: Settling,
    /// Orders that could not be heard, for the journal failed.
    unheard: BTreeMap<PathBuf, Before>,
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
    let settling = Settling::new(config.quiet, config.quiet, config.max_age);
    let mut orders = Orders { settling, unheard: BTreeMap::new() };
    let mut in_reach = true;
    let mut forgotten = station.board.facts().alarms.contains_key(JOURNAL_REBUILT);
    while !stop.is_requested() {
        let alive = || beat.beat();
        let stalled = || out_of_reach(&station, "it does not answer");
        let (theirs, of) = (Arc::clone(&config), Arc::clone(&station));
        let look = move |pulse: &Pulse| {
            let began = of.now();
            let found = looked(&of, &theirs, forgotten, pulse);
            (found, LookTime { began, ended: of.now() })
        };
        let looked = patiently(DEADLINE, &mut stop, look, alive, stalled).await?;
        let Some((found, when)) = looked else { break };
        forgotten &= found.is_err();
        let look = told(&station, found, &mut in_reach);
        for settled in orders.due(look, when) {
            alive();
            let (theirs, of, order) = (Arc::clone(&config), Arc::clone(&station), settled.clone());
            let before = orders.unheard.get(&settled.path).cloned();
            let taking = move |pulse: &Pulse| take(&of, &theirs, &order, before, pulse);
            let stalled = || out_of_reach(&station, "it does not answer");
            let taken = patiently(DEADLINE, &mut stop, taking, alive, stalled).await?;
            let Some(taken) = taken else { return Ok(()) };
            if let Err(fault) = &taken {
                warn!(event = "order-put-off", error = chain(fault));
                if let TakeFault::Journal(error) = fault {
                    station.check_corruption(error);
                }
            }
            orders.taken(&settled, taken, station.now());
        }
        rest(&config, &station, &beat, &mut stop).await;
    }
    Ok(())
}

/// A look, and what the journal learns from it before anything is heard. Blocks.
///
/// # Errors
/// Where the folder cannot be listed, or the journal fails: nothing may be heard then.
fn looked(
    station: &Station,
    config: &OrdersConfig,
    forgotten: bool,
    pulse: &Pulse,
) -> io::Result<list_orders::Found> {
    let found = list_orders::look(&config.path, &config.files, pulse)?;
    let noted = match forgotten {
        true => known::pass_over(station, &found, pulse),
        false => known::update(station, config, &found, pulse),
    };
    noted.map_err(|error| {
        station.check_corruption(&error);
        io::Error::other(chain(&error))
    })?;
    Ok(found)
}

impl Orders {
    /// The orders to be dealt with after a look; of two that came at once, the later one names the
    /// patient.
    fn due(&mut self, look: Look, when: LookTime) -> Vec<Settled> {
        if let Look::Seen(there) = &look {
            self.unheard.retain(|path, _| there.contains_key(path));
        }
        let mut due = self.settling.observe(look, when);
        due.sort_by_key(|settled| settled.stamp.mtime_ns);
        due
    }

    fn taken(&mut self, settled: &Settled, taken: Result<Taken, TakeFault>, now: Duration) {
        match taken {
            Ok(Taken::Done) => {
                self.unheard.remove(&settled.path);
                self.settling.taken(settled);
            }
            Ok(Taken::Changed) => self.settling.changed(settled, now),
            Ok(Taken::Unheard(known)) => {
                self.unheard.insert(settled.path.clone(), Before::Noted(known));
                self.settling.failed(settled, now, jitter::unit());
            }
            Ok(Taken::Later) => {
                self.unheard.remove(&settled.path);
                self.settling.failed(settled, now, jitter::unit());
            }
            Err(fault) => {
                if let TakeFault::Journal(_) = fault {
                    self.unheard.entry(settled.path.clone()).or_insert(Before::Unnoted);
                }
                self.settling.failed(settled, now, jitter::unit());
            }
        }
    }
}

/// Waits for the next look, and beats meanwhile.
async fn rest(config: &OrdersConfig, station: &Station, beat: &Beat, stop: &mut Stop) {
    let until = station.now() + config.rescan;
    loop {
        beat.beat();
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
fn told(station: &Station, found: io::Result<list_orders::Found>, in_reach: &mut bool) -> Look {
    match found {
        Ok(found) => {
            if !std::mem::replace(in_reach, true) {
                info!(event = "orders-in-reach");
            }
            station.board.note(|facts| drop(facts.alarms.remove(OUT_OF_REACH)));
            Look::Seen(found.orders)
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

/// Reads an order that somebody brings; one that cannot be read puts the name that waits in doubt.
/// Blocks.
///
/// # Errors
/// Why it is none.
pub fn brought(station: &Station, bytes: &[u8]) -> Result<Order, OrderFault> {
    let config = station.config.patient.orders.as_ref();
    let (charset, lenient) =
        config.map_or((Charset::Cp1252, false), |config| (config.charset, config.lenient));
    let order = order::read(bytes, charset, lenient);
    match &order {
        Ok(_) => take::tell_taken(station),
        // It is another program's.
        Err(OrderFault::OtherKind { .. }) => {}
        Err(_) => {
            station.hear(&Heard::Unread { by: SourceKind::Order });
        }
    }
    order
}

#[cfg(test)]
mod tests;
