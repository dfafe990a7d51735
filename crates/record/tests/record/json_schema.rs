//! The JSON Schema of the record that is shipped. `tests/schema_check.py` holds records to it.
//!
//! `GAITER_RENEW=1 cargo test --test record json_schema::` writes docs/record.schema.json anew.

#![allow(clippy::unwrap_used)]

use std::fs;

use gaiter_record::schema::json_schema;
use support::root;

#[test]
fn the_shipped_schema_is_that_of_the_program() {
    let made = format!("{}\n", serde_json::to_string_pretty(&json_schema()).unwrap());
    let path = root().join("docs/record.schema.json");
    if std::env::var_os("GAITER_RENEW").is_some() {
        fs::write(&path, &made).unwrap();
    }
    assert!(fs::read_to_string(&path).unwrap() == made, "renew docs/record.schema.json");
}
