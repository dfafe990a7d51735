//! Deals with one order: whether it is new, whom it names, and what happens to its file.

use std::path::Path;
use std::time::Duration;

use gaiter_flow::booth::PortEvent;
use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::orders::{self, News};
use gaiter_flow::round::Doubt;
use gaiter_flow::{OrderState, Settled};
use gaiter_record::gdt::{Order, OrderFault, order};
use jiff::Timestamp;
use tracing::{info, warn};

use super::read::{self, Read};
use super::removal;
use super::{NOT_REMOVED, REFUSED, REPEATED, TakeFault, aside};
use crate::config::{AfterOrder, OrdersConfig};
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::share::stall::StepCounter;

/// The code of an order that is too old.
const TOO_OLD: &str = "order-too-old";

/// The outcome for an order.
pub enum Taken {
    /// It was dealt with in this state.
    Done,
    /// It changed while it was read.
    Changed,
    /// Its file must still be removed or put back.
    Later,
    /// The journal failed when it was to be applied. Holds what was known before it was noted.
    Unheard(Option<OrderState>),
}

/// An order that could not be applied before.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Before {
    /// It could not be read or noted.
    Unnoted,
    /// It was noted but could not be applied. Holds what was known before that.
    Noted(Option<OrderState>),
}

/// An order that is being dealt with.
struct Taking<'a> {
    core: &'a Core,
    booth: &'a Booth,
    config: &'a OrdersConfig,
    settled: &'a Settled,
    read: Read,
    /// It has a hidden name of ours.
    is_hidden: bool,
    /// It could not be applied earlier: other patients may have been named since.
    is_late: bool,
    /// It was not there yet at this time; `None` if not known.
    absent: Option<Duration>,
    counter: &'a StepCounter,
}

/// Deals with one order. `before` is set if it could not be applied before; at `absent` it was not there yet.
/// Blocks.
///
/// # Errors
/// See [`TakeFault`]; nothing was applied.
pub fn take(
    booth: &Booth,
    config: &OrdersConfig,
    settled: &Settled,
    before: Option<Before>,
    absent: Option<Duration>,
    counter: &StepCounter,
) -> Result<Taken, TakeFault> {
    let core = booth.core();
    let read = read::read(&settled.path, settled.group.stamp, counter);
    let read = read.map_err(|source| TakeFault::Io { what: "reading an order", source })?;
    let Some(read) = read else { return Ok(Taken::Changed) };
    let journal = core.custody.journal();
    let original = removal::original(&settled.path);
    let (is_hidden, is_late) = (original.is_some(), before.is_some());
    let taking = Taking { core, booth, config, settled, read, is_hidden, is_late, absent, counter };
    if let Some(original) = &original {
        for name in [&settled.path, original] {
            let known = journal.order_known(name)?;
            if orders::news(known.as_ref(), &taking.read.state) == News::Known {
                return taking.remove(&[&settled.path, name]);
            }
        }
        if removal::put_back(&settled.path, original).is_ok() {
            return Ok(Taken::Done);
        }
    }
    let known = match before {
        Some(Before::Noted(known)) => known,
        Some(Before::Unnoted) | None => journal.order_known(taking.path())?,
    };
    match orders::news(known.as_ref(), &taking.read.state) {
        // It is to stay, or it is not an order, or the last run ended before it was removed.
        News::Known if taking.is_order() => taking.remove_if_asked(),
        News::Known => Ok(Taken::Done),
        found => taking.apply(known, found == News::Repeated),
    }
}

