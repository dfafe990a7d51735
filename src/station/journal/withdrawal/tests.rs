//! Whatever a person decides while deliveries are in hand, fail, or are cut off: at rest each store holds
//! the record for whom it was decided last, and for nobody else.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use gaiter_flow::outbox::{Ended, Key};
use gaiter_flow::round::CaptureMatch;
use gaiter_flow::{Outbox, ScanState};
use gaiter_record::{Patient, Source, SourceKind};
use proptest::prelude::*;

use super::*;
use crate::station::journal::{Entry, ScanRow, Task};

const STORES: [&str; 3] = ["copy", "folder", "fhir"];

/// Those of them that are servers.
const SERVERS: [&str; 1] = ["fhir"];

fn is_server(store: &str) -> bool {
    SERVERS.contains(&store)
}

/// The stores that take the record of a scan of this patient: a server takes none without one.
fn takers(id: &str) -> Vec<&'static str> {
    STORES.into_iter().filter(|store| !id.is_empty() || !is_server(store)).collect()
}

fn open(dir: &Path) -> Journal {
    Journal::open(&dir.join("journal.db")).unwrap().with_servers(&SERVERS).unwrap()
}

/// What may happen next.
#[derive(Debug, Clone, Copy)]
enum Happening {
    /// A person assigns the scan to one of two patients, where it is unassigned.
    Assign(bool),
    /// A person takes it back from whose it is.
    Unassign,
    /// Begins the work, as far as the outbox allows it.
    Begin,
    /// What is in hand at this place continues by a step; the store may fail at it.
    GoOn(usize, bool),
    /// The station is killed and starts again.
    Crash,
}

fn happening() -> impl Strategy<Value = Happening> {
    prop_oneof![
        2 => any::<bool>().prop_map(Happening::Assign),
        2 => Just(Happening::Unassign),
        3 => Just(Happening::Begin),
        8 => (0_usize..4, prop::bool::weighted(0.8)).prop_map(|(at, ok)| Happening::GoOn(at, ok)),
        1 => Just(Happening::Crash),
    ]
}

/// How far an attempt has come.
#[derive(Debug, Clone)]
enum Stage {
    Begun,
    /// A delivery that is to be made; a withdrawal with the one who keeps the record.
    Ready(String),
    /// The store has done it.
    Done,
}

/// A station with one scan, two folders and a server that hold records by their patients' ids.
struct World {
    dir: tempfile::TempDir,
    journal: Journal,
    outbox: Outbox,
    now: Duration,
    hand: Vec<(Due, Stage)>,
    stores: BTreeMap<&'static str, BTreeSet<String>>,
    /// Whose the scan is by the last decision; '' for nobody.
    decided: String,
    number: usize,
    /// Whether it is asked before a record is put that nobody decided otherwise.
    looks_before: bool,
}

fn scan() -> ScanId {
    ScanId::of_digest([7; 32])
}

fn patient(id: &str) -> Patient {
    Patient { id: id.to_owned(), sources: vec![Source::from_kind(SourceKind::Operator)] }
}

fn key(due: &Due) -> Key {
    let patient = due.patient.as_ref().map(|patient| patient.id.clone());
    Key { scan: due.scan.clone(), patient, store: due.store.clone() }
}

fn store_of(due: &Due) -> &'static str {
    STORES.into_iter().find(|store| *store == due.store).unwrap()
}

impl World {
    fn new(first: Option<&str>, looks_before: bool) -> World {
        let dir = tempfile::tempdir().unwrap();
        let journal = open(dir.path());
        let row = ScanRow {
            scan: scan(),
            format: "obj".to_owned(),
            size: 12,
            first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
            file_time: None,
            pressed_at: None,
            state: ScanState::Spooled,
        };
        let (of, judged) = (first.map(patient), &CaptureMatch::Unpressed);
        let entry = Entry {
            row: &row,
            patient: of.as_ref(),
            held: None,
            claims: &[],
            judged,
            geometry: "",
            candidates: &[],
        };
        journal.enter(&entry, &takers(first.unwrap_or_default())).unwrap();
        World {
            dir,
            journal,
            outbox: Outbox::default(),
            now: Duration::ZERO,
            hand: Vec::new(),
            stores: STORES.into_iter().map(|store| (store, BTreeSet::new())).collect(),
            decided: first.unwrap_or_default().to_owned(),
            number: 0,
            looks_before,
        }
    }

