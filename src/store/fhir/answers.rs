//! What a server's answers mean.

use serde_json::Value;

use super::patient::is_id;
use crate::record::fhir::Entry;
use crate::record::fhir::outcome;
use crate::store::server::ServerFault;
use crate::store::{Misfit, StoreFault};

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
    pub(super) fn of(answer: &Value, entries: &[Entry]) -> Result<Vec<Asked>, StoreFault> {
        let answers = Asked::all(answer, entries.len())?;
        answers.iter().zip(entries).map(|(of, entry)| one(of, entry.kind())).collect()
    }

    /// The answers to so many entries, all of them done.
    pub(super) fn all(answer: &Value, count: usize) -> Result<Vec<Value>, StoreFault> {
        let is_one = answer["resourceType"] == "Bundle" && answer["type"] == "transaction-response";
        let entries = answer["entry"].as_array().cloned().unwrap_or_default();
        if !is_one || entries.len() != count {
            let why = format!("a transaction of {count} has {} answers", entries.len());
            return Err(ServerFault::Answer(why).into());
        }
        match entries.iter().find(|entry| !status(entry).starts_with('2')) {
            None => Ok(entries),
            Some(fault) => {
                let number = status(fault).get(..3).and_then(|digits| digits.parse().ok());
                Err(outcome_of(number.unwrap_or(0), &fault["response"]["outcome"], &[]))
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
        None => {
            let why = format!("it does not say where the {kind} is");
            Err(ServerFault::Answer(why).into())
        }
    }
}

/// The fault of an answer that is none of success.
pub(super) fn outcome_of(status: u16, answer: &Value, secret: &[&str]) -> StoreFault {
    let why = outcome::words(answer, secret).unwrap_or_else(|| "it does not say why".to_owned());
    match status {
        400 | 410 | 412 | 413 | 415 | 422 => {
            StoreFault::Permanent(Misfit::ServerRefused { status, why })
        }
        401 | 403 | 404 | 405 | 407 => ServerFault::Forbidden { status, why }.into(),
        _ => ServerFault::Busy { status, why }.into(),
    }
}
