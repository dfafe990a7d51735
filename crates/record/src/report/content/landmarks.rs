//! Every figure of the levels in mm.

use gaiter_leg::{Level, Side};

use super::super::{in_words, title};
use super::{Report, ReportFigure, Table, TableRow};
use crate::schema::{EstimateFigures, LandmarkFigures};
use crate::statement::Statement;

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
        let row = |level: Level| {
            let found = leg.landmarks.get(level.name()).map(|of| TableRow {
                head: head("report.landmarks.row", level),
                figures: self.found_in_mm(of),
            });
            let estimated = || {
                leg.estimates.get(level.name()).map(|of| TableRow {
                    head: head("report.landmarks.row_estimated", level),
                    figures: self.estimate_in_mm(of),
                })
            };
            found.or_else(estimated)
        };
        Level::ALL.into_iter().rev().filter_map(row).collect()
    }

    fn found_in_mm(&self, of: &LandmarkFigures) -> Vec<ReportFigure> {
        let mm = [
            Some(of.height_mm),
            of.height_sd_mm,
            Some(of.along_axis_mm),
            of.surface_length_mm,
            Some(of.girth_tape_mm),
            of.girth_sd_mm,
            of.girth_of_level_sd_mm,
            of.girth_per_deg_mm,
            Some(of.girth_contour_mm),
        ];
        self.figures(mm, &of.rule, &of.by, &of.doubts)
    }

    fn estimate_in_mm(&self, of: &EstimateFigures) -> Vec<ReportFigure> {
        let mm = [
            Some(of.height_mm),
            of.height_sd_mm,
            Some(of.along_axis_mm),
            None,
            Some(of.girth_tape_mm),
            of.girth_sd_mm,
            of.girth_of_level_sd_mm,
            None,
            None,
        ];
        self.figures(mm, &of.rule, &of.by, &of.doubts)
    }

    /// Figures in mm, how they were found, and the doubts about them.
    fn figures(
        &self,
        mm: [Option<f64>; 9],
        rule: &Statement,
        by: &str,
        doubts: &[String],
    ) -> Vec<ReportFigure> {
        let by = ReportFigure::plain(in_words(Some(rule), by, self.language).0);
        let words = [by, self.doubts_in_words(doubts)];
        mm.map(|mm| self.digits(mm)).into_iter().chain(words).collect()
    }

    /// A figure as JSON writes it.
    fn digits(&self, mm: Option<f64>) -> ReportFigure {
        match mm {
            Some(mm) => ReportFigure::plain(format!("{mm:?}")),
            None => ReportFigure::missing(self.language.text("report.missing.not_known")),
        }
    }

    fn doubts_in_words(&self, codes: &[String]) -> ReportFigure {
        match codes {
            [] => ReportFigure::plain(self.text("report.landmarks.no_doubts")),
            codes => {
                let words: Vec<&str> =
                    codes.iter().map(|code| title(code, self.language)).collect();
                ReportFigure::plain(words.join(", "))
            }
        }
    }
}
