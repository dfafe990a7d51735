//! A record as DICOM objects, and how they get to an archive of images.
//!
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod content;
mod dataset;
pub mod dimse;
mod document;
mod measurement;
mod stored;
mod study;
pub mod web;
mod withdrawal;
mod worklist;

use std::fmt;

pub use dicom_dictionary_std::tags;
use dicom_dictionary_std::uids;
use dicom_object::FileMetaTableBuilder;
pub use dicom_object::{InMemDicomObject, Tag};
use gaiter_language::Language;
use gaiter_record::export::taken;
use gaiter_record::{Record, RecordFile};
use jiff::civil::Date;
use jiff::{Timestamp, Zoned};

pub use self::dataset::EncodeFault;
use self::dataset::{Dataset, Syntax};
pub use self::document::attachable;
pub use self::stored::NotStored;
pub use self::study::{Listed, PatientIdFault, Study};
pub use self::withdrawal::withdrawal;
pub use self::worklist::planned;

/// The name of the character set of all objects: UTF-8 (PS3.3, C.12.1.1.2).
const UTF_8: &str = "ISO_IR 192";

/// Who makes the objects.
const MAKER: &str = "gaiter";

/// The instance numbers of a revision lie within so many.
const NUMBERS_A_REVISION: u32 = 100;

/// How records are written for an archive of images.
#[derive(Debug, Clone, PartialEq)]
pub struct DicomRules {
    /// Who assigns the patients' ids (0010,0021); empty for nobody.
    pub issuer: String,
    /// The name of gaiter's own coding scheme.
    pub coding: String,
    /// The language of texts.
    pub language: Language,
    /// Files of the record that are sent with it, by name. A file that a record lacks is left out.
    pub attach: Vec<String>,
    /// Whether objects say who the patient is, as a worklist told it.
    pub names: bool,
}

/// Who a patient is, as a worklist told it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Person<'a> {
    /// Patient's Name (0010,0010), which DICOM can write; empty if it is not known.
    pub name: &'a str,
    /// Patient's Birth Date (0010,0030).
    pub birth_date: Option<Date>,
    /// Patient's Sex (0010,0040); empty if it is not known.
    pub sex: &'a str,
}

/// Logs get no names.
impl fmt::Debug for Person<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Person(..)")
    }
}

impl Person<'_> {
    fn elements(self) -> Dataset {
        let birth_date = self.birth_date.map(|date| date.strftime("%Y%m%d").to_string());
        Dataset::new()
            .text(tags::PATIENT_NAME, self.name)
            .text(tags::PATIENT_BIRTH_DATE, birth_date.unwrap_or_default())
            .text(tags::PATIENT_SEX, self.sex)
    }
}

/// The kinds of objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SopClass {
    /// The figures: Comprehensive 3D SR.
    Measurements,
    /// Encapsulated PDF.
    Pdf,
    /// Encapsulated STL.
    Stl,
    /// Encapsulated OBJ.
    Obj,
    /// What marks others as wrong: Key Object Selection.
    Withdrawal,
}

impl SopClass {
    /// All of them.
    pub const ALL: [SopClass; 5] =
        [SopClass::Measurements, SopClass::Pdf, SopClass::Stl, SopClass::Obj, SopClass::Withdrawal];

    /// Its UID.
    pub fn uid(self) -> &'static str {
        match self {
            SopClass::Measurements => uids::COMPREHENSIVE3_DSR_STORAGE,
            SopClass::Pdf => uids::ENCAPSULATED_PDF_STORAGE,
            SopClass::Stl => uids::ENCAPSULATED_STL_STORAGE,
            SopClass::Obj => uids::ENCAPSULATED_OBJ_STORAGE,
            SopClass::Withdrawal => uids::KEY_OBJECT_SELECTION_DOCUMENT_STORAGE,
        }
    }

    /// Its modality. Objects of one modality are a series.
    pub fn modality(self) -> &'static str {
        match self {
            SopClass::Measurements => "SR",
            SopClass::Pdf => "DOC",
            SopClass::Stl | SopClass::Obj => "M3D",
            SopClass::Withdrawal => "KO",
        }
    }

    fn series_number(self) -> &'static str {
        match self {
            SopClass::Measurements => "1",
            SopClass::Pdf => "2",
            SopClass::Stl | SopClass::Obj => "3",
            SopClass::Withdrawal => "4",
        }
    }
}

/// A DICOM object.
#[derive(Debug, Clone)]
pub struct DicomObject {
    class: SopClass,
    uid: String,
    dataset: InMemDicomObject,
}

impl DicomObject {
    /// Its kind.
    pub fn class(&self) -> SopClass {
        self.class
    }

    /// Its UID.
    pub fn uid(&self) -> &str {
        &self.uid
    }

    /// Its elements.
    pub fn dataset(&self) -> &InMemDicomObject {
        &self.dataset
    }

