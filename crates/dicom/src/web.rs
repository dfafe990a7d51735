//! Messages of DICOMweb (PS3.18): objects to be stored, what became of them, and what a server shows of a study.

use std::fmt;

use gaiter_record::sha256;
use serde::Deserializer;
use serde::de::{DeserializeOwned, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

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

/// Whether a server has the object of a request, by the failures in its answer; `None` if it names none. A sequence
/// without items, as some answer after success, names none, and an object that the server has already is no failure.
pub fn stored(answer: &[u8]) -> Option<Result<(), NotStored>> {
    let [failed] = members(whole(answer)?, ["00081198"])?;
    let mut stored = None;
    each_value(failed, |item| {
        let reason = members(item, ["00081197"]).and_then(|[reason]| first(reason));
        if !matches!(stored, Some(Err(_))) {
            let failure = NotStored::for_reason(reason.unwrap_or_default());
            stored = Some(failure.map_or(Ok(()), Err));
        }
    });
    stored
}

/// The path of the search for what a server has of a study.
pub fn search(study: &Study) -> String {
    format!("studies/{}/instances", study.uid())
}

/// What a server shows of a study; `None` if it is not an answer to that search. Others may have thousands of objects
/// in it, with some kB of attributes each, of which three UIDs are kept. Whatever an answer holds, that is less than five
/// times its length.
pub fn listed(answer: &[u8]) -> Option<Vec<Listed>> {
    let (mut listed, mut is_whole) = (Vec::new(), true);
    each(whole(answer)?, |item| match one(item) {
        Some(object) => listed.push(object),
        None => is_whole = false,
    })?;
    is_whole.then_some(listed)
}

/// Whether an answer is a list, as each search has.
pub fn is_list(answer: &[u8]) -> bool {
    serde_json::from_slice::<Vec<IgnoredAny>>(answer).is_ok()
}

fn one(item: &RawValue) -> Option<Listed> {
    let [class, series, uid] = members(item, ["00080016", "0020000E", "00080018"])?.map(first);
    Some(Listed { class: class?, series: series?, uid: uid? })
}

/// An answer that is JSON as a whole.
fn whole(answer: &[u8]) -> Option<&RawValue> {
    serde_json::from_slice(answer).ok()
}

/// The first value of an attribute, if it is one of this type.
fn first<T: DeserializeOwned>(attribute: Option<&RawValue>) -> Option<T> {
    let mut first = None;
    each_value(attribute, |value| {
        first.get_or_insert(value);
    });
    serde_json::from_str(first?.get()).ok()
}

/// Takes each value of an attribute, if it has any.
fn each_value<'a>(attribute: Option<&'a RawValue>, take: impl FnMut(&'a RawValue)) {
    let values = attribute.and_then(|attribute| members(attribute, ["Value"]));
    if let Some([Some(values)]) = values {
        each(values, take);
    }
}

/// Takes each value of an array; `None` if it is none.
fn each<'a>(array: &'a RawValue, take: impl FnMut(&'a RawValue)) -> Option<()> {
    array.deserialize_seq(Each(take)).ok()
}

/// The members of these names in an object, as they are written; `None` if it is none.
fn members<'a, const N: usize>(
    object: &'a RawValue,
    names: [&str; N],
) -> Option<[Option<&'a RawValue>; N]> {
    object.deserialize_map(Members(names)).ok()
}

/// Reads an array, value by value.
struct Each<F>(F);

impl<'a, F: FnMut(&'a RawValue)> Visitor<'a> for Each<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array")
    }

    fn visit_seq<A: SeqAccess<'a>>(mut self, mut array: A) -> Result<(), A::Error> {
        while let Some(value) = array.next_element()? {
            (self.0)(value);
        }
        Ok(())
    }
}

/// Reads the members of these names in an object. The others are passed over, however long or deep they are.
struct Members<'n, const N: usize>([&'n str; N]);

