//! The outbox: when each delivery is tried. Each store has its own pace and each delivery its own
//! pauses, so that neither a store that is away nor a record that cannot be stored delays another.
//!
//! A delivery is tried only at a store that is known to be in reach; a store that is not is asked from
//! time to time, without limit. Whatever fails is tried again, without limit.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use super::{ScanId, backoff};

/// A store at which so many different scans have failed one after the other rests, and is tried with one at a time.
const SEVERAL: usize = 3;

/// Identifies one delivery.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    pub scan: ScanId,
    /// The patient's id; `None` while no patient is named.
    pub patient: Option<String>,
    pub store: String,
}

/// How an attempt at a delivery ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// For good: delivered, refused or taken back.
    ForGood,
    /// It will be tried again; the fault is not the store's.
    PutOff,
    /// A record that was to be taken back was changed by someone, or something is in its way. It stays until
    /// the operator has dealt with it: taking it back is tried again.
    Kept,
    /// It will be tried again, and the store is asked whether it is in reach.
    StoreFailed,
    /// The same, but the store may have something against this record alone, such as one that is locked there.
    NotTaken,
}

/// What to start now.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Plan {
    /// Stores to ask whether they are in reach.
    pub ask: Vec<String>,
    /// Deliveries to try, those of one scan and patient together: they share a measurement.
    pub attempts: Vec<Vec<Key>>,
}

/// What is known about the attempts at deliveries.
#[derive(Debug, Default)]
pub struct Outbox {
    stores: BTreeMap<String, Store>,
    pauses: BTreeMap<Key, Pause>,
    in_hand: BTreeSet<Key>,
}

/// The state of a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reach {
    /// Not asked yet, or something has failed there since.
    Unknown,
    /// It is being asked.
    Asked,
    Answers,
    /// It is to be asked again at this time.
    Away {
        until: Duration,
    },
    /// An operation that was started there does not return.
    Stalled,
}

#[derive(Debug, Clone)]
struct Store {
    reach: Reach,
    /// How often in a row it did not answer, or did not take a record while it fails.
    failures: u32,
    /// The scans that failed there since the last that did not, at most [`SEVERAL`].
    failed: BTreeSet<ScanId>,
}

#[derive(Debug, Clone, Copy)]
struct Pause {
    failures: u32,
    until: Duration,
}

impl Outbox {
    /// Decides what to start. `due` are all deliveries to be made, in the order in which they are
    /// wanted; at most `jobs_max` scans are in progress at a time, not counting those at stalled stores.
    pub fn plan(&mut self, due: &[Key], now: Duration, jobs_max: usize) -> Plan {
        let ask = self.to_ask(due.iter().map(|key| key.store.clone()), now);
        let mut plan = Plan { ask, attempts: Vec::new() };
        // A delivery that is no longer due needs no pause; so nothing here grows over the years.
        let names: BTreeSet<&Key> = due.iter().collect();
        self.pauses.retain(|key, _| names.contains(key));
        let mut free = jobs_max.saturating_sub(self.busy());
        for key in due {
            let Some(store) = self.stores.get(&key.store) else { continue };
            let paused = self.pauses.get(key).is_some_and(|pause| pause.until > now);
            if store.reach != Reach::Answers || paused || self.in_hand.contains(key) {
                continue;
            }
            let same = |group: &&mut Vec<Key>| {
                group.first().is_some_and(|k| k.scan == key.scan && k.patient == key.patient)
            };
            // The operator may have decided otherwise while a delivery was in progress: its replacement
            // comes after it.
            let mut tried = self.in_hand.iter().chain(plan.attempts.iter().flatten());
            let is_tried_there = tried.any(|other| {
                let is_behind = other.scan == key.scan && other.patient != key.patient;
                other.store == key.store && (is_behind || store.is_failing())
            });
            if is_tried_there {
                continue;
            }
            if let Some(group) = plan.attempts.iter_mut().find(same) {
                group.push(key.clone());
            } else if free > 0 {
                free -= 1;
                plan.attempts.push(vec![key.clone()]);
            }
        }
        self.in_hand.extend(plan.attempts.iter().flatten().cloned());
        plan
    }

