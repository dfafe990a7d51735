//! The differences between an earlier and a later record of a scan.

use serde::Serialize;
use serde_json::{Map, Value};

use super::Record;
use super::rounding::mm;
use super::schema::{FindingNote, LegFigures};

/// The differences between two records of the same scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Changes {
    /// How far the records agree.
    pub sameness: Sameness,
    /// Levels in both records, in the order of legs and names.
    pub levels: Vec<LevelChange>,
    /// Levels that are only in the later record.
    pub came: Vec<LegLevel>,
    /// Levels that are only in the earlier record.
    pub went: Vec<LegLevel>,
    /// Findings that are only in the later record.
    pub new_findings: Vec<FindingNote>,
    /// Findings that are only in the earlier record.
    pub gone_findings: Vec<FindingNote>,
}

/// How far two records of a scan agree. Who made them, when and how does not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sameness {
    /// In everything.
    Same,
    /// In everything the earlier record holds. The later one also holds keys of a newer gaiter.
    Gained,
    /// Some figure or finding differs.
    Differs,
}

/// A level of a leg.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct LegLevel {
    /// `left` or `right`.
    pub leg: String,
    /// The level's name.
    pub level: String,
}

/// A level that is in both records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelChange {
    /// The level.
    #[serde(flatten)]
    pub place: LegLevel,
    /// Tape girth, mm.
    pub girth_mm: Change,
    /// Height above the floor, mm.
    pub height_mm: Change,
}

/// A figure that is in both records.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Change {
    /// In the earlier record.
    pub old: f64,
    /// In the later record.
    pub new: f64,
}

impl Change {
    /// The increase, negative if the figure shrank.
    pub fn by(self) -> f64 {
        mm(self.new - self.old)
    }
}

/// Keys of a record that describe how it was made and not what the scan shows.
const NOT_OF_THE_SCAN: [&str; 6] =
    ["schema", "revision", "station", "patient", "acquired", "made_by"];

/// Objects whose keys come from the scan, so that an added key is a change of the result.
const FOUND: [&str; 2] = ["landmarks", "estimates"];

/// Texts that a later gaiter may word otherwise, and the key of the same statement as data.
const WORDS: [(&str, &str); 2] = [("message", "says"), ("by", "rule")];

/// Compares two records of a scan. `old_json` is the earlier one as written, which shows the keys that
/// an older gaiter did not know.
pub fn changes(old: &Record, old_json: &Value, new: &Record) -> Result<Changes, serde_json::Error> {
    let (mut earlier, mut later) = (old_json.clone(), serde_json::to_value(new)?);
    for record in [&mut earlier, &mut later] {
        let object = record.as_object_mut().into_iter();
        object.for_each(|object| object.retain(|key, _| !NOT_OF_THE_SCAN.contains(&key.as_str())));
    }
    let places = |record: &Record| record.legs.iter().flat_map(places).collect::<Vec<_>>();
    let (was, is) = (places(old), places(new));
    let only = |of: &[LegLevel], other: &[LegLevel]| {
        of.iter().filter(|place| !other.contains(place)).cloned().collect()
    };
    let new_notes = |of: &Record, other: &Record| {
        let known = |note: &&FindingNote| !other.findings.iter().any(|other| note.is_like(other));
        of.findings.iter().filter(known).cloned().collect()
    };
    Ok(Changes {
        sameness: sameness(&earlier, &later, false),
        levels: was.iter().filter_map(|place| level(place, old, new)).collect(),
        came: only(&is, &was),
        went: only(&was, &is),
        new_findings: new_notes(new, old),
        gone_findings: new_notes(old, new),
    })
}

fn places(leg: &LegFigures) -> impl Iterator<Item = LegLevel> + '_ {
    leg.landmarks.keys().map(|level| LegLevel { leg: leg.side.clone(), level: level.clone() })
}

