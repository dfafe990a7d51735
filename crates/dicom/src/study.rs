//! The study that a scan of a patient belongs to: the UIDs of the record in it, and what of it a server shows.

use dicom_core::Tag;
use dicom_dictionary_std::tags;
use gaiter_record::ImagingRequest;
use gaiter_record::fhir::uuid_bytes;
use jiff::Zoned;

use super::SopClass;
use super::dataset::Dataset;

/// The longest id of a patient, characters (LO).
const ID_MOST: usize = 64;

/// A patient's id that DICOM cannot write: a backslash divides values, and spaces at an end do not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the patient's id has more than 64 characters, a backslash, a control character or a space at an end, which \
     DICOM does not allow"
)]
pub struct PatientIdFault;

/// The study of a scan of a patient: that of the request which the scan answers, else one of its own. The UIDs of the
/// record in it are always the same, and show neither scan nor patient.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Study {
    patient: String,
    key: String,
    /// The request whose study it is; `None` for the scan's own.
    request: Option<ImagingRequest>,
    /// When the scan was taken, by the clock at the scanner, if it is known.
    taken: Option<Zoned>,
}

/// An object that a server shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// The UID of its kind.
    pub class: String,
    /// The UID of its series.
    pub series: String,
    /// Its own UID.
    pub uid: String,
}

impl Study {
    /// The own study of a scan, by the hash of its bytes, and a patient's id.
    ///
    /// # Errors
    /// If DICOM cannot write the id.
    pub fn new(scan: &str, patient: &str) -> Result<Study, PatientIdFault> {
        let is_plain = |letter: char| letter != '\\' && !letter.is_control();
        let is_whole = patient.trim_matches(' ') == patient && !patient.is_empty();
        if !is_whole || patient.chars().count() > ID_MOST || !patient.chars().all(is_plain) {
            return Err(PatientIdFault);
        }
        let (patient, key) = (patient.to_owned(), format!("{scan}\0{patient}"));
        Ok(Study { patient, key, request: None, taken: None })
    }

    /// The study of the request that the scan answers, if it answers one. Others may have objects in it.
    pub fn answering(self, request: Option<&ImagingRequest>) -> Study {
        Study { request: request.cloned(), ..self }
    }

    /// Whether it is the study of a request, in which others may have objects.
    pub fn is_of_request(&self) -> bool {
        self.request.is_some()
    }

    /// The study of a scan that was taken then, by the clock at the scanner.
    pub fn taken_at(self, at: Zoned) -> Study {
        Study { taken: Some(at), ..self }
    }

    /// The study of this UID, in which a server has confirmed the record.
    pub fn confirmed(self, uid: &str) -> Study {
        if self.uid() == uid {
            return self;
        }
        let own = Study { request: None, ..self };
        if own.uid() == uid {
            return own;
        }
        let request = ImagingRequest { study_instance_uid: uid.to_owned(), accession_number: None };
        Study { request: Some(request), ..own }
    }

    /// When the scan was taken, if it is known.
    pub(crate) fn taken(&self) -> Option<&Zoned> {
        self.taken.as_ref()
    }

    /// The patient's id.
    pub fn patient(&self) -> &str {
        &self.patient
    }

    /// Its UID.
    pub fn uid(&self) -> String {
        match &self.request {
            Some(request) => request.study_instance_uid.clone(),
            None => self.part_uid("study"),
        }
    }

    /// Whether a server shows a withdrawal of the record.
    pub fn shows_withdrawal(&self, listed: &[Listed]) -> bool {
        let series = self.series(SopClass::Withdrawal, 0);
        listed.iter().any(|of| of.series == series)
    }

    /// What a server shows of the record in its first `turns` turns, withdrawn or not: nothing of others in the study.
    pub fn shown<'a>(&self, turns: u32, listed: &'a [Listed]) -> Vec<&'a Listed> {
        let series = self.record_series(turns);
        listed.iter().filter(|of| series.contains(&of.series)).collect()
    }

    /// The series of the record in its first `turns` turns.
    pub(crate) fn record_series(&self, turns: u32) -> Vec<String> {
        let classes = SopClass::ALL.into_iter().filter(|class| *class != SopClass::Withdrawal);
        let mut series: Vec<String> = (0..turns)
            .flat_map(|turn| classes.clone().map(move |class| self.series(class, turn)))
            .collect();
        // Meshes of both kinds have one.
        series.dedup();
        series
    }

    /// The series of a kind. In another turn a record has other series; the withdrawals have one together.
    pub(crate) fn series(&self, class: SopClass, turn: u32) -> String {
        let modality = class.modality();
        match class {
            SopClass::Withdrawal => self.part_uid(modality),
            _ => self.part_uid(&format!("{modality}\0{turn}")),
        }
    }

    /// The object of a part of a revision.
    pub(crate) fn instance(&self, part: &str, revision: u32, turn: u32) -> String {
        self.part_uid(&format!("{part}\0{revision}\0{turn}"))
    }

    /// Patient and study, as each object has them. The name is not known.
    pub(crate) fn of_patient(&self, issuer: &str) -> Dataset {
        let known = without_values(&[
            tags::PATIENT_NAME,
            tags::PATIENT_BIRTH_DATE,
            tags::PATIENT_SEX,
            tags::REFERRING_PHYSICIAN_NAME,
            tags::STUDY_ID,
        ])
        .text(tags::PATIENT_ID, self.patient.as_str())
        .text(tags::STUDY_INSTANCE_UID, self.uid())
        .text(tags::ACCESSION_NUMBER, self.accession_number());
        match issuer.is_empty() {
            true => known,
            false => known.text(tags::ISSUER_OF_PATIENT_ID, issuer),
        }
    }

    /// The request that a report in it answers (PS3.3, C.17.2); `None` if it answers none.
    pub(crate) fn request(&self) -> Option<Dataset> {
        self.request.as_ref()?;
        let request = without_values(&[
            tags::PLACER_ORDER_NUMBER_IMAGING_SERVICE_REQUEST,
            tags::FILLER_ORDER_NUMBER_IMAGING_SERVICE_REQUEST,
            tags::REQUESTED_PROCEDURE_ID,
            tags::REQUESTED_PROCEDURE_DESCRIPTION,
        ])
        .text(tags::STUDY_INSTANCE_UID, self.uid())
        .text(tags::ACCESSION_NUMBER, self.accession_number())
        .items(tags::REFERENCED_STUDY_SEQUENCE, Vec::new())
        .items(tags::REQUESTED_PROCEDURE_CODE_SEQUENCE, Vec::new());
        Some(request)
    }

    /// The number of its request in the hospital system; empty if it has none.
    fn accession_number(&self) -> &str {
        let request = self.request.as_ref();
        request.and_then(|request| request.accession_number.as_deref()).unwrap_or_default()
    }

    /// The UID of something of the record in the study. No two studies share one: an object belongs to one study.
    pub(crate) fn part_uid(&self, part: &str) -> String {
        match &self.request {
            Some(request) => uid(&format!("{}\0{}\0{part}", self.key, request.study_instance_uid)),
            None => uid(&format!("{}\0{part}", self.key)),
        }
    }
}

