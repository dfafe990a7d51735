//! Whose scan it is: what a file name and the scanner's own measures state, how that combines with the
//! patient who was named before, and what it means when the same bytes are seen again.

use std::collections::BTreeSet;

use gaiter_record::{Patient, Source, SourceKind};
use regex::Regex;

use crate::patient::check_digit::CheckDigit;
use crate::round::{CaptureMatch, Named};

/// The named group of the file-name expression that holds the id.
const GROUP: &str = "patient";

/// The longest id, bytes. It becomes a folder name of at most three times this length.
const LONGEST_ID: usize = 64;

/// Finding: the expression matched, but what it found is not allowed as an id.
pub const ID_NOT_ALLOWED: &str = "patient-id-not-allowed";

/// Finding: known bytes were seen for another patient.
pub const SAME_SCAN_OTHER_PATIENT: &str = "same-scan-other-patient";

/// Finding: two sources name different patients.
pub const PATIENTS_DIFFER: &str = "patients-differ";

/// Finding: nobody pressed the button for this export, and the configuration holds such exports.
pub const NO_PRESS: &str = "no-press";

/// The rules for finding the patient of a scan.
#[derive(Debug, Clone)]
pub struct Identity {
    file_name: Option<Regex>,
    sidecar: Option<Regex>,
    whole_id: Regex,
    check_digit: CheckDigit,
}

/// Whose scan it is, according to all sources.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Whose {
    /// The one patient who is named, with every source that names them.
    pub patient: Option<Patient>,
    /// Why the operator must decide; `None` if no decision is needed.
    pub held: Option<&'static str>,
    /// A source named something that is not allowed as an id.
    pub not_an_id: bool,
    /// Every source with its id, if they differ.
    pub claims: Vec<Patient>,
}

/// What a file name or the scanner's own measures state about the patient.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StatedPatient {
    Nothing,
    /// This id, allowed by the pattern.
    Patient(Patient),
    /// Something that is not allowed as an id; worth a finding, but it names nobody.
    NotAnId,
}

/// What it means that bytes were seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// These bytes were never seen: deliver them.
    New,
    /// This scan is known for this patient, or no patient is named now: nothing to do.
    Already,
    /// The operator must decide, for this reason: these bytes are known for another patient, or it is
    /// not clear whose they are.
    Held(&'static str),
}

impl Identity {
    /// The rules of the configuration: the expressions on the file name and on the scanner's own
    /// measures, the pattern that a whole id must match, and its check digit.
    ///
    /// # Errors
    /// If the pattern cannot be applied to the whole id.
    pub fn new(
        file_name: Option<Regex>,
        sidecar: Option<Regex>,
        pattern: &Regex,
        check_digit: CheckDigit,
    ) -> Result<Identity, regex::Error> {
        // Checking whether a match happens to span the id would miss `a|ab` on "ab".
        let whole_id = Regex::new(&format!(r"\A(?:{})\z", pattern.as_str()))?;
        Ok(Identity { file_name, sidecar, whole_id, check_digit })
    }

    /// What a file name states. Bytes that are not UTF-8 arrive as U+FFFD; two different names may then look
    /// the same, so no id may contain one.
    pub fn of_file_name(&self, name: &str) -> StatedPatient {
        self.patient_in(self.file_name.as_ref(), name, SourceKind::FileName)
    }

    /// What the scanner's own measures beside a scan state, by the first line that matches.
    pub fn of_sidecar(&self, text: &str) -> StatedPatient {
        let mut stated = text.lines().map(|line| {
            self.patient_in(self.sidecar.as_ref(), line.trim_end(), SourceKind::Sidecar)
        });
        stated.find(|of| *of != StatedPatient::Nothing).unwrap_or(StatedPatient::Nothing)
    }

    fn patient_in(
        &self,
        expression: Option<&Regex>,
        text: &str,
        kind: SourceKind,
    ) -> StatedPatient {
        let found = expression.and_then(|expression| expression.captures(text));
        let Some(id) = found.as_ref().and_then(|groups| groups.name(GROUP)) else {
            return StatedPatient::Nothing;
        };
        match self.patient(id.as_str(), kind) {
            Some(patient) => StatedPatient::Patient(patient),
            None => StatedPatient::NotAnId,
        }
    }

    /// The patient of an id that a source gave; `None` if it is not allowed as an id.
    pub fn patient(&self, id: &str, kind: SourceKind) -> Option<Patient> {
        let is_allowed = !id.is_empty()
            && id.len() <= LONGEST_ID
            && !id.contains(char::REPLACEMENT_CHARACTER)
            && self.whole_id.is_match(id)
            && self.check_digit.holds(id);
        is_allowed.then(|| Patient { id: id.to_owned(), sources: vec![Source::from_kind(kind)] })
    }
}

