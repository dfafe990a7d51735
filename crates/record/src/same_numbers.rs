//! Whether the record of a crop equals that of the whole body: all texts, counts and nulls, and every number.

use gaiter_leg::{Extraction, Method};
use serde_json::Value;

use super::compose::record;
use super::provenance::Provenance;
use super::schema::Record;

/// A length on a crop may differ by this from that on the whole body, mm: by 1 µm, to which it is rounded, and by what
/// decimal numbers lose in binary.
const CROP_MM: f64 = 1e-3 + 1e-9;

/// The first number or text that differs between what was measured on a whole body and on its crop, with its place and
/// both values; `None` if all agree.
///
/// # Errors
/// If a record cannot be written.
pub fn crop_differs(
    whole: &Extraction,
    crop: &Extraction,
    method: &Method,
) -> Result<Option<String>, serde_json::Error> {
    let provenance = Provenance::of_scan(String::new());
    let record = |of: &Extraction| record(of, &provenance, method);
    record_differs(&record(whole), &record(crop))
}

/// As [`crop_differs`], of the records of both.
///
/// # Errors
/// If a record cannot be written.
pub fn record_differs(whole: &Record, crop: &Record) -> Result<Option<String>, serde_json::Error> {
    let (whole, crop) = (serde_json::to_value(whole)?, serde_json::to_value(crop)?);
    Ok(first_difference("", 0.0, &whole, &crop))
}

/// The first difference at a place of two documents, where numbers may differ by `allowed`.
fn first_difference(place: &str, allowed: f64, whole: &Value, crop: &Value) -> Option<String> {
    match (whole, crop) {
        (Value::Object(whole), Value::Object(crop)) if whole.keys().eq(crop.keys()) => {
            whole.iter().zip(crop.values()).find_map(|((key, whole), crop)| {
                let is_length = key.ends_with("_mm") && !key.ends_with("per_mm");
                let allowed = if is_length { CROP_MM } else { 0.0 };
                first_difference(&format!("{place}.{key}"), allowed, whole, crop)
            })
        }
        (Value::Array(whole), Value::Array(crop)) if whole.len() == crop.len() => {
            whole.iter().zip(crop).enumerate().find_map(|(index, (whole, crop))| {
                first_difference(&format!("{place}[{index}]"), allowed, whole, crop)
            })
        }
        _ => {
            let numbers = whole.as_f64().zip(crop.as_f64());
            let is_same = match numbers {
                Some((whole, crop)) => (whole - crop).abs() <= allowed,
                None => whole == crop,
            };
            (!is_same).then(|| format!("{place}: {whole} → {crop}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_crop_may_move_lengths_by_a_micrometre_and_nothing_else() {
        let record = |tape_mm: f64, r2: f64, code: &str| {
            let leg = json!({"curve": {"tape_mm": [200.0, tape_mm]}, "r2": r2});
            json!({"legs": [leg], "code": code})
        };
        let differs = |crop: Value| {
            first_difference("", 0.0, &record(230.5, 0.9996, "a"), &crop).unwrap_or_default()
        };
        assert_eq!(differs(record(230.501, 0.9996, "a")), "");
        let girth = ".legs[0].curve.tape_mm[1]: 230.5 → 230.502";
        assert_eq!(differs(record(230.502, 0.9996, "a")), girth);
        assert_eq!(differs(record(230.5, 0.9995, "a")), ".legs[0].r2: 0.9996 → 0.9995");
        assert_eq!(differs(record(230.5, 0.9996, "b")), ".code: \"a\" → \"b\"");
        assert!(differs(json!({})).starts_with(": {"));
    }
}