    fn happens(&mut self, happening: Happening) {
        match happening {
            Happening::Assign(first) => self.assign(if first { "1" } else { "2" }),
            Happening::Unassign => self.unassign(),
            Happening::Begin => self.begin(),
            Happening::GoOn(at, ok) if !self.hand.is_empty() => {
                self.go_on(at % self.hand.len(), ok)
            }
            Happening::GoOn(..) => {}
            Happening::Crash => self.crash(),
        }
    }

    fn assign(&mut self, id: &str) {
        if self.journal.owners(&scan()).unwrap().is_empty() {
            self.number += 1;
            let (theirs, detail) = ([patient(id)], json!({ "decision": self.number }));
            let stores = takers(id);
            self.journal.given_to(&scan(), &theirs, &stores, Event::Assigned, &detail).unwrap();
            self.decided = id.to_owned();
        }
    }

    fn unassign(&mut self) {
        if self.journal.owners(&scan()).unwrap().len() == 1 {
            self.number += 1;
            let (stores, detail) = (takers(""), json!({ "decision": self.number }));
            self.journal.given_to(&scan(), &[], &stores, Event::Unassigned, &detail).unwrap();
            self.decided.clear();
        }
    }

    fn begin(&mut self) {
        // No pause is left.
        self.now += Duration::from_secs(3600);
        for store in STORES {
            self.outbox.asked(store, true, self.now, 0.5);
        }
        let pending = self.journal.pending().unwrap();
        let keys: Vec<Key> = pending.iter().map(key).collect();
        let plan = self.outbox.plan(&keys, self.now, 4);
        for begun in plan.attempts.iter().flatten() {
            let due = pending.iter().find(|due| key(due) == *begun).unwrap();
            self.hand.push((due.clone(), Stage::Begun));
        }
    }

    fn go_on(&mut self, at: usize, ok: bool) {
        let (due, stage) = self.hand.remove(at);
        let next = match due.task {
            Task::Deliver => self.deliver(&due, &stage, ok),
            Task::Withdraw => self.withdraw(&due, &stage, ok),
            Task::HandOver => Err(Ended::ForGood),
        };
        match next {
            Ok(stage) => self.hand.push((due, stage)),
            Err(ended) => {
                self.outbox.ended(&key(&due), ended, self.now, 0.5);
                if ended != Ended::ForGood {
                    let at = "2026-11-21T09:15:00Z".parse().unwrap();
                    self.journal.put_off(&due, "put-off", at).unwrap();
                }
            }
        }
    }

    fn deliver(&mut self, due: &Due, stage: &Stage, ok: bool) -> Result<Stage, Ended> {
        match stage {
            Stage::Begun if self.looks_before && !self.journal.is_to_be_made(due).unwrap() => {
                Err(Ended::ForGood)
            }
            Stage::Begun => Ok(Stage::Ready(String::new())),
            Stage::Ready(_) if !ok => Err(Ended::StoreFailed),
            Stage::Ready(_) => {
                let records = self.stores.get_mut(store_of(due)).unwrap();
                records.insert(due.patient_cell().to_owned());
                Ok(Stage::Done)
            }
            Stage::Done => {
                self.journal.delivered(due, "/r/x".as_ref()).unwrap();
                Err(Ended::ForGood)
            }
        }
    }

    /// A record goes only where the keeper's is there, as in the folder store; from a server at once.
    fn withdraw(&mut self, due: &Due, stage: &Stage, ok: bool) -> Result<Stage, Ended> {
        let from = due.patient_cell();
        match stage {
            Stage::Begun if is_server(&due.store) => Ok(Stage::Ready(String::new())),
            Stage::Begun => {
                let keeper = self.journal.keeper(&due.scan, &due.store).unwrap();
                let keeper = keeper.map(Option::unwrap_or_default);
                keeper.filter(|keeper| keeper != from).map(Stage::Ready).ok_or(Ended::PutOff)
            }
            Stage::Ready(_) if !ok => Err(Ended::StoreFailed),
            Stage::Ready(keeper) => {
                let records = self.stores.get_mut(store_of(due)).unwrap();
                if records.contains(from) && !records.contains(keeper) && !is_server(&due.store) {
                    return Err(Ended::Kept);
                }
                records.remove(from);
                Ok(Stage::Done)
            }
            Stage::Done => {
                self.journal.withdrawn(due).unwrap();
                Err(Ended::ForGood)
            }
        }
    }

    fn crash(&mut self) {
        self.hand.clear();
        self.outbox = Outbox::default();
        self.journal = open(self.dir.path());
        self.journal.take_back_unwanted().unwrap();
    }

