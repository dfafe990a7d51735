//! Whose scan it is: what a file name says, and what the same bytes seen again mean.

use regex::Regex;

use crate::record::{Patient, Source, SourceKind};

/// The named group of the file-name expression that holds the id.
const GROUP: &str = "patient";

/// The longest id, bytes. It becomes a folder name of at most three times this length.
pub const LONGEST_ID: usize = 64;

/// Finding: the expression matched, but what it found is not allowed as an id.
pub const ID_NOT_ALLOWED: &str = "patient-id-not-allowed";

/// Finding: bytes that are known already were seen for another patient.
pub const SAME_SCAN_OTHER_PATIENT: &str = "same-scan-other-patient";

/// The rules by which file names say whose scan it is.
#[derive(Debug, Clone)]
pub struct Identity {
    file_name: Option<Regex>,
    whole_id: Regex,
}

/// What a file name says about the patient.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NameSays {
    /// Nothing.
    Nothing,
    /// This id, allowed by the pattern.
    Patient(Patient),
    /// It names something that is not allowed as an id; worth a finding, says nothing.
    NotAnId,
}

/// What a sighting of bytes means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// These bytes were never seen: deliver them.
    New,
    /// This scan is known for this patient, or the sighting names nobody: nothing to do.
    Already,
    /// The same bytes for another patient: a person decides.
    Held,
}

impl Identity {
    /// The rules of the configuration: the expression on the file name, and the pattern that a
    /// whole id must match.
    ///
    /// # Errors
    /// Where the pattern cannot be applied to the whole id.
    pub fn new(file_name: Option<Regex>, pattern: &Regex) -> Result<Identity, regex::Error> {
        // Asking whether a match happens to span the id would miss `a|ab` on "ab".
        let whole_id = Regex::new(&format!(r"\A(?:{})\z", pattern.as_str()))?;
        Ok(Identity { file_name, whole_id })
    }

    /// What a file name says. Bytes that are no UTF-8 come in as U+FFFD; two different names may
    /// look alike then, so no id may hold one.
    pub fn of_file_name(&self, name: &str) -> NameSays {
        let found = self.file_name.as_ref().and_then(|expression| expression.captures(name));
        let Some(id) = found.as_ref().and_then(|groups| groups.name(GROUP)) else {
            return NameSays::Nothing;
        };
        if !self.allows(id.as_str()) {
            return NameSays::NotAnId;
        }
        let sources = vec![Source { kind: SourceKind::FileName }];
        NameSays::Patient(Patient { id: id.as_str().to_owned(), sources })
    }

    /// The patient of an id that a person gave; none where it is not allowed as an id.
    pub fn of_operator(&self, id: &str) -> Option<Patient> {
        let sources = vec![Source { kind: SourceKind::Operator }];
        self.allows(id).then(|| Patient { id: id.to_owned(), sources })
    }

    fn allows(&self, id: &str) -> bool {
        !id.is_empty()
            && id.len() <= LONGEST_ID
            && !id.contains(char::REPLACEMENT_CHARACTER)
            && self.whole_id.is_match(id)
    }
}

/// What it means to see bytes for `sighted` that are known for the patients in `known`, held ones
/// included; none stands for a patient nobody named. `known` is empty for new bytes.
pub fn judge<'a>(
    known: impl IntoIterator<Item = Option<&'a str>>,
    sighted: Option<&str>,
) -> Verdict {
    let mut known = known.into_iter().peekable();
    if known.peek().is_none() {
        return Verdict::New;
    }
    // A sighting that names nobody adds nothing to what is known.
    if sighted.is_none() || known.any(|patient| patient == sighted) {
        return Verdict::Already;
    }
    Verdict::Held
}

#[cfg(test)]
mod tests {
    use super::*;

    fn says(expression: &str, pattern: &str, name: &str) -> NameSays {
        let expression = Some(Regex::new(expression).unwrap());
        Identity::new(expression, &Regex::new(pattern).unwrap()).unwrap().of_file_name(name)
    }

    fn shipped(name: &str) -> NameSays {
        says("^(?<patient>P?[0-9]+)_", "^P?[0-9]{1,12}$", name)
    }

    fn patient(id: &str) -> NameSays {
        let sources = vec![Source { kind: SourceKind::FileName }];
        NameSays::Patient(Patient { id: id.to_owned(), sources })
    }

    #[test]
    fn a_matching_name_says_the_id() {
        assert_eq!(shipped("4711_2026-11-21.obj"), patient("4711"));
        assert_eq!(shipped("P0815_left\u{FFFD}.obj"), patient("P0815"));
    }

    #[test]
    fn a_name_that_does_not_match_says_nothing() {
        assert_eq!(shipped("scan001.obj"), NameSays::Nothing);
        let silent = Identity::new(None, &Regex::new(".*").unwrap()).unwrap();
        assert_eq!(silent.of_file_name("4711_.obj"), NameSays::Nothing);
    }

    #[test]
    fn an_id_against_the_pattern_is_a_finding_not_an_id() {
        assert_eq!(shipped("1234567890123_.obj"), NameSays::NotAnId);
        assert_eq!(says("^(?<patient>.*)_", ".*", "_.obj"), NameSays::NotAnId);
        assert_eq!(says("^(?<patient>.*)_", ".*", "M\u{FFFD}ller_.obj"), NameSays::NotAnId);
        let long = format!("{}_.obj", "7".repeat(LONGEST_ID + 1));
        assert_eq!(says("^(?<patient>.*)_", ".*", &long), NameSays::NotAnId);
    }

    #[test]
    fn the_pattern_is_matched_against_the_whole_id() {
        assert_eq!(says("^(?<patient>[^_]*)_", "[0-9]+", "47x11_.obj"), NameSays::NotAnId);
        assert_eq!(says("^(?<patient>[^_]*)_", "a|ab", "ab_.obj"), patient("ab"));
        assert_eq!(says("^(?<patient>[^_]*)_", "^[0-9]+$", "47\n_.obj"), NameSays::NotAnId);
    }

    #[test]
    fn the_same_bytes_are_one_record_per_patient_and_another_patient_is_held() {
        let (a, b) = (Some("4711"), Some("0815"));
        assert_eq!(judge([], a), Verdict::New);
        assert_eq!(judge([], None), Verdict::New);
        assert_eq!(judge([a], a), Verdict::Already);
        assert_eq!(judge([a], b), Verdict::Held);
        assert_eq!(judge([a, b], b), Verdict::Already, "held once is enough");
    }

    #[test]
    fn naming_nobody_adds_nothing_and_a_name_after_nobody_is_held() {
        assert_eq!(judge([Some("4711")], None), Verdict::Already);
        assert_eq!(judge([None], None), Verdict::Already);
        assert_eq!(judge([None], Some("4711")), Verdict::Held);
    }
}
