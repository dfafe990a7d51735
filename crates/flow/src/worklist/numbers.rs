//! Whether a hospital's accession numbers can be told from the ids of its patients.
//!
//! A list has some of the numbers only: the paper in a patient's hand may be of a request that the station does not
//! know yet, or of another department. So it counts what kind of numbers they are, and that is remembered beyond the
//! list.

use jiff::civil::Date;
use serde::{Deserialize, Serialize};

use super::{Worklist, WorklistChoice, WorklistEntry};

/// What the answers of a server have shown of its accession numbers, under the present rules for ids.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AccessionNumbers {
    /// No answer had an entry.
    #[default]
    Unseen,
    /// None was allowed as a patient's id: what is allowed as one is one.
    Apart,
    /// Some are: what is allowed as an id may be another patient's accession number.
    LikeIds,
}

impl AccessionNumbers {
    /// What is known after another answer. One number that is allowed as an id tells for good that there are such.
    #[must_use]
    pub fn seen_with(
        self,
        answer: &[WorklistEntry],
        is_id: impl Fn(&str) -> bool,
    ) -> AccessionNumbers {
        let has_like_ids = answer.iter().filter_map(WorklistEntry::accession_number).any(is_id);
        match self {
            AccessionNumbers::LikeIds => self,
            _ if has_like_ids => AccessionNumbers::LikeIds,
            _ if answer.is_empty() => self,
            _ => AccessionNumbers::Apart,
        }
    }

    /// Whom a scanned code chooses: a patient's id or an accession number. `may_be_id` is whether it is allowed as a
    /// patient's id, `list` the last answer, if one is known.
    ///
    /// Where a number may be like an id, nothing tells whether a code is one or the other, whatever the list has: its
    /// patient may have come with the number of a request that the list does not have.
    pub fn chosen_by<'a>(
        self,
        code: &str,
        may_be_id: bool,
        list: Option<&'a Worklist>,
        today: Date,
    ) -> WorklistChoice<'a> {
        if may_be_id && self != AccessionNumbers::Apart {
            return WorklistChoice::Unclear;
        }
        list.map_or(WorklistChoice::NotListed, |list| list.chosen_by(code, may_be_id, today))
    }
}

#[cfg(test)]
mod tests {
    use jiff::civil::date;

    use super::*;
    use crate::worklist::{FindResponse, WorklistFilter};

    const TODAY: Date = date(2026, 11, 28);

    fn entry(patient: &str, number: &str) -> WorklistEntry {
        WorklistEntry::from(FindResponse {
            patient_id: patient,
            study_instance_uid: "1.2.276.4242",
            accession_number: number,
            scheduled_station_ae_title: "LEGSCAN",
            start_date: "20261128",
            ..FindResponse::default()
        })
    }

    fn is_id(text: &str) -> bool {
        !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
    }

    fn seen(answers: &[&[WorklistEntry]]) -> AccessionNumbers {
        let begin = AccessionNumbers::default();
        answers.iter().fold(begin, |known, answer| known.seen_with(answer, is_id))
    }

    #[test]
    fn one_number_that_is_allowed_as_an_id_tells_for_good_that_there_are_such() {
        let (apart, alike) = ([entry("1", "A1")], [entry("2", "77")]);
        let without = [entry("3", "")];
        assert_eq!(seen(&[&[]]), AccessionNumbers::Unseen);
        assert_eq!(seen(&[&apart, &[]]), AccessionNumbers::Apart);
        assert_eq!(seen(&[&without]), AccessionNumbers::Apart, "its requests have no numbers");
        assert_eq!(seen(&[&apart, &alike, &apart, &[]]), AccessionNumbers::LikeIds);
        // Also one of another station, or of a request that is not valid: its paper is shown like any.
        let mut others = entry("2", "77");
        (others.scheduled.stations, others.request) = (vec!["CT1".to_owned()], None);
        assert_eq!(seen(&[&apart, &[others]]), AccessionNumbers::LikeIds);
    }

    /// Red while only the present list counted: 77 named patient 77 once the list had it no more.
    #[test]
    fn where_numbers_may_be_ids_no_code_that_may_be_one_names_anybody() {
        let filter = WorklistFilter { station: "LEGSCAN".to_owned(), modality: None };
        let list = Worklist::new(vec![entry("1", "A1")], &filter, TODAY, is_id);
        for numbers in [AccessionNumbers::Unseen, AccessionNumbers::LikeIds] {
            for code in ["1", "77"] {
                for list in [None, Some(&list)] {
                    let chosen = numbers.chosen_by(code, true, list, TODAY);
                    assert_eq!(chosen, WorklistChoice::Unclear, "{code} where {numbers:?}");
                }
            }
            let chosen = numbers.chosen_by("A1", false, Some(&list), TODAY);
            assert!(matches!(chosen, WorklistChoice::Patient { id: "1", .. }), "{chosen:?}");
        }
    }

    #[test]
    fn where_none_can_be_an_id_whoever_is_not_listed_is_named_by_the_card() {
        let filter = WorklistFilter { station: "LEGSCAN".to_owned(), modality: None };
        let list = Worklist::new(vec![entry("1", "A1")], &filter, TODAY, is_id);
        let chosen = |code, list| AccessionNumbers::Apart.chosen_by(code, true, list, TODAY);
        assert_eq!(chosen("2", Some(&list)), WorklistChoice::NotListed);
        assert_eq!(chosen("1", None), WorklistChoice::NotListed);
        assert!(matches!(chosen("1", Some(&list)), WorklistChoice::Patient { id: "1", .. }));
    }
}