fn level(place: &LegLevel, old: &Record, new: &Record) -> Option<LevelChange> {
    let [old, new] = [old, new].map(|record| {
        let leg = record.legs.iter().find(|leg| leg.side == place.leg);
        leg.and_then(|leg| leg.landmarks.get(&place.level))
    });
    let (old, new) = (old?, new?);
    Some(LevelChange {
        place: place.clone(),
        girth_mm: Change { old: old.girth_tape_mm, new: new.girth_tape_mm },
        height_mm: Change { old: old.height_mm, new: new.height_mm },
    })
}

/// `found` means that the keys of these objects come from the scan.
fn sameness(old: &Value, new: &Value, found: bool) -> Sameness {
    match (old, new) {
        (Value::Object(old), Value::Object(new)) => {
            let gone = old.iter().any(|(key, value)| !value.is_null() && !new.contains_key(key));
            let of_key = |(key, value): (&String, &Value)| match old.get(key) {
                Some(_) if are_words(key, old, new) => Sameness::Same,
                Some(old) => sameness(old, value, FOUND.contains(&key.as_str())),
                None if found => Sameness::Differs,
                None if is_empty(value) => Sameness::Same,
                None => Sameness::Gained,
            };
            let worst = new.iter().map(of_key).max().unwrap_or(Sameness::Same);
            if gone { Sameness::Differs } else { worst }
        }
        (Value::Array(old), Value::Array(new)) if old.len() == new.len() => {
            let pairs = old.iter().zip(new);
            pairs.map(|(old, new)| sameness(old, new, false)).max().unwrap_or(Sameness::Same)
        }
        (old, new) if old == new => Sameness::Same,
        _ => Sameness::Differs,
    }
}

/// Whether a key holds the words of a statement that both records also hold as data.
fn are_words(key: &str, old: &Map<String, Value>, new: &Map<String, Value>) -> bool {
    let stated =
        |data: &str| [old, new].iter().all(|all| all.get(data).is_some_and(Value::is_object));
    WORDS.iter().any(|(words, data)| *words == key && stated(data))
}