    /// Everything goes well until nothing is to be done.
    fn comes_to_rest(&mut self) {
        for _ in 0..60 {
            self.begin();
            while !self.hand.is_empty() {
                self.go_on(0, true);
            }
            if self.journal.pending().unwrap().is_empty() {
                return;
            }
        }
        panic!("it never rests: {:?}", self.journal.pending());
    }
}

fn rests_where_it_was_decided_last(
    first: Option<&str>,
    looks_before: bool,
    happenings: &[Happening],
) -> Result<(), TestCaseError> {
    let mut world = World::new(first, looks_before);
    for happening in happenings {
        world.happens(*happening);
        prop_assert_eq!(world.journal.misjudged(), []);
    }
    world.comes_to_rest();
    prop_assert_eq!(world.journal.misjudged(), []);
    let takers = takers(&world.decided);
    for (store, records) in &world.stores {
        let takes = takers.contains(store);
        let decided = BTreeSet::from_iter(takes.then(|| world.decided.clone()));
        prop_assert_eq!(records, &decided, "in {}", store);
    }
    prop_assert_eq!(world.journal.tally().unwrap().withdrawing, 0);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, ..ProptestConfig::default() })]

    #[test]
    fn at_rest_a_record_lies_with_whom_it_was_decided_for_last_and_with_nobody_else(
        first in prop::option::of(Just("1")),
        looks_before in any::<bool>(),
        happenings in prop::collection::vec(happening(), 0..48),
    ) {
        rests_where_it_was_decided_last(first, looks_before, &happenings)?;
    }
}

#[test]
fn what_is_taken_back_and_assigned_again_while_it_is_put_for_nobody_is_not_left_there() {
    use Happening::{Assign, Begin, GoOn, Unassign};
    // Two folders and a server, from which the first is withdrawn meanwhile.
    let put_all = [GoOn(0, true); 3];
    let delivered = [Begin].into_iter().chain(put_all).chain(put_all).chain(put_all);
    let under_way = [Unassign, Begin].into_iter().chain(put_all).chain(put_all);
    for first in [true, false] {
        let happenings: Vec<Happening> =
            delivered.clone().chain(under_way.clone()).chain([Assign(first)]).collect();
        rests_where_it_was_decided_last(Some("1"), true, &happenings).unwrap();
    }
}

#[test]
fn what_was_taken_back_is_withdrawn_from_a_server_at_once_and_from_a_folder_once_another_has_it() {
    let mut world = World::new(Some("1"), true);
    world.comes_to_rest();
    world.unassign();
    let pending = world.journal.pending().unwrap();
    let to_go: Vec<&str> = pending
        .iter()
        .filter(|due| due.task == Task::Withdraw)
        .map(|due| due.store.as_str())
        .collect();
    assert_eq!(to_go, SERVERS);
}

#[test]
fn what_a_lost_journal_knew_of_a_server_is_not_sent_again_and_can_be_taken_back() {
    let mut world = World::new(Some("1"), true);
    world.comes_to_rest();
    let unknown = "DELETE FROM deliveries WHERE store = 'fhir'";
    world.journal.connection().execute(unknown, []).unwrap();
    world.journal.may_be_at_servers(&scan(), &patient("1"), true).unwrap();
    assert!(world.journal.pending().unwrap().is_empty());
    world.unassign();
    world.comes_to_rest();
    assert!(world.stores["fhir"].is_empty());
    // Of what the journal knows it changes nothing.
    world.assign("2");
    world.comes_to_rest();
    world.journal.may_be_at_servers(&scan(), &patient("2"), false).unwrap();
    assert!(world.journal.pending().unwrap().is_empty());
}

#[test]
fn the_codes_of_what_nobody_wants_are_those_that_the_queries_name() {
    for code in [UNASSIGNED, SUPERSEDED, HANDED_OVER] {
        assert!(UNWANTED.contains(&format!("'{code}'")), "{code}");
    }
}

