//! Which file in the folder of orders is a new order, and how old it is.
//!
//! An order that was heard may lie there for years, and whatever looks after the folder may touch it: a
//! virus scanner, a backup, somebody who sets permissions. None of that names a patient again.

use std::time::Duration;

/// A file in the folder of orders, as far as it matters to whether it was heard. Not what a change of
/// mode or a link changes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OrderState {
    /// Its size, bytes.
    pub size: u64,
    /// When its content was last written, nanoseconds since 1970, as the file says.
    pub mtime_ns: i128,
    /// The digest of its bytes; empty where they were not read: they are too many for an order, or
    /// could not be read.
    pub digest: String,
}

/// What a file in the folder of orders is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum News {
    /// The one that was heard.
    Known,
    /// The same words as the one that was heard, written at another time: whether the patient comes
    /// again is a question.
    Repeated,
    /// One that was not heard.
    New,
}

/// What a file is, by what is known of the one that was heard under its name. Nothing is known of one
/// that was gone since.
pub fn news(known: Option<&OrderState>, found: &OrderState) -> News {
    let Some(known) = known else { return News::New };
    let is_unread = known.digest.is_empty() || found.digest.is_empty();
    let same_words = known.size == found.size && (is_unread || known.digest == found.digest);
    match (same_words, known.mtime_ns == found.mtime_ns) {
        (false, _) => News::New,
        (true, true) => News::Known,
        // Nobody knows whether the words are the same.
        (true, false) if is_unread => News::New,
        (true, false) => News::Repeated,
    }
}

/// How old an order is that was first seen so long ago: at least that, and by the time of its file,
/// both nanoseconds since 1970, where that is no time to come.
pub fn age(mtime_ns: i128, wall_ns: i128, in_sight: Duration) -> Duration {
    let by_file_ns = u64::try_from((wall_ns - mtime_ns).max(0)).unwrap_or(u64::MAX);
    Duration::from_nanos(by_file_ns).max(in_sight)
}

/// Which folder a path leads to, as the system has it: device and inode.
pub type FolderId = (u64, u64);

/// What a look at the folder of orders says of those that it does not list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unlisted {
    /// They are gone.
    Gone,
    /// Nothing yet, but this is their folder from now on.
    TheirFolder,
    /// Nothing: it may be the bare folder of a share that is not mounted.
    Nothing,
}

/// What a look says of known orders that it does not list. `theirs` is the folder in which they were
/// seen, `lists` whether it lists any that is known, or none is known.
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

    fn order(mtime_ns: i128, digest: &str) -> OrderState {
        OrderState { size: 300, mtime_ns, digest: digest.into() }
    }

    #[test]
    fn the_same_words_at_the_same_time_are_known_and_at_another_a_question() {
        let heard = order(5, "a");
        assert_eq!(news(Some(&heard), &heard), News::Known);
        assert_eq!(news(Some(&heard), &order(6, "a")), News::Repeated);
        // The clock of the practice was put back, or an older copy was brought back.
        assert_eq!(news(Some(&heard), &order(4, "a")), News::Repeated);
    }

    #[test]
    fn other_words_and_a_file_that_was_gone_are_new() {
        let heard = order(5, "a");
        assert_eq!(news(Some(&heard), &order(5, "b")), News::New);
        assert_eq!(news(Some(&heard), &OrderState { size: 301, ..heard.clone() }), News::New);
        assert_eq!(news(None, &heard), News::New);
        // Of one that was not read, size and time are all that is known.
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
        // It was mounted anew, or none was ever seen.
        assert_eq!(unlisted(Some(share), (3, 7), true), Unlisted::TheirFolder);
        assert_eq!(unlisted(None, share, true), Unlisted::TheirFolder);
    }
}
