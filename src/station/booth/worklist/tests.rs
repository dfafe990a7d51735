//! A worklist as a server might send it, at a booth without a button: whoever is named is expected at once.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use gaiter_flow::booth::PortEvent;
use gaiter_flow::cause::Cause;
use gaiter_flow::facts::WorklistFacts;
use gaiter_flow::worklist::FindResponse;
use gaiter_flow::{Facts, Identity};
use gaiter_record::Source;
use jiff::Timestamp;

use super::worker::note_fault;
use super::*;
use crate::config;
use crate::station::assembly::open_custody;
use crate::station::board::Board;
use crate::station::core::Core;
use crate::station::event::Observer;
use crate::station::stores::Stores;

/// What may stand nowhere but in memory.
const PLANTED: [&str; 3] = ["Quastenflosser", "1950-01-02", "19500102"];

/// A booth in this folder that asks a worklist for LEGSCAN.
fn booth(dir: &Path) -> Booth {
    let text = format!(
        "[station]\nid = \"booth-1\"\nstate_dir = \"{0}/state\"\n[scanner]\nexport_dirs = [\"{0}/export\"]\n\
         [patient]\npattern = '^[0-9]{{4}}$'\n\
         [patient.worklist]\naddress = \"127.0.0.1:104\"\nserver_ae_title = \"RIS\"\nae_title = \"LEGSCAN\"\n\
         encryption = \"none\"\n[store.folder]\npath = \"{0}/records\"\n",
        dir.display()
    );
    let config = config::load(&text).unwrap();
    fs::create_dir(dir.join("state")).unwrap();
    let stores = Stores::from_config(&config);
    let (custody, _) = open_custody(&config, &stores, true).unwrap();
    let patient = &config.patient;
    let identity = Identity::new(None, None, &patient.pattern, patient.check_digit).unwrap();
    let mut facts = Facts::new(Timestamp::now(), 1);
    facts.worklist = Some(WorklistFacts::new(Timestamp::now()));
    let core = Core::new(config, identity, custody, stores, Board::new(facts), Observer::default());
    Booth::open(Arc::new(core)).unwrap()
}

/// An entry for a patient who was born on 2 January 1950, planned for today.
fn entry(patient: &str, number: &str) -> WorklistEntry {
    WorklistEntry::from(FindResponse {
        patient_id: patient,
        patient_name: "Quastenflosser^Hanna",
        patient_birth_date: "19500102",
        requested_procedure_description: "Beinvermessung",
        study_instance_uid: &format!("1.2.276.{patient}"),
        accession_number: number,
        scheduled_station_ae_title: "LEGSCAN",
        start_date: &today().strftime("%Y%m%d").to_string(),
        ..FindResponse::default()
    })
}

fn answers(booth: &Booth, answer: Vec<WorklistEntry>) {
    let config = booth.core().config.patient.worklist.clone().unwrap();
    let answer = WorklistAnswer { entries: answer, unreadable: 0 };
    booth.note_worklist(answer, &config, today());
}

/// What the list has for today.
fn listed(booth: &Booth) -> Vec<WorklistEntry> {
    booth.listed().unwrap_or_default()
}

fn read(booth: &Booth, code: &str) {
    assert!(booth.receive(&PortEvent::Named { id: code.to_owned(), by: SourceKind::Reader }));
}

/// The patients whose exports are expected, each with the accession number that was chosen.
fn expected(booth: &Booth) -> Vec<(String, Option<String>)> {
    let inner = booth.inner();
    let named = inner.captures.open().iter().flat_map(|capture| capture.named());
    let number = |named: &Named| named.request.as_ref()?.accession_number.clone();
    named.map(|named| (named.id.clone(), number(named))).collect()
}

fn is(patient: &str, number: Option<&str>) -> (String, Option<String>) {
    (patient.to_owned(), number.map(str::to_owned))
}

fn facts(booth: &Booth) -> WorklistFacts {
    booth.core().board.facts().worklist.unwrap()
}

