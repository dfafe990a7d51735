//! What a server reports about a fault: the issues of an OperationOutcome, in words.

use serde_json::Value;

pub use crate::shown::in_a_line;

/// The most issues that are reported; servers repeat one fault at every place.
const ISSUES_MOST: usize = 3;

/// The issues of an answer in a line, without these words, which must not get into a log; `None` if the answer
/// is no OperationOutcome.
pub fn words(answer: &Value, secret: &[&str]) -> Option<String> {
    if answer["resourceType"] != "OperationOutcome" {
        return None;
    }
    let issues = answer["issue"].as_array()?;
    let texts: Vec<String> =
        issues.iter().take(ISSUES_MOST).map(|of| issue_text(of, secret)).collect();
    (!texts.is_empty()).then(|| texts.join("; "))
}

fn issue_text(issue: &Value, secret: &[&str]) -> String {
    let code = issue["code"].as_str().unwrap_or("unknown");
    let details = issue["details"]["text"].as_str().or(issue["diagnostics"].as_str());
    let place = issue["expression"][0].as_str().or(issue["location"][0].as_str());
    let mut text = code.to_owned();
    for (sign, part) in [(": ", details), (" at ", place)] {
        if let Some(part) = part {
            text += &format!("{sign}{part}");
        }
    }
    in_a_line(&text, secret)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    #[test]
    fn issues_are_told_in_a_line_without_the_patient_and_without_control_characters() {
        let issue = |text: &str| json!({ "severity": "error", "code": "invalid", "details": { "text": text } });
        let outcome = json!({
            "resourceType": "OperationOutcome",
            "issue": [
                { "code": "required", "diagnostics": "no\u{1b}[2J\nstatus", "expression": ["Observation.status"] },
                issue("Patient 4711 is not there"), issue("third"), issue("fourth"),
            ],
        });
        let said = words(&outcome, &["4711"]).unwrap();
        assert_eq!(
            said,
            "required: no[2J status at Observation.status; invalid: Patient … is not there; invalid: third"
        );
    }

    #[test]
    fn what_is_no_outcome_has_no_words() {
        for answer in [json!({}), json!([]), json!({ "resourceType": "Bundle" }), Value::Null] {
            assert_eq!(words(&answer, &[]), None);
        }
        let empty = json!({ "resourceType": "OperationOutcome", "issue": [] });
        assert_eq!(words(&empty, &[]), None);
    }

    /// Any JSON, with the names of an outcome and with a patient's id in it.
    fn anything() -> impl Strategy<Value = Value> {
        let texts = ["4711", "47\u{0}11", "Patient/4711\u{202E}", "47 11", "invalid"];
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::Bool),
            any::<i64>().prop_map(Value::from),
            ".{0,300}".prop_map(Value::String),
            prop::sample::select(texts.to_vec()).prop_map(Value::from),
        ];
        let names = ["code", "details", "text", "diagnostics", "expression", "location"];
        leaf.prop_recursive(4, 60, 4, move |inner| {
            let name = prop::sample::select(names.to_vec()).prop_map(str::to_owned);
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..5).prop_map(Value::Array),
                prop::collection::vec((name, inner), 0..6)
                    .prop_map(|fields| Value::Object(fields.into_iter().collect())),
            ]
        })
    }

    proptest! {
        #[test]
        fn whatever_a_server_says_is_a_short_line_without_the_patient(
            issues in prop::collection::vec(anything(), 0..5),
            other in anything(),
        ) {
            let outcome = json!({ "resourceType": "OperationOutcome", "issue": issues });
            if let Some(said) = words(&outcome, &["4711"]) {
                prop_assert!(!said.contains("4711"), "{said:?}");
                prop_assert!(!said.chars().any(char::is_control), "{said:?}");
                prop_assert!(said.chars().count() <= 3 * 200 + 4);
            }
            words(&json!({ "resourceType": "OperationOutcome", "issue": other }), &["4711"]);
            words(&other, &["4711"]);
        }
    }
}
