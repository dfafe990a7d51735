//! The worklist: its server answers, refuses, hangs and dies. It lists patients of the exporter, but nobody chooses
//! from it, so it must have no effect on whose a scan is.

use rig::worklist::{Manner, Planned, WorklistServer};

use crate::chance::Chance;
use crate::field::Field;
use crate::plan::{Event, follow, weighed};

/// The name of all who are expected, which no log has.
const NAME: &str = "Quastenflosser";

/// A patient of the exporter, and one to whom exports are renamed.
const EXPECTED: [Planned; 2] = [
    Planned {
        patient: "4711",
        name: NAME,
        born: "19470311",
        study: "1.2.276.4711",
        accession_number: "A4711",
    },
    Planned {
        patient: "4721",
        name: NAME,
        born: "19310423",
        study: "1.2.276.4721",
        accession_number: "A4721",
    },
];

pub fn server() -> WorklistServer {
    WorklistServer::new(&EXPECTED)
}

pub fn draw(chance: &mut Chance) -> Manner {
    let manners =
        [(3, Manner::Answers), (2, Manner::Hangs), (2, Manner::IsAway), (1, Manner::Refuses(NAME))];
    weighed(chance, &manners)
}

/// Changes what becomes of questions, and lets the server answer at the end.
pub fn change(field: &Field, events: Vec<Event<Manner>>) {
    follow(field, events, |manner, _| {
        field.worklist.is(manner);
        field.tell(format_args!("the worklist: {manner:?}"));
    });
    field.wait_until(field.plan.length);
    field.worklist.is(Manner::Answers);
    field.tell("the worklist answers");
}

/// Whether it was asked, and its names are in no log.
pub fn judge(field: &Field, log: &str) {
    if field.worklist.days().is_empty() {
        field.fault("the station never asked the worklist: the test has tested nothing there");
    }
    if let Some(line) = log.lines().find(|line| line.contains(NAME)) {
        field.fault(format_args!("a name of the worklist is in the log: {line}"));
    }
}
