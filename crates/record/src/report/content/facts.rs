//! Where a record comes from, in words.

use std::fmt::Display;

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::{Fact, Report, Section};
use crate::phantom::{CheckResult, LastCheck};
use crate::rounding::{cm_words, shortest, signed, tenths_words};
use crate::{Acquired, Source, shown};

/// How many digits of a scan's hash distinguish it from all others of a clinic.
const HASH_DIGITS: usize = 16;

/// How many digits of it name a scan to people, on the page and in the log.
const ID_DIGITS: usize = 8;

impl Report<'_> {
    pub(super) fn patient(&self) -> String {
        match &self.record.patient {
            Some(patient) => shown::id(&patient.id),
            None => self.text("report.fact.not_assigned"),
        }
    }

    pub(super) fn taken(&self) -> String {
        let station = self.record.station.as_ref().map(|station| shown::id(station));
        [Some(self.time()), station].into_iter().flatten().collect::<Vec<_>>().join(" · ")
    }

    fn time(&self) -> String {
        match &self.record.acquired {
            Some(acquired) => self.local(acquired.at),
            None => self.text("report.fact.time_unknown"),
        }
    }

    /// Date and time at the scanner in the format of the language; UTC, and marked so, if the record does
    /// not hold how the two differ.
    pub(super) fn local(&self, at: Timestamp) -> String {
        let offset = self.record.acquired.as_ref().and_then(Acquired::offset);
        let zone = offset.map_or(TimeZone::UTC, TimeZone::fixed);
        let words = at.to_zoned(zone).strftime(self.language.text("report.time")).to_string();
        if offset.is_some() { words } else { words + " UTC" }
    }

    pub(super) fn facts(&self) -> Vec<Fact> {
        let record = self.record;
        let fact = |name: String, value: String| Fact { name, value };
        let ordered = self.garment.title(self.language.tag());
        let mut facts = vec![
            fact(self.text("report.fact.patient"), self.patient()),
            fact(self.text("report.fact.record"), self.which_record()),
            fact(self.text("report.fact.order"), ordered.to_owned()),
        ];
        facts.extend(self.sources().map(|by| fact(self.text("report.fact.named_by"), by)));
        facts.push(fact(self.text("report.fact.taken"), self.time_and_source()));
        let station = record
            .station
            .as_deref()
            .map_or_else(|| self.text("report.fact.no_station"), shown::id);
        facts.push(fact(self.text("report.fact.station"), station));
        facts.extend(self.heights().map(|heights| fact(self.text("report.fact.body"), heights)));
        let hash: String = record.scan.sha256.chars().take(HASH_DIGITS).collect();
        facts.push(fact(self.text("report.fact.scan"), self.scan(&shown::id(&hash))));
        let phantom = record.phantom_check.as_ref().map(|check| self.phantom(check));
        facts.extend(phantom.map(|check| fact(self.text("report.fact.phantom"), check)));
        let program = format!("gaiter {}", shown::id(&record.made_by.gaiter));
        facts.push(fact(self.text("report.fact.program"), program));
        facts
    }

    /// What identifies this sheet: the beginning of the scan's id, and the revision.
    fn which_record(&self) -> String {
        let digits: String = self.record.scan.sha256.chars().take(ID_DIGITS).collect();
        let words: [(&str, &dyn Display); 2] =
            [("scan", &shown::id(&digits)), ("revision", &self.record.revision)];
        self.filled("report.fact.record_is", &words)
    }

    /// All sources that named the patient.
    fn sources(&self) -> Option<String> {
        let patient = self.record.patient.as_ref()?;
        let source = |of: &Source| self.language.word("report.source", of.kind.word());
        let words = patient.sources.iter().map(source).collect::<Vec<_>>().join(", ");
        (!words.is_empty()).then_some(words)
    }

    fn time_and_source(&self) -> String {
        match &self.record.acquired {
            Some(of) => {
                let from = self.language.word("report.time_from", of.from.word());
                format!("{} ({from})", self.local(of.at))
            }
            None => self.text("report.fact.unknown"),
        }
    }

    /// Heights of the body, if the scan holds more than a single leg.
    fn heights(&self) -> Option<String> {
        let body = &self.record.body;
        let fact = |key, mm| self.filled(key, &[("cm", &cm_words(mm, self.language))]);
        let stature = body.stature_mm.map(|mm| fact("report.fact.stature", mm));
        let crotch = body.crotch_height_mm.map(|mm| fact("report.fact.crotch", mm));
        let words = [stature, crotch].into_iter().flatten().collect::<Vec<_>>().join(", ");
        (!words.is_empty()).then_some(words)
    }

    /// The last check with a body of known girths, in words.
    fn phantom(&self, check: &LastCheck) -> String {
        let when = self.local(check.at);
        let tolerance = shortest(check.tolerance_mm, self.language);
        let worst_mm = check.worst_mm.unwrap_or_default();
        let worst = signed(worst_mm, &tenths_words(worst_mm, self.language));
        let key = match check.result {
            CheckResult::Within => "report.fact.phantom_within",
            CheckResult::Beyond => "report.fact.phantom_beyond",
            CheckResult::NotMeasured => "report.fact.phantom_not_measured",
        };
        self.filled(key, &[("when", &when), ("tolerance", &tolerance), ("worst", &worst)])
    }

    fn scan(&self, hash: &str) -> String {
        let scan = &self.record.scan;
        let (format, unit) = (shown::id(&scan.format), shown::id(&scan.unit));
        let from = match scan.unit_inferred {
            true => self.text("report.fact.unit_found"),
            false => self.text("report.fact.unit_declared"),
        };
        self.filled(
            "report.fact.scan_is",
            &[
                ("hash", &hash),
                ("format", &format),
                ("points", &scan.points),
                ("unit", &unit),
                ("from", &from),
            ],
        )
    }

    pub(super) fn legend(&self) -> Section {
        let entries = [
            "report.legend.girth",
            "report.legend.height",
            "report.legend.margin",
            "report.legend.marks",
            "report.legend.difference",
            "report.legend.sides",
        ];
        Section {
            title: self.text("report.legend.title"),
            entries: entries.map(|key| self.text(key)).into(),
        }
    }
}
