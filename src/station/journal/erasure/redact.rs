//! A person's id in the details of the history.

use serde_json::Value;

use gaiter_flow::patient::erasure::ERASED;

/// Puts a word in the place of an id wherever it is a whole text, and drops it from lists. Returns whether
/// there was one.
pub(super) fn redact(value: &mut Value, id: &str) -> bool {
    match value {
        Value::String(text) if text == id => {
            ERASED.clone_into(text);
            true
        }
        Value::Array(values) => {
            let before = values.len();
            values.retain(|value| !is_of(value, id));
            let is_shorter = values.len() != before;
            values.iter_mut().fold(is_shorter, |found, value| redact(value, id) | found)
        }
        Value::Object(fields) => {
            fields.values_mut().fold(false, |found, value| redact(value, id) | found)
        }
        _ => false,
    }
}

/// Whether an element of a list is the id, or a patient with it.
fn is_of(value: &Value, id: &str) -> bool {
    value.as_str() == Some(id) || value.get("id").and_then(Value::as_str) == Some(id)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_id_gives_way_wherever_it_is_and_nothing_else_does() {
        let mut value = json!({
            "patient": "4711", "decision": 4711, "store": "47110", "patients": ["4711", "4712"],
            "claims": [{"id": "4711", "sources": []}, {"id": "4712", "sources": []}],
            "deep": {"by": ["x", {"patient": "4711"}]},
        });
        assert!(redact(&mut value, "4711"));
        let wanted = json!({
            "patient": ERASED, "decision": 4711, "store": "47110", "patients": ["4712"],
            "claims": [{"id": "4712", "sources": []}], "deep": {"by": ["x", {"patient": ERASED}]},
        });
        assert_eq!(value, wanted);
        assert!(!redact(&mut value, "4711"));
    }
}