/// Elements that must be there and whose values nobody knows.
fn without_values(tags: &[Tag]) -> Dataset {
    tags.iter().fold(Dataset::new(), |set, tag| set.text(*tag, ""))
}

/// A UID that is always the same for one text: that of a UUID (PS3.5, B.2).
pub(crate) fn uid(text: &str) -> String {
    format!("2.25.{}", u128::from_be_bytes(uuid_bytes(text)))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn study() -> Study {
        Study::new("ab", "4711").unwrap()
    }

    fn listed(class: SopClass, turn: u32, uid: &str) -> Listed {
        let series = study().series(class, turn);
        Listed { class: class.uid().to_owned(), series, uid: uid.to_owned() }
    }

    #[test]
    fn a_uid_is_valid_and_that_of_one_part_alone() {
        let uids = [study().uid(), study().series(SopClass::Pdf, 0), study().instance("sr", 1, 0)];
        for (at, uid) in uids.iter().enumerate() {
            let digits = uid.strip_prefix("2.25.").unwrap();
            assert!(uid.len() <= 64 && !digits.starts_with('0') && !uid.contains("4711"), "{uid}");
            assert!(digits.bytes().all(|of| of.is_ascii_digit()));
            assert!(!uids[at + 1..].contains(uid));
        }
        assert_eq!(study().uid(), study().uid());
        for other in [Study::new("ac", "4711"), Study::new("ab", "4712")] {
            assert_ne!(other.unwrap().uid(), study().uid());
        }
    }

    #[test]
    fn a_record_in_the_study_of_a_request_shares_no_uid_with_one_in_another_study() {
        let of = |uid: &str| study().answering(ImagingRequest::new(uid, "A1").as_ref());
        let theirs = of("1.2.276.4711");
        assert_eq!(theirs.uid(), "1.2.276.4711");
        let studies = [study(), theirs.clone(), of("1.2.276.4712")];
        let uids = |study: &Study| {
            [study.series(SopClass::Pdf, 0), study.instance("sr", 1, 0), study.part_uid("frame")]
        };
        let all: BTreeSet<String> = studies.iter().flat_map(uids).collect();
        assert_eq!(all.len(), 9);
        assert_eq!(study().answering(None), study());
        // Whatever is known of the request later, what was confirmed is found where it is.
        for known in &studies {
            assert_eq!(uids(&known.clone().confirmed("1.2.276.4711")), uids(&theirs));
            assert_eq!(known.clone().confirmed(&study().uid()), study());
        }
        assert_eq!(theirs.clone().confirmed("1.2.276.4711"), theirs);
    }

    #[test]
    fn an_id_that_dicom_would_read_as_another_is_refused() {
        let long = "4".repeat(65);
        for id in ["", "47\\11", " 4711", "4711 ", "47\n11", long.as_str()] {
            assert_eq!(Study::new("ab", id), Err(PatientIdFault), "{id:?}");
        }
        assert!(Study::new("ab", &long[1..]).is_ok() && Study::new("ab", "Ü 11").is_ok());
    }

    #[test]
    fn what_others_have_in_the_study_and_what_marks_it_is_not_of_the_record() {
        let other = Listed { series: "1.2.3".to_owned(), ..listed(SopClass::Pdf, 0, "9") };
        let all = [
            listed(SopClass::Pdf, 0, "1"),
            listed(SopClass::Measurements, 1, "2"),
            other,
            listed(SopClass::Withdrawal, 0, "3"),
        ];
        let shown = |turns: u32| {
            study().shown(turns, &all).into_iter().map(|of| of.uid.as_str()).collect::<Vec<_>>()
        };
        assert_eq!([shown(0), shown(1), shown(2)], [vec![], vec!["1"], vec!["1", "2"]]);
        assert!(study().shows_withdrawal(&all) && !study().shows_withdrawal(&all[..3]));
    }
}