/// Whether a value is empty, so that a key of a newer gaiter adds nothing with it.
fn is_empty(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(values) => values.is_empty(),
        Value::Object(values) => values.is_empty(),
        Value::Bool(_) | Value::Number(_) | Value::String(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn same(old: &Value, new: &Value) -> Sameness {
        sameness(old, new, false)
    }

    #[test]
    fn a_key_that_an_older_gaiter_did_not_write_is_gained_and_an_empty_one_is_nothing() {
        let old = json!({"legs": [{"side": "left", "landmarks": {"B": {"height_mm": 118.0}}}]});
        let mut new = old.clone();
        assert_eq!(same(&old, &new), Sameness::Same);
        new["legs"][0]["at"] = json!([]);
        new["legs"][0]["foot"] = Value::Null;
        assert_eq!(same(&old, &new), Sameness::Same);
        new["legs"][0]["shape"] = json!({"rows": 3});
        assert_eq!(same(&old, &new), Sameness::Gained);
        assert_eq!(same(&new, &old), Sameness::Differs, "what is lost was a figure");
    }

    #[test]
    fn a_level_more_or_less_a_finding_or_a_digit_is_another_result() {
        let old = json!({"legs": [{"landmarks": {"B": {"height_mm": 118.0}}, "foot": null}],
                         "findings": [{"code": "x"}]});
        let differs = |change: &dyn Fn(&mut Value)| {
            let mut new = old.clone();
            change(&mut new);
            assert_eq!(same(&old, &new), Sameness::Differs, "{new}");
            assert_eq!(same(&new, &old), Sameness::Differs, "{new}");
        };
        differs(&|new| new["legs"][0]["landmarks"]["C"] = json!({"height_mm": 300.0}));
        differs(&|new| new["legs"][0]["landmarks"]["B"]["height_mm"] = json!(118.001));
        differs(&|new| new["legs"][0]["foot"] = json!({"length_mm": 250.0}));
        differs(&|new| new["findings"] = json!([]));
    }

    #[test]
    fn other_words_for_the_same_statement_are_the_same_result() {
        let finding = |message: &str, points: u32| {
            json!({"findings": [{"code": "gap", "message": message,
                                 "says": {"is": "foot-not-seen", "points": points}}]})
        };
        let (old, new) = (finding("a foot of 3 points", 3), finding("a foot has only 3 points", 3));
        assert_eq!(same(&old, &new), Sameness::Same);
        assert_eq!(same(&old, &finding("a foot of 3 points", 4)), Sameness::Differs);
        let level = |by: &str| json!({"by": by, "rule": {"is": "turning-point"}});
        assert_eq!(same(&level("turn of the girth"), &level("turning point")), Sameness::Same);
        // Without the data, the words are all there is.
        let untold = |message: &str| json!({"code": "gap", "message": message});
        assert_eq!(same(&untold("3 points"), &untold("4 points")), Sameness::Differs);
    }

    /// A record without legs, with a finding about C on each of these legs.
    fn record(doubts: &[&str]) -> Record {
        let note = |leg: &&str| json!({"code": "gap", "severity": "warning", "leg": leg, "level": "C", "message": ""});
        let findings: Vec<Value> = doubts.iter().map(note).collect();
        let record = json!({
            "schema": "gaiter.leg-record/1", "revision": 1, "station": null, "patient": null,
            "acquired": null, "made_by": {"gaiter": "0.1.0", "method": {}},
            "scan": {"sha256": "0", "format": "obj", "unit": "mm", "unit_inferred": false,
                     "points": 0, "triangles": 0},
            "body": {"stature_mm": null, "crotch_height_mm": null, "crotch_from": "saddle",
                     "facing_deg": 0.0,
                     "facing_from": "feet", "from_export": vec![0.0; 16]},
            "legs": [], "differences": null, "findings": findings,
        });
        serde_json::from_value(record).unwrap()
    }

    fn between(old: &Record, new: &Record) -> Changes {
        changes(old, &serde_json::to_value(old).unwrap(), new).unwrap()
    }

    #[test]
    fn a_finding_that_came_and_one_that_went_are_told_each_at_its_place() {
        let found = between(&record(&["left"]), &record(&["right"]));
        assert_eq!(found.sameness, Sameness::Differs);
        assert_eq!(found.new_findings, record(&["right"]).findings);
        assert_eq!(found.gone_findings, record(&["left"]).findings);
        let found = between(&record(&["left"]), &record(&["left", "right"]));
        assert_eq!((found.new_findings.len(), found.gone_findings.len()), (1, 0));
    }

    #[test]
    fn whatever_the_scan_shows_otherwise_is_another_result_and_who_says_so_is_none() {
        let old = record(&[]);
        let differs = |change: fn(&mut Record)| {
            let mut new = old.clone();
            change(&mut new);
            between(&old, &new).sameness
        };
        assert_eq!(differs(|new| new.body.facing_deg = 90.0), Sameness::Differs);
        assert_eq!(differs(|new| new.findings = record(&["left"]).findings), Sameness::Differs);
        assert_eq!(differs(|new| new.scan.unit = "cm".to_owned()), Sameness::Differs);
        assert_eq!(differs(|new| new.revision = 2), Sameness::Same);
        assert_eq!(differs(|new| new.made_by.gaiter = "9".to_owned()), Sameness::Same);
    }

    #[test]
    fn what_is_said_of_the_legs_is_compared() {
        let record = record(&[]);
        let mut written = serde_json::to_value(&record).unwrap();
        assert_eq!(changes(&record, &written, &record).unwrap().sameness, Sameness::Same);
        // As written, the record had a leg, which the later one has lost.
        written["legs"] = json!([{"side": "left", "tilt_deg": 3.1}]);
        assert_eq!(changes(&record, &written, &record).unwrap().sameness, Sameness::Differs);
    }

    #[test]
    fn a_change_is_what_the_later_figure_has_more() {
        assert_eq!(Change { old: 178.3, new: 178.1 }.by(), -0.2);
        assert_eq!(Change { old: 0.1, new: 0.3 }.by(), 0.2);
    }
}
