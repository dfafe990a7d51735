//! Orders from practice software: which are new, and whether they arrive before the press of the button or after it.
//!
//! An order may stay in its folder for years after it was applied, and other programs and people may touch
//! its file: a virus scanner, a backup, an administrator who sets permissions. None of that names a patient
//! again.

use std::time::Duration;

use gaiter_language::Language;
use serde::{Deserialize, Serialize};

/// Whether an order arrives before the press of the button or after it, by the habit of the practice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OrdersWhen {
    /// Before it: an order names the patient of the next press.
    #[default]
    BeforePress,
    /// After it: an order names the patient of the press that is open.
    AfterPress,
}

/// How many of the latest orders define the habit: a practice may change it.
pub const ORDERS_MOST: usize = 50;

/// Fewer orders do not make a habit.
const ORDERS_LEAST: usize = 5;

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
        language.filled("terminal.orders_late", &[("after", &self.after), ("count", &self.of)])
    }
}

/// Whether most of the latest orders arrived after the press. `are_late`: of each, whether it arrived while a press
/// without a name was open; the newest order comes last.
pub fn orders_come_late(are_late: &[bool]) -> Option<OrdersComeLate> {
    let last = &are_late[are_late.len().saturating_sub(ORDERS_MOST)..];
    let after = last.iter().filter(|is_late| **is_late).count();
    let is_habit = last.len() >= ORDERS_LEAST && after * 2 > last.len();
    is_habit.then_some(OrdersComeLate { after, of: last.len() })
}

/// The state of a file in the folder of orders by which an applied order is recognised. Excludes what a
/// change of mode or a link changes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OrderState {
    /// Its size, bytes.
    pub size: u64,
    /// When its content was last written, according to the file, nanoseconds since 1970.
    pub mtime_ns: i128,
    /// The digest of its bytes; empty if they were not read, because there are too many for an order or
    /// because reading failed.
    pub digest: String,
}

/// What a file in the folder of orders is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum News {
    /// The order that was already applied.
    Known,
    /// The same content as the applied order, written at another time: whether the patient comes again is in
    /// doubt.
    Repeated,
    /// An order that was not applied before.
    New,
}

/// Classifies a file by what is known of the order that was applied under its name. Nothing is known of an
/// order whose file has been missing since.
pub fn news(known: Option<&OrderState>, found: &OrderState) -> News {
    let Some(known) = known else { return News::New };
    let is_unread = known.digest.is_empty() || found.digest.is_empty();
    let same_words = known.size == found.size && (is_unread || known.digest == found.digest);
    match (same_words, known.mtime_ns == found.mtime_ns) {
        (false, _) => News::New,
        (true, true) => News::Known,
        // It is unknown whether the words are the same.
        (true, false) if is_unread => News::New,
        (true, false) => News::Repeated,
    }
}

/// How old an order is that was first seen `in_sight` ago: at least that old, and at least as old as its
/// file, unless the file's time is in the future. Both times are nanoseconds since 1970.
pub fn age(mtime_ns: i128, wall_ns: i128, in_sight: Duration) -> Duration {
    let by_file_ns = u64::try_from((wall_ns - mtime_ns).max(0)).unwrap_or(u64::MAX);
    Duration::from_nanos(by_file_ns).max(in_sight)
}

/// The folder that a path leads to: device and inode.
pub type FolderId = (u64, u64);

/// What a look at the folder of orders means for the orders that it does not list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unlisted {
    Gone,
    /// Nothing yet, but this is their folder from now on.
    TheirFolder,
    /// Nothing: it may be the bare folder of a share that is not mounted.
    Nothing,
}

/// What a look means for known orders that it does not list. `theirs` is the folder in which they were
/// seen; `lists` is whether it lists any known order, or no order is known.
pub fn unlisted(theirs: Option<FolderId>, found: FolderId, lists: bool) -> Unlisted {
    match (theirs == Some(found), lists) {
        (true, _) => Unlisted::Gone,
        (false, true) => Unlisted::TheirFolder,
        (false, false) => Unlisted::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(before: usize, after: usize) -> Option<OrdersComeLate> {
        orders_come_late(&[vec![false; before], vec![true; after]].concat())
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

    fn order(mtime_ns: i128, digest: &str) -> OrderState {
        OrderState { size: 300, mtime_ns, digest: digest.into() }
    }

    #[test]
    fn the_same_words_at_the_same_time_are_known_and_at_another_a_question() {
        let heard = order(5, "a");
        assert_eq!(news(Some(&heard), &heard), News::Known);
        assert_eq!(news(Some(&heard), &order(6, "a")), News::Repeated);
        // The practice's clock was set back, or an older copy was restored.
        assert_eq!(news(Some(&heard), &order(4, "a")), News::Repeated);
    }

    #[test]
    fn other_words_and_a_file_that_was_gone_are_new() {
        let heard = order(5, "a");
        assert_eq!(news(Some(&heard), &order(5, "b")), News::New);
        assert_eq!(news(Some(&heard), &OrderState { size: 301, ..heard.clone() }), News::New);
        assert_eq!(news(None, &heard), News::New);
        // If one of them was not read, only size and time can be compared.
        for found in ["", "a"] {
            assert_eq!(news(Some(&order(5, "")), &order(5, found)), News::Known);
            assert_eq!(news(Some(&order(5, "")), &order(6, found)), News::New);
        }
    }

    #[test]
    fn an_order_ages_by_its_file_and_one_dated_ahead_since_it_was_seen() {
        let (second, hour) = (Duration::from_secs(1), Duration::from_secs(3600));
        let ns = |time: Duration| i128::try_from(time.as_nanos()).unwrap();
        assert_eq!(age(0, ns(hour), second), hour);
        assert_eq!(age(ns(hour), 0, second), second);
        assert_eq!(age(ns(hour), 0, 2 * hour), 2 * hour);
        assert_eq!(age(i128::MIN / 2, i128::MAX / 2, second), Duration::from_nanos(u64::MAX));
    }

    #[test]
    fn an_order_is_gone_only_where_its_own_folder_does_not_list_it() {
        let (share, bare) = ((1, 7), (2, 9));
        assert_eq!(unlisted(Some(share), share, false), Unlisted::Gone);
        assert_eq!(unlisted(Some(share), bare, false), Unlisted::Nothing);
        // It was mounted again, or no folder was ever seen.
        assert_eq!(unlisted(Some(share), (3, 7), true), Unlisted::TheirFolder);
        assert_eq!(unlisted(None, share, true), Unlisted::TheirFolder);
    }
}