#[test]
fn an_entry_that_is_tapped_names_its_patient_with_its_request() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    answers(&booth, vec![entry("4711", "A1"), entry("4712", "A2")]);
    assert_eq!(facts(&booth).entries, 2);
    let [first, second] = ["4711", "4712"]
        .map(|patient| listed(&booth).iter().find(|entry| entry.patient == patient).unwrap().key());
    assert!(expected(&booth).is_empty(), "a list names nobody");
    booth.name_listed(&first, false).unwrap();
    assert_eq!(expected(&booth), [is("4711", Some("A1"))]);
    // The journal has it, too.
    let journal = booth.core().custody.journal();
    let kept = journal.captures_waiting().unwrap().remove(0).capture;
    assert_eq!(kept.patient, booth.inner().captures.open()[0].patient);
    assert!(matches!(booth.name_listed(&second, false), Err(NameFault::AnotherNamed)));
    booth.name_listed(&second, true).unwrap();
    assert_eq!(expected(&booth), [is("4712", Some("A2"))]);
    answers(&booth, vec![entry("4711", "A1")]);
    assert!(matches!(booth.name_listed(&second, true), Err(NameFault::EntryGone)));
}

#[test]
fn a_code_that_is_read_chooses_an_entry_by_its_number_and_by_its_patient() {
    for code in ["A1", "4711"] {
        let dir = tempfile::tempdir().unwrap();
        let booth = booth(dir.path());
        answers(&booth, vec![entry("4711", "A1"), entry("4712", "A2")]);
        read(&booth, code);
        assert_eq!(expected(&booth), [is("4711", Some("A1"))], "{code}");
    }
}

#[test]
fn who_is_not_listed_is_named_as_without_a_list_where_no_number_can_be_an_id() {
    for has_list in [true, false] {
        let dir = tempfile::tempdir().unwrap();
        let booth = booth(dir.path());
        answers(&booth, vec![entry("4711", "A1")]);
        if !has_list {
            booth.end_worklist(today().tomorrow().unwrap());
        }
        read(&booth, "A9");
        assert!(expected(&booth).is_empty());
        read(&booth, "4800");
        assert_eq!(expected(&booth), [is("4800", None)], "{has_list}");
    }
}

#[test]
fn where_a_number_may_be_an_id_no_code_that_may_be_one_names_anybody_also_after_a_start() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    let read_all = || ["4799", "4711", "4800"].map(|code| read(&booth, code));
    read_all();
    assert!(expected(&booth).is_empty(), "no list has shown what numbers there are");
    answers(&booth, vec![entry("4711", "4799"), entry("4712", "A2")]);
    read_all();
    answers(&booth, vec![entry("4712", "A2")]);
    read_all();
    booth.end_worklist(today().tomorrow().unwrap());
    read_all();
    assert!(expected(&booth).is_empty());
    let recalled = BoothWorklist::recall(booth.core()).unwrap();
    assert_eq!(*recalled.numbers(), Some(AccessionNumbers::LikeIds));
    // Other rules for ids are another question.
    let journal = booth.core().custody.journal();
    let under_others = journal.accession_numbers("None ^[0-9]{5}$").unwrap();
    assert_eq!(under_others, AccessionNumbers::Unseen);
    // A number that is none of an id chooses, and whoever is typed is named.
    answers(&booth, vec![entry("4712", "A2")]);
    read(&booth, "A2");
    assert_eq!(expected(&booth), [is("4712", Some("A2"))]);
    booth.name_patient("4800", SourceKind::Operator, true).unwrap();
    assert_eq!(expected(&booth), [is("4800", None)]);
}

#[test]
fn an_id_that_is_typed_gets_the_request_of_its_only_entry() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    answers(&booth, vec![entry("4711", "A1"), entry("4712", "A2"), entry("4712", "A3")]);
    booth.name_patient("4711", SourceKind::Operator, true).unwrap();
    assert_eq!(expected(&booth), [is("4711", Some("A1"))]);
    booth.name_patient("4712", SourceKind::Operator, true).unwrap();
    assert_eq!(expected(&booth), [is("4712", None)]);
    booth.name_patient("4711", SourceKind::Order, true).unwrap();
    assert!(expected(&booth).contains(&is("4711", None)), "an order chooses nothing");
    // An accession number is no id, whoever types it.
    let typed = booth.name_patient("A1", SourceKind::Operator, true);
    assert!(matches!(typed, Err(NameFault::NotAnId)));
}