impl<'a, const N: usize> Visitor<'a> for Members<'_, N> {
    type Value = [Option<&'a RawValue>; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'a>>(self, mut object: A) -> Result<Self::Value, A::Error> {
        let mut members: Self::Value = [None; N];
        while let Some(name) = object.next_key::<String>()? {
            let value = object.next_value()?;
            if let Some(at) = self.0.iter().position(|of| *of == name) {
                members[at] = Some(value);
            }
        }
        Ok(members)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// Arrays in one another, deeper than any stack.
    const DEEP: usize = 1_000_000;

    fn bytes(answer: &Value) -> Vec<u8> {
        answer.to_string().into_bytes()
    }

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
            assert_eq!(stored(&bytes(&success)), None, "{success}");
        }
        for (reasons, told) in [
            (vec![0xa700], Err((0xa700, true))),
            (vec![0x0122], Err((0x0122, false))),
            (vec![0x0111], Ok(())),
            (vec![0x0111, 0x0122, 0xa700], Err((0x0122, false))),
            (vec![0x0122, 0x0111], Err((0x0122, false))),
        ] {
            let reasons: Vec<Value> = reasons.into_iter().map(|reason| json!(reason)).collect();
            let stored = stored(&bytes(&answer(&reasons))).unwrap();
            assert_eq!(stored.map_err(|of| (of.reason, of.is_passing())), told, "{reasons:?}");
        }
    }

    #[test]
    fn a_failure_without_a_reason_is_tried_again() {
        for item in [json!({}), json!(1), json!({ "00081197": null }), json!({ "00081197": {} })] {
            let failed = json!({ "00081198": { "vr": "SQ", "Value": [item] } });
            let failed = stored(&bytes(&failed)).unwrap().unwrap_err();
            assert!(failed.reason == 0 && failed.is_passing(), "{item}");
        }
    }

    #[test]
    fn what_a_server_shows_is_read_whole_or_not_at_all() {
        let of = |tag: &str, uid: &str| (tag.to_owned(), json!({ "vr": "UI", "Value": [uid] }));
        let tags = [of("00080016", "1.2"), of("0020000E", "1.3"), of("00080018", "1.4")];
        let whole: Value = Value::Object(tags.clone().into_iter().collect());
        let expected =
            Listed { class: "1.2".to_owned(), series: "1.3".to_owned(), uid: "1.4".to_owned() };
        assert_eq!(listed(&bytes(&json!([whole]))), Some(vec![expected]));
        assert_eq!(listed(b" []\n"), Some(Vec::new()));
        let part: Value = Value::Object(tags[..2].iter().cloned().collect());
        for other in [json!([whole, part]), json!({}), Value::Null, json!([1])] {
            assert_eq!(listed(&bytes(&other)), None, "{other}");
            assert_eq!(is_list(&bytes(&other)), other.is_array(), "{other}");
        }
        assert!(listed(b"").is_none() && listed(b"[] []").is_none() && listed(b"[").is_none());
    }

    #[test]
    fn what_is_not_looked_for_is_passed_over_however_much_or_deep_it_is() {
        let of = |value: &str| format!("{{\"vr\":\"UI\",\"Value\":[{value}]}}");
        let (open, close) = ("[".repeat(DEEP), "]".repeat(DEEP));
        let many: String = (0..10_000)
            .map(|at| format!("\"0009{at:04}\":{},", of("{\"00080018\":{\"Value\":[\"9\"]}}")))
            .collect();
        let object = |class: &str| {
            let [class, series, uid] = [class, "\"1.3\"", "\"1.4\",5"].map(of);
            format!(
                "{{{many}\"00080016\":{class},\"00099999\":{open}{close},\"0020000E\":{series},\
                 \"00080018\":{uid}}}"
            )
        };
        let shown = listed(format!("[{}]", object("\"1.2\"")).as_bytes()).unwrap();
        let expected =
            Listed { class: "1.2".to_owned(), series: "1.3".to_owned(), uid: "1.4".to_owned() };
        assert_eq!(shown, [expected]);
        let deep = format!("{open}{close}");
        assert_eq!(listed(format!("[{}]", object(&deep)).as_bytes()), None, "its class is no text");
        for answer in [&open, &deep] {
            assert_eq!(listed(answer.as_bytes()), None);
            assert_eq!(stored(answer.as_bytes()), None);
        }
        assert!(!is_list(open.as_bytes()) && is_list(deep.as_bytes()));
        let failed = format!("{{{many}\"00081198\":{{\"Value\":[{{\"00081197\":{deep}}}]}}}}");
        assert_eq!(stored(failed.as_bytes()), Some(Err(NotStored { reason: 0 })));
    }
}
