//! The sizes of makers' tables, calibre jumps, and the boxes of an order form.

use std::fmt::Display;

use gaiter_leg::Side;
use gaiter_sizes::Point;
use gaiter_sizes::garment::{FormBox, FormUnit};
use gaiter_sizes::verdict::{PointVerdict, Reading, SURE, UNLIKELY};

use super::{Report, ReportFigure, Section, Sizes, Table, TableRow};
use crate::rounding::{cm_words, number, shortest, tenths_words};
use crate::sizing::{LegSizes, SizeVerdicts, TableVerdict, reading, words};

/// In the place of a point that a size or length does not ask for.
const NOT_ASKED: &str = "–";

impl Report<'_> {
    /// The section; `None` if there is no table and the garment's form is that of the sheet.
    pub(super) fn sizes(&self, verdicts: &SizeVerdicts) -> Option<Sizes> {
        let has_tables = !verdicts.tables.is_empty();
        if !has_tables && self.garment.is_shipped() {
            return None;
        }
        let is_comparable = verdicts.tables.iter().any(|of| of.not_comparable.is_none());
        Some(Sizes {
            title: self.text("sizes.title"),
            see: has_tables
                .then(|| self.filled("sizes.see", &[("tables", &verdicts.tables.len())])),
            about: self.about_tables(verdicts, is_comparable),
            tables: match is_comparable {
                true => Side::FROM_FRONT
                    .into_iter()
                    .filter_map(|of| self.leg_sizes(of, verdicts))
                    .collect(),
                false => Vec::new(),
            },
            calibre: has_tables.then(|| Section {
                title: self.text("sizes.calibre.title"),
                entries: std::iter::once(self.text("sizes.calibre.explanation"))
                    .chain(words::calibre(&verdicts.calibre, self.language))
                    .collect(),
            }),
            form: self.form(verdicts),
        })
    }

    /// The tables by their signs, what to know about each, and how to read the figures.
    fn about_tables(&self, verdicts: &SizeVerdicts, is_comparable: bool) -> Vec<String> {
        let language = self.language;
        let about = |(index, table): (usize, &TableVerdict)| {
            let heading = words::heading(index, table, language);
            let identity = words::identity(table, language);
            let warnings = words::warnings(table, language);
            let sentences = std::iter::once(format!("{heading}. {identity}.")).chain(warnings);
            sentences.collect::<Vec<_>>().join(" ")
        };
        let mut sentences: Vec<String> = verdicts.tables.iter().enumerate().map(about).collect();
        if is_comparable {
            let percent = |share: f64| number(100.0 * share, 0, language);
            let limits: [(&str, &dyn Display); 2] =
                [("sure", &percent(SURE)), ("unlikely", &percent(UNLIKELY))];
            sentences.push(self.filled("sizes.explanation", &limits));
            let mm = |mm: f64| shortest(mm, language);
            if verdicts.scanner_girth_mm > 0.0 {
                sentences
                    .push(self.filled("sizes.common", &[("mm", &mm(verdicts.scanner_girth_mm))]));
            }
            if verdicts.has(|of| !of.is_required) {
                sentences.push(self.text("sizes.not_required"));
            }
            if verdicts.has(PointVerdict::is_by_hand) {
                sentences.push(self.filled("sizes.tape", &[("mm", &mm(verdicts.tape_girth_mm))]));
            }
        }
        sentences
    }

    /// The candidates of all tables for a leg, side by side.
    fn leg_sizes(&self, side: Side, verdicts: &SizeVerdicts) -> Option<Table> {
        let legs = verdicts.tables.iter().enumerate().filter_map(|(index, table)| {
            let leg = table.legs.iter().find(|of| of.side == side.word())?;
            Some((index, table, leg))
        });
        let legs: Vec<(usize, &TableVerdict, &LegSizes)> = legs.collect();
        let points = asked_points(&legs);
        let rows: Vec<TableRow> = legs
            .iter()
            .flat_map(|(index, table, leg)| self.of_table(*index, table, leg, &points))
            .collect();
        let words: [(&str, &dyn Display); 2] = [
            ("leg", &self.leg_heading(side)),
            ("garment", &self.garment.in_sentence(self.language.tag())),
        ];
        let together = |(index, table, leg): &(usize, &TableVerdict, &LegSizes)| {
            words::together(*index, table, leg, self.language)
        };
        let first = ["sizes.size", "sizes.verdict"].map(|key| self.text(key));
        let heads = points.iter().map(ToString::to_string);
        (!legs.is_empty()).then(|| Table {
            title: self.filled("sizes.leg", &words),
            explanation: Some(legs.iter().map(together).collect::<Vec<_>>().join(" ")),
            columns: first.into_iter().chain(heads).collect(),
            rows,
            below: None,
        })
    }

    /// The candidates of a table and its lengths.
    fn of_table(
        &self,
        index: usize,
        table: &TableVerdict,
        leg: &LegSizes,
        points: &[Point],
    ) -> Vec<TableRow> {
        let language = self.language;
        let sign = words::marked(index, table, language);
        let row = |name: &str, verdict: String, of: &[PointVerdict]| TableRow {
            head: format!("{sign} · {name}"),
            figures: std::iter::once(ReportFigure::plain(verdict))
                .chain(self.cells(of, points))
                .collect(),
        };
        let verdict = &leg.verdict;
        let mut rows = Vec::new();
        for of in verdict.sizes.iter().filter(|of| of.is_candidate) {
            let fit = words::fit(of.fit, &of.points, language);
            let codes = words::codes(of, language).map(|codes| format!(", {codes}"));
            rows.push(row(
                &words::size(of, language),
                fit + &codes.unwrap_or_default(),
                &of.points,
            ));
        }
        for of in &verdict.lengths {
            let name = self.filled("sizes.length", &[("name", &of.length)]);
            rows.push(row(&name, words::fit(of.fit, &of.points, language), &of.points));
        }
        rows
    }

    /// A cell for each of these points.
    fn cells(&self, of: &[PointVerdict], points: &[Point]) -> Vec<ReportFigure> {
        let cell = |point: &Point| match of.iter().find(|of| of.point == *point) {
            None => ReportFigure::plain(NOT_ASKED),
            Some(of) => self.cell(of),
        };
        points.iter().map(cell).collect()
    }

    fn cell(&self, of: &PointVerdict) -> ReportFigure {
        let Some(margins_mm) = of.margins_mm else {
            return ReportFigure::missing(words::not_given(of, self.language).unwrap_or_default());
        };
        let sign = match of.reading {
            Reading::Given(given) if given.is_by_hand => " *",
            _ => "",
        };
        let margins = words::margins(margins_mm, self.language);
        let text = format!("{margins}{sign} ({})", words::inside(of, self.language));
        match of.is_required {
            true => ReportFigure::plain(text),
            false => ReportFigure::plain(format!("[{text}]")),
        }
    }

    /// The boxes of the order form with their values as printed.
    fn form(&self, verdicts: &SizeVerdicts) -> Table {
        let garment = self.garment;
        let step = |point: Point| shortest(garment.step_mm(point), self.language);
        let words: [(&str, &dyn Display); 3] = [
            ("unit", &garment.unit().word()),
            ("girth", &step(Point::Girth(gaiter_leg::Level::B))),
            ("length", &step(Point::Foot)),
        ];
        let title: [(&str, &dyn Display); 1] = [("garment", &garment.title(self.language.tag()))];
        let legs = Side::FROM_FRONT.map(|side| self.leg_heading(side));
        let row = |of: &FormBox| TableRow {
            head: of.name.clone(),
            figures: Side::FROM_FRONT.map(|side| self.in_box(side, of, verdicts)).into(),
        };
        Table {
            title: self.filled("sizes.form.title", &title),
            explanation: Some(self.filled("sizes.form.explanation", &words)),
            columns: std::iter::once(self.text("sizes.form.box")).chain(legs).collect(),
            rows: garment.boxes().iter().map(row).collect(),
            below: None,
        }
    }

    fn in_box(&self, side: Side, of: &FormBox, verdicts: &SizeVerdicts) -> ReportFigure {
        match reading(self.record, side, of.point, verdicts.scanner_girth_mm) {
            Reading::NotGiven { .. } if of.is_optional => ReportFigure::missing(NOT_ASKED),
            Reading::NotGiven { why } => {
                ReportFigure::missing(self.language.word("sizes.not_given", why.word()))
            }
            Reading::Given(given) => {
                let mm = self.garment.printed_mm(of.point, given.mm);
                let words = match self.garment.unit() {
                    FormUnit::Cm => cm_words(mm, self.language),
                    FormUnit::Mm if mm.fract() == 0.0 => number(mm, 0, self.language),
                    FormUnit::Mm => tenths_words(mm, self.language),
                };
                ReportFigure::plain(if given.is_by_hand { words + " *" } else { words })
            }
        }
    }
}

/// The points of the candidates and lengths of all tables, in the order in which they come, girths first.
fn asked_points(legs: &[(usize, &TableVerdict, &LegSizes)]) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    for (_, _, leg) in legs {
        let sizes = leg.verdict.sizes.iter().filter(|of| of.is_candidate).flat_map(|of| &of.points);
        let lengths = leg.verdict.lengths.iter().flat_map(|of| &of.points);
        for of in sizes.chain(lengths) {
            if !points.contains(&of.point) {
                points.push(of.point);
            }
        }
    }
    points.sort();
    points
}
