//! What a server's answers mean.

use gaiter_record::fhir::{Entry, outcome};
use serde_json::Value;

use crate::store::server::ServerFault;
use crate::store::{Rejection, StoreFault};

/// What became of an entry of a transaction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Asked {
    /// The resource on the server: `Observation/17`.
    pub reference: String,
    /// It was created now; another was there before.
    pub is_new: bool,
}

impl Asked {
    /// What became of these entries.
    pub(super) fn read(
        answer: &Value,
        entries: &[Entry],
        secret: &[&str],
    ) -> Result<Vec<Asked>, StoreFault> {
        let answers = Asked::all(answer, entries.len(), secret)?;
        answers.iter().zip(entries).map(|(of, entry)| one(of, entry.kind())).collect()
    }

    /// The answers to this many entries, all of them done.
    pub(super) fn all<'a>(
        answer: &'a Value,
        count: usize,
        secret: &[&str],
    ) -> Result<&'a [Value], StoreFault> {
        let is_one = answer["resourceType"] == "Bundle" && answer["type"] == "transaction-response";
        let entries = answer["entry"].as_array().map(Vec::as_slice).unwrap_or_default();
        if !is_one || entries.len() != count {
            let why = format!("a transaction of {count} has {} answers", entries.len());
            return Err(ServerFault::Answer(why).into());
        }
        match entries.iter().find(|entry| !status(entry).starts_with('2')) {
            None => Ok(entries),
            Some(fault) => {
                let number = status(fault).get(..3).and_then(|digits| digits.parse().ok());
                Err(outcome_of(number.unwrap_or(0), &fault["response"]["outcome"], secret))
            }
        }
    }
}

fn status(entry: &Value) -> &str {
    entry["response"]["status"].as_str().unwrap_or_default()
}

/// The answer to one entry: its location is `Observation/17`, maybe with an address before it and a version behind.
fn one(entry: &Value, kind: &str) -> Result<Asked, StoreFault> {
    let location = entry["response"]["location"].as_str().unwrap_or_default();
    let of_resource = entry["resource"]["id"].as_str();
    let parts: Vec<&str> = location.split('/').collect();
    let at = parts.iter().rposition(|part| *part == kind);
    let id = at.and_then(|at| parts.get(at + 1)).copied().or(of_resource);
    match id.filter(|id| is_id(id)) {
        Some(id) => {
            let is_new = status(entry).starts_with("201");
            Ok(Asked { reference: format!("{kind}/{id}"), is_new })
        }
        None => Err(ServerFault::Answer(format!("it does not say where the {kind} is")).into()),
    }
}

/// The reference of a resource of the server.
pub(super) fn reference(resource: &Value) -> Result<String, StoreFault> {
    let kind = resource["resourceType"].as_str().unwrap_or_default();
    match resource["id"].as_str().filter(|id| is_id(id)) {
        Some(id) => Ok(format!("{kind}/{id}")),
        None => Err(ServerFault::Answer("a resource has no id".to_owned()).into()),
    }
}

/// Whether a text is an id of FHIR: nothing that leads elsewhere.
fn is_id(text: &str) -> bool {
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'.';
    let is_step = text.bytes().all(|byte| byte == b'.');
    (1..=64).contains(&text.len()) && text.bytes().all(is_letter) && !is_step
}

/// The fault of an answer that is none of success.
pub(super) fn outcome_of(status: u16, answer: &Value, secret: &[&str]) -> StoreFault {
    let why = outcome::words(answer, secret).unwrap_or_else(|| "it does not say why".to_owned());
    match status {
        // Several resources have the identifier of one.
        412 => StoreFault::Permanent(Rejection::ServerRefused { status, why }),
        _ => StoreFault::of_status(status, why),
    }
}

