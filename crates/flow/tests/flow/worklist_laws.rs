//! Laws of the worklist: whatever a server answers, nobody is chosen who is not meant.

#![allow(clippy::unwrap_used)]

use gaiter_flow::worklist::{
    AccessionNumbers, ListedPerson, ScheduledStep, Worklist, WorklistChoice, WorklistEntry,
    WorklistFilter,
};
use gaiter_record::ImagingRequest;
use jiff::civil::{Date, date};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

const TODAY: Date = date(2026, 11, 28);

/// Ids and accession numbers from so few that they meet.
const TEXTS: [&str; 7] = ["1", "2", "3", "A1", "A2", "", "1\\2"];

fn is_id(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

fn text() -> impl Strategy<Value = String> {
    prop::sample::select(TEXTS.to_vec()).prop_map(str::to_owned)
}

fn day() -> impl Strategy<Value = Option<Date>> {
    option::of(prop::sample::select(vec![TODAY, date(2026, 11, 27), date(2026, 11, 29)]))
}

fn station() -> impl Strategy<Value = Vec<String>> {
    vec(prop::sample::select(vec!["LEGSCAN".to_owned(), "CT1".to_owned()]), 0..3)
}

fn entry() -> impl Strategy<Value = WorklistEntry> {
    let person = (text(), option::of(Just(date(1950, 1, 1))));
    let modality = prop::sample::select(vec!["OSS", "CT", ""]);
    let scheduled = (station(), modality, day(), text());
    (text(), text(), person, scheduled, text(), text()).prop_map(
        |(patient, issuer, (name, birth_date), scheduled, uid, number)| {
            let (stations, modality, date, step) = scheduled;
            let modality = modality.to_owned();
            WorklistEntry {
                patient,
                issuer,
                person: ListedPerson { name, birth_date, ..ListedPerson::default() },
                procedure: String::new(),
                scheduled: ScheduledStep { stations, modality, date, time: None, step },
                accession_number: number.clone(),
                request: ImagingRequest::new(&uid, &number),
            }
        },
    )
}

fn expected() -> WorklistFilter {
    WorklistFilter { station: "LEGSCAN".to_owned(), modality: Some("OSS".to_owned()) }
}

proptest! {
    #[test]
    fn every_entry_is_of_today_and_this_station_and_names_one_person(
        answer in vec(entry(), 0..12)
    ) {
        let list = Worklist::new(answer.clone(), &expected(), TODAY, is_id);
        for entry in list.entries(TODAY) {
            prop_assert!(expected().has(entry, TODAY));
            prop_assert!(is_id(&entry.patient) && entry.request.is_some());
            prop_assert!(answer.contains(entry));
            let same = |other: &&WorklistEntry| other.patient == entry.patient;
            for other in list.entries(TODAY).iter().filter(same) {
                let births = (other.person.birth_date, entry.person.birth_date);
                prop_assert!(births.0.is_none() || births.1.is_none() || births.0 == births.1);
            }
        }
        let ours = answer.iter().filter(|entry| expected().has(entry, TODAY)).count();
        prop_assert!(list.entries(TODAY).len() + list.left_out() <= ours);
    }

    #[test]
    fn a_code_chooses_only_the_one_patient_whom_it_can_mean(
        answer in vec(entry(), 0..12),
        code in text(),
    ) {
        let list = Worklist::new(answer.clone(), &expected(), TODAY, is_id);
        let has_number = |entry: &&WorklistEntry| entry.accession_number() == Some(code.as_str());
        let entries = list.entries(TODAY);
        let is_listed = entries.iter().any(|entry| entry.patient == code);
        match AccessionNumbers::Apart.chosen_by(&code, is_id(&code), Some(&list), TODAY) {
            WorklistChoice::Patient { id, request } => {
                // Every entry with this number is of the same patient.
                prop_assert!(entries.iter().filter(has_number).all(|entry| entry.patient == id));
                prop_assert!(id == code || (!is_listed && !is_id(&code)));
                let theirs = entries.iter().filter(|entry| entry.patient == id);
                let mut requests = theirs.filter_map(|entry| entry.request.as_ref());
                prop_assert!(request.is_none_or(|meant| requests.any(|own| own == meant)));
            }
            WorklistChoice::NotListed => {
                prop_assert!(!is_listed && !entries.iter().any(|entry| has_number(&entry)));
            }
            WorklistChoice::Unclear => prop_assert!(answer.iter().any(|entry| has_number(&entry))),
        }
    }

    #[test]
    fn after_an_answer_no_code_names_anybody_that_may_be_an_id_and_a_number_of_it(
        answer in vec(entry(), 0..12),
        code in text(),
    ) {
        let list = Worklist::new(answer.clone(), &expected(), TODAY, is_id);
        let numbers = AccessionNumbers::default().seen_with(&answer, is_id);
        let has_alike = answer.iter().any(|entry| entry.accession_number().is_some_and(is_id));
        if is_id(&code) && (answer.is_empty() || has_alike) {
            for list in [None, Some(&list)] {
                let chosen = numbers.chosen_by(&code, true, list, TODAY);
                prop_assert_eq!(chosen, WorklistChoice::Unclear);
            }
        }
    }

    #[test]
    fn the_order_of_the_answer_and_repetitions_in_it_change_nothing(
        answer in vec(entry(), 0..8)
    ) {
        let list = |answer: Vec<WorklistEntry>| Worklist::new(answer, &expected(), TODAY, is_id);
        let keys = |list: &Worklist| {
            list.entries(TODAY).iter().map(WorklistEntry::key).collect::<Vec<_>>()
        };
        let mut other: Vec<WorklistEntry> = answer.iter().rev().cloned().collect();
        other.extend(answer.clone());
        let (list, other) = (list(answer), list(other));
        prop_assert_eq!(keys(&list), keys(&other));
        prop_assert_eq!(list.left_out(), other.left_out());
    }

    #[test]
    fn nothing_of_it_is_there_on_another_day(answer in vec(entry(), 0..12), code in text()) {
        let list = Worklist::new(answer, &expected(), TODAY, is_id);
        for day in [date(2026, 11, 27), date(2026, 11, 29)] {
            prop_assert!(list.entries(day).is_empty());
            let chosen =
                AccessionNumbers::Apart.chosen_by(&code, is_id(&code), Some(&list), day);
            prop_assert_eq!(chosen, WorklistChoice::NotListed);
            prop_assert_eq!(list.request_of(&code, day), None);
        }
    }
}
