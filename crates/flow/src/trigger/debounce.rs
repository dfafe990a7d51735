//! A contact that is seen closed or open, with bounces → when it closes and opens.

use std::time::Duration;

/// How long a contact must be stable before its state is accepted. Contacts bounce for 1 to 20 ms; a longer
/// time misses quick presses.
pub(super) const DEBOUNCE: Duration = Duration::from_millis(30);

/// What a contact has done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// It has closed: the button is down.
    Down,
    /// It has opened.
    Up,
}

/// A contact, and how long its state must be stable before it is accepted.
#[derive(Debug, Clone)]
pub struct Contact {
    debounce: Duration,
    /// The accepted state; `None` before it is known.
    closed: Option<bool>,
    /// The state that is seen if it differs from the accepted one, and since when without a break.
    seen: Option<(bool, Duration)>,
    /// Since when the contact is accepted as closed.
    pub(super) closed_since: Option<Duration>,
}

impl Contact {
    /// A contact whose state is unknown: one that is closed from the beginning, because it is stuck or
    /// someone leans on it, does not count as closing.
    pub fn unknown(debounce: Duration) -> Contact {
        Contact { debounce, closed: None, seen: None, closed_since: None }
    }

    /// A contact that only reports its changes and has reported none: it is open.
    pub fn open(debounce: Duration) -> Contact {
        Contact { closed: Some(false), ..Contact::unknown(debounce) }
    }

    /// Processes how the contact is seen at `now`; returns what it has done, if that is certain by now.
    pub fn observe(&mut self, closed: bool, now: Duration) -> Option<Change> {
        if self.closed == Some(closed) {
            self.seen = None;
            return None;
        }
        let since = self.seen.filter(|(seen, _)| *seen == closed).map_or(now, |(_, since)| since);
        self.seen = Some((closed, since));
        if now.saturating_sub(since) < self.debounce {
            return None;
        }
        self.seen = None;
        self.closed_since = closed.then_some(now);
        let known = self.closed.replace(closed).is_some();
        known.then_some(if closed { Change::Down } else { Change::Up })
    }

    /// When a change becomes certain if the contact stays as it is seen; `None` if it is seen in its
    /// accepted state.
    pub fn due(&self) -> Option<Duration> {
        self.seen.map(|(_, since)| since + self.debounce)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(time: u64) -> Duration {
        Duration::from_millis(time)
    }

    /// The changes of a contact that is seen like this at these times, ms.
    fn changes(contact: &mut Contact, seen: &[(u64, bool)]) -> Vec<(u64, Change)> {
        let change = |(at, closed): &(u64, bool)| Some((*at, contact.observe(*closed, ms(*at))?));
        seen.iter().filter_map(change).collect()
    }

    #[test]
    fn a_contact_closes_once_it_was_seen_closed_for_the_whole_time() {
        let mut contact = Contact::open(DEBOUNCE);
        let seen = [(0, true), (10, true), (20, false), (22, true), (51, true), (52, true)];
        assert_eq!(changes(&mut contact, &seen), [(52, Change::Down)]);
        assert_eq!(contact.closed_since, Some(ms(52)));
        let seen = [(60, false), (89, false), (90, false), (200, false)];
        assert_eq!(changes(&mut contact, &seen), [(90, Change::Up)]);
    }

    #[test]
    fn a_contact_that_is_closed_from_the_beginning_does_not_close() {
        let mut contact = Contact::unknown(DEBOUNCE);
        assert_eq!(changes(&mut contact, &[(0, true), (30, true), (1000, true)]), []);
        assert_eq!(contact.closed_since, Some(ms(30)), "it is known to be closed all the same");
        let seen = [(1010, false), (1040, false), (2000, true), (2030, true)];
        let changes = changes(&mut contact, &seen);
        assert_eq!(changes, [(1040, Change::Up), (2030, Change::Down)]);
    }

    #[test]
    fn what_bounces_at_first_is_unknown_until_it_rests() {
        let mut contact = Contact::unknown(DEBOUNCE);
        let seen = [(0, false), (20, true), (40, false), (69, false), (70, false)];
        assert_eq!(changes(&mut contact, &seen), []);
        assert_eq!(changes(&mut contact, &[(80, true), (110, true)]), [(110, Change::Down)]);
    }

    #[test]
    fn without_a_time_every_change_is_believed_at_once() {
        let mut contact = Contact::open(Duration::ZERO);
        let seen = [(0, true), (1, false)];
        assert_eq!(changes(&mut contact, &seen), [(0, Change::Down), (1, Change::Up)]);
    }
}
