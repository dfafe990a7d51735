//! The desk: the orders of the practice software, and what the station reads of them.

use std::time::Duration;

use gaiter_flow::OrdersWhen;
use gaiter_flow::orders::{self, News, OrderState};
use gaiter_flow::round::Doubt;
use gaiter_record::SourceKind;

use super::laws::Off;
use super::people::{People, Said};
use super::truth::id;

/// An order, as the practice software keeps it.
#[derive(Debug, Clone)]
pub struct Order {
    pub file: String,
    pub patient: usize,
    pub mtime_ms: u64,
    /// The journal failed when it was to be heard.
    pub is_late: bool,
    /// When it did not lie there yet, on the station's clock; none if the station did not look then.
    pub absent: Option<Duration>,
}

impl Order {
    fn state(&self) -> OrderState {
        let mtime_ns = i128::from(self.mtime_ms) * 1_000_000;
        OrderState { size: 100, mtime_ns, digest: id(self.patient) }
    }
}

impl People {
    /// An order of the practice software is written. The desk does not order for somebody else while
    /// somebody stands in the booth unnamed who has not been scanned.
    pub fn order(&mut self, patient: usize) {
        let order = self.written(patient);
        self.booth.tell(|| format!("an order for {}", id(patient)));
        // With a button everybody takes a late order to be for its press.
        let is_late = self.not_ordered.remove(&patient).is_some() && self.has_button();
        if !is_late && !self.waiting.contains(&patient) {
            self.waiting.push(patient);
        }
        if self.keeps_orders {
            self.orders.push(order.clone());
        }
        self.letters.push(order);
        self.read_orders();
    }

    /// An order that is written now.
    pub fn written(&mut self, patient: usize) -> Order {
        let file = format!("order{}", self.booth.truth.comment());
        let (mtime_ms, absent) = (self.booth.now_ms, self.orders_absent());
        Order { file, patient, mtime_ms, is_late: false, absent }
    }

    /// When the station saw last that an order which is written now is not there.
    pub fn orders_absent(&self) -> Option<Duration> {
        if self.are_orders_away { self.orders_seen } else { Some(self.booth.clock()) }
    }

    /// The folder goes out of reach just before an order that comes after its press is written, or comes back.
    pub fn orders_away(&mut self) -> bool {
        let is_late = self.newest_not_ordered().is_some();
        if !self.runs() || !(self.are_orders_away || is_late) {
            return false;
        }
        self.booth.missed_name();
        if self.are_orders_away {
            self.booth.tell(|| "the folder of orders is back".to_owned());
            self.are_orders_away = false;
            self.read_orders();
            return true;
        }
        self.booth.tell(|| "the folder of orders is out of reach".to_owned());
        (self.are_orders_away, self.orders_seen) = (true, Some(self.booth.clock()));
        self.newest_not_ordered().is_some_and(|patient| {
            self.order(patient);
            true
        })
    }

    /// Whose order is still to come, if theirs was the last scan.
    pub fn newest_not_ordered(&self) -> Option<usize> {
        let newest = self.booth.truth.bodies.len().checked_sub(1);
        let mut all = self.not_ordered.iter();
        all.find(|(_, body)| Some(**body) == newest).map(|(patient, _)| *patient)
    }

    /// The station reads what orders there are.
    pub fn read_orders(&mut self) {
        if self.booth.run.is_none() {
            // What a run could not keep it takes with it.
            self.letters.iter_mut().for_each(|order| (order.is_late, order.absent) = (false, None));
            self.orders_seen = None;
        }
        if !self.runs() || self.letters.is_empty() || self.are_orders_away {
            return;
        }
        if self.booth.disk.is_locked {
            // They were said and are not kept.
            self.booth.unread();
            self.letters.iter_mut().for_each(|order| order.is_late = true);
            return;
        }
        for order in std::mem::take(&mut self.letters) {
            // One that could not be read in time comes too late where no button tells one scan from
            // the next.
            let is_of_before = order.mtime_ms < self.booth.now_ms;
            self.booth.truth.is_late |= is_of_before && self.is_nobodys_awaited();
            self.read_order(&order);
        }
    }

    /// The orders that lie there are noted, and name nobody.
    pub fn pass_over_orders(&mut self) {
        for order in std::mem::take(&mut self.letters) {
            self.booth.disk.orders.insert(order.file.clone(), order.state());
        }
    }

    fn read_order(&mut self, order: &Order) {
        let (words, found) = (id(order.patient), order.state());
        let known = self.booth.disk.orders.insert(order.file.clone(), found.clone());
        let news = match self.booth.setup.off {
            Off::OrdersNameOnce => News::New,
            _ => orders::news(known.as_ref(), &found),
        };
        match news {
            News::Known => {}
            News::Repeated => {
                self.booth.tell(|| format!("the order for {words} came again"));
                let doubt = Some(Doubt::Repeated);
                self.booth.heard_name(&words, SourceKind::Order, doubt, order.absent);
            }
            News::New => {
                let doubt = order.is_late.then_some(Doubt::Unread);
                self.booth.heard_name(&words, SourceKind::Order, doubt, order.absent);
            }
        }
    }

    /// Whether this is a practice that orders after the press.
    pub fn orders_after_press(&self) -> bool {
        self.has_button() && self.booth.setup.rules.orders == OrdersWhen::AfterPress
    }

    /// Whether the desk may send an order for somebody who is not in the booth.
    pub fn may_order_ahead(&self) -> bool {
        if self.orders_after_press() {
            return false;
        }
        let is_unnamed = self.standing.is_some() && self.said_now() != Some(Said::Name);
        let was_scanned = self.said.is_none() && self.was_scanned();
        self.runs()
            && !self.booth.disk.is_locked
            && (!is_unnamed || was_scanned)
            && !self.is_nobodys_awaited()
            && !self.is_order_owed()
    }

    /// Whether the order of a scan is still to come where orders come after the press.
    pub fn is_order_owed(&self) -> bool {
        let is_after_press = self.booth.setup.rules.orders == OrdersWhen::AfterPress;
        is_after_press && self.not_ordered.keys().any(|patient| self.unsettled_of(*patient))
    }
}
