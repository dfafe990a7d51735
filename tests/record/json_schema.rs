//! The JSON Schema of the record holds for records, and for nothing that is damaged.
//!
//! `GAITER_RENEW=1 cargo test --test record json_schema::` writes docs/record.schema.json anew.

#![allow(clippy::unwrap_used)]

use std::fs;

use gaiter::leg::method::Scope;
use gaiter::leg::{Method, Side};
use gaiter::record::schema::json_schema;
use gaiter::record::{Acquired, AcquiredFrom, Patient, Record, Source, SourceKind};
use jiff::Timestamp;
use jsonschema::Validator;
use serde_json::{Value, json};
use support::geometry::bodies::{export, record_of};
use support::geometry::mesh::Mesh;
use support::root;

fn validator() -> Validator {
    jsonschema::draft202012::new(json_schema().as_value()).unwrap()
}

/// Records of the fixtures: with and without a patient, with findings, doubts and holes.
fn records() -> Vec<Value> {
    let with_heights = Method { at_heights_mm: vec![150.0, 2000.0], ..Method::default() };
    let mut records: Vec<Record> = vec![
        record_of(&export("f_average_clean"), &with_heights).1,
        record_of(&export("f_average_tc2"), &Method::default()).1,
        record_of(&lone_leg(), &Method { scope: Scope::Leg(Side::Left), ..Method::default() }).1,
    ];
    records[1].patient =
        Some(Patient { id: "4711".to_owned(), sources: vec![Source::of(SourceKind::Reader)] });
    records[1].acquired = Some(Acquired { at: Timestamp::UNIX_EPOCH, from: AcquiredFrom::Press });
    records.iter().map(|record| serde_json::to_value(record).unwrap()).collect()
}

/// The points of one leg, up to the thigh.
fn lone_leg() -> Vec<u8> {
    let leg = Mesh::body("f_average_clean");
    leg.kept(|[x, y, _]| y < 720.0 && x > 0.0 && x < 260.0).obj()
}

#[test]
fn the_shipped_schema_is_that_of_the_program() {
    let made = format!("{}\n", serde_json::to_string_pretty(&json_schema()).unwrap());
    let path = root().join("docs/record.schema.json");
    if std::env::var_os("GAITER_RENEW").is_some() {
        fs::write(&path, &made).unwrap();
    }
    assert!(fs::read_to_string(&path).unwrap() == made, "renew docs/record.schema.json");
}

#[test]
fn every_record_holds_to_the_schema() {
    let validator = validator();
    for record in records() {
        let faults: Vec<String> = validator
            .iter_errors(&record)
            .map(|fault| format!("{}: {fault}", fault.instance_path()))
            .collect();
        assert!(faults.is_empty(), "{faults:#?}");
    }
}

/// Changes one place after another; the first rows of a list stand for all.
fn damage(value: &Value, path: &str, damaged: &mut dyn FnMut(&str, Value)) {
    // Nothing in a record is a list of lists.
    damaged(path, json!([[]]));
    match value {
        Value::Object(fields) => {
            for (name, field) in fields {
                let with = |field: Value| {
                    let mut fields = fields.clone();
                    fields.insert(name.clone(), field);
                    Value::Object(fields)
                };
                damage(field, &format!("{path}/{name}"), &mut |path, field| {
                    damaged(path, with(field));
                });
            }
        }
        Value::Array(items) => {
            for (at, item) in items.iter().enumerate().take(2) {
                let with = |item: Value| {
                    let mut items = items.clone();
                    items[at] = item;
                    Value::Array(items)
                };
                damage(item, &format!("{path}/{at}"), &mut |path, item| damaged(path, with(item)));
            }
        }
        _ => {}
    }
}

#[test]
fn a_record_with_a_value_of_another_kind_anywhere_does_not_hold_to_it() {
    let validator = validator();
    let mut places = 0;
    for record in records() {
        damage(&record, "", &mut |path, damaged| {
            assert!(!validator.is_valid(&damaged), "{path}");
            places += 1;
        });
    }
    assert!(places > 500, "only {places} places");
}

#[test]
fn a_record_without_one_of_its_parts_does_not_hold_to_it() {
    let validator = validator();
    let record = records().swap_remove(0);
    for part in record.as_object().unwrap().keys() {
        let mut without = record.clone();
        without.as_object_mut().unwrap().remove(part);
        assert!(!validator.is_valid(&without), "{part}");
    }
    let leg = record["legs"][0].as_object().unwrap();
    for part in leg.keys() {
        let mut without = record.clone();
        without["legs"][0].as_object_mut().unwrap().remove(part);
        assert!(!validator.is_valid(&without), "legs/0/{part}");
    }
}
