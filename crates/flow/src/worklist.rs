//! The day's worklist of a hospital system (DICOM Modality Worklist): which of its entries are of this station
//! today, and which one a tap on the page or a scanned code chooses.
//!
//! A worklist states who is expected. Only a choice at the booth states who is there, so a choice is a word at the
//! booth ([`crate::round`]) and the list itself names nobody. Names and birth dates are for the person who
//! chooses: they are in no `Debug`, and they are gone with the day.

mod answer;
mod numbers;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use gaiter_record::{ImagingRequest, sha256};
use jiff::civil::{Date, Time};

pub use answer::FindResponse;
pub use numbers::AccessionNumbers;

/// The most entries that can be chosen from: no booth scans more patients in a day, and no person looks through
/// more of them.
pub const ENTRIES_MOST: usize = 300;

/// How many digits of its hash name an entry.
const KEY_DIGITS: usize = 16;

/// Who is expected, for the person who chooses, and for an archive of images that is to be told.
#[derive(Clone, PartialEq, Eq, Default)]
pub struct ListedPerson {
    /// Patient's Name (0010,0010) as people write it.
    pub name: String,
    /// The same as the server has written it; empty if it is no valid name.
    pub dicom_name: String,
    /// Patient's Birth Date (0010,0030).
    pub birth_date: Option<Date>,
    /// Patient's Sex (0010,0040): `M`, `F` or `O`; empty if the server sent nothing else.
    pub sex: String,
}

impl ListedPerson {
    /// The birth date as text; empty if it is not known.
    fn born(&self) -> String {
        self.birth_date.map(|date| date.to_string()).unwrap_or_default()
    }
}

/// Logs get no names.
impl fmt::Debug for ListedPerson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ListedPerson(..)")
    }
}

/// Where and when an examination is planned: the item of Scheduled Procedure Step Sequence (0040,0100).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ScheduledStep {
    /// Scheduled Station AE Title (0040,0001), which may have several values.
    pub stations: Vec<String>,
    /// Modality (0008,0060).
    pub modality: String,
    /// Scheduled Procedure Step Start Date (0040,0002).
    pub date: Option<Date>,
    /// Scheduled Procedure Step Start Time (0040,0003).
    pub time: Option<Time>,
    /// Scheduled Procedure Step ID (0040,0009).
    pub step: String,
}

/// An entry of a worklist. Texts have no spaces around them, and are empty where the server sent none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorklistEntry {
    /// Patient ID (0010,0020).
    pub patient: String,
    /// Issuer of Patient ID (0010,0021).
    pub issuer: String,
    pub person: ListedPerson,
    /// What is to be done, for the person who chooses: Requested Procedure Description (0032,1060).
    pub procedure: String,
    pub scheduled: ScheduledStep,
    /// Accession Number (0008,0050), also of a request that is not valid.
    pub accession_number: String,
    /// The request that the examination answers; `None` if the server sent none that is valid.
    pub request: Option<ImagingRequest>,
}

impl WorklistEntry {
    /// Identifies the entry on a page without its patient: a hash. It changes with name and birth date, so that a tap
    /// on a page that still shows the old ones chooses nothing.
    pub fn key(&self) -> String {
        let request = self.request.as_ref();
        let born = self.person.born();
        let parts = [
            self.patient.as_str(),
            &self.issuer,
            &self.person.name,
            &born,
            request.map_or("", |request| &request.study_instance_uid),
            self.accession_number().unwrap_or_default(),
            &self.scheduled.step,
        ];
        sha256(parts.join("\0").as_bytes()).chars().take(KEY_DIGITS).collect()
    }

    /// The number of its request in the hospital system; `None` if it has none.
    pub fn accession_number(&self) -> Option<&str> {
        Some(self.accession_number.as_str()).filter(|number| !number.is_empty())
    }
}

/// What the entries of a station have in common.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorklistFilter {
    /// Its Scheduled Station AE Title.
    pub station: String,
    /// Its modality; `None` if entries of any are its own.
    pub modality: Option<String>,
}

impl WorklistFilter {
    /// Whether an entry is of this station on this day. A server that does not know a key of the query leaves it out
    /// of the search, so its answer proves nothing.
    pub fn has(&self, entry: &WorklistEntry, today: Date) -> bool {
        let ScheduledStep { stations, modality, date, .. } = &entry.scheduled;
        stations.contains(&self.station)
            && self.modality.as_ref().is_none_or(|own| own == modality)
            && *date == Some(today)
    }
}

/// The worklist of one day.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Worklist {
    day: Date,
    entries: Vec<WorklistEntry>,
    /// How many entries name no patient: entries of this station, and unreadable ones.
    left_out: usize,
    /// The accession numbers of these.
    numbers_left_out: BTreeSet<String>,
}