    /// How many scans are in progress at stores that answer.
    pub fn busy(&self) -> usize {
        let stalled = |key: &&Key| {
            self.stores.get(&key.store).is_some_and(|store| store.reach == Reach::Stalled)
        };
        let busy = self.in_hand.iter().filter(|key| !stalled(key));
        busy.map(|key| (&key.scan, &key.patient)).collect::<BTreeSet<_>>().len()
    }

    /// Those of these stores to ask now. Something other than a delivery waits for them, as an erasure does.
    pub fn to_ask(
        &mut self,
        stores: impl IntoIterator<Item = String>,
        now: Duration,
    ) -> Vec<String> {
        let mut ask = Vec::new();
        for name in stores {
            let store = self.stores.entry(name.clone()).or_insert(Store::NEW);
            if store.wants_asking(now) {
                store.reach = Reach::Asked;
                ask.push(name);
            }
        }
        ask
    }

    /// A store is being asked although nothing is due there, as at a start.
    pub fn asking(&mut self, store: &str) {
        self.stores.entry(store.to_owned()).or_insert(Store::NEW).reach = Reach::Asked;
    }

    /// A store was asked. `chance` is uniform in [0, 1).
    pub fn asked(&mut self, store: &str, in_reach: bool, now: Duration, chance: f64) {
        let store = self.stores.entry(store.to_owned()).or_insert(Store::NEW);
        if !in_reach {
            store.rest(now, chance);
            return;
        }
        store.reach = Reach::Answers;
        if !store.is_failing() {
            store.failures = 0;
        }
    }

    /// Whether different scans have failed at a store, one after the other.
    pub fn is_failing(&self, store: &str) -> bool {
        self.stores.get(store).is_some_and(Store::is_failing)
    }

    /// An operation started at a store does not return: nothing else is started there until it does.
    pub fn stalled(&mut self, store: &str) {
        self.stores.entry(store.to_owned()).or_insert(Store::NEW).reach = Reach::Stalled;
    }

    /// An attempt ended; returns the length of the pause, if there is one.
    pub fn ended(
        &mut self,
        key: &Key,
        ended: Ended,
        now: Duration,
        chance: f64,
    ) -> Option<Duration> {
        self.in_hand.remove(key);
        let store = self.stores.entry(key.store.clone()).or_insert(Store::NEW);
        let has_failed = matches!(ended, Ended::StoreFailed | Ended::NotTaken);
        if has_failed || store.reach == Reach::Stalled {
            store.reach = Reach::Unknown;
        }
        if has_failed {
            if !store.is_failing() {
                store.failed.insert(key.scan.clone());
            }
            if store.is_failing() {
                store.rest(now, chance);
            }
        }
        if ended == Ended::ForGood {
            (store.failures, store.failed) = (0, BTreeSet::new());
            self.pauses.remove(key);
            return None;
        }
        let failures = self.pauses.get(key).map_or(0, |pause| pause.failures).saturating_add(1);
        let pause = backoff::pause(failures, chance);
        self.pauses.insert(key.clone(), Pause { failures, until: now + pause });
        Some(pause)
    }

    /// The operator wants a scan tried now. Stores that rest are asked for it.
    pub fn retry_now(&mut self, scan: &ScanId) {
        for key in self.pauses.keys().filter(|key| key.scan == *scan) {
            if let Some(store) = self.stores.get_mut(&key.store)
                && matches!(store.reach, Reach::Away { .. })
            {
                store.reach = Reach::Unknown;
            }
        }
        self.pauses.retain(|key, _| key.scan != *scan);
    }

    /// Whether a plan could start anything: a hand is free, or a store wants asking. If not, what is due
    /// does not matter.
    pub fn can_start(&self, now: Duration, jobs_max: usize) -> bool {
        self.busy() < jobs_max || self.stores.values().any(|store| store.wants_asking(now))
    }