/// A fault of a transaction that replaces what was read before. If another changed it meanwhile, the next try
/// reads it again.
pub(super) fn of_replacing(fault: StoreFault) -> StoreFault {
    match fault {
        StoreFault::Permanent(Rejection::ServerRefused { status: 412, why }) => {
            ServerFault::Busy { status: 412, why }.into()
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use gaiter_record::fhir::Identifier;
    use serde_json::json;

    use super::*;

    fn entries() -> Vec<Entry> {
        let of = |kind: &str| {
            let identifier = Identifier { system: "urn:s".to_owned(), value: kind.to_owned() };
            Entry::new(identifier, json!({ "resourceType": kind }))
        };
        vec![of("Device"), of("Observation")]
    }

    fn answer(first: Value, second: Value) -> Value {
        json!({ "resourceType": "Bundle", "type": "transaction-response", "entry": [first, second] })
    }

    fn done(status: &str, location: &str) -> Value {
        json!({ "response": { "status": status, "location": location } })
    }

    #[test]
    fn an_answer_tells_what_is_new_and_where_everything_is() {
        let places = ["Device/a-1", "https://fhir.clinic.example/r4/Observation/7.b/_history/2"];
        let both = answer(done("200", places[0]), done("201 Created", places[1]));
        let told = Asked::read(&both, &entries(), &[]).unwrap();
        let expected = [("Device/a-1", false), ("Observation/7.b", true)];
        assert_eq!(
            told.iter().map(|of| (of.reference.as_str(), of.is_new)).collect::<Vec<_>>(),
            expected
        );
        let by_resource = json!({
            "response": { "status": "200 OK" }, "resource": { "resourceType": "Device", "id": "a-1" },
        });
        let both = answer(by_resource, done("200", "Observation/7.b"));
        assert_eq!(Asked::read(&both, &entries(), &[]).unwrap()[0].reference, "Device/a-1");
    }

    #[test]
    fn an_answer_that_leaves_something_open_is_not_believed() {
        let first = done("201", "Device/1");
        for second in [
            done("201", "Patient/9"),
            done("201", "Observation/"),
            done("201", "Observation/../Patient"),
            done("201", "Observation/7?x=1"),
            json!({}),
        ] {
            let fault = Asked::read(&answer(first.clone(), second.clone()), &entries(), &[]);
            assert_eq!(fault.unwrap_err().code(), "store-unavailable", "{second}");
        }
        let one =
            json!({ "resourceType": "Bundle", "type": "transaction-response", "entry": [first] });
        let batch = json!({ "resourceType": "Bundle", "type": "batch-response", "entry": [] });
        for other in [one, batch, json!({ "resourceType": "Bundle" }), json!([]), Value::Null] {
            let fault = Asked::read(&other, &entries(), &[]).unwrap_err();
            assert!(matches!(fault, StoreFault::Server(ServerFault::Answer(_))), "{other}");
        }
    }

    #[test]
    fn what_a_person_must_correct_waits_and_the_rest_is_asked_again() {
        for status in [400, 412, 413, 422] {
            let fault = outcome_of(status, &Value::Null, &[]);
            assert!(matches!(fault, StoreFault::Permanent(Rejection::ServerRefused { .. })));
            assert_eq!(fault.code(), "server-refused");
        }
        for status in [401, 403, 404, 408, 409, 429, 500, 502, 503, 599] {
            assert_eq!(outcome_of(status, &Value::Null, &[]).code(), "store-unavailable");
        }
        let stale = of_replacing(outcome_of(412, &Value::Null, &[]));
        assert!(matches!(stale, StoreFault::Server(ServerFault::Busy { status: 412, .. })));
    }

    #[test]
    fn a_refusal_within_a_transaction_is_told_without_the_patients_id() {
        let outcome = json!({
            "resourceType": "OperationOutcome",
            "issue": [{ "severity": "error", "code": "invalid", "diagnostics": "P4711 is closed" }],
        });
        let refused = json!({ "response": { "status": "422", "outcome": outcome } });
        let fault = Asked::read(&answer(done("201", "Device/1"), refused), &entries(), &["P4711"]);
        let fault = fault.unwrap_err();
        assert_eq!(fault.code(), "server-refused");
        assert!(fault.to_string().contains("is closed"), "{fault}");
        for told in [fault.to_string(), fault.cause().to_string(), format!("{fault:?}")] {
            assert!(!told.contains("4711"), "{told}");
        }
    }
}
