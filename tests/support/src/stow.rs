//! What a request sends that stores objects over DICOMweb (STOW-RS), read by hand and not by what wrote it.

#![allow(clippy::unwrap_used)]

use serde_json::{Value, json};

/// An object that was sent.
#[derive(Debug, Clone)]
pub struct SentObject {
    /// SOP Class UID (0008,0016).
    pub class: String,
    /// SOP Instance UID (0008,0018).
    pub uid: String,
    /// Patient's Name (0010,0010).
    pub name: String,
    /// Series Instance UID (0020,000E).
    series: String,
    /// All of its elements; bytes that are no text are lost.
    pub text: String,
}

impl SentObject {
    /// The objects in a request.
    pub fn all(request: &str) -> Vec<SentObject> {
        request.split("DICM").skip(1).map(SentObject::read).collect()
    }

    fn read(text: &str) -> SentObject {
        let of = |element: &str| value(text.split_once(element).unwrap().1);
        SentObject {
            class: of("\x08\0\x16\0UI"),
            uid: of("\x08\0\x18\0UI"),
            name: of("\x10\0\x10\0PN"),
            series: of("\x20\0\x0e\0UI"),
            text: text.to_owned(),
        }
    }

    /// As a search (QIDO-RS) shows it.
    pub fn shown(&self) -> Value {
        let of = |uid: &str| json!({ "vr": "UI", "Value": [uid] });
        let SentObject { class, uid, series, .. } = self;
        json!({ "00080016": of(class), "00080018": of(uid), "0020000E": of(series) })
    }

    /// The objects that it names: Referenced SOP Instance UID (0008,1155).
    pub fn references(&self) -> impl Iterator<Item = String> {
        self.text.split("\x08\0\x55\x11UI").skip(1).map(value)
    }
}

/// A short value after its tag and representation.
fn value(after: &str) -> String {
    let length = usize::from(after.as_bytes()[0]);
    after[2..2 + length].trim_end_matches(['\0', ' ']).to_owned()
}