    /// How long after the plan of `now` something can start by the passing of time alone; `None` if
    /// nothing waits. What that plan could have started but did not waits for something else: a store
    /// that is away, or a delivery in progress.
    pub fn next_in(&self, now: Duration, jobs_max: usize) -> Option<Duration> {
        let has_room = self.busy() < jobs_max;
        let waiting = self.pauses.iter().filter(|(key, _)| has_room && !self.in_hand.contains(key));
        let pauses = waiting.map(|(_, pause)| pause.until);
        let away = self.stores.values().filter_map(|store| match store.reach {
            Reach::Away { until } => Some(until),
            _ => None,
        });
        let next = pauses.chain(away).filter(|until| *until > now).min();
        next.map(|until| until.saturating_sub(now))
    }
}

impl Store {
    const NEW: Store = Store { reach: Reach::Unknown, failures: 0, failed: BTreeSet::new() };

    fn is_failing(&self) -> bool {
        self.failed.len() >= SEVERAL
    }

    fn rest(&mut self, now: Duration, chance: f64) {
        self.failures = self.failures.saturating_add(1);
        self.reach = Reach::Away { until: now + backoff::pause(self.failures, chance) };
    }

    fn wants_asking(&self, now: Duration) -> bool {
        match self.reach {
            Reach::Unknown => true,
            Reach::Away { until } => until <= now,
            Reach::Asked | Reach::Answers | Reach::Stalled => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::from_secs(100);

    fn key(scan: u8, store: &str) -> Key {
        Key { scan: ScanId::of_digest([scan; 32]), patient: None, store: store.to_owned() }
    }

    /// An outbox whose stores are in reach.
    fn outbox(stores: &[&str]) -> Outbox {
        let mut outbox = Outbox::default();
        stores.iter().for_each(|store| outbox.asked(store, true, NOW, 0.5));
        outbox
    }

    #[test]
    fn a_store_is_asked_once_before_anything_is_tried_there() {
        let (mut outbox, due) = (Outbox::default(), [key(1, "a"), key(2, "a")]);
        let plan = outbox.plan(&due, NOW, 4);
        assert_eq!(plan, Plan { ask: vec!["a".into()], attempts: vec![] });
        assert_eq!(outbox.plan(&due, NOW, 4), Plan::default(), "it is being asked");
        outbox.asked("a", true, NOW, 0.5);
        assert_eq!(outbox.plan(&due, NOW, 4).attempts, [[key(1, "a")], [key(2, "a")]]);
    }

    #[test]
    fn a_store_that_is_away_delays_no_other_and_is_asked_for_ever() {
        let mut outbox = outbox(&["b"]);
        let due = [key(1, "a"), key(1, "b")];
        assert_eq!(outbox.plan(&due, NOW, 4).ask, ["a"]);
        assert!(outbox.in_hand.contains(&key(1, "b")));
        outbox.ended(&key(1, "b"), Ended::ForGood, NOW, 0.5);
        let mut now = NOW;
        for _ in 0..50 {
            outbox.asked("a", false, now, 1.0);
            let wait = outbox.next_in(now, 4).unwrap();
            assert!(wait > Duration::ZERO && wait <= backoff::CEILING);
            assert_eq!(outbox.plan(&due[..1], now, 4), Plan::default());
            now += wait;
            assert_eq!(outbox.plan(&due[..1], now, 4).ask, ["a"]);
        }
    }

    #[test]
    fn deliveries_of_one_scan_are_tried_together_and_hands_count_scans() {
        let mut outbox = outbox(&["a", "b"]);
        let due = [key(1, "a"), key(1, "b"), key(2, "a"), key(3, "a")];
        let plan = outbox.plan(&due, NOW, 2);
        assert_eq!(plan.attempts, [vec![key(1, "a"), key(1, "b")], vec![key(2, "a")]]);
        assert_eq!(outbox.plan(&due, NOW, 2), Plan::default());
        outbox.ended(&key(2, "a"), Ended::ForGood, NOW, 0.5);
        let due = [key(1, "a"), key(1, "b"), key(3, "a")];
        assert_eq!(outbox.plan(&due, NOW, 2).attempts, [[key(3, "a")]]);
    }

    #[test]
    fn deliveries_of_one_scan_to_two_are_made_one_after_the_other() {
        let mut outbox = outbox(&["a"]);
        let theirs = Key { patient: Some("4711".to_owned()), ..key(1, "a") };
        let due = [key(1, "a"), theirs.clone()];
        assert_eq!(outbox.plan(&due, NOW, 4).attempts, [[key(1, "a")]]);
        assert_eq!(outbox.plan(&due[1..], NOW, 4), Plan::default());
        outbox.ended(&key(1, "a"), Ended::ForGood, NOW, 0.5);
        assert_eq!(outbox.plan(&due[1..], NOW, 4).attempts, [[theirs]]);
    }

    #[test]
    fn a_record_that_cannot_be_put_does_not_stand_before_the_others() {
        let mut outbox = outbox(&["a"]);
        let due = [key(1, "a"), key(2, "a")];
        assert_eq!(outbox.plan(&due, NOW, 1).attempts, [[key(1, "a")]]);
        assert!(outbox.ended(&key(1, "a"), Ended::StoreFailed, NOW, 0.9).is_some());
        assert_eq!(outbox.plan(&due, NOW, 1).ask, ["a"]);
        outbox.asked("a", true, NOW, 0.5);
        assert_eq!(outbox.plan(&due, NOW, 1).attempts, [[key(2, "a")]]);
    }

    /// What a store is asked and tried within a time, if it answers and takes nothing.
    fn tries(outbox: &mut Outbox, due: &[Key], ended: Ended, end: Duration) -> (usize, usize) {
        let (mut now, mut asked, mut tried) = (NOW, 0, 0);
        while now < end {
            let plan = outbox.plan(due, now, 3);
            for store in &plan.ask {
                asked += 1;
                outbox.asked(store, true, now, 0.5);
            }
            for key in plan.attempts.iter().flatten() {
                tried += 1;
                outbox.ended(key, ended, now, 0.5);
            }
            now += Duration::from_millis(100);
        }
        (asked, tried)
    }

    #[test]
    fn a_store_that_answers_and_takes_none_of_many_records_rests_and_is_tried_with_one() {
        let due: Vec<Key> = (1..=20).map(|n| key(n, "a")).collect();
        for ended in [Ended::StoreFailed, Ended::NotTaken] {
            let mut outbox = outbox(&["a"]);
            let end = NOW + Duration::from_secs(60);
            let (asked, tried) = tries(&mut outbox, &due, ended, end);
            assert!(outbox.is_failing("a"));
            assert!((4..=16).contains(&tried) && asked <= 16, "{ended:?}: {asked}, {tried}");
            // A person does not wait for that.
            outbox.retry_now(&due[0].scan);
            assert_eq!(outbox.plan(&due, end, 3).ask, ["a"]);
            outbox.asked("a", true, end, 0.5);
            let plan = outbox.plan(&due, end, 3);
            assert_eq!(plan.attempts.len(), 1, "one at a time");
            outbox.ended(&plan.attempts[0][0], Ended::ForGood, end, 0.5);
            assert!(!outbox.is_failing("a"));
            let later = end + backoff::CEILING;
            assert_eq!(outbox.plan(&due[10..], later, 3).attempts.len(), 3);
        }
    }

    #[test]
    fn one_record_that_a_store_does_not_take_keeps_no_other_waiting() {
        let mut outbox = outbox(&["a"]);
        let (_, tried) = tries(&mut outbox, &[key(1, "a")], Ended::NotTaken, NOW * 2);
        assert!(tried > 1 && !outbox.is_failing("a"), "{tried}");
    }

    #[test]
    fn a_pause_that_is_over_causes_no_wake_while_its_store_is_away() {
        let (mut outbox, due) = (outbox(&["a"]), [key(1, "a")]);
        outbox.plan(&due, NOW, 1);
        let pause = outbox.ended(&key(1, "a"), Ended::StoreFailed, NOW, 0.5).unwrap();
        assert_eq!(outbox.next_in(NOW, 1), Some(pause));
        let later = NOW + pause;
        assert_eq!(outbox.plan(&due, later, 1).ask, ["a"]);
        outbox.asked("a", false, later, 1.0);
        assert_eq!(outbox.plan(&due, later, 1), Plan::default());
        assert_eq!(outbox.next_in(later, 1), Some(backoff::pause(1, 1.0)));
    }

    #[test]
    fn a_store_that_an_erasure_waits_for_is_asked_until_it_answers_though_nothing_is_due_there() {
        let mut outbox = outbox(&["a"]);
        let waits = || ["a".to_owned(), "b".to_owned()];
        assert_eq!(outbox.to_ask(waits(), NOW), ["b"], "the other answers");
        assert!(outbox.to_ask(waits(), NOW).is_empty(), "it is being asked");
        outbox.asked("b", false, NOW, 0.5);
        let wait = outbox.next_in(NOW, 4).unwrap();
        assert!(outbox.to_ask(waits(), NOW).is_empty(), "too early");
        assert_eq!(outbox.to_ask(waits(), NOW + wait), ["b"]);
        outbox.asked("b", true, NOW + wait, 0.5);
        assert!(outbox.to_ask(waits(), NOW + wait).is_empty());
    }

    #[test]
    fn while_no_hand_is_free_only_a_store_that_wants_asking_matters() {
        let mut outbox = outbox(&["a", "b"]);
        let due = [key(1, "a"), key(2, "a"), key(2, "b")];
        outbox.plan(&due[..1], NOW, 2);
        outbox.ended(&key(1, "a"), Ended::PutOff, NOW, 0.9);
        assert!(outbox.can_start(NOW, 1) && outbox.next_in(NOW, 1).is_some());
        outbox.plan(&due[1..2], NOW, 1);
        assert!(!outbox.can_start(NOW, 1) && outbox.can_start(NOW, 2));
        assert_eq!(outbox.next_in(NOW, 1), None);
        outbox.asked("b", false, NOW, 0.5);
        let wait = outbox.next_in(NOW, 1).unwrap();
        assert!(!outbox.can_start(NOW, 1) && outbox.can_start(NOW + wait, 1));
        assert_eq!(outbox.plan(&due, NOW + wait, 1).ask, ["b"]);
    }

    #[test]
    fn a_stalled_store_takes_no_hands_and_goes_on_when_it_comes_back() {
        let mut outbox = outbox(&["a", "b"]);
        outbox.plan(&[key(1, "a")], NOW, 1);
        outbox.stalled("a");
        let due = [key(1, "a"), key(2, "a"), key(3, "b")];
        assert_eq!(outbox.plan(&due, NOW, 1).attempts, [[key(3, "b")]]);
        outbox.ended(&key(1, "a"), Ended::ForGood, NOW, 0.5);
        assert_eq!(outbox.plan(&due[1..2], NOW, 2).ask, ["a"]);
    }

    #[test]
    fn a_person_may_cut_a_pause_short() {
        let mut outbox = outbox(&["a"]);
        let due = [key(1, "a")];
        outbox.plan(&due, NOW, 1);
        outbox.ended(&key(1, "a"), Ended::PutOff, NOW, 0.9);
        assert_eq!(outbox.plan(&due, NOW, 1), Plan::default());
        outbox.retry_now(&key(1, "a").scan);
        assert_eq!(outbox.plan(&due, NOW, 1).attempts, [[key(1, "a")]]);
    }
}
