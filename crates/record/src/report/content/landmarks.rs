//! Every figure of the levels in mm.

use gaiter_leg::{Level, Side};

use super::super::words::{title, told};
use super::{Figure, Report, Table, TableRow};
use crate::schema::{EstimateFigures, LandmarkFigures};

impl Report<'_> {
    /// Every figure of the levels, with the digits of `record.json`.
    pub(super) fn landmarks(&self) -> Table {
        let columns = [
            "report.landmarks.column.level",
            "report.landmarks.column.height",
            "report.landmarks.column.height_error",
            "report.landmarks.column.along_axis",
            "report.landmarks.column.along_skin",
            "report.landmarks.column.girth_tape",
            "report.landmarks.column.girth_error",
            "report.landmarks.column.girth_of_level_error",
            "report.landmarks.column.girth_per_degree",
            "report.landmarks.column.girth_skin",
            "report.landmarks.column.found_by",
            "report.landmarks.column.doubts",
        ];
        let rows = Side::FROM_FRONT.into_iter().flat_map(|side| self.landmarks_of(side)).collect();
        Table {
            title: self.text("report.landmarks.title"),
            explanation: Some(self.text("report.landmarks.explanation")),
            columns: columns.map(|column| self.text(column)).into(),
            rows,
            below: None,
        }
    }

    fn landmarks_of(&self, side: Side) -> Vec<TableRow> {
        let Some(leg) = self.record.leg(side) else { return Vec::new() };
        let head = |row: &'static str, level: Level| {
            self.filled(row, &[("level", &level.name()), ("leg", &self.leg(side))])
        };
        let row =
            |level: Level| match (leg.landmarks.get(level.name()), leg.estimates.get(level.name()))
            {
                (Some(found), _) => Some(TableRow {
                    head: head("report.landmarks.row", level),
                    figures: self.found_in_mm(found),
                }),
                (None, Some(of)) => Some(TableRow {
                    head: head("report.landmarks.row_estimated", level),
                    figures: self.estimate_in_mm(of),
                }),
                (None, None) => None,
            };
        Level::ALL.into_iter().rev().filter_map(row).collect()
    }

    fn found_in_mm(&self, of: &LandmarkFigures) -> Vec<Figure> {
        vec![
            self.digits(Some(of.height_mm)),
            self.digits(of.height_sd_mm),
            self.digits(Some(of.along_axis_mm)),
            self.digits(of.surface_length_mm),
            self.digits(Some(of.girth_tape_mm)),
            self.digits(of.girth_sd_mm),
            self.digits(of.girth_of_level_sd_mm),
            self.digits(of.girth_per_deg_mm),
            self.digits(Some(of.girth_contour_mm)),
            Figure::plain(told(Some(&of.rule), &of.by, self.language).0),
            self.doubts_in_words(&of.doubts),
        ]
    }

    fn estimate_in_mm(&self, of: &EstimateFigures) -> Vec<Figure> {
        vec![
            self.digits(Some(of.height_mm)),
            self.digits(of.height_sd_mm),
            self.digits(Some(of.along_axis_mm)),
            self.digits(None),
            self.digits(Some(of.girth_tape_mm)),
            self.digits(of.girth_sd_mm),
            self.digits(of.girth_of_level_sd_mm),
            self.digits(None),
            self.digits(None),
            Figure::plain(told(Some(&of.rule), &of.by, self.language).0),
            self.doubts_in_words(&of.doubts),
        ]
    }

    /// A figure as JSON writes it.
    fn digits(&self, mm: Option<f64>) -> Figure {
        match mm {
            Some(mm) => Figure::plain(format!("{mm:?}")),
            None => Figure::missing(self.language.text("report.missing.not_known")),
        }
    }

    fn doubts_in_words(&self, codes: &[String]) -> Figure {
        match codes {
            [] => Figure::plain(self.text("report.landmarks.no_doubts")),
            codes => {
                let words: Vec<&str> =
                    codes.iter().map(|code| title(code, self.language)).collect();
                Figure::plain(words.join(", "))
            }
        }
    }
}
