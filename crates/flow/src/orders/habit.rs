//! Whether the orders of a practice arrive before the press of the button or after it.

use std::fmt::Display;

use gaiter_language::Language;
use serde::{Deserialize, Serialize};

/// How many of the latest orders define the habit: a practice may change it.
pub const ORDERS_MOST: usize = 50;

/// Fewer orders do not make a habit.
const ORDERS_LEAST: usize = 5;

/// When an order arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrderCame {
    /// Before the press of its patient.
    BeforePress,
    /// While a press without a name was open.
    AfterPress,
}

/// Most orders arrive after the press: the practice should set this in its configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct OrdersComeLate {
    /// How many arrived after it.
    pub after: usize,
    /// How many orders were counted.
    pub of: usize,
}

impl OrdersComeLate {
    /// What was seen, and the key to set.
    pub fn in_words(self, language: Language) -> String {
        let words: [(&str, &dyn Display); 2] = [("after", &self.after), ("count", &self.of)];
        language.filled("terminal.orders_late", &words)
    }
}

/// Whether most of the latest orders arrived after the press; the newest order comes last.
pub fn orders_come_late(orders: &[OrderCame]) -> Option<OrdersComeLate> {
    let last = &orders[orders.len().saturating_sub(ORDERS_MOST)..];
    let after = last.iter().filter(|came| **came == OrderCame::AfterPress).count();
    let is_habit = last.len() >= ORDERS_LEAST && after * 2 > last.len();
    is_habit.then_some(OrdersComeLate { after, of: last.len() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(before: usize, after: usize) -> Option<OrdersComeLate> {
        let before = vec![OrderCame::BeforePress; before];
        orders_come_late(&[before, vec![OrderCame::AfterPress; after]].concat())
    }

    #[test]
    fn a_practice_is_told_where_more_than_half_of_five_orders_or_more_come_after_the_press() {
        let cases = [
            (0, 0, false),
            (0, 4, false),
            (0, 5, true),
            (2, 3, true),
            (3, 2, false),
            (5, 5, false),
            (5, 6, true),
        ];
        for (before, after, is_told) in cases {
            let told = is_told.then_some(OrdersComeLate { after, of: before + after });
            assert_eq!(late(before, after), told, "{before} before, {after} after");
        }
    }

    #[test]
    fn only_the_last_orders_count() {
        assert_eq!(late(1000, 26), Some(OrdersComeLate { after: 26, of: ORDERS_MOST }));
        assert_eq!(late(1000, 25), None);
    }

    #[test]
    fn it_is_said_with_the_key_to_set() {
        assert_eq!(
            late(2, 7).unwrap().in_words(Language::En),
            "7 of the last 9 orders came after the press of the button; \
             set patient.orders.when = \"after-press\""
        );
    }
}