/// Whose scan it is, by the capture that it answers, its file name and the files beside it. A name in the
/// file name binds to that content: it settles what is held for nobody else. `hold_unpressed` is whether
/// exports without a press are held.
pub fn of_judged(judged: &CaptureMatch, hold_unpressed: bool, stated: [StatedPatient; 2]) -> Whose {
    let (named, held) = match judged {
        CaptureMatch::Of(capture) => (capture.patient.as_ref(), None),
        CaptureMatch::Held { why, patient, candidates, .. } => {
            let is_settled = matches!(&stated[0], StatedPatient::Patient(own)
                if candidates.iter().all(|named| named.id == own.id));
            (patient.as_ref(), (!is_settled).then_some(why.word()))
        }
        CaptureMatch::Unpressed => (None, hold_unpressed.then_some(NO_PRESS)),
        CaptureMatch::Known => (None, None),
    };
    whose(named, held, stated)
}

/// Whose scan it is, by the patient named before, the scan's file name and the files beside it, in this
/// order. `held` is why the capture of its export holds it.
pub(crate) fn whose(
    named: Option<&Named>,
    held: Option<&'static str>,
    stated: [StatedPatient; 2],
) -> Whose {
    let not_an_id = stated.contains(&StatedPatient::NotAnId);
    let named = named.map(|named| Patient { id: named.id.clone(), sources: vec![named.source()] });
    let patients = stated.into_iter().filter_map(|stated| match stated {
        StatedPatient::Patient(patient) => Some(patient),
        StatedPatient::Nothing | StatedPatient::NotAnId => None,
    });
    let claims: Vec<Patient> = named.into_iter().chain(patients).collect();
    let ids: BTreeSet<&str> = claims.iter().map(|claim| claim.id.as_str()).collect();
    if ids.len() > 1 {
        // Differing sources are a more specific reason than that of the capture.
        return Whose { patient: None, held: Some(PATIENTS_DIFFER), not_an_id, claims };
    }
    let sources = claims.iter().flat_map(|claim| claim.sources.clone()).collect();
    let patient = claims.first().map(|claim| Patient { id: claim.id.clone(), sources });
    Whose { patient, held, not_an_id, claims: Vec::new() }
}

