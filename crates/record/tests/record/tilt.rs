//! Where a tape that is not held square would read another girth, the report says so.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter_language::Language;
use gaiter_record::Record;
use gaiter_record::report::{self, Paper, ReportContent};
use gaiter_sizes::Garment;
use support::page::words;
use support::records::measured;

static RECORD: LazyLock<&Record> = LazyLock::new(|| &measured("f_average_clean").1);

/// The record with these changes of the girth per degree at the right leg, mm, and none elsewhere.
fn record(per_deg_mm: &[(&str, f64)]) -> Record {
    let mut record = RECORD.clone();
    for leg in &mut record.legs {
        leg.landmarks.values_mut().for_each(|of| of.girth_per_deg_mm = Some(0.0));
        for (level, mm) in per_deg_mm.iter().filter(|_| leg.side == "right") {
            leg.landmarks.get_mut(*level).unwrap().girth_per_deg_mm = Some(*mm);
        }
    }
    record
}

/// What a report says of it, in every language.
fn told(record: &Record) -> [Option<String>; 2] {
    [Language::En, Language::De].map(|language| {
        ReportContent::from_record(record, language, &Garment::default()).levels.tilted
    })
}

#[test]
fn a_girth_that_three_degrees_of_tilt_change_by_more_than_two_millimetres_is_told() {
    let record = record(&[("D", 0.9), ("C", 0.6)]);
    let english = "A tape that is tilted by 3° may read up to this much more or less: right leg D \
                   2.7 mm. Hold it square to the lower leg.";
    let german = "Liegt das Maßband um 3° schräg, kann es bis zu so viel mehr oder weniger \
                  anzeigen: rechtes Bein D 2,7 mm. Das Maßband rechtwinklig zum Unterschenkel anlegen.";
    assert_eq!(told(&record), [english, german].map(|said| Some(said.to_owned())));
    for (language, sentence) in [(Language::En, english), (Language::De, german)] {
        let content = ReportContent::from_record(&record, language, &Garment::default());
        let page = report::page(&content.document(&record, &[]), Paper::A4).unwrap();
        assert!(words(&page).contains(sentence), "{language:?}");
    }
}

#[test]
fn one_sentence_names_all_levels_of_a_leg_from_the_highest() {
    let all = told(&record(&[("B", 0.8), ("G", 2.0), ("D", 1.37)]));
    let [english, german] = all.map(Option::unwrap);
    let levels = ": right leg G 6.0 mm, D 4.1 mm, B 2.4 mm. Hold it square to the lower leg, above the knee square \
                  to the thigh.";
    assert!(english.ends_with(levels), "{english:?}");
    assert!(german.contains(": rechtes Bein G 6,0 mm, D 4,1 mm, B 2,4 mm"));
    assert!(german.ends_with(" oberhalb des Knies rechtwinklig zum Oberschenkel."));
}

#[test]
fn where_the_tilt_matters_little_or_is_not_known_nothing_is_said() {
    let mut record = record(&[("D", 0.6), ("B", 0.6)]);
    assert_eq!(told(&record), [None, None]);
    for leg in &mut record.legs {
        leg.landmarks.values_mut().for_each(|of| of.girth_per_deg_mm = None);
    }
    assert_eq!(told(&record), [None, None]);
}

#[test]
fn only_where_girths_are_those_of_a_tape_held_square_it_is_to_be_held_so() {
    let mut record = record(&[("D", 0.9)]);
    record.made_by.method.insert("tape".to_owned(), "horizontal".to_owned());
    let [english, german] = told(&record).map(Option::unwrap);
    assert!(english.ends_with("D 2.7 mm."), "{english:?}");
    assert!(german.ends_with("D 2,7 mm."), "{german:?}");
}

#[test]
fn both_legs_stand_in_one_sentence() {
    let mut record = record(&[("D", 0.9)]);
    let left = record.legs.iter_mut().find(|leg| leg.side == "left").unwrap();
    left.landmarks.get_mut("B").unwrap().girth_per_deg_mm = Some(0.8);
    let english = told(&record)[0].clone().unwrap();
    assert!(english.contains(": right leg D 2.7 mm; left leg B 2.4 mm. Hold it"), "{english}");
}
