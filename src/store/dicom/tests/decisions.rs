//! A scan that is given to a patient and taken from them, whatever the archive does meanwhile.

use proptest::prelude::*;

use super::*;

/// What may happen next to a scan of a patient.
#[derive(Debug, Clone, Copy)]
enum Happening {
    /// A person gives it to the patient, or takes it from them.
    Decide,
    /// The station does what is due, at an archive in this mode.
    Work(Mode),
}

fn happening() -> impl Strategy<Value = Happening> {
    let mode = prop_oneof![
        Just(Mode::Keep),
        Just(Mode::Lose),
        Just(Mode::RefuseReport(0xa700)),
        Just(Mode::KeepAndRefuse(0xc000)),
        Just(Mode::KeepAndDie),
        Just(AWAY),
    ];
    prop_oneof![1 => Just(Happening::Decide), 2 => mode.prop_map(Happening::Work)]
}

/// A station with one scan, as far as its journal and decisions tell.
#[derive(Debug)]
struct Station {
    is_theirs: bool,
    turn: u32,
    /// What the archive may have, '' if it was sent and not confirmed.
    receipt: Option<String>,
    is_done: bool,
}

impl Station {
    fn decides(&mut self) {
        self.is_theirs = !self.is_theirs;
        self.turn += u32::from(self.is_theirs);
        self.is_done = !self.is_theirs && self.receipt.is_none();
    }

    /// Its journal ends every wait at last.
    fn works(&mut self, store: &DicomStore) {
        if self.is_done {
            return;
        }
        let done = match self.is_theirs {
            true => {
                self.receipt.get_or_insert_default();
                put_in(store, "4711", 1, self.turn)
                    .map(|receipt| Some(receipt.folder.to_str().unwrap().to_owned()))
            }
            false => match withdraw(store, self.receipt.as_deref(), self.turn) {
                done if is_not_shown(&done) => Ok(None),
                done => done.map(|()| None),
            },
        };
        match done {
            Ok(receipt) => (self.receipt, self.is_done) = (receipt, true),
            Err(StoreFault::Server(_)) => {}
            Err(fault) => panic!("{fault}: {self:?}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn in_the_end_an_archive_holds_the_record_once_or_not_at_all_as_was_decided_last(
        is_hiding in any::<bool>(),
        happenings in prop::collection::vec(happening(), 0..16),
    ) {
        let archive = Archive::that_hides(is_hiding);
        let store = archive.store();
        let mut station =
            Station { is_theirs: true, turn: 0, receipt: None, is_done: false };
        for happening in happenings {
            match happening {
                Happening::Decide => station.decides(),
                Happening::Work(mode) => {
                    archive.becomes(mode);
                    station.works(&store);
                }
            }
        }
        archive.becomes(Mode::Keep);
        station.works(&store);
        prop_assert!(station.is_done, "{:?}", station);
        prop_assert_eq!(archive.holding(), if station.is_theirs { 2 } else { 0 });
    }
}
