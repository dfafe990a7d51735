//! How old a scan is, on every sheet: a leg changes, and an order needs measures of today's leg.

use std::fmt::Display;

use gaiter_language::Language;
use jiff::ToSpan;
use jiff::civil::Date;
use serde::{Deserialize, Serialize};

use crate::{Acquired, Record};

/// How old a scan may be for an order, days.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct AgeMax(pub u32);

impl Default for AgeMax {
    /// 180 days: suppliers measure again after six months.
    fn default() -> AgeMax {
        AgeMax(180)
    }
}

impl AgeMax {
    /// The last day on which a scan of this day may be used for an order; `None` if no calendar has it.
    pub fn last_day(self, taken: Date) -> Option<Date> {
        taken.checked_add(i64::from(self.0).days()).ok()
    }
}

/// What a sheet states about the age of its scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Age {
    /// For paper, which does not know the day on which it is read: until when the measures hold.
    pub until: String,
    /// For a page, which counts the days when it is read; `None` if the time of the scan is not known.
    pub counted: Option<Counted>,
}

/// What a page needs to state the age of its scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Counted {
    /// The day of the scan, on the calendar of its scanner.
    pub taken: Date,
    /// How old it may be.
    pub most: AgeMax,
    /// The sentence for a scan that is not too old, with a place for `{days}`.
    pub fresh: String,
    /// The sentence for one that is too old.
    pub old: String,
}

impl Age {
    /// The age of a record's scan.
    pub fn new(record: &Record, most: AgeMax, language: Language) -> Age {
        let taken = record.acquired.as_ref().map(|acquired: &Acquired| acquired.local().date());
        let last = taken.and_then(|taken| most.last_day(taken));
        let (Some(taken), Some(last)) = (taken, last) else {
            return Age { until: language.text("report.age.unknown").to_owned(), counted: None };
        };
        let day = |date: Date| date.strftime(language.text("report.age.day")).to_string();
        let values: [(&str, &dyn Display); 3] =
            [("taken", &day(taken)), ("last", &day(last)), ("most", &most.0)];
        let counted = Counted {
            taken,
            most,
            fresh: language.filled("report.age.fresh", &values),
            old: language.filled("report.age.old", &values),
        };
        Age { until: language.filled("report.age.until", &values), counted: Some(counted) }
    }
}
