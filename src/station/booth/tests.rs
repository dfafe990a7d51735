//! What a start finds of captures in the journal.

use gaiter_flow::ScanState;
use gaiter_flow::round::{Doubt, Named, Names};
use gaiter_record::{ImagingRequest, SourceKind};

use super::super::journal::{BoothChange, Entry, ScanRow};
use super::*;

/// Identifies this start of the machine.
const BOOT: &str = "this start";

const SECOND: Duration = Duration::from_secs(1);

fn rules() -> Rules {
    Rules {
        window: SECOND * 90,
        late: SECOND * 90,
        name_lasts: SECOND * 900,
        orders: OrdersWhen::BeforePress,
        by_press: true,
    }
}

/// A patient was named, the button pressed, the export taken, and then the machine started again.
fn taken_before(journal: &Journal, boot: &str) -> ScanId {
    let before = Rounds::new(rules(), Vec::new(), Names::default());
    let mut after = before.clone();
    after.receives(Duration::ZERO);
    let named = Named::new("4711".to_owned(), SourceKind::Operator);
    after.named(named, 1, SECOND * 1000, &[]);
    let capture = after.pressed(1, SECOND * 1001);
    let change = |before, after| BoothChange {
        before,
        after,
        boot,
        ended_as: "over",
        answers: None,
        event: None,
    };
    journal.booth_changed(&change(&before, &after)).unwrap();
    let scan = ScanId::parse(&"a".repeat(64)).unwrap();
    let row = ScanRow {
        scan: scan.clone(),
        format: "obj".to_owned(),
        size: 12,
        first_seen: Timestamp::now(),
        file_time: None,
        pressed_at: None,
        state: ScanState::Spooled,
    };
    let judged = CaptureMatch::Of(capture);
    let (patient, held, candidates) = (None, None, &[][..]);
    let entry =
        Entry { row: &row, patient, held, claims: &[], judged: &judged, geometry: "", candidates };
    journal.enter(&entry, &["folder"]).unwrap();
    scan
}

/// How many captures a start of the station remembers whose exports were taken, and the doubt of the
/// one whose scan is then refused.
fn after_start(journal: &Journal, scan: &ScanId) -> (usize, Option<Doubt>) {
    let mut inner = Inner::recall(journal, rules(), BTreeSet::new(), BOOT, SECOND * 20).unwrap();
    let taken = inner.captures.open().len();
    let answered = journal.capture_answered_by(scan).unwrap().unwrap();
    let reopened = inner.captures.refused(answered.number, SECOND * 21);
    (taken, reopened.and_then(|capture| capture.doubt))
}

#[test]
fn a_scan_that_is_refused_after_the_machine_has_started_anew_opens_its_capture_in_doubt() {
    for boot in [BOOT, "another start"] {
        let dir = tempfile::tempdir().unwrap();
        let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
        let scan = taken_before(&journal, boot);
        assert_eq!(after_start(&journal, &scan), (1, Some(Doubt::Unheard)), "{boot}");
        // A second start finds the same.
        assert_eq!(after_start(&journal, &scan), (1, Some(Doubt::Unheard)), "{boot}");
    }
}

#[test]
fn the_entry_that_was_chosen_with_a_name_is_still_there_after_a_start() {
    let dir = tempfile::tempdir().unwrap();
    let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
    let request = ImagingRequest::new("1.2.276.4242", "ACC0815");
    let named = |id: &str| Named {
        request: request.clone(),
        is_chosen: id == "4711",
        ..Named::new(id, SourceKind::Operator)
    };
    let before = Rounds::new(rules(), Vec::new(), Names::default());
    let mut after = before.clone();
    after.receives(Duration::ZERO);
    after.named(named("4711"), 1, SECOND * 10, &[]);
    after.pressed(1, SECOND * 11);
    after.named(named("4712"), 2, SECOND * 12, &[]);
    let (boot, ended_as) = (BOOT, "over");
    let change =
        BoothChange { before: &before, after: &after, boot, ended_as, answers: None, event: None };
    journal.booth_changed(&change).unwrap();
    let inner = Inner::recall(&journal, rules(), BTreeSet::new(), BOOT, SECOND * 20).unwrap();
    let pressed = inner.captures.open()[0].patient.clone().unwrap();
    let next = inner.captures.next().unwrap().names[0].named.clone();
    assert_eq!((pressed, next), (named("4711"), named("4712")));
}
