//! Messages of DICOMweb (PS3.18): objects to be stored, what became of them, and what a server shows of a study.

use gaiter_record::sha256;
use serde_json::Value;

use super::{DicomObject, EncodeFault, Listed, NotStored, Study};

/// The media type of an object.
const OBJECT: &str = "application/dicom";

/// The media type of an answer.
pub const JSON: &str = "application/dicom+json";

/// An object as the body of a request, with its media type.
///
/// # Errors
/// If it cannot be written.
pub fn multipart(object: &DicomObject) -> Result<(String, Vec<u8>), EncodeFault> {
    let file = object.file()?;
    // It is not in the object: it depends on all of its bytes.
    let boundary = sha256(&file);
    let head = format!("--{boundary}\r\nContent-Type: {OBJECT}\r\n\r\n");
    let end = format!("\r\n--{boundary}--\r\n");
    let body = [head.as_bytes(), &file, end.as_bytes()].concat();
    Ok((format!("multipart/related; type=\"{OBJECT}\"; boundary={boundary}"), body))
}

/// The objects that a server did not store, by its answer. A sequence without items, as some answer after success, is
/// none, and so is one that the server has already.
pub fn not_stored(answer: &Value) -> Vec<NotStored> {
    let reasons = values(&answer["00081198"])
        .map(|of| values(&of["00081197"]).next().and_then(Value::as_u64).unwrap_or_default());
    reasons.filter_map(NotStored::for_reason).collect()
}

/// The path of the search for what a server has of a study.
pub fn search(study: &Study) -> String {
    format!("studies/{}/instances", study.uid())
}

/// What a server shows of a study; `None` if it is not an answer to that search.
pub fn listed(answer: &Value) -> Option<Vec<Listed>> {
    answer.as_array()?.iter().map(one).collect()
}

fn one(of: &Value) -> Option<Listed> {
    let [class, series, uid] = ["00080016", "0020000E", "00080018"]
        .map(|tag| values(&of[tag]).next().and_then(Value::as_str).map(str::to_owned));
    Some(Listed { class: class?, series: series?, uid: uid? })
}

/// The values of an attribute.
fn values(attribute: &Value) -> impl Iterator<Item = &Value> {
    attribute["Value"].as_array().into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn answer(reasons: &[Value]) -> Value {
        let failed: Vec<Value> = reasons
            .iter()
            .map(|reason| json!({ "00081197": { "vr": "US", "Value": [reason] } }))
            .collect();
        json!({ "00081198": { "vr": "SQ", "Value": failed } })
    }

    #[test]
    fn failures_are_counted_by_items_because_the_sequence_is_there_after_success_too() {
        for success in [json!({}), json!({ "00081198": { "vr": "SQ" } }), answer(&[]), Value::Null]
        {
            assert!(not_stored(&success).is_empty(), "{success}");
        }
        let failed = not_stored(&answer(&[json!(0xa700), json!(0x0122), json!(0x0111)]));
        assert_eq!(failed.iter().map(NotStored::is_passing).collect::<Vec<_>>(), [true, false]);
    }

    #[test]
    fn a_failure_without_a_reason_is_tried_again() {
        let failed = not_stored(&json!({ "00081198": { "vr": "SQ", "Value": [{}] } }));
        assert_eq!(failed, [NotStored { reason: 0 }]);
        assert!(failed[0].is_passing());
    }

    #[test]
    fn what_a_server_shows_is_read_whole_or_not_at_all() {
        let of = |tag: &str, uid: &str| (tag.to_owned(), json!({ "vr": "UI", "Value": [uid] }));
        let tags = [of("00080016", "1.2"), of("0020000E", "1.3"), of("00080018", "1.4")];
        let whole: Value = Value::Object(tags.clone().into_iter().collect());
        let expected =
            Listed { class: "1.2".to_owned(), series: "1.3".to_owned(), uid: "1.4".to_owned() };
        assert_eq!(listed(&json!([whole])), Some(vec![expected]));
        assert_eq!(listed(&json!([])), Some(Vec::new()));
        let part: Value = Value::Object(tags[..2].iter().cloned().collect());
        for other in [json!([whole, part]), json!({}), Value::Null, json!([1])] {
            assert_eq!(listed(&other), None, "{other}");
        }
    }
}
