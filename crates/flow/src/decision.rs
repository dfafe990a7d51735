//! What the operator has decided about a scan, and to whom it belongs as a result.

use std::collections::BTreeSet;

use gaiter_record::ImagingRequest;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

/// One decision of the operator about a scan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Decision {
    pub at: Timestamp,
    pub what: Decided,
    /// The patient to whom the scan belongs as a result; for a scan that was taken back, the previous
    /// patient. `None` if the decision concerns no patient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patient: Option<String>,
    /// The request that the scan answers for this patient; `None` if it answers none. What was sent into its study is
    /// taken back there although the journal, and the patient's record, are lost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub request: Option<ImagingRequest>,
}

/// The possible decisions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decided {
    /// The scan belongs to this patient and to nobody else.
    Assigned,
    /// It was taken back from its patient: it is unassigned.
    Unassigned,
    /// A held scan belongs to this patient, too.
    Released,
    /// It no longer needs a decision.
    GivenUp,
    /// What was given up is tried again.
    Retried,
}

/// To whom a scan belongs after all decisions about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ruling {
    /// Whether only [`Ruling::patients`] may have it; if there are none, it is unassigned.
    pub is_exclusive: bool,
    /// The ids of the patients to whom the decisions give the scan.
    pub patients: BTreeSet<String>,
    /// Whether it no longer needs a decision.
    pub is_given_up: bool,
}

impl Ruling {
    /// Nothing was decided: every patient may have the scan.
    pub const OPEN: Ruling =
        Ruling { is_exclusive: false, patients: BTreeSet::new(), is_given_up: false };

    /// The ruling of decisions in their order; without any, every patient may have the scan.
    pub fn from_decisions(decisions: &[Decision]) -> Ruling {
        let mut ruling = Ruling::OPEN;
        for Decision { what, patient, .. } in decisions {
            ruling.is_given_up = *what == Decided::GivenUp;
            match what {
                Decided::Assigned | Decided::Unassigned => {
                    ruling.is_exclusive = true;
                    ruling.patients.clear();
                    let theirs = patient.iter().filter(|_| *what == Decided::Assigned);
                    ruling.patients.extend(theirs.cloned());
                }
                Decided::Released => ruling.patients.extend(patient.clone()),
                Decided::GivenUp | Decided::Retried => {}
            }
        }
        ruling
    }

    /// How often decisions gave a scan to this patient after they had taken it away.
    pub fn turn(decisions: &[Decision], patient: &str) -> u32 {
        let allows =
            |number: usize| Ruling::from_decisions(&decisions[..number]).allows(Some(patient));
        let again = (1..=decisions.len()).filter(|&number| allows(number) && !allows(number - 1));
        u32::try_from(again.count()).unwrap_or(u32::MAX)
    }

    /// Whether a record of the scan for this patient, or unassigned, may stay where it is.
    pub fn allows(&self, patient: Option<&str>) -> bool {
        match patient {
            _ if !self.is_exclusive => true,
            Some(id) => self.patients.contains(id),
            None => self.patients.is_empty(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decisions(decided: &[(Decided, Option<&str>)]) -> Vec<Decision> {
        let decision = |(what, patient): &(Decided, Option<&str>)| Decision {
            at: Timestamp::UNIX_EPOCH,
            what: *what,
            patient: patient.map(str::to_owned),
            request: None,
        };
        decided.iter().map(decision).collect()
    }

    fn ruling(decided: &[(Decided, Option<&str>)]) -> Ruling {
        Ruling::from_decisions(&decisions(decided))
    }

    #[test]
    fn without_a_decision_everybody_may_have_a_scan() {
        let open = ruling(&[]);
        assert!(open.allows(None) && open.allows(Some("1")) && !open.is_exclusive);
    }

    #[test]
    fn the_last_word_says_whose_a_scan_is() {
        use Decided::{Assigned, Unassigned};
        let theirs = ruling(&[(Unassigned, Some("1")), (Assigned, Some("2"))]);
        assert!(theirs.allows(Some("2")) && !theirs.allows(Some("1")) && !theirs.allows(None));
        let unassigned = ruling(&[(Assigned, Some("2")), (Unassigned, Some("2"))]);
        assert!(
            unassigned.allows(None)
                && !unassigned.allows(Some("1"))
                && !unassigned.allows(Some("2"))
        );
    }

    #[test]
    fn a_turn_begins_when_a_scan_is_given_back_and_stays_when_it_is_taken_away() {
        use Decided::{Assigned, GivenUp, Released, Unassigned};
        let decided = decisions(&[
            (Released, Some("1")),
            (Unassigned, Some("1")),
            (GivenUp, None),
            (Assigned, Some("2")),
            (Released, Some("1")),
            (Assigned, Some("1")),
            (Assigned, Some("2")),
            (Assigned, Some("1")),
        ]);
        let turns = |id: &str| -> Vec<u32> {
            (0..=decided.len()).map(|number| Ruling::turn(&decided[..number], id)).collect()
        };
        assert_eq!(turns("1"), [0, 0, 0, 0, 0, 1, 1, 1, 2]);
        assert_eq!(turns("2"), [0, 0, 0, 0, 1, 1, 1, 2, 2]);
    }

    #[test]
    fn a_release_adds_a_patient_and_takes_the_scan_from_nobody() {
        use Decided::{Assigned, Released};
        let open = ruling(&[(Released, Some("2"))]);
        assert!(open.allows(Some("1")) && open.allows(Some("2")));
        let both = ruling(&[(Assigned, Some("1")), (Released, Some("2"))]);
        assert!(both.allows(Some("1")) && both.allows(Some("2")) && !both.allows(Some("3")));
    }

    #[test]
    fn what_was_given_up_is_until_it_is_decided_upon_again() {
        use Decided::{Assigned, GivenUp, Released, Retried};
        assert!(ruling(&[(Assigned, Some("1")), (GivenUp, None)]).is_given_up);
        for again in [Retried, Released, Assigned] {
            assert!(!ruling(&[(GivenUp, None), (again, Some("1"))]).is_given_up);
        }
        assert!(!ruling(&[(Assigned, Some("1")), (GivenUp, None)]).allows(Some("2")));
    }
}