/// Whom a scanned code chooses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorklistChoice<'a> {
    /// The list knows nothing of the code: it is what it would be without a list.
    NotListed,
    /// This patient, and the request if there is only one that may be meant.
    Patient { id: &'a str, request: Option<&'a ImagingRequest> },
    /// It may be the id of one patient and the accession number of another.
    Unclear,
}

impl Worklist {
    /// The list of a day, from the answer to a query. `is_id` is whether a text is allowed as a patient's id.
    ///
    /// An entry without a valid id or request is left out, and so are entries that differ on whose the id is.
    pub fn new(
        answer: Vec<WorklistEntry>,
        filter: &WorklistFilter,
        today: Date,
        is_id: impl Fn(&str) -> bool,
    ) -> Worklist {
        let mut ours: Vec<WorklistEntry> =
            answer.into_iter().filter(|entry| filter.has(entry, today)).collect();
        let disputed = disputed(&ours);
        // What is planned for no time stands last.
        ours.sort_by_cached_key(|entry| {
            let time = entry.scheduled.time;
            (time.is_none(), time, entry.key())
        });
        let mut known = BTreeSet::new();
        ours.retain(|entry| known.insert(entry.key()));
        let (mut entries, mut others): (Vec<WorklistEntry>, Vec<WorklistEntry>) =
            ours.into_iter().partition(|entry| {
                entry.request.is_some()
                    && is_id(&entry.patient)
                    && !disputed.contains(&entry.patient)
            });
        others.extend(entries.drain(ENTRIES_MOST.min(entries.len())..));
        let numbers = others.iter().filter_map(WorklistEntry::accession_number).map(str::to_owned);
        let numbers_left_out = numbers.collect();
        Worklist { day: today, entries, left_out: others.len(), numbers_left_out }
    }

    /// It with so many entries besides that cannot be read.
    pub fn with_unreadable(self, count: usize) -> Worklist {
        Worklist { left_out: self.left_out + count, ..self }
    }

    /// Its entries, in the order of their times; none on another day than its own.
    pub fn entries(&self, today: Date) -> &[WorklistEntry] {
        if self.is_over(today) { &[] } else { &self.entries }
    }

    /// Whether its day is over. A clock that is set back ends it, too.
    pub fn is_over(&self, today: Date) -> bool {
        self.day != today
    }

    /// How many entries name no patient: entries of this station, and unreadable ones.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// The entry of this key.
    pub fn entry(&self, key: &str, today: Date) -> Option<&WorklistEntry> {
        self.entries(today).iter().find(|entry| entry.key() == key)
    }

    /// Who is expected for a request of a patient.
    pub fn person_of(
        &self,
        patient: &str,
        request: &ImagingRequest,
        today: Date,
    ) -> Option<&ListedPerson> {
        let is_theirs = |entry: &&WorklistEntry| {
            entry.patient == patient && entry.request.as_ref() == Some(request)
        };
        self.entries(today).iter().find(is_theirs).map(|entry| &entry.person)
    }

    /// The request that the scan of a patient answers, if there is only one that may be meant.
    pub fn request_of(&self, patient: &str, today: Date) -> Option<&ImagingRequest> {
        only_request(self.entries(today).iter().filter(|entry| entry.patient == patient))
    }

    /// Whom a scanned code chooses: a patient's id or an accession number. `may_be_id` is whether it is allowed as
    /// a patient's id; then it may be that of somebody who is not listed, and no accession number. Whether it may be
    /// that of somebody whom the list does not have, [`AccessionNumbers::chosen_by`] knows.
    fn chosen_by(&self, code: &str, may_be_id: bool, today: Date) -> WorklistChoice<'_> {
        let entries = self.entries(today);
        if !self.is_over(today) && self.numbers_left_out.contains(code) {
            return WorklistChoice::Unclear;
        }
        let is_meant = |entry: &&WorklistEntry| {
            entry.patient == code || entry.accession_number() == Some(code)
        };
        let patients: BTreeSet<&str> =
            entries.iter().filter(is_meant).map(|entry| entry.patient.as_str()).collect();
        let mut patients = patients.into_iter();
        match (patients.next(), patients.next()) {
            (None, _) => WorklistChoice::NotListed,
            (Some(id), None) if id == code || !may_be_id => WorklistChoice::Patient {
                id,
                request: only_request(entries.iter().filter(is_meant)),
            },
            (Some(_), _) => WorklistChoice::Unclear,
        }
    }
}

/// The one request of these entries; `None` if they have several.
fn only_request<'a>(
    entries: impl Iterator<Item = &'a WorklistEntry>,
) -> Option<&'a ImagingRequest> {
    let requests: BTreeSet<&ImagingRequest> =
        entries.filter_map(|entry| entry.request.as_ref()).collect();
    let mut requests = requests.into_iter();
    requests.next().filter(|_| requests.next().is_none())
}

