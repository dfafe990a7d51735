//! The worklist of a hospital, which changes at any time, whose server is away at any time, and whose numbers may be
//! anybody's ids, or another's numbers; and the people who choose from it, by codes and on a page that may be old.
//!
//! It draws from a chance of its own: what else happens in a sequence does not depend on it.

use gaiter_flow::round::Named;
use gaiter_flow::worklist::{
    AccessionNumbers, FindResponse, Worklist, WorklistChoice, WorklistEntry, WorklistFilter,
};
use gaiter_record::{ImagingRequest, SourceKind};
use jiff::civil::{self, Date};

use super::chance::Chance;
use super::disk::Disk;
use super::laws::Off;
use super::truth::id;

const TODAY: Date = civil::date(2026, 11, 28);

/// So many patients to come may be listed already.
const AHEAD: usize = 3;

/// One in so many times something changes: an entry, whether the server is away, what station or page have.
const CHANGES: usize = 3;

/// The worklist as the server, the station and the page have it.
pub struct DayList {
    chance: Chance,
    off: Off,
    /// A practice that has none.
    is_none: bool,
    /// A hospital whose numbers may be ids: all are.
    has_like_ids: bool,
    is_away: bool,
    server: Vec<WorklistEntry>,
    /// What the server last answered to the station.
    answer: Vec<WorklistEntry>,
    station: Option<Worklist>,
    /// What the station's journal knows of the numbers.
    numbers: AccessionNumbers,
    page: Option<Worklist>,
    requests: usize,
}

impl DayList {
    pub fn new(seed: u64, off: Off) -> DayList {
        let mut chance = Chance(seed.wrapping_mul(0xa076_1d64_78bd_642f));
        chance.below(7);
        // Other laws are looked for without it.
        let is_none = match off {
            Off::Nothing => chance.below(2) == 0,
            of => of != Off::CodesMeanOne,
        };
        let has_like_ids = chance.below(4) == 0;
        DayList {
            chance,
            off,
            is_none,
            has_like_ids,
            is_away: false,
            server: Vec::new(),
            answer: Vec::new(),
            station: None,
            numbers: AccessionNumbers::default(),
            page: None,
            requests: 0,
        }
    }

    /// Time goes on: so many patients have been here, and the station runs or does not.
    pub fn pass(&mut self, patients: usize, runs: bool) {
        if self.is_none {
            return;
        }
        if !runs {
            // It is in memory only.
            self.station = None;
        }
        if self.chance.below(CHANGES) == 0 {
            self.changes(patients);
        }
        if runs && !self.is_away && self.chance.below(CHANGES) == 0 {
            self.answer.clone_from(&self.server);
            self.numbers = self.numbers.seen_with(&self.server, is_id);
            self.station = Some(Worklist::new(self.server.clone(), &ours(), TODAY, is_id));
        }
        // A page is a little older than what the station has, or much.
        if self.chance.below(CHANGES) == 0 {
            self.page.clone_from(&self.station);
        }
    }

    /// An entry appears, disappears or changes; or the server goes or comes back.
    fn changes(&mut self, patients: usize) {
        let count = self.server.len();
        match self.chance.below(8) {
            0 => self.is_away = !self.is_away,
            1 if count > 0 => drop(self.server.swap_remove(self.chance.below(count))),
            2 if count > 0 => {
                let place = self.chance.below(count);
                self.server[place].person.name = format!("Testfrau {place}");
            }
            3 if count > 0 => {
                let (place, patient) = (self.chance.below(count), 1 + self.chance.below(AHEAD));
                self.server[place].issuer = format!("HOUSE {patient}");
            }
            _ => {
                let entry = self.entry(patients);
                self.server.push(entry);
            }
        }
    }

    /// An entry for some patient. Its number may be somebody's id, or the number of another entry.
    fn entry(&mut self, patients: usize) -> WorklistEntry {
        let (most, has_like_ids) = (patients + AHEAD, self.has_like_ids);
        let chance = &mut self.chance;
        let (patient, other) = (1 + chance.below(most), 1 + chance.below(most));
        let number = match chance.below(4) {
            _ if has_like_ids => id(other),
            0 => format!("A{other}"),
            _ => format!("A{patient}"),
        };
        let is_ours = chance.below(8) > 0;
        let has_study = chance.below(8) > 0;
        self.requests += 1;
        let study = format!("1.2.{}.{}", id(patient), self.requests);
        WorklistEntry::from(FindResponse {
            patient_id: &id(patient),
            study_instance_uid: if has_study { &study } else { "" },
            accession_number: &number,
            scheduled_station_ae_title: if is_ours { "LEGSCAN" } else { "CT1" },
            start_date: "20261128",
            ..FindResponse::default()
        })
    }

