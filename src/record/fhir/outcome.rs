//! What a server says about a fault: the issues of an OperationOutcome, in words.

use serde_json::Value;

/// The most issues that are told; servers repeat one fault at every place.
const ISSUES_MOST: usize = 3;

/// The longest text of an issue, characters.
const TEXT_MOST: usize = 200;

/// The issues of an answer in a line, without these words, which must not get into a log; `None` if the answer
/// is no OperationOutcome.
pub fn words(answer: &Value, secret: &[&str]) -> Option<String> {
    if answer["resourceType"] != "OperationOutcome" {
        return None;
    }
    let issues = answer["issue"].as_array()?;
    let said: Vec<String> = issues.iter().take(ISSUES_MOST).map(|of| issue(of, secret)).collect();
    (!said.is_empty()).then(|| said.join("; "))
}

fn issue(issue: &Value, secret: &[&str]) -> String {
    let code = issue["code"].as_str().unwrap_or("unknown");
    let details = issue["details"]["text"].as_str().or(issue["diagnostics"].as_str());
    let place = issue["expression"][0].as_str().or(issue["location"][0].as_str());
    let mut said = code.to_owned();
    for (sign, part) in [(": ", details), (" at ", place)] {
        if let Some(part) = part {
            said += &format!("{sign}{part}");
        }
    }
    in_a_line(&said, secret)
}

/// A text of a server as part of a line: without control characters and secrets, and not long.
pub fn in_a_line(text: &str, secret: &[&str]) -> String {
    let mut told: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for secret in secret.iter().filter(|secret| !secret.is_empty()) {
        told = told.replace(secret, "…");
    }
    let line: String = told.chars().filter(|letter| !letter.is_control()).take(TEXT_MOST).collect();
    line
}

#[cfg(test)]
mod tests {
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
        let told = words(&outcome, &["4711"]).unwrap();
        assert_eq!(
            told,
            "required: no[2J status at Observation.status; invalid: Patient … is not there; invalid: third"
        );
        let long =
            json!({ "resourceType": "OperationOutcome", "issue": [issue(&"x".repeat(5000))] });
        assert_eq!(words(&long, &[]).unwrap().chars().count(), TEXT_MOST);
    }

    #[test]
    fn what_is_no_outcome_has_no_words() {
        for answer in [json!({}), json!([]), json!({ "resourceType": "Bundle" }), Value::Null] {
            assert_eq!(words(&answer, &[]), None);
        }
        let empty = json!({ "resourceType": "OperationOutcome", "issue": [] });
        assert_eq!(words(&empty, &[]), None);
    }
}
