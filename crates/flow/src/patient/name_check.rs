//! Parts of file names that are mistaken for patients' ids: a date, a counter, a word that most names
//! share.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use jiff::civil::{Date, Time};

/// The years in which an export can have been made.
const YEARS: std::ops::RangeInclusive<i16> = 1990..=2099;

/// One in 1 200 numbers of eight digits reads as a date by chance. If one in fifty of the ids of that
/// length does, it is not by chance.
const DATES_PER: usize = 50;

/// One in 27 numbers of six digits reads as a date by chance. They are taken for dates if nine in ten
/// do, and at least two.
const SHORT_DATES_LEAST: usize = 2;

/// Two consecutive patients may have consecutive numbers; three seldom do.
const COUNTED_LEAST: usize = 3;

/// A patient seldom has more than five exports from one visit.
const MANY_NAMES: usize = 6;

/// A file name and the id that is taken from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Taken<'a> {
    /// The file's name.
    pub name: &'a str,
    pub patient: &'a str,
}

/// What an id seems to be if it is not a patient's, and what that would mean, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NameFinding {
    /// Ids read as dates.
    Date(String),
    /// The ids count the exports.
    Counter(String),
    /// Most names have the same id.
    OneForMany(String),
}

/// What an id reads as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reading {
    /// A day, with four digits for the year.
    Day(Date),
    /// A day and a time of day.
    Moment(Date),
    /// A day, with two digits for the year.
    ShortDay,
}

impl NameFinding {
    /// Its stable code.
    pub fn code(&self) -> &'static str {
        match self {
            NameFinding::Date(_) => "looks-like-a-date",
            NameFinding::Counter(_) => "looks-like-a-counter",
            NameFinding::OneForMany(_) => "one-id-for-many",
        }
    }
}

impl fmt::Display for NameFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (NameFinding::Date(words)
        | NameFinding::Counter(words)
        | NameFinding::OneForMany(words)) = self;
        f.write_str(words)
    }
}

