//! The texts of an answer to a query for a worklist → an entry.

use std::ops::Range;

use gaiter_record::ImagingRequest;
use jiff::civil::{Date, Time};

use super::{ListedPerson, ScheduledStep, WorklistEntry};

/// The longest text that is shown to people, characters.
const SHOWN_MOST: usize = 100;

/// The longest way in which a name is written, characters, and how many ways there are at most (PS3.5, 6.2.1).
const NAME_GROUP_MOST: usize = 64;
const NAME_GROUPS: usize = 3;

/// The values of a response as DICOM writes them (PS3.5, 6.2), decoded from their character set; empty where there
/// are none. Values of several are separated by a backslash.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub struct FindResponse<'a> {
    /// (0010,0020) LO
    pub patient_id: &'a str,
    /// (0010,0021) LO
    pub issuer_of_patient_id: &'a str,
    /// (0010,0010) PN
    pub patient_name: &'a str,
    /// (0010,0030) DA
    pub patient_birth_date: &'a str,
    /// (0010,0040) CS
    pub patient_sex: &'a str,
    /// (0032,1060) LO
    pub requested_procedure_description: &'a str,
    /// (0020,000D) UI
    pub study_instance_uid: &'a str,
    /// (0008,0050) SH
    pub accession_number: &'a str,
    /// (0040,0001) AE, in the item of (0040,0100), as those below
    pub scheduled_station_ae_title: &'a str,
    /// (0008,0060) CS
    pub modality: &'a str,
    /// (0040,0002) DA
    pub start_date: &'a str,
    /// (0040,0003) TM
    pub start_time: &'a str,
    /// (0040,0009) SH
    pub step_id: &'a str,
}

impl From<FindResponse<'_>> for WorklistEntry {
    fn from(of: FindResponse<'_>) -> WorklistEntry {
        let stations = of.scheduled_station_ae_title.split('\\').map(plain);
        WorklistEntry {
            patient: plain(of.patient_id),
            issuer: plain(of.issuer_of_patient_id),
            person: ListedPerson {
                name: shown(&name(of.patient_name)),
                dicom_name: as_written(of.patient_name),
                birth_date: date(of.patient_birth_date),
                sex: sex(of.patient_sex),
            },
            procedure: shown(of.requested_procedure_description),
            scheduled: ScheduledStep {
                stations: stations.filter(|title| !title.is_empty()).collect(),
                modality: plain(of.modality),
                date: date(of.start_date),
                time: time(of.start_time),
                step: plain(of.step_id),
            },
            accession_number: plain(of.accession_number),
            request: ImagingRequest::new(
                of.study_instance_uid.trim_end_matches('\0'),
                of.accession_number,
            ),
        }
    }
}

/// A value without what pads it to an even length.
fn plain(value: &str) -> String {
    value.trim_matches([' ', '\0']).to_owned()
}

/// A text for people, in a line and not too long.
fn shown(text: &str) -> String {
    let spaced = text.trim().chars().map(|sign| if sign.is_control() { ' ' } else { sign });
    spaced.take(SHOWN_MOST).collect()
}

/// `Meier^Anna^Maria^Dr.` → `Meier, Anna Maria`. Of the ways in which the name is written, the first.
fn name(value: &str) -> String {
    let written = value.split('=').find(|group| !group.trim_matches(['^', ' ']).is_empty());
    let mut parts = written.unwrap_or_default().split('^').map(str::trim);
    let family = parts.next().unwrap_or_default();
    let given: Vec<&str> = parts.take(2).filter(|part| !part.is_empty()).collect();
    let parts = [family.to_owned(), given.join(" ")];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

/// A name as it is; empty if DICOM could not write it again.
fn as_written(value: &str) -> String {
    let name = plain(value);
    let groups = || name.split('=');
    let fits = groups().count() <= NAME_GROUPS
        && groups().all(|group| group.chars().count() <= NAME_GROUP_MOST)
        && !name.chars().any(|sign| sign.is_control() || sign == '\\');
    if fits { name } else { String::new() }
}

/// One of the values that there are (PS3.3, C.7.1.1); else empty.
fn sex(value: &str) -> String {
    let sex = plain(value);
    if matches!(sex.as_str(), "M" | "F" | "O") { sex } else { String::new() }
}

/// `20261128`, or as it was written long ago `2026.11.28`.
fn date(value: &str) -> Option<Date> {
    let digits = digits(value, '.')?;
    let number = |range: Range<usize>| digits.get(range)?.parse::<i16>().ok();
    let (year, month, day) = (number(0..4)?, number(4..6)?, number(6..8)?);
    let is_whole = digits.len() == 8;
    Date::new(year, i8::try_from(month).ok()?, i8::try_from(day).ok()?).ok().filter(|_| is_whole)
}

/// `0930`, `093000.5`, or as it was written long ago `09:30`: hour and minute.
fn time(value: &str) -> Option<Time> {
    let whole = value.trim().split('.').next().unwrap_or_default();
    let digits = digits(whole, ':')?;
    let number = |range: Range<usize>| digits.get(range)?.parse::<i8>().ok();
    let minute = if digits.len() > 2 { number(2..4)? } else { 0 };
    Time::new(number(0..2)?, minute, 0, 0).ok()
}

/// The digits of a value without its separators; `None` if it has anything else, or nothing.
fn digits(value: &str, separator: char) -> Option<String> {
    let digits = plain(value).replace(separator, "");
    (!digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())).then_some(digits)
}