    /// Whom a code names that a patient shows to the reader: the card with the id, or the paper of a request. None if
    /// it names nobody.
    pub fn read(&mut self, patient: usize) -> Option<Named> {
        let own = id(patient);
        let theirs = self.server.iter().filter(|entry| entry.patient == own);
        let numbers = theirs.filter_map(WorklistEntry::accession_number);
        let papers: Vec<String> =
            numbers.filter(|number| self.may_show(&own, number)).map(str::to_owned).collect();
        let is_paper = self.chance.below(2) == 0;
        let code = match self.chance.pick(&papers) {
            Some(number) if is_paper => number.clone(),
            _ => own,
        };
        self.named_by(&code)
    }

    /// Whether a patient shows a paper with this number: where it is somebody else's number, too, only while the
    /// station knows that it is this patient's. Nothing else tells one from the other.
    fn may_show(&self, patient: &str, number: &str) -> bool {
        let (false, Some(list)) = (is_id(number), &self.station) else { return true };
        let is_own = |entry: &WorklistEntry| {
            entry.patient == patient && entry.accession_number() == Some(number)
        };
        let is_known_as_theirs =
            self.answer.iter().any(|entry| is_own(entry) && ours().has(entry, TODAY));
        let chosen = self.numbers.chosen_by(number, false, Some(list), TODAY);
        is_known_as_theirs || chosen == WorklistChoice::NotListed
    }

    /// As `Booth::identified` of the station.
    fn named_by(&self, code: &str) -> Option<Named> {
        let by = SourceKind::Reader;
        let as_id = is_id(code).then(|| Named::new(code, by));
        if self.is_none {
            return as_id;
        }
        let list = self.station.as_ref();
        if self.off == Off::CodesMeanOne {
            let mut entries = list.iter().flat_map(|list| list.entries(TODAY));
            let found = entries.find(|entry| entry.accession_number() == Some(code));
            return found.map(|entry| chosen(entry, by)).or(as_id);
        }
        match self.numbers.chosen_by(code, is_id(code), list, TODAY) {
            WorklistChoice::Patient { id, request } => {
                Some(Named { request: request.cloned(), ..Named::new(id, by) })
            }
            WorklistChoice::NotListed => as_id,
            WorklistChoice::Unclear => None,
        }
    }

    /// Whom the operator names: by a tap on an entry of the patient, as the page has it, or by typing the id, also where
    /// the station refuses the tap because it has that entry no more.
    pub fn tapped_or_typed(&mut self, patient: usize) -> Named {
        let (own, by) = (id(patient), SourceKind::Operator);
        let page = self.page.iter().flat_map(|list| list.entries(TODAY));
        let keys: Vec<String> =
            page.filter(|entry| entry.patient == own).map(WorklistEntry::key).collect();
        let key = self.chance.pick(&keys);
        let list = self.station.as_ref();
        let tapped = list.zip(key).and_then(|(list, key)| list.entry(key, TODAY));
        match tapped {
            Some(entry) => Named { is_chosen: true, ..chosen(entry, by) },
            None => {
                let request = list.and_then(|list| list.request_of(&own, TODAY)).cloned();
                Named { request, ..Named::new(own, by) }
            }
        }
    }
}

/// What is chosen with an entry.
fn chosen(entry: &WorklistEntry, by: SourceKind) -> Named {
    Named { request: entry.request.clone(), ..Named::new(entry.patient.clone(), by) }
}

/// The entries of this booth.
fn ours() -> WorklistFilter {
    WorklistFilter { station: "LEGSCAN".to_owned(), modality: None }
}

fn is_id(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// A request that came to a scan of somebody else: a study names its patient.
pub fn wrong_request(disk: &Disk) -> Option<String> {
    let is_of = |request: &ImagingRequest, patient: &str| {
        request.study_instance_uid.starts_with(&format!("1.2.{patient}."))
    };
    disk.scans().find_map(|(_, row)| {
        row.deliveries.keys().flatten().find_map(|patient| {
            let request = row.judged.request_of(patient)?;
            (!is_of(request, patient)).then(|| format!("{patient} has the request {request:?}"))
        })
    })
}
