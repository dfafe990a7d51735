//! Records of earlier versions are read, and a report tells them in its reader's language.

#![allow(clippy::unwrap_used)]

use std::io::Read;

use flate2::read::GzDecoder;
use gaiter_language::Language;
use gaiter_record::Record;
use gaiter_record::report::Content;
use gaiter_record::schema::OLDER_SCHEMA;
use gaiter_sizes::Garment;
use serde_json::Value;

/// A record of schema 1.
fn older() -> Value {
    let bytes = include_bytes!("../../../../fixtures/records/schema_1.json.gz").as_slice();
    let mut text = String::new();
    GzDecoder::new(bytes).read_to_string(&mut text).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_record_of_schema_1_is_read_with_all_its_figures() {
    let (text, record) = (older(), serde_json::from_value::<Record>(older()).unwrap());
    assert_eq!(record.schema, OLDER_SCHEMA);
    assert_eq!(record.body.crotch_from, None);
    let written = serde_json::to_value(&record).unwrap();
    for (leg, again) in
        text["legs"].as_array().unwrap().iter().zip(written["legs"].as_array().unwrap())
    {
        for key in ["landmarks", "estimates", "girth_curve", "surface", "volume"] {
            for (name, value) in leg[key].as_object().unwrap() {
                match value.as_object() {
                    Some(figures) => {
                        for (figure, value) in figures {
                            assert_eq!(&again[key][name][figure], value, "{key} {name} {figure}");
                        }
                    }
                    None => assert_eq!(&again[key][name], value, "{key} {name}"),
                }
            }
        }
    }
    record.checked().unwrap();
}

#[test]
fn the_rules_of_a_record_of_schema_1_are_told_in_german() {
    let record: Record = serde_json::from_value(older()).unwrap();
    let table = Content::of(&record, Language::De, &Garment::default()).landmarks;
    let cells: Vec<&str> = table
        .rows
        .iter()
        .flat_map(|row| &row.figures)
        .map(|figure| figure.value.as_str())
        .collect();
    assert!(cells.contains(&"0,575 der Schritthöhe"), "{cells:?}");
    assert!(cells.iter().all(|cell| !cell.contains("crotch")), "{cells:?}");
}

#[test]
fn a_record_without_statements_is_told_in_its_english_words() {
    let mut older = older();
    let message = "the legs are joined from 702 mm up";
    older["findings"] = serde_json::json!([{
        "code": "thighs-touch", "severity": "warning", "leg": null, "level": null, "message": message,
    }]);
    let record: Record = serde_json::from_value(older).unwrap();
    let note = Content::of(&record, Language::De, &Garment::default()).notes.entries.swap_remove(0);
    assert!(note.is_message_english);
    assert!(note.message.to_lowercase().starts_with(message), "{note:?}");
    assert!(note.meaning.unwrap().contains("berühren sich"));
}
