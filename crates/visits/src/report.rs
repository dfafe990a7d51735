//! The report of a patient's visits for people: its content as data, which record's report prints.

mod legend;
mod pictures;
mod summary;
mod tables;
mod words;

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::Record;
use gaiter_record::report::content::{Section, Verdict};
use gaiter_record::report::document::{Block, Document, Origin, PaperLink};
use gaiter_record::report::{AgeMax, Head};
use jiff::civil::Date;

use self::words::Words;
use super::comparison::Comparison;
use super::course::{Course, Group};
use super::overlay::Overlay;
use super::threshold::Threshold;

/// How many visits before the last one stand beside it, except the first.
const VISITS_BEFORE_LAST: usize = 2;

/// What a report of visits needs besides the visits.
#[derive(Debug, Clone, Copy)]
pub struct ReportOf<'a> {
    /// The visits.
    pub course: &'a Course,
    /// The records from which it was made.
    pub records: &'a [Record],
    /// Thresholds of the clinic.
    pub thresholds: &'a [Threshold],
    /// The day on which it is read.
    pub today: Date,
    /// A scan that is older than this is reported as old.
    pub age_max: AgeMax,
    /// The language of its texts.
    pub language: Language,
}

impl ReportOf<'_> {
    /// The report.
    pub fn document(&self) -> Document {
        let words = Words { course: self.course, language: self.language };
        let verdict = Verdict { kind: None, parts: self.summary(&words) };
        let mut blocks = vec![Block::Verdict(verdict)];
        let section = |key, entries: Vec<String>| {
            let is_any = !entries.is_empty();
            is_any.then(|| Block::Section(Section { title: words.text(key), entries }))
        };
        blocks.extend(section("visits.missing_records", self.left_out(&words)));
        blocks.extend(section("visits.cautions", self.cautions(&words)));
        let group = self.course.last_group();
        let compared = group.map(|of| self.course.last_compared(of)).unwrap_or_default();
        let pictures = pictures::first(&words, &compared);
        if !pictures.is_empty() {
            blocks.extend(pictures);
            blocks.push(Block::Turn);
        }
        blocks.push(Block::Table(tables::visits(&words)));
        if let Some(group) = group {
            blocks.extend(self.of_group(&words, group, &compared));
        }
        let legend = group.map(|group| legend::legend(&words, group, &compared));
        blocks.extend(section("visits.legend", legend.unwrap_or_default()));
        let (head, origin) = (self.head(&words), self.origin());
        Document { head, origin, paper: None, blocks, appendix: None }
    }

    /// The report for a page that has the PDF of it beside it, under this name.
    pub fn document_beside(&self, paper: &str) -> Document {
        let words = self.language.text("visits.paper").to_owned();
        let paper = Some(PaperLink { address: paper.to_owned(), words });
        Document { paper, ..self.document() }
    }

    /// The tables and pictures of the visits that can be compared with the last one. Tables that may continue on the
    /// next page stand between the pictures, which may not.
    fn of_group(&self, words: &Words, group: &Group, compared: &[Comparison]) -> Vec<Block> {
        let mut blocks: Vec<Block> = Vec::new();
        let compared_volumes = compared.iter().filter(|of| !of.is_of_other_posture());
        blocks.extend(compared_volumes.map(|of| Block::Table(tables::volumes(words, group, of))));
        let shown = visits_side_by_side(group);
        blocks.extend(pictures::profiles(words, &shown));
        let legs = || Side::FROM_FRONT.into_iter();
        let girths = legs().filter_map(|side| tables::girths(words, side, &shown, compared));
        blocks.extend(girths.map(Block::Table));
        blocks.extend(pictures::slices(words, group, compared));
        let slices = legs().filter_map(|side| tables::slices(words, group, side, &shown, compared));
        blocks.extend(slices.map(Block::Table));
        let overlaid = compared.first().filter(|of| !of.is_of_other_posture());
        blocks.extend(overlaid.map(|of| self.overlaid(words, of)).into_iter().flatten());
        blocks.extend(tables::levels(words, &shown).map(Block::Table));
        blocks
    }

    /// The legs of two visits laid over each other: a map of the distances, and the 3D view.
    fn overlaid(&self, words: &Words, of: &Comparison) -> Vec<Block> {
        let record = |visit: usize| self.records.get(self.course.visits[visit].record);
        let (Some(earlier), Some(later)) = (record(of.earlier), record(of.later)) else {
            return Vec::new();
        };
        let overlay = Overlay::new(earlier, later);
        overlay.map(|overlay| pictures::overlay(words, of, overlay)).unwrap_or_default()
    }

    fn head(&self, words: &Words) -> Head {
        let visits = self.course.visits.len();
        let [first, last] = [0, visits.saturating_sub(1)].map(|visit| words.day(visit));
        let taken =
            words.filled("visits.taken", &[("count", &visits), ("first", &first), ("last", &last)]);
        Head {
            language: self.language,
            title: words.text("visits.title"),
            is_vouched: true,
            patient: words.patient(),
            taken,
        }
    }

    fn origin(&self) -> Origin {
        let visits = &self.course.visits;
        let id = visits.iter().map(|visit| format!("{} {}", visit.sha256, visit.revision));
        let last = visits.last();
        let station = last.and_then(|visit| visit.station.clone());
        let record = last.and_then(|visit| self.records.get(visit.record));
        let program = record.map(|record| record.made_by.gaiter.as_str());
        Origin {
            id: id.collect::<Vec<_>>().join(" "),
            author: station.unwrap_or_else(|| "gaiter".to_owned()),
            made_by: format!("gaiter {}", program.unwrap_or_default()),
            at: last.and_then(|visit| visit.acquired.as_ref()).map(|acquired| acquired.at),
        }
    }
}

/// The visits of a group that are beside each other: the first, and the last three.
fn visits_side_by_side(group: &Group) -> Vec<usize> {
    let from = group.visits.len().saturating_sub(VISITS_BEFORE_LAST + 1);
    let mut shown = group.visits[from..].to_vec();
    if let Some(first) = group.visits.first().filter(|first| !shown.contains(first)) {
        shown.insert(0, *first);
    }
    shown
}