    /// It as a file (PS3.10), in Explicit VR Little Endian.
    ///
    /// # Errors
    /// If an element cannot be written.
    pub fn file(&self) -> Result<Vec<u8>, EncodeFault> {
        let meta = FileMetaTableBuilder::new()
            .transfer_syntax(Syntax::ExplicitLittleEndian.uid())
            .implementation_class_uid(study::uid(MAKER));
        let file = self.dataset.clone().with_meta(meta).map_err(EncodeFault::new)?;
        let mut bytes = Vec::new();
        file.write_all(&mut bytes).map_err(EncodeFault::new)?;
        Ok(bytes)
    }
}

/// A record on its way to an archive of images.
#[derive(Debug, Clone, Copy)]
pub struct Sent<'a> {
    /// The record; its patient must be the one of the study.
    pub record: &'a Record,
    /// Its files.
    pub files: &'a [RecordFile],
    /// When the station first saw the scan: the time of a record that does not state when it was taken.
    pub first_seen: Timestamp,
    /// The study that it becomes a part of.
    pub study: &'a Study,
    /// Who the patient is, if a worklist told it.
    pub person: Option<Person<'a>>,
    /// How often the scan was taken from this patient and given back: what was marked as wrong stays so, and an archive
    /// that hides it does not take its UIDs again.
    pub turn: u32,
}

/// All objects of a record: the figures, then the files that the rules name.
///
/// The same record with the same rules gives the same objects.
pub fn objects(sent: &Sent<'_>, rules: &DicomRules) -> Vec<DicomObject> {
    let at = taken(sent.record, sent.first_seen);
    let study = sent.study.clone().taken_at(at.clone());
    let parts = Parts { sent: Sent { study: &study, ..*sent }, rules, at };
    let documents = parts.documents();
    [vec![parts.measurements()], documents].concat()
}

/// What the objects of a record have in common.
struct Parts<'a> {
    sent: Sent<'a>,
    rules: &'a DicomRules,
    /// When the scan was taken, by the clock at the scanner.
    at: Zoned,
}

impl Parts<'_> {
    /// An object for a part of the record, with its own attributes. `number` is its place among them, from 1.
    fn object(&self, class: SopClass, part: &str, number: u32, own: Dataset) -> DicomObject {
        let Sent { study, record, person, turn, .. } = self.sent;
        let uid = study.instance(part, record.revision, turn);
        let number = NUMBERS_A_REVISION * record.revision.saturating_sub(1) + number;
        let person = person.filter(|_| self.rules.names).map(Person::elements);
        let dataset = common(study, self.rules, class, turn, &self.at)
            .and(person.unwrap_or_else(Dataset::new))
            .and(equipment(record.station.as_deref(), &record.made_by.gaiter))
            .text(tags::SOP_INSTANCE_UID, uid.as_str())
            .text(tags::INSTANCE_NUMBER, number.to_string())
            .and(own);
        DicomObject { class, uid, dataset: dataset.0 }
    }
}

/// What all objects of a kind have in a turn of a study. `at` is the time of their content, in the zone of the study's:
/// archives take what any object says of the study for all of it.
fn common(study: &Study, rules: &DicomRules, class: SopClass, turn: u32, at: &Zoned) -> Dataset {
    let [date, time] = moment(at);
    let [study_date, study_time] = study.taken().map(moment).unwrap_or_default();
    study
        .of_patient(&rules.issuer)
        .text(tags::STUDY_DATE, study_date)
        .text(tags::STUDY_TIME, study_time)
        .text(tags::SPECIFIC_CHARACTER_SET, UTF_8)
        .text(tags::SOP_CLASS_UID, class.uid())
        .text(tags::CONTENT_DATE, date)
        .text(tags::CONTENT_TIME, time)
        .text(tags::TIMEZONE_OFFSET_FROM_UTC, at.strftime("%z").to_string())
        .text(tags::STUDY_DESCRIPTION, rules.language.text("hospital.leg_measures"))
        .text(tags::MODALITY, class.modality())
        .text(tags::SERIES_INSTANCE_UID, study.series(class, turn))
        .text(tags::SERIES_NUMBER, class.series_number())
}

/// What made an object.
fn equipment(station: Option<&str>, version: &str) -> Dataset {
    Dataset::new()
        .text(tags::MANUFACTURER, MAKER)
        .text(tags::MANUFACTURER_MODEL_NAME, MAKER)
        .text(tags::DEVICE_SERIAL_NUMBER, station.unwrap_or(MAKER))
        .text(tags::SOFTWARE_VERSIONS, version)
}

/// Date and time as DICOM writes them, to the second.
fn moment(at: &Zoned) -> [String; 2] {
    ["%Y%m%d", "%H%M%S"].map(|form| at.strftime(form).to_string())
}
