//! Which scans are visits, and what comparisons need of a record.

use std::collections::BTreeMap;

use gaiter_leg::comparison::tape_volume::VolumeBy;
use gaiter_leg::side::Sides;
use gaiter_leg::{Level, Side};
use gaiter_record::measure::Measure;
use gaiter_record::report::Reliability;
use gaiter_record::sizing::SCANNER_GIRTH_MM;
use gaiter_record::{Acquired, Record};
use jiff::Timestamp;
use jiff::civil::Date;

use super::leg::{Common, LegAtVisit};

/// Standard error of all girths of a scan in common, mm, where nothing better is known.
pub const GIRTH_COMMON_MM: f64 = SCANNER_GIRTH_MM;

/// The part of the floor's standard error that is not the same at every visit. The rest is of the person and
/// of the scanner: soles that it never sees, heels that sink in alike. Measured with bodies in other stances
/// and noise; see docs/visits.md.
const FLOOR_CHANGES_SHARE: f64 = 0.3;

/// Standard error of the floor where a record does not state it, mm.
const FLOOR_UNKNOWN_MM: f64 = 1.1;

/// One visit.
#[derive(Debug, Clone, PartialEq)]
pub struct Visit {
    /// The place of its record among those that were given, counted from 0.
    pub record: usize,
    /// The patient's id; `None` if the record names none.
    pub patient: Option<String>,
    /// When the scan was taken; `None` if unknown.
    pub acquired: Option<Acquired>,
    /// SHA-256 of the scan, lower-case hexadecimal.
    pub sha256: String,
    /// The record's revision.
    pub revision: u32,
    /// The station that made it; `None` for a bare `extract`.
    pub station: Option<String>,
    /// What its figures mean.
    pub definition: Definition,
    /// How the patient held the legs; `None` if the record does not state it.
    pub posture: Option<String>,
    /// The phantom's mean error at the last check before, mm; `None` if there was none.
    pub phantom_mm: Option<f64>,
    /// The errors that its figures have in common.
    pub common: Common,
    /// The legs; `None` for one that was not measured.
    pub legs: Sides<Option<LegAtVisit>>,
    /// Levels with their measures, of each leg, highest first.
    pub levels: Sides<Vec<LevelAtVisit>>,
}

/// What the figures of a record mean. Only figures of the same definition are compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Definition {
    /// How the tape lies around the leg, from which axis, and how sections are fitted.
    pub girths: String,
    /// How a volume is made of girths; `None` if the record does not state it, or nothing was chosen.
    pub volume: Option<VolumeBy>,
}

/// A level at one visit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelAtVisit {
    /// Which level.
    pub level: Level,
    /// Its girth, mm.
    pub girth_mm: f64,
    /// Its height above the floor, mm; `None` on the foot.
    pub height_mm: Option<f64>,
    /// How to read the girth; a value by hand counts and is marked.
    pub mark: Reliability,
}

impl Visit {
    /// The visit of a record at this place among those that were given. `girth_common_mm` is the standard error that all girths of a scan have in
    /// common; a phantom that was off by more counts instead.
    pub fn new(at: usize, record: &Record, girth_common_mm: f64) -> Visit {
        let leg = |side: Side| record.leg(side).map(|leg| LegAtVisit::new(&record.body, leg));
        let check = record.phantom_check.as_ref();
        let phantom_mm = check.and_then(|check| check.bias_mm);
        let floor_mm = record.body.floor_sd_mm.unwrap_or(FLOOR_UNKNOWN_MM);
        Visit {
            record: at,
            patient: record.patient.as_ref().map(|patient| patient.id.clone()),
            acquired: record.acquired.clone(),
            sha256: record.scan.sha256.clone(),
            revision: record.revision,
            station: record.station.clone(),
            definition: Definition::from_record(record),
            posture: record.made_by.method.get("posture").cloned(),
            phantom_mm,
            common: Common {
                girth_mm: phantom_mm.map_or(girth_common_mm, |mm| mm.abs().max(girth_common_mm)),
                floor_mm: FLOOR_CHANGES_SHARE * floor_mm,
            },
            legs: Sides::of_each(leg),
            levels: Sides::of_each(|side| levels(record, side)),
        }
    }

    /// Whether another posture was declared than at another visit; not if one of the records does not state
    /// it.
    pub(crate) fn is_of_other_posture(&self, other: &Visit) -> bool {
        self.posture.as_ref().zip(other.posture.as_ref()).is_some_and(|(one, other)| one != other)
    }

    /// Whether a person set a measure of a leg.
    pub fn has_by_hand(&self, side: Side) -> bool {
        self.levels.get(side).iter().any(|level| level.mark == Reliability::ByHand)
    }
}

impl Definition {
    fn from_record(record: &Record) -> Definition {
        let setting = |key: &str| record.made_by.method.get(key).map_or("", String::as_str);
        let words = ["scope", "tape", "axis", "fit"].map(setting);
        let words = words.into_iter().filter(|word| !word.is_empty());
        let words: Vec<&str> = std::iter::once(record.schema.as_str()).chain(words).collect();
        Definition { girths: words.join(", "), volume: VolumeBy::of_word(setting("volume")) }
    }
}

/// The last scan of each day on the calendar of its scanner, oldest first: a scan that was repeated on the same
/// day is no visit of its own. Scans of unknown time all stay, before the others.
pub fn last_of_days<T>(scans: Vec<T>, record: impl Fn(&T) -> &Record) -> Vec<T> {
    let mut kept = Vec::new();
    let mut days = BTreeMap::<Date, (Timestamp, T)>::new();
    for of in scans {
        match record(&of).acquired.as_ref().map(|own| (own.local().date(), own.at)) {
            None => kept.push(of),
            Some((day, at)) if days.get(&day).is_none_or(|(known, _)| *known < at) => {
                days.insert(day, (at, of));
            }
            Some(_) => {}
        }
    }
    kept.extend(days.into_values().map(|(_, of)| of));
    kept
}

fn levels(record: &Record, side: Side) -> Vec<LevelAtVisit> {
    let level = |level: Level| {
        let of = Measure::find(record, side, level).ok()?;
        Some(LevelAtVisit {
            level,
            girth_mm: of.girth.mm,
            height_mm: of.height.map(|height| height.mm),
            mark: of.mark(),
        })
    };
    Level::ALL.into_iter().rev().filter_map(level).collect()
}
