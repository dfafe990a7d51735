//! A data set, made element by element, and its bytes.

use std::error::Error;

use dicom_core::dictionary::DataDictionaryEntry;
use dicom_core::value::DataSetSequence;
use dicom_core::{DataDictionary, DataElement, PrimitiveValue, Tag, VR};
use dicom_object::{InMemDicomObject, StandardDataDictionary};
use dicom_transfer_syntax_registry::TransferSyntax;
use dicom_transfer_syntax_registry::entries::{
    EXPLICIT_VR_LITTLE_ENDIAN, IMPLICIT_VR_LITTLE_ENDIAN,
};

/// A data set or packet that cannot be written, with what the library that writes it says.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the data set cannot be written: {0}")]
pub struct EncodeFault(String);

impl EncodeFault {
    pub(crate) fn new(why: impl Error) -> EncodeFault {
        EncodeFault(why.to_string())
    }
}

/// How data sets are written. Every program knows one of the two (PS3.5, 10.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Syntax {
    ExplicitLittleEndian,
    ImplicitLittleEndian,
}

impl Syntax {
    pub(crate) const ALL: [Syntax; 2] =
        [Syntax::ExplicitLittleEndian, Syntax::ImplicitLittleEndian];

    /// It as the library knows it.
    pub(crate) fn transfer_syntax(self) -> TransferSyntax {
        match self {
            Syntax::ExplicitLittleEndian => EXPLICIT_VR_LITTLE_ENDIAN.erased(),
            Syntax::ImplicitLittleEndian => IMPLICIT_VR_LITTLE_ENDIAN.erased(),
        }
    }

    pub(crate) fn uid(self) -> &'static str {
        self.transfer_syntax().uid()
    }

    /// The bytes of a data set.
    pub(crate) fn encoded(self, set: &InMemDicomObject) -> Result<Vec<u8>, EncodeFault> {
        let mut bytes = Vec::new();
        set.write_dataset_with_ts(&mut bytes, &self.transfer_syntax()).map_err(EncodeFault::new)?;
        Ok(bytes)
    }
}

/// A data set in the making. Each value is represented as the dictionary of the standard has it (PS3.6).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dataset(pub(crate) InMemDicomObject);

impl Dataset {
    pub(crate) fn new() -> Dataset {
        Dataset(InMemDicomObject::new_empty())
    }

    /// It with a text, which may be empty.
    pub(crate) fn text(self, tag: Tag, text: impl Into<String>) -> Dataset {
        self.with(tag, PrimitiveValue::from(text.into()))
    }

    /// It with a value that is no text.
    pub(crate) fn value(self, tag: Tag, value: impl Into<PrimitiveValue>) -> Dataset {
        self.with(tag, value.into())
    }

    /// It with a sequence, which may be empty.
    pub(crate) fn items(mut self, tag: Tag, items: Vec<Dataset>) -> Dataset {
        let items: Vec<InMemDicomObject> = items.into_iter().map(|Dataset(item)| item).collect();
        self.0.put(DataElement::new(tag, VR::SQ, DataSetSequence::from(items)));
        self
    }

    /// It with all of another.
    pub(crate) fn and(mut self, Dataset(other): Dataset) -> Dataset {
        self.0.extend(other);
        self
    }

    fn with(mut self, tag: Tag, value: PrimitiveValue) -> Dataset {
        self.0.put(DataElement::new(tag, vr(tag), value));
        self
    }
}

/// How the value of an attribute is represented.
pub(crate) fn vr(tag: Tag) -> VR {
    StandardDataDictionary.by_tag(tag).map_or(VR::UN, |entry| entry.vr().relaxed())
}

/// The text of an element without what pads it; `None` if the data set lacks it.
pub(crate) fn text_of(set: &InMemDicomObject, tag: Tag) -> Option<String> {
    let text = set.get(tag)?.to_str().ok()?;
    Some(text.trim_end_matches([' ', '\0']).to_owned())
}

#[cfg(test)]
mod tests {
    use dicom_dictionary_std::tags;

    use super::*;

    fn encoded(set: &Dataset) -> Vec<u8> {
        Syntax::ExplicitLittleEndian.encoded(&set.0).unwrap()
    }

    #[test]
    fn elements_stand_in_the_order_of_their_tags_whatever_the_order_they_were_given_in() {
        let set = Dataset::new().text(tags::PATIENT_ID, "4711").text(tags::SOP_CLASS_UID, "1.2");
        let expected = b"\x08\0\x16\0UI\x04\x001.2\0\x10\0\x20\0LO\x04\x004711";
        assert_eq!(encoded(&set), expected);
    }

    #[test]
    fn odd_values_are_padded_as_their_representation_wants_it() {
        let set = Dataset::new()
            .text(tags::PATIENT_ID, "471")
            .value(tags::ENCAPSULATED_DOCUMENT_LENGTH, 5_u32)
            .value(tags::ENCAPSULATED_DOCUMENT, b"%PDF-".to_vec());
        let expected = b"\x10\0\x20\0LO\x04\x00471 \x42\0\x11\0OB\0\0\x06\0\0\0%PDF-\0\x42\0\x15\0UL\x04\0\x05\0\0\0";
        assert_eq!(encoded(&set), expected);
    }

    #[test]
    fn texts_behind_the_name_of_the_character_set_are_utf_8() {
        let set = Dataset::new()
            .text(tags::SPECIFIC_CHARACTER_SET, "ISO_IR 192")
            .text(tags::PATIENT_ID, "\u{dc}1");
        assert!(encoded(&set).ends_with(b"\x10\0\x20\0LO\x04\0\xc3\x9c1 "));
    }
}