/// What it means to see bytes for `sighted` that are known for the patients in `known`, including held
/// ones; `None` stands for an unnamed patient. `known` is empty for new bytes.
pub fn verdict<'a>(
    known: impl IntoIterator<Item = Option<&'a str>>,
    sighted: Option<&str>,
) -> Verdict {
    let mut known = known.into_iter().peekable();
    if known.peek().is_none() {
        return Verdict::New;
    }
    // A sighting without a patient adds nothing to what is known.
    if sighted.is_none() || known.any(|patient| patient == sighted) {
        return Verdict::Already;
    }
    Verdict::Held(SAME_SCAN_OTHER_PATIENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn says(expression: &str, pattern: &str, name: &str) -> StatedPatient {
        let expression = Some(Regex::new(expression).unwrap());
        let pattern = Regex::new(pattern).unwrap();
        let identity = Identity::new(expression, None, &pattern, CheckDigit::None).unwrap();
        identity.of_file_name(name)
    }

    fn shipped(name: &str) -> StatedPatient {
        says("^(?<patient>P?[0-9]+)_", "^P?[0-9]{1,12}$", name)
    }

    fn patient(id: &str) -> StatedPatient {
        StatedPatient::Patient(from(SourceKind::FileName, id))
    }

    fn from(kind: SourceKind, id: &str) -> Patient {
        Patient { id: id.to_owned(), sources: vec![Source::from_kind(kind)] }
    }

    #[test]
    fn a_matching_name_says_the_id() {
        assert_eq!(shipped("4711_2026-11-21.obj"), patient("4711"));
        assert_eq!(shipped("P0815_left\u{FFFD}.obj"), patient("P0815"));
    }

    #[test]
    fn a_name_that_does_not_match_says_nothing() {
        assert_eq!(shipped("scan001.obj"), StatedPatient::Nothing);
        let pattern = Regex::new(".*").unwrap();
        let silent = Identity::new(None, None, &pattern, CheckDigit::None).unwrap();
        assert_eq!(silent.of_file_name("4711_.obj"), StatedPatient::Nothing);
        assert_eq!(silent.of_sidecar("4711_"), StatedPatient::Nothing);
    }

    #[test]
    fn an_id_against_the_pattern_is_a_finding_not_an_id() {
        assert_eq!(shipped("1234567890123_.obj"), StatedPatient::NotAnId);
        assert_eq!(says("^(?<patient>.*)_", ".*", "_.obj"), StatedPatient::NotAnId);
        assert_eq!(says("^(?<patient>.*)_", ".*", "M\u{FFFD}ller_.obj"), StatedPatient::NotAnId);
        let long = format!("{}_.obj", "7".repeat(LONGEST_ID + 1));
        assert_eq!(says("^(?<patient>.*)_", ".*", &long), StatedPatient::NotAnId);
    }

    #[test]
    fn the_pattern_is_matched_against_the_whole_id() {
        assert_eq!(says("^(?<patient>[^_]*)_", "[0-9]+", "47x11_.obj"), StatedPatient::NotAnId);
        assert_eq!(says("^(?<patient>[^_]*)_", "a|ab", "ab_.obj"), patient("ab"));
        assert_eq!(says("^(?<patient>[^_]*)_", "^[0-9]+$", "47\n_.obj"), StatedPatient::NotAnId);
    }

    #[test]
    fn the_same_bytes_are_one_record_per_patient_and_another_patient_is_held() {
        let (a, b) = (Some("4711"), Some("0815"));
        assert_eq!(verdict([], a), Verdict::New);
        assert_eq!(verdict([], None), Verdict::New);
        assert_eq!(verdict([a], a), Verdict::Already);
        assert_eq!(verdict([a], b), Verdict::Held(SAME_SCAN_OTHER_PATIENT));
        assert_eq!(verdict([a, b], b), Verdict::Already, "held once is enough");
    }

    #[test]
    fn naming_nobody_adds_nothing_and_a_name_after_nobody_is_held() {
        assert_eq!(verdict([Some("4711")], None), Verdict::Already);
        assert_eq!(verdict([None], None), Verdict::Already);
        assert_eq!(verdict([None], Some("4711")), Verdict::Held(SAME_SCAN_OTHER_PATIENT));
    }

    #[test]
    fn the_measures_beside_a_scan_name_the_patient_by_their_first_line_that_matches() {
        let line = Some(Regex::new("^PATIENT=(?<patient>.*)$").unwrap());
        let pattern = Regex::new("[0-9]+").unwrap();
        let identity = Identity::new(None, line, &pattern, CheckDigit::None).unwrap();
        let says = |text| identity.of_sidecar(text);
        let named = StatedPatient::Patient(from(SourceKind::Sidecar, "4711"));
        assert_eq!(says("MEASURE Calf=1\r\nPATIENT=4711\r\nPATIENT=0815\r\n"), named);
        assert_eq!(says("MEASURE Calf=1\n"), StatedPatient::Nothing);
        assert_eq!(says("PATIENT=Meier\n"), StatedPatient::NotAnId);
    }

    #[test]
    fn sources_that_agree_are_all_kept_and_sources_that_differ_hold_the_scan() {
        let named = |id: &str| Named::new(id.to_owned(), SourceKind::Reader);
        let (nothing, file) = (StatedPatient::Nothing, patient("4711"));
        let whose = |named: Option<&Named>, file: &StatedPatient| {
            super::whose(named, None, [file.clone(), nothing.clone()])
        };
        assert_eq!(whose(None, &nothing), Whose::default());
        let agreed = whose(Some(&named("4711")), &file);
        let sources =
            vec![Source::from_kind(SourceKind::Reader), Source::from_kind(SourceKind::FileName)];
        let both = Patient { id: "4711".into(), sources };
        assert_eq!(agreed, Whose { patient: Some(both), ..Whose::default() });
        let differ = whose(Some(&named("0815")), &file);
        assert_eq!((differ.patient, differ.held), (None, Some(PATIENTS_DIFFER)));
        let claims = vec![from(SourceKind::Reader, "0815"), from(SourceKind::FileName, "4711")];
        assert_eq!(differ.claims, claims);
    }

    #[test]
    fn what_is_not_an_id_says_nothing_and_does_not_contradict() {
        let named = Named::new("4711", SourceKind::Order);
        let whose = whose(Some(&named), None, [StatedPatient::NotAnId, StatedPatient::Nothing]);
        assert_eq!(whose.patient, Some(from(SourceKind::Order, "4711")));
        assert!(whose.not_an_id && whose.held.is_none());
    }
}