/// The ids that belong to different people according to entries which differ in the issuer of the id, or in a name
/// or birth date.
fn disputed(entries: &[WorklistEntry]) -> BTreeSet<String> {
    let mut people: BTreeMap<&str, [BTreeSet<String>; 3]> = BTreeMap::new();
    for entry in entries {
        let name = entry.person.name.to_lowercase();
        let told = [entry.issuer.clone(), name, entry.person.born()];
        let known = people.entry(&entry.patient).or_default();
        for (known, told) in known.iter_mut().zip(told).filter(|(_, told)| !told.is_empty()) {
            known.insert(told);
        }
    }
    let differ = |known: &[BTreeSet<String>; 3]| known.iter().any(|values| values.len() > 1);
    let found = people.into_iter().filter(|(_, known)| differ(known));
    found.map(|(id, _)| id.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use jiff::civil::date;

    use super::*;

    const TODAY: Date = date(2026, 11, 28);

    fn entry(patient: &str, accession_number: &str) -> WorklistEntry {
        let person =
            ListedPerson { name: format!("Testfrau, {patient}"), ..ListedPerson::default() };
        WorklistEntry {
            patient: patient.to_owned(),
            issuer: String::new(),
            person,
            procedure: "Beinvermessung".to_owned(),
            scheduled: ScheduledStep {
                stations: vec!["LEGSCAN".to_owned()],
                modality: "OSS".to_owned(),
                date: Some(TODAY),
                time: None,
                step: "1".to_owned(),
            },
            accession_number: accession_number.to_owned(),
            request: ImagingRequest::new(&format!("1.2.3.{}", patient.len()), accession_number),
        }
    }

    fn expected() -> WorklistFilter {
        WorklistFilter { station: "LEGSCAN".to_owned(), modality: Some("OSS".to_owned()) }
    }

    /// Ids are digits, as in the default of `patient.pattern` but for its P.
    fn is_id(text: &str) -> bool {
        !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
    }

    fn list(answer: &[WorklistEntry]) -> Worklist {
        Worklist::new(answer.to_vec(), &expected(), TODAY, is_id)
    }

    fn patients(list: &Worklist) -> Vec<&str> {
        list.entries(TODAY).iter().map(|entry| entry.patient.as_str()).collect()
    }

    #[test]
    fn what_is_of_another_day_station_or_modality_is_not_on_the_list() {
        let own = entry("1", "A1");
        let with = |change: &dyn Fn(&mut ScheduledStep)| {
            let mut other = entry("2", "A2");
            change(&mut other.scheduled);
            other
        };
        let others = [
            with(&|of| of.date = Some(date(2026, 11, 27))),
            with(&|of| of.date = None),
            with(&|of| of.stations = vec!["CT1".to_owned()]),
            with(&|of| of.stations.clear()),
            with(&|of| of.modality = "CT".to_owned()),
        ];
        for other in others {
            let found = list(&[own.clone(), other.clone()]);
            assert_eq!((patients(&found), found.left_out()), (vec!["1"], 0), "{other:?}");
        }
        let shared = with(&|of| of.stations.push("CT1".to_owned()));
        assert_eq!(patients(&list(&[shared])), ["2"]);
        let any = WorklistFilter { modality: None, ..expected() };
        let other = with(&|of| of.modality = "CT".to_owned());
        let found = Worklist::new(vec![other], &any, TODAY, is_id);
        assert_eq!(patients(&found), ["2"]);
    }

    #[test]
    fn entries_stand_in_the_order_of_their_times_and_each_once() {
        let at = |patient: &str, hour: i8| {
            let mut planned = entry(patient, "");
            planned.scheduled.time = Some(jiff::civil::time(hour, 0, 0, 0));
            planned
        };
        let answer = [entry("4", ""), at("3", 11), at("1", 9), at("2", 10), at("1", 9)];
        assert_eq!(patients(&list(&answer)), ["1", "2", "3", "4"]);
    }

    #[test]
    fn by_whom_nobody_can_be_named_is_counted_and_left_out() {
        let no_id = entry("ABC", "A1");
        let no_request = WorklistEntry { request: None, ..entry("2", "A2") };
        let found = list(&[entry("1", "A0"), no_id, no_request]);
        assert_eq!((patients(&found), found.left_out()), (vec!["1"], 2));
        let found = found.with_unreadable(3);
        assert_eq!((patients(&found), found.left_out()), (vec!["1"], 5));
    }

    /// Red while only valid requests had a number.
    #[test]
    fn a_number_whose_request_is_not_valid_is_no_id_of_somebody_else() {
        let no_study = WorklistEntry { request: None, ..entry("2", "9") };
        let found = list(&[entry("1", "A1"), no_study]);
        assert_eq!(found.chosen_by("9", true, TODAY), WorklistChoice::Unclear);
    }

    #[test]
    fn an_id_that_entries_give_to_different_people_names_nobody() {
        let first = entry("1", "A1");
        let (mut issuer, mut name, mut born) =
            (entry("1", "A2"), entry("1", "A2"), entry("1", "A2"));
        issuer.issuer = "OTHER".to_owned();
        name.person.name = "Beispielmann".to_owned();
        born.person.birth_date = Some(date(1950, 1, 1));
        // What one of them does not tell is no difference.
        let found = list(&[first.clone(), issuer.clone()]);
        assert_eq!(patients(&found), ["1", "1"]);
        let first = WorklistEntry {
            issuer: "HOUSE".to_owned(),
            person: ListedPerson { birth_date: Some(date(1960, 1, 1)), ..first.person },
            ..first
        };
        for other in [issuer, name, born] {
            let found = list(&[first.clone(), other, entry("2", "A3")]);
            assert_eq!((patients(&found), found.left_out()), (vec!["2"], 2));
        }
    }

    #[test]
    fn more_entries_than_a_day_has_are_left_out() {
        let answer: Vec<WorklistEntry> =
            (0..ENTRIES_MOST + 7).map(|at| entry(&at.to_string(), "")).collect();
        let found = list(&answer);
        assert_eq!((patients(&found).len(), found.left_out()), (ENTRIES_MOST, 7));
    }

    #[test]
    fn a_code_chooses_by_id_and_by_a_number_that_can_be_no_id() {
        let found = list(&[entry("1", "A1"), entry("2", "A2"), entry("3", "77")]);
        let chosen = |code| found.chosen_by(code, is_id(code), TODAY);
        for (code, id) in [("1", "1"), ("A1", "1"), ("A2", "2")] {
            let WorklistChoice::Patient { id: by, request } = chosen(code) else {
                panic!("{code}")
            };
            assert_eq!((by, request.is_some()), (id, true), "{code}");
        }
        assert_eq!(chosen("9"), WorklistChoice::NotListed);
        // It may be the id of somebody who has come unannounced.
        assert_eq!(chosen("77"), WorklistChoice::Unclear);
    }

    #[test]
    fn a_code_of_two_patients_chooses_neither() {
        let found = list(&[
            entry("1", "A1"),
            entry("2", "A1"),
            entry("3", "1"),
            entry("4", "A4"),
            entry("X", "A4"),
        ]);
        for code in ["A1", "1", "A4"] {
            assert_eq!(
                found.chosen_by(code, is_id(code), TODAY),
                WorklistChoice::Unclear,
                "{code}"
            );
        }
    }

    #[test]
    fn where_several_requests_may_be_meant_the_patient_is_named_without_one() {
        let mut second = entry("1", "A2");
        second.request = ImagingRequest::new("1.2.9", "A2");
        let found = list(&[entry("1", "A1"), second]);
        assert_eq!(
            found.chosen_by("1", true, TODAY),
            WorklistChoice::Patient { id: "1", request: None }
        );
        assert_eq!(found.request_of("1", TODAY), None);
        let request = ImagingRequest::new("1.2.9", "A2");
        let by_number = found.chosen_by("A2", false, TODAY);
        assert_eq!(by_number, WorklistChoice::Patient { id: "1", request: request.as_ref() });
    }

    /// Red while the key held neither: a page that showed the old name chose whom the entry named since.
    #[test]
    fn an_entry_that_names_its_patient_otherwise_than_a_page_showed_is_not_chosen_by_it() {
        let shown = entry("1", "A1").key();
        assert!(list(&[entry("1", "A1")]).entry(&shown, TODAY).is_some());
        let (mut name, mut born) = (entry("1", "A1"), entry("1", "A1"));
        name.person.name = "Beispielmann".to_owned();
        born.person.birth_date = Some(date(1950, 1, 1));
        for corrected in [name, born] {
            assert_eq!(list(&[corrected]).entry(&shown, TODAY), None);
        }
    }

    #[test]
    fn the_next_day_has_nothing_of_it() {
        let found = list(&[entry("1", "A1")]);
        let key = found.entries(TODAY)[0].key();
        assert!(found.entry(&key, TODAY).is_some());
        for day in [date(2026, 11, 29), date(2026, 11, 27)] {
            assert!(found.is_over(day) && found.entries(day).is_empty());
            assert_eq!(found.entry(&key, day), None);
            assert_eq!(found.chosen_by("1", true, day), WorklistChoice::NotListed);
        }
    }

    #[test]
    fn names_and_birth_dates_are_in_no_log() {
        let mut planned = entry("1", "A1");
        planned.person.birth_date = Some(date(1950, 1, 1));
        let logged = format!("{:?}", list(&[planned]));
        assert!(!logged.contains("Testfrau") && !logged.contains("1950"), "{logged}");
    }
}