#[test]
fn while_the_server_is_away_the_last_answer_holds_and_its_day_ends_it() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    answers(&booth, vec![entry("4711", "A1")]);
    note_fault(booth.core(), Cause::known("no-answer", []));
    let known = facts(&booth);
    assert!(known.fault.is_some() && known.answered.is_some());
    assert_eq!((known.entries, listed(&booth).len()), (1, 1));
    booth.end_worklist(today());
    assert_eq!(listed(&booth).len(), 1);
    let before = facts(&booth).edition;
    booth.end_worklist(today().tomorrow().unwrap());
    assert!(booth.listed().is_none() && booth.worklist.list().is_none(), "nothing is known of it");
    assert_eq!((facts(&booth).entries, facts(&booth).edition), (0, before + 1));
}

#[test]
fn entries_that_cannot_be_read_are_told_as_left_out() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    let config = booth.core().config.patient.worklist.clone().unwrap();
    let answer = WorklistAnswer { entries: vec![entry("4711", "A1")], unreadable: 2 };
    booth.note_worklist(answer, &config, today());
    assert_eq!((facts(&booth).entries, facts(&booth).left_out), (1, 2));
}

#[test]
fn an_answer_without_changes_is_no_new_edition() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    assert!(booth.listed().is_none());
    let editions: Vec<u64> = [vec![entry("4711", "A1")], vec![entry("4711", "A1")], vec![]]
        .into_iter()
        .map(|answer| {
            answers(&booth, answer);
            facts(&booth).edition
        })
        .collect();
    assert_eq!(editions, [1, 1, 2]);
    assert_eq!(booth.listed(), Some(Vec::new()), "nobody is planned");
}

#[test]
fn who_a_patient_is_is_known_for_a_chosen_request_of_the_day_and_no_longer() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    answers(&booth, vec![entry("4711", "A1")]);
    let of = |request: Option<ImagingRequest>| {
        let sources = vec![Source::from_kind(SourceKind::Operator).with_request(request)];
        booth.listed_person(&Patient { id: "4711".to_owned(), sources })
    };
    let chosen = || ImagingRequest::new("1.2.276.4711", "A1");
    assert_eq!(of(chosen()).unwrap().dicom_name, "Quastenflosser^Hanna");
    assert_eq!(of(ImagingRequest::new("1.2.276.4711", "A2")), None);
    assert_eq!(of(None), None);
    booth.end_worklist(today().tomorrow().unwrap());
    assert_eq!(of(chosen()), None);
}

/// Every file below a folder, as text.
fn texts(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            found.extend(texts(&path));
        } else {
            let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
            found.push((path.display().to_string(), text));
        }
    }
    found
}

#[test]
fn names_and_birth_dates_are_in_no_file_and_in_nothing_that_is_told_of_the_station() {
    let dir = tempfile::tempdir().unwrap();
    let booth = booth(dir.path());
    answers(&booth, vec![entry("4711", "A1"), entry("4712", "A2"), entry("no id", "A3")]);
    let all = listed(&booth);
    let first = all.iter().find(|entry| entry.patient == "4711").unwrap();
    booth.name_listed(&first.key(), true).unwrap();
    read(&booth, "A2");
    read(&booth, "A3");
    assert_eq!(first.person.name, "Quastenflosser, Hanna", "the list has them");
    let mut told = texts(&dir.path().join("state"));
    assert!(told.iter().any(|(_, text)| text.contains("4711")), "the journal was read");
    told.push(("facts".to_owned(), format!("{:?}", booth.core().board.facts())));
    told.push(("the booth".to_owned(), format!("{booth:?}")));
    for (what, text) in told {
        for planted in PLANTED {
            assert!(!text.contains(planted), "{planted} is in {what}");
        }
    }
}