impl Taking<'_> {
    fn path(&self) -> &Path {
        &self.settled.path
    }

    fn order(&self) -> Result<Order, OrderFault> {
        if self.read.is_too_large() {
            return Err(OrderFault::TooLarge { bytes: self.read.state.size });
        }
        let charset = self.core.config.store.gdt_product.charset();
        order::read(&self.read.bytes, charset, self.config.lenient)
    }

    /// Whether it is an order or was set aside as one, and not a file of another program.
    fn is_order(&self) -> bool {
        let order = self.order();
        !matches!(order, Err(OrderFault::OtherKind { .. } | OrderFault::TooLarge { .. }))
    }

    /// Applies an order that was not applied yet, or refuses it. It is noted first, so that no interruption
    /// applies it twice.
    fn apply(&self, known: Option<OrderState>, repeated: bool) -> Result<Taken, TakeFault> {
        let (received, refused) = match self.order() {
            // Results and orders may share a folder: this file is for another program and goes back.
            Err(OrderFault::OtherKind { .. }) if self.is_hidden => return Ok(Taken::Later),
            Err(OrderFault::OtherKind { found }) => {
                self.note()?;
                info!(event = "order-passed-over", kind = found);
                return Ok(Taken::Done);
            }
            Err(fault) => {
                let unread = PortEvent::UnreadOrder { absent: self.absent };
                (Some(unread), Some((fault.code(), Cause::from(&fault))))
            }
            Ok(_) if self.is_old() => (None, Some((TOO_OLD, Cause::known(TOO_OLD, [])))),
            Ok(order) => {
                let (id, absent) = (order.patient, self.absent);
                let late = self.is_late.then_some(Doubt::Unread);
                let doubt = if repeated { Some(Doubt::Repeated) } else { late };
                (Some(PortEvent::Ordered { id, doubt, absent }), None)
            }
        };
        if let Some((code, why)) = refused.as_ref().filter(|_| !self.read.is_too_large()) {
            let state_dir = &self.core.config.station.state_dir;
            let kept = aside::keep(state_dir, &self.read.bytes, code, &why.to_string());
            kept.map_err(|source| TakeFault::Io { what: "setting an order aside", source })?;
        }
        if let Err(fault) = self.note() {
            // The name was given but is not stored: the patient named before may have left.
            if received.is_some() {
                self.booth.receive(&PortEvent::UnreadOrder { absent: self.absent });
            }
            return Err(fault);
        }
        if received.is_some_and(|received| !self.booth.receive(&received)) {
            return Ok(Taken::Unheard(known));
        }
        match refused {
            Some((code, why)) => self.report_refused(code, &why),
            None if repeated => {
                warn!(event = "order-repeated");
                self.core.board.raise(REPEATED, ComplaintFigures::default());
            }
            None => report_taken(self.core),
        }
        if self.read.is_too_large() { Ok(Taken::Done) } else { self.remove_if_asked() }
    }

    fn note(&self) -> Result<(), TakeFault> {
        Ok(self.core.custody.journal().order_handled(self.path(), &self.read.state)?)
    }

    fn is_old(&self) -> bool {
        let in_sight = self.core.now().saturating_sub(self.settled.writing.appeared().seen);
        let wall_ns = Timestamp::now().as_nanosecond();
        orders::age(self.read.state.mtime_ns, wall_ns, in_sight) > self.config.max_age
    }

    fn report_refused(&self, code: &str, why: &Cause) {
        warn!(event = "order-refused", code);
        let place = if self.read.is_too_large() { "left" } else { "aside" };
        let figures = ComplaintFigures::default().words("fault", code).cause("said", why);
        self.core.board.raise(REFUSED, figures.words("place", place));
    }

    fn remove_if_asked(&self) -> Result<Taken, TakeFault> {
        match self.config.after {
            AfterOrder::Keep if !self.is_hidden => Ok(Taken::Done),
            AfterOrder::Keep | AfterOrder::Delete => self.remove(&[self.path()]),
        }
    }

    /// Removes the file if it is still the one that was read, and forgets what was known under these names.
    /// If it cannot be removed, an alarm is raised and the order is not applied again.
    fn remove(&self, names: &[&Path]) -> Result<Taken, TakeFault> {
        let removed = match self.is_hidden {
            true => removal::delete(self.path()),
            false => removal::remove(self.path(), &self.read, self.counter),
        };
        match removed {
            Ok(()) => {
                self.core.board.clear(NOT_REMOVED);
                self.core.custody.journal().forget_orders(names)?;
                Ok(Taken::Done)
            }
            Err(error) => {
                warn!(event = "order-not-removed", error = %error);
                self.core
                    .board
                    .raise(NOT_REMOVED, ComplaintFigures::why(&Cause::of_system(&error)));
                Ok(Taken::Later)
            }
        }
    }
}

/// Notes that a valid order was applied. It clears the alarms about earlier orders.
pub(super) fn report_taken(core: &Core) {
    info!(event = "order-taken");
    core.board.clear(REFUSED);
    core.board.clear(REPEATED);
}
