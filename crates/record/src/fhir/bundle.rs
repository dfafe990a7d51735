//! Resources as one transaction: all of it is done, or nothing.

use serde_json::{Value, json};

use super::identity::{Identifier, uuid};

/// A resource on its way to a server.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What it is created by: no other resource of its kind has it.
    pub identifier: Identifier,
    /// The resource; references to others of the transaction are their [`Entry::reference`].
    pub resource: Value,
}

impl Entry {
    /// A resource with what it is created by.
    pub fn new(identifier: Identifier, resource: Value) -> Entry {
        Entry { identifier, resource }
    }

    /// The kind of resource, such as `Observation`.
    pub fn kind(&self) -> &str {
        self.resource["resourceType"].as_str().unwrap_or_default()
    }

    /// How others of the transaction refer to it; always the same for one identifier.
    pub fn reference(&self) -> String {
        let Identifier { system, value } = &self.identifier;
        format!("urn:uuid:{}", uuid(&format!("{}\0{system}\0{value}", self.kind())))
    }
}

/// A transaction that creates each resource if none has its identifier yet. A replay creates nothing.
pub fn created(entries: &[Entry]) -> Value {
    let entry = |of: &Entry| {
        json!({
            "fullUrl": of.reference(),
            "resource": of.resource,
            "request": {
                "method": "POST",
                "url": of.kind(),
                "ifNoneExist": format!("identifier={}", of.identifier.query()),
            },
        })
    };
    transaction(entries.iter().map(entry).collect())
}

/// A resource in the place of one that the server has.
#[derive(Debug, Clone, PartialEq)]
pub struct Replacement {
    /// The new content.
    pub resource: Value,
    /// The resource that it takes the place of: `Observation/17`.
    pub reference: String,
    /// The version of it that was seen; a later one is not replaced. `None` if the server has no versions.
    pub version: Option<String>,
}

/// A transaction that replaces resources. `known` gives the place on the server of each reference within a
/// transaction.
pub fn replaced(replacements: &[Replacement], known: &[(String, String)]) -> Value {
    let entry = |of: &Replacement| {
        let mut resource = of.resource.clone();
        refer(&mut resource, known);
        if let Some(fields) = resource.as_object_mut() {
            let id = of.reference.rsplit('/').next().unwrap_or_default();
            fields.insert("id".to_owned(), id.into());
        }
        let mut request = json!({ "method": "PUT", "url": of.reference });
        if let Some(version) = &of.version {
            request["ifMatch"] = format!("W/\"{version}\"").into();
        }
        // An address must be absolute, and the server's own is not known here behind a proxy.
        let address = format!("urn:uuid:{}", uuid(&of.reference));
        json!({ "fullUrl": address, "resource": resource, "request": request })
    };
    transaction(replacements.iter().map(entry).collect())
}

fn transaction(entries: Vec<Value>) -> Value {
    json!({ "resourceType": "Bundle", "type": "transaction", "entry": entries })
}

/// Puts known references in the place of those within the transaction.
fn refer(value: &mut Value, known: &[(String, String)]) {
    match value {
        Value::Object(fields) => fields.values_mut().for_each(|field| refer(field, known)),
        Value::Array(items) => items.iter_mut().for_each(|item| refer(item, known)),
        Value::String(text) => {
            if let Some((_, place)) = known.iter().find(|(reference, _)| reference == text) {
                place.clone_into(text);
            }
        }
        _ => {}
    }
}
