//! The JSON Schemas that are shipped are those of the types. `tests/schema_check.py` holds records to them.
//!
//! `GAITER_RENEW=1 cargo test -p gaiter-record --lib schema::` writes them anew.

#![allow(clippy::disallowed_methods)]

use std::fs;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;

use super::Record;
use crate::order::Order;

fn check<T: JsonSchema>(name: &str, shipped: &str) {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let schema = settings.into_generator().into_root_schema_for::<T>();
    let made = format!("{}\n", serde_json::to_string_pretty(&schema).unwrap());
    if std::env::var_os("GAITER_RENEW").is_some() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/schemas");
        fs::write(format!("{folder}/{name}.schema.json"), &made).unwrap();
    }
    assert!(shipped == made, "renew schemas/{name}.schema.json");
}

#[test]
fn the_shipped_schemas_are_those_of_the_types() {
    check::<Record>("record", super::JSON_SCHEMA);
    check::<Order>("order", crate::order::JSON_SCHEMA);
}
