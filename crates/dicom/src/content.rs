//! The content of a structured report: a tree of items, each with the name of what it is (PS3.3, C.17.3).

use dicom_dictionary_std::tags;

use super::dataset::Dataset;

/// The codes of DICOM itself (PS3.16).
pub(crate) const DCM: &str = "DCM";

/// SNOMED CT, in the subset of PS3.16.
pub(crate) const SCT: &str = "SCT";

/// How an item is related to the one above it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Relation {
    Contains,
    HasProperties,
    HasConceptModifier,
    HasObservationContext,
}

impl Relation {
    fn word(self) -> &'static str {
        match self {
            Relation::Contains => "CONTAINS",
            Relation::HasProperties => "HAS PROPERTIES",
            Relation::HasConceptModifier => "HAS CONCEPT MOD",
            Relation::HasObservationContext => "HAS OBS CONTEXT",
        }
    }
}

/// A code of a scheme, with the same in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Concept<'a> {
    pub value: &'a str,
    pub scheme: &'a str,
    pub meaning: &'a str,
}

impl<'a> Concept<'a> {
    pub(crate) const fn new(value: &'a str, scheme: &'a str, meaning: &'a str) -> Concept<'a> {
        Concept { value, scheme, meaning }
    }

    /// It as the only item of a sequence.
    pub(crate) fn items(self) -> Vec<Dataset> {
        let item = Dataset::new()
            .text(tags::CODE_VALUE, self.value)
            .text(tags::CODING_SCHEME_DESIGNATOR, self.scheme)
            .text(tags::CODE_MEANING, self.meaning);
        vec![item]
    }
}

/// An item of the content.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Item(Dataset);

impl Item {
    /// An item that holds others.
    pub(crate) fn container(name: Concept<'_>) -> Item {
        Item(Item::named("CONTAINER", name).0.text(tags::CONTINUITY_OF_CONTENT, "SEPARATE"))
    }

    /// A text.
    pub(crate) fn text(name: Concept<'_>, text: &str) -> Item {
        Item(Item::named("TEXT", name).0.text(tags::TEXT_VALUE, text))
    }

    /// A code.
    pub(crate) fn code(name: Concept<'_>, code: Concept<'_>) -> Item {
        Item(Item::named("CODE", name).0.items(tags::CONCEPT_CODE_SEQUENCE, code.items()))
    }

    /// A UID.
    pub(crate) fn uid(name: Concept<'_>, uid: &str) -> Item {
        Item(Item::named("UIDREF", name).0.text(tags::UID, uid))
    }

    /// A length in cm, as text.
    pub(crate) fn length_cm(name: Concept<'_>, cm: &str) -> Item {
        let cm = Dataset::new()
            .text(tags::NUMERIC_VALUE, cm)
            .items(tags::MEASUREMENT_UNITS_CODE_SEQUENCE, Concept::new("cm", "UCUM", "cm").items());
        Item(Item::named("NUM", name).0.items(tags::MEASURED_VALUE_SEQUENCE, vec![cm]))
    }

    /// A reference to another object, which needs no name.
    pub(crate) fn reference(class: &str, uid: &str) -> Item {
        let to = reference(class, uid);
        Item(
            Dataset::new()
                .text(tags::VALUE_TYPE, "COMPOSITE")
                .items(tags::REFERENCED_SOP_SEQUENCE, vec![to]),
        )
    }

    fn named(kind: &str, name: Concept<'_>) -> Item {
        Item(
            Dataset::new()
                .text(tags::VALUE_TYPE, kind)
                .items(tags::CONCEPT_NAME_CODE_SEQUENCE, name.items()),
        )
    }

    /// It with these below it; a sequence of them is there only if there is one.
    pub(crate) fn with(self, below: Vec<(Relation, Item)>) -> Item {
        let below: Vec<Dataset> = below
            .into_iter()
            .map(|(relation, Item(item))| item.text(tags::RELATIONSHIP_TYPE, relation.word()))
            .collect();
        match below.is_empty() {
            true => self,
            false => Item(self.0.items(tags::CONTENT_SEQUENCE, below)),
        }
    }

    /// It as the root of a document of this template (PS3.16).
    pub(crate) fn root(self, template: &str) -> Dataset {
        let template = Dataset::new()
            .text(tags::MAPPING_RESOURCE, "DCMR")
            .text(tags::TEMPLATE_IDENTIFIER, template);
        self.0.items(tags::CONTENT_TEMPLATE_SEQUENCE, vec![template])
    }
}

/// A reference to an object.
pub(crate) fn reference(class: &str, uid: &str) -> Dataset {
    Dataset::new()
        .text(tags::REFERENCED_SOP_CLASS_UID, class)
        .text(tags::REFERENCED_SOP_INSTANCE_UID, uid)
}