#[test]
fn what_practice_software_was_handed_stays_and_is_nobodys_any_more() {
    let mut world = World::new(Some("1"), true);
    world.comes_to_rest();
    world.unassign();
    world.assign("2");
    world.begin();
    while let Some(at) = world.hand.iter().position(|(due, _)| due.task == Task::Deliver) {
        world.go_on(at, true);
    }
    let pending = world.journal.pending().unwrap();
    let due = pending.iter().find(|due| due.task == Task::Withdraw).unwrap();
    world.journal.left_there(due).unwrap();
    assert_eq!(world.journal.owners(&scan()).unwrap(), ["2"]);
    let whole = world.journal.whole(&scan()).unwrap().unwrap();
    let of = |store: &str| {
        let theirs = |of: &&gaiter_flow::account::Delivered| {
            of.store == store && of.patient.as_deref() == Some("1")
        };
        whole.deliveries.iter().find(theirs).unwrap().clone()
    };
    let left = of(&due.store);
    assert_eq!((left.state, left.code.as_deref()), (DeliveryState::Delivered, Some(HANDED_OVER)));
    assert!(left.is_to_go() && !left.is_there());
    // And theirs again, if that is decided.
    world.unassign();
    world.assign("1");
    assert_eq!(world.journal.owners(&scan()).unwrap(), ["1"]);
}

/// A scan of patient 1 whose stores refuse what was set by hand in its record.
fn with_refused_revision() -> World {
    let mut world = World::new(Some("1"), true);
    world.comes_to_rest();
    world.journal.amend_begun(&scan(), "1", &["copy", "fhir"]).unwrap();
    world.journal.amend_ended(&scan(), "1", &[]).unwrap();
    for due in world.journal.pending().unwrap() {
        assert_eq!(due.task, Task::HandOver);
        world.journal.revision_refused(&due, "server-refused").unwrap();
    }
    assert_eq!(world.journal.tally().unwrap().revisions_refused, 1);
    world
}

#[test]
fn a_revision_that_was_refused_is_told_and_offered_until_it_is_taken() {
    let world = with_refused_revision();
    let whole = world.journal.whole(&scan()).unwrap().unwrap();
    assert!(whole.is_revision_refused() && whole.has_record());
    assert!(world.journal.owes_revision(&scan()).unwrap());
    let [first, second]: [Due; 2] = world.journal.pending().unwrap().try_into().unwrap();
    world.journal.handed_over(&first, None).unwrap();
    assert_eq!(world.journal.tally().unwrap().revisions_refused, 1, "the other still refuses");
    // The next revision may be taken.
    world.journal.amend_begun(&scan(), "1", &[second.store.as_str()]).unwrap();
    world.journal.amend_ended(&scan(), "1", &[]).unwrap();
    assert_eq!(world.journal.tally().unwrap().revisions_refused, 0);
    world.journal.handed_over(&second, None).unwrap();
    assert!(!world.journal.owes_revision(&scan()).unwrap());
    assert!(world.journal.pending().unwrap().is_empty());
}

#[test]
fn a_record_of_which_a_revision_was_refused_is_taken_back_as_any_other() {
    let mut world = with_refused_revision();
    world.unassign();
    world.assign("2");
    world.comes_to_rest();
    for (store, records) in &world.stores {
        assert_eq!(*records, BTreeSet::from(["2".to_owned()]), "in {store}");
    }
    assert_eq!(world.journal.tally().unwrap().revisions_refused, 0);
}

#[test]
fn a_record_at_an_earlier_address_of_a_server_is_withdrawn_only_there_or_where_a_person_says() {
    let mut world = World::new(Some("1"), true);
    let [server] = SERVERS;
    let due_at = |world: &World| {
        let mut pending = world.journal.pending().unwrap().into_iter();
        pending.find(|due| due.store == server).unwrap()
    };
    let moved = |world: &World| world.journal.tally().unwrap().moved.get(server).copied();
    world.journal.begun(server, "a").unwrap();
    let due = due_at(&world);
    assert!(world.journal.places(&due).unwrap().is_empty());
    world.journal.put_at(&due, "a", Some(Path::new("DiagnosticReport/1"))).unwrap();
    // Sent once more, and no answer yet.
    world.journal.put_at(&due, "a", None).unwrap();
    world.comes_to_rest();
    assert_eq!(world.journal.withdrawing_since(&due).unwrap(), None);
    world.unassign();
    assert!(world.journal.withdrawing_since(&due).unwrap().is_some());
    assert_eq!(moved(&world), None);
    world.journal.begun(server, "b").unwrap();
    assert_eq!(moved(&world), Some(1));
    let due = due_at(&world);
    let places = world.journal.places(&due).unwrap();
    assert_eq!(places.get("a").map(String::as_str), Some("DiagnosticReport/1"));
    assert!(world.journal.gone_from(&due, "b").unwrap(), "it is still at the other");
    assert!(world.journal.withdraw_here(&scan()).unwrap());
    assert!(!world.journal.withdraw_here(&scan()).unwrap());
    assert_eq!(moved(&world), None);
    assert!(!world.journal.gone_from(&due, "b").unwrap());
}