#[cfg(test)]
mod tests {
    use jiff::civil;

    use super::*;

    #[test]
    fn the_values_of_a_response_become_an_entry() {
        let entry = WorklistEntry::from(FindResponse {
            patient_id: "P4711 ",
            issuer_of_patient_id: "",
            patient_name: "Müller^Änne^Maria^Dr.",
            patient_birth_date: "19500102",
            patient_sex: "F ",
            requested_procedure_description: "Beinvermessung ",
            study_instance_uid: "1.2.276.4242\0",
            accession_number: "ACC0815 ",
            scheduled_station_ae_title: "LEGSCAN \\CT1",
            modality: "OSS ",
            start_date: "20261128",
            start_time: "0930",
            step_id: "1 ",
        });
        let scheduled = ScheduledStep {
            stations: vec!["LEGSCAN".to_owned(), "CT1".to_owned()],
            modality: "OSS".to_owned(),
            date: Some(civil::date(2026, 11, 28)),
            time: Some(civil::time(9, 30, 0, 0)),
            step: "1".to_owned(),
        };
        let expected = WorklistEntry {
            patient: "P4711".to_owned(),
            issuer: String::new(),
            person: ListedPerson {
                name: "Müller, Änne Maria".to_owned(),
                dicom_name: "Müller^Änne^Maria^Dr.".to_owned(),
                birth_date: Some(civil::date(1950, 1, 2)),
                sex: "F".to_owned(),
            },
            procedure: "Beinvermessung".to_owned(),
            scheduled,
            accession_number: "ACC0815".to_owned(),
            request: ImagingRequest::new("1.2.276.4242", "ACC0815"),
        };
        assert_eq!(entry, expected);
        assert_eq!(entry.person.name, expected.person.name);
        let empty = WorklistEntry::from(FindResponse::default());
        assert_eq!((empty.request, empty.scheduled), (None, ScheduledStep::default()));
    }

    #[test]
    fn dates_and_times_are_read_as_dicom_writes_them_and_nothing_else() {
        for text in ["20261128", "2026.11.28", " 20261128"] {
            assert_eq!(date(text), Some(civil::date(2026, 11, 28)), "{text}");
        }
        for text in ["", "20261328", "2026112", "202611281", "20261128-20261130", "today"] {
            assert_eq!(date(text), None, "{text}");
        }
        for text in ["0930", "093000", "093059.123456", "09:30", "09:30:00"] {
            assert_eq!(time(text), Some(civil::time(9, 30, 0, 0)), "{text}");
        }
        assert_eq!(time("09"), Some(civil::time(9, 0, 0, 0)));
        for text in ["", "2530", "0961", "9", "093", "morning"] {
            assert_eq!(time(text), None, "{text}");
        }
    }

    #[test]
    fn what_an_archive_may_be_told_is_as_the_server_wrote_it_or_empty() {
        let long = "x".repeat(64);
        let (three, longer) = ([long.as_str(); 3].join("="), format!("{long}x"));
        let in_three_ways = "Yamada^Tarou=山田^太郎=やまだ^たろう";
        for name in ["Müller^Änne^^Dr.", in_three_ways, three.as_str(), ""] {
            assert_eq!(as_written(&format!("{name} ")), name);
        }
        for name in ["A\\B", "A\nB", longer.as_str(), "a=b=c=d"] {
            assert_eq!(as_written(name), "", "{name}");
        }
        assert_eq!(["M ", "F", "O", "", "m", "MALE"].map(sex), ["M", "F", "O", "", "", ""]);
    }

    #[test]
    fn a_name_is_shown_as_it_is_written_first() {
        for (value, shown) in [
            ("Meier^Anna", "Meier, Anna"),
            ("Meier", "Meier"),
            ("^Anna", "Anna"),
            ("", ""),
            ("Yamada^Tarou=山田^太郎=やまだ^たろう", "Yamada, Tarou"),
            ("=山田^太郎", "山田, 太郎"),
        ] {
            assert_eq!(name(value), shown, "{value}");
        }
    }
}
