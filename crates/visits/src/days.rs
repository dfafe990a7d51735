//! Which scans of a patient are visits.

use std::collections::BTreeMap;

use gaiter_record::{Acquired, Record};

/// The last scan of each day on the calendar of its scanner, oldest first: a scan that was repeated on the same
/// day is no visit of its own. Scans of unknown time all stay, before the others.
pub fn last_of_days<T>(scans: Vec<T>, record: impl Fn(&T) -> &Record) -> Vec<T> {
    let acquired = |of: &T| -> Option<Acquired> { record(of).acquired.clone() };
    let (timed, mut kept): (Vec<T>, Vec<T>) =
        scans.into_iter().partition(|of| acquired(of).is_some());
    let mut days: BTreeMap<_, (Acquired, T)> = BTreeMap::new();
    for of in timed {
        let Some(own) = acquired(&of) else { continue };
        let day = own.local().date();
        if days.get(&day).is_none_or(|(known, _)| known.at < own.at) {
            days.insert(day, (own, of));
        }
    }
    kept.extend(days.into_values().map(|(_, of)| of));
    kept
}