/// What is wrong with the ids that are taken from the names of files; the oldest file comes first.
pub fn findings(taken: &[Taken<'_>]) -> Vec<NameFinding> {
    let date = dates(taken);
    // Dates of consecutive days count up, too.
    let counter = if date.is_none() { counter(taken) } else { None };
    let is_date = |patient: &str| date.is_some() && reading(patient).is_some();
    let one = one_for_many(taken, is_date);
    date.into_iter().chain(counter).chain(one).collect()
}

/// Ids that read as dates, if that is not by chance; named is the latest of them.
fn dates(taken: &[Taken<'_>]) -> Option<NameFinding> {
    let read = taken.iter().filter_map(|taken| Some((taken.patient, reading(taken.patient)?)));
    let (short, full): (Vec<_>, Vec<_>) =
        read.partition(|(_, reading)| *reading == Reading::ShortDay);
    let of = taken.len();
    let is_chance = |(patient, _): &&(&str, Reading)| {
        let as_long = taken.iter().filter(|taken| taken.patient.len() == patient.len()).count();
        full.len() * DATES_PER < as_long
    };
    let are_dates = short.len() >= SHORT_DATES_LEAST && short.len() * 10 >= of * 9;
    let (patient, reads, count) = match full.last().filter(|last| !is_chance(last)) {
        Some((patient, reads)) => (patient, reads, full.len()),
        None => short.last().filter(|_| are_dates).map(|(id, reads)| (id, reads, short.len()))?,
    };
    let words = match reads {
        Reading::Day(day) => {
            let day = day.strftime("%-d %B %Y");
            format!(
                "every scan of {day} would go to a patient {patient}; \
                 {count} of {of} ids read as a date"
            )
        }
        Reading::Moment(day) => {
            let day = day.strftime("%-d %B %Y");
            format!(
                "every scan of {day} would go to a patient of its own, such as {patient}; \
                 {count} of {of} ids read as a date and a time"
            )
        }
        Reading::ShortDay => format!(
            "every scan of one day would go to one patient, such as {patient}; \
             {count} of {of} ids read as a date"
        ),
    };
    Some(NameFinding::Date(words))
}

/// The date that an id reads as, if any.
fn reading(patient: &str) -> Option<Reading> {
    let is_separator = |c: char| matches!(c, '-' | '.' | '_');
    let digits: String = patient.chars().filter(|c| !is_separator(*c)).collect();
    if !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    match digits.len() {
        6 => {
            let year = format!("20{}", &digits[..2]);
            date(&year, &digits[2..4], &digits[4..]).map(|_| Reading::ShortDay)
        }
        8 => {
            let day_first = || date(&digits[4..], &digits[2..4], &digits[..2]);
            year_first(&digits).or_else(day_first).map(Reading::Day)
        }
        10 | 12 | 14 if is_time(&digits[8..]) => year_first(&digits[..8]).map(Reading::Moment),
        _ => None,
    }
}

fn year_first(digits: &str) -> Option<Date> {
    date(&digits[..4], &digits[4..6], &digits[6..])
}

fn date(year: &str, month: &str, day: &str) -> Option<Date> {
    let year = year.parse().ok().filter(|year| YEARS.contains(year))?;
    Date::new(year, month.parse().ok()?, day.parse().ok()?).ok()
}

/// Whether two, four or six digits are hour, minute and second.
fn is_time(digits: &str) -> bool {
    let part = |at: usize| digits.get(at..at + 2).unwrap_or("0").parse().unwrap_or(i8::MAX);
    Time::new(part(0), part(2), part(4), 0).is_ok()
}

/// Ids that go up by one from file to file.
fn counter(taken: &[Taken<'_>]) -> Option<NameFinding> {
    let mut seen = BTreeSet::new();
    let ids: Vec<&str> =
        taken.iter().map(|taken| taken.patient).filter(|id| seen.insert(*id)).collect();
    let numbers = ids.iter().map(|id| number(id)).collect::<Option<Vec<_>>>()?;
    let goes_up = |pair: &[(&str, u64)]| match pair {
        [before, next] => before.0 == next.0 && before.1.checked_add(1) == Some(next.1),
        _ => false,
    };
    let is_counted = ids.len() >= COUNTED_LEAST && numbers.windows(2).all(goes_up);
    let (first, last) = (ids.first()?, ids.last()?);
    is_counted.then(|| {
        NameFinding::Counter(format!(
            "the ids go up by one from file to file, from {first} to {last}: if they count the \
             scans, each would go to the patient with that number"
        ))
    })
}

/// The part of an id before its last digits, and the value of those digits.
fn number(id: &str) -> Option<(&str, u64)> {
    let front = id.trim_end_matches(|c: char| c.is_ascii_digit());
    Some((front, id[front.len()..].parse().ok()?))
}

/// The id that most of many different names share, unless `is_date` has told it already.
fn one_for_many(taken: &[Taken<'_>], is_date: impl Fn(&str) -> bool) -> Option<NameFinding> {
    let names: BTreeMap<&str, &str> =
        taken.iter().map(|taken| (taken.name, taken.patient)).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for patient in names.values() {
        *counts.entry(patient).or_default() += 1;
    }
    let (of, (patient, count)) = (names.len(), counts.into_iter().max_by_key(|(_, count)| *count)?);
    (of >= MANY_NAMES && count * 2 > of && !is_date(patient)).then(|| {
        let words = format!("{count} of {of} names would go to the one patient {patient}");
        NameFinding::OneForMany(words)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The findings for files with these names, oldest first; an id ends at the first `_`.
    fn said(names: &[&str]) -> Vec<String> {
        let id = |name: &&str| name.split_once('_').unwrap().0.to_owned();
        let ids: Vec<String> = names.iter().map(id).collect();
        let taken = names.iter().zip(&ids).map(|(name, patient)| Taken { name, patient });
        let taken: Vec<Taken> = taken.collect();
        findings(&taken).iter().map(|found| format!("{}: {found}", found.code())).collect()
    }

    fn codes(names: &[&str]) -> Vec<String> {
        let code = |said: String| said.split_once(':').unwrap().0.to_owned();
        said(names).into_iter().map(code).collect()
    }

    #[test]
    fn an_id_that_is_a_date_says_whose_scans_would_go_to_it() {
        assert_eq!(
            said(&["20261122_0915.obj"]),
            ["looks-like-a-date: every scan of 22 November 2026 would go to a patient 20261122; \
              1 of 1 ids read as a date"]
        );
        assert_eq!(
            said(&["4711_left.obj", "202611220915_a.obj"]),
            [
                "looks-like-a-date: every scan of 22 November 2026 would go to a patient of its own, such \
              as 202611220915; 1 of 2 ids read as a date and a time"
            ]
        );
        assert_eq!(
            said(&["261122_a.obj", "261123_b.obj"]),
            ["looks-like-a-date: every scan of one day would go to one patient, such as 261123; \
              2 of 2 ids read as a date"]
        );
    }

    #[test]
    fn dates_are_known_in_each_of_their_forms_and_what_is_no_date_is_none() {
        let cases: [(&str, bool); 18] = [
            ("20261122", true),
            ("22112026", true),
            ("2026-11-22", true),
            ("22.11.2026", true),
            ("2026112209", true),
            ("202611220915", true),
            ("20261122091501", true),
            ("19900101", true),
            ("20240229", true),
            ("20230229", false),
            ("20261322", false),
            ("20261132", false),
            ("21000101", false),
            ("19891231", false),
            ("202611222415", false),
            ("202611220960", false),
            ("P20261122", false),
            ("4711", false),
        ];
        for (id, is_date) in cases {
            let found = codes(&[&format!("{id}_a.obj")]);
            assert_eq!(found == ["looks-like-a-date"], is_date, "{id}: {found:?}");
        }
    }

    #[test]
    fn six_digits_are_dates_where_nearly_all_are() {
        let dates = ["261122_1.obj"; 9];
        let of =
            |more: &[&str]| codes(&[&dates, more].concat()).contains(&"looks-like-a-date".into());
        assert!(of(&[]) && of(&["471147_a.obj"]));
        assert!(!of(&["471147_a.obj", "471148_a.obj"]));
        assert!(codes(&["261122_1.obj"]).is_empty(), "one may be a patient");
    }

    #[test]
    fn a_number_of_eight_digits_that_happens_to_be_a_date_is_a_patient_among_many_as_long() {
        let patients: Vec<String> = (0..60).map(|n| format!("7{:07}_a.obj", n * 7919)).collect();
        let mut names: Vec<&str> = patients.iter().map(String::as_str).collect();
        names.push("20261122_a.obj");
        assert_eq!(codes(&names), [""; 0]);
        names.push("20261123_a.obj");
        assert_eq!(codes(&names), ["looks-like-a-date"], "two of 62");
    }

    #[test]
    fn ids_that_go_up_by_one_from_file_to_file_are_a_counter() {
        assert_eq!(
            said(&["P0009_a.obj", "P0010_a.obj", "P0010_b.obj", "P0011_a.obj"]),
            [
                "looks-like-a-counter: the ids go up by one from file to file, from P0009 to P0011: if \
              they count the scans, each would go to the patient with that number"
            ]
        );
        let none: [&[&str]; 5] = [
            &["1_a.obj", "2_a.obj"],
            &["1_a.obj", "2_a.obj", "4_a.obj"],
            &["3_a.obj", "2_a.obj", "1_a.obj"],
            &["1_a.obj", "P2_a.obj", "3_a.obj"],
            &["18446744073709551614_a", "18446744073709551615_a", "18446744073709551616_a"],
        ];
        for names in none {
            assert_eq!(codes(names), [""; 0], "{names:?}");
        }
        let days = ["20261122_a.obj", "20261123_a.obj", "20261124_a.obj"];
        assert_eq!(codes(&days), ["looks-like-a-date"], "days are no counter");
    }

    #[test]
    fn an_id_that_most_of_many_names_share_is_told_once() {
        let year = ["2026_a", "2026_b", "2026_c", "2026_d", "4711_e", "4712_f"];
        assert_eq!(said(&year), ["one-id-for-many: 4 of 6 names would go to the one patient 2026"]);
        assert_eq!(codes(&year[..5]), [""; 0], "a patient may have four exports");
        assert_eq!(codes(&["2026_a"; 9]), [""; 0], "one name in many folders is one");
        let half = ["2026_a", "2026_b", "2026_c", "4711_d", "4711_e", "4712_f"];
        assert_eq!(codes(&half), [""; 0]);
        let dates = ["1", "2", "3", "4", "5", "6"].map(|n| format!("20261122_{n}"));
        assert_eq!(codes(&dates.each_ref().map(String::as_str)), ["looks-like-a-date"]);
    }

    #[test]
    fn names_that_name_patients_are_as_they_should_be() {
        assert_eq!(codes(&["4711_left.obj", "P12_front.obj", "0815_20261122.obj"]), [""; 0]);
        assert_eq!(codes(&[]), [""; 0]);
    }
}
