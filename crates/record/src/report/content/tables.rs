//! Both legs at the same heights, requested heights, volumes and slices.

use gaiter_leg::Side;

use super::{Report, ReportFigure, Section, Table, TableRow};
use crate::chart::{
    AtFigures, SliceFigures, VolumeDifferenceFigures, VolumeFigures, girth_difference, same_heights,
};
use crate::report::Reliability;
use crate::rounding::{cm_words, number, tenths_words};
use crate::surface::SurfaceFigures;

impl Report<'_> {
    pub(super) fn tables(&self) -> Vec<Table> {
        let tables = [self.same_heights(), self.asked(), Some(self.volumes())];
        tables.into_iter().flatten().collect()
    }

    /// Headings of a table with one column per leg and these columns of differences.
    fn columns(&self, first: String, differences: &[String]) -> Vec<String> {
        let legs = Side::FROM_FRONT.map(|side| self.leg_heading(side));
        [first].into_iter().chain(legs).chain(differences.iter().cloned()).collect()
    }

    fn differences(&self) -> [String; 2] {
        [self.text("report.volumes.difference"), self.text("report.volumes.percent")]
    }

    fn volumes(&self) -> Table {
        let whole = self.record.differences.as_ref().and_then(|of| of.whole.as_ref());
        let whole_row = TableRow {
            head: self.text("report.volumes.whole_leg"),
            figures: self.volume_row(|of| (of.whole_ml, of.sd_ml), whole),
        };
        let between = TableRow {
            head: self.text("report.volumes.between"),
            figures: self.volume_row(|of| (of.b_to_d_ml, of.b_to_d_sd_ml), None),
        };
        Table {
            title: self.text("report.volumes.title"),
            explanation: Some(self.ranges()),
            columns: self.columns(self.text("report.volumes.part"), &self.differences()),
            rows: vec![whole_row, between],
            below: None,
        }
    }

    /// The range of each whole leg, and the range over which they are compared.
    fn ranges(&self) -> String {
        let cm = |mm| cm_words(mm, self.language);
        let of_leg = |side: Side| {
            let volume = &self.record.leg(side)?.volume;
            let (from_mm, to_mm) = (volume.from_height_mm?, volume.to_height_mm?);
            Some(self.filled(
                "report.volumes.range_of_leg",
                &[("leg", &self.leg(side)), ("from", &cm(from_mm)), ("to", &cm(to_mm))],
            ))
        };
        let legs: Vec<String> = Side::FROM_FRONT.into_iter().filter_map(of_leg).collect();
        let ranges = match legs.as_slice() {
            [] => self.text("report.volumes.range"),
            legs => self.filled("report.volumes.ranges", &[("legs", &legs.join(", "))]),
        };
        if self.record.differences.iter().any(|of| of.whole.is_some()) {
            format!("{ranges} {}", self.text("report.volumes.common"))
        } else {
            ranges
        }
    }

    fn volume_row(
        &self,
        figure: fn(&VolumeFigures) -> (Option<f64>, Option<f64>),
        difference: Option<&VolumeDifferenceFigures>,
    ) -> Vec<ReportFigure> {
        let of_leg = |side: Side| match self.record.leg(side).map(|leg| figure(&leg.volume)) {
            Some((Some(ml), sd_ml)) => ReportFigure::ml(ml, sd_ml, self.language),
            Some((None, _)) => {
                ReportFigure::missing(self.language.text("report.missing.volume_not_whole"))
            }
            None => ReportFigure::missing(self.no_leg(side)),
        };
        Side::FROM_FRONT.map(of_leg).into_iter().chain(self.volume_difference(difference)).collect()
    }

    fn volume_difference(&self, difference: Option<&VolumeDifferenceFigures>) -> [ReportFigure; 2] {
        match difference {
            Some(of) => ReportFigure::ml_difference([of.ml, of.percent], of.sd_ml, self.language),
            None => {
                let why = self.language.text("report.missing.not_compared");
                [ReportFigure::missing(why), ReportFigure::missing(why)]
            }
        }
    }

    /// Girths at the requested heights; `None` if no height was requested.
    fn asked(&self) -> Option<Table> {
        let heights = &self.record.legs.iter().map(|leg| &leg.at).find(|at| !at.is_empty())?;
        let row = |(index, at): (usize, &AtFigures)| TableRow {
            head: format!("{} cm", cm_words(at.height_mm, self.language)),
            figures: Side::FROM_FRONT.map(|side| self.girth_asked(side, index)).into(),
        };
        Some(Table {
            title: self.text("report.asked.title"),
            explanation: None,
            columns: self.columns(self.text("report.asked.height"), &[]),
            rows: heights.iter().enumerate().map(row).collect(),
            below: None,
        })
    }

    fn girth_asked(&self, side: Side, index: usize) -> ReportFigure {
        let Some(leg) = self.record.leg(side) else {
            return ReportFigure::missing(self.no_leg(side));
        };
        match leg.at.get(index) {
            Some(at) => self.girth_at(at),
            None => ReportFigure::missing(self.language.text("report.missing.height_not_seen")),
        }
    }

    /// Both legs at the same heights above the floor; `None` if the record has fewer than two legs with such
    /// girths. Levels are no place to compare legs: B1 of one may lie centimetres above that of the other.
    fn same_heights(&self) -> Option<Table> {
        let [Some(right), Some(left)] = Side::FROM_FRONT.map(|side| self.record.leg(side)) else {
            return None;
        };
        let pairs = same_heights([&right.profile, &left.profile]);
        let row = |[right, left]: &[&AtFigures; 2]| TableRow {
            head: cm_words(right.height_mm, self.language),
            figures: vec![
                self.girth_at(right),
                self.girth_at(left),
                self.girth_difference(right, left),
            ],
        };
        (!pairs.is_empty()).then(|| Table {
            title: self.text("report.same_heights.title"),
            explanation: Some(self.text("report.same_heights.explanation")),
            columns: self.columns(
                self.text("report.same_heights.height"),
                &[self.text("report.same_heights.difference")],
            ),
            rows: pairs.iter().rev().map(row).collect(),
            below: None,
        })
    }

    fn girth_at(&self, at: &AtFigures) -> ReportFigure {
        let mark = if at.doubts.is_empty() { Reliability::Sure } else { Reliability::Doubtful };
        match at.girth_tape_mm {
            Some(mm) => ReportFigure::cm(mm, at.girth_sd_mm, mark, self.language),
            None => ReportFigure::missing(self.language.text("report.missing.height_not_seen")),
        }
    }

    fn girth_difference(&self, right: &AtFigures, left: &AtFigures) -> ReportFigure {
        match girth_difference(right, left) {
            Some((mm, sd_mm)) => ReportFigure::cm_difference(mm, sd_mm, self.language),
            None => ReportFigure::missing(self.language.text("report.missing.not_compared")),
        }
    }

    /// Volumes of the slices of 4 cm; `None` if no leg has any.
    pub(super) fn slices(&self) -> Option<Table> {
        let longest = self.record.legs.iter().map(|leg| &leg.volume.slices);
        let longest = longest.max_by_key(|slices| slices.len()).filter(|all| !all.is_empty())?;
        let row = |slice: &SliceFigures| {
            let figure = |side: Side| self.slice(side, slice);
            let differences = self.record.differences.iter().flat_map(|of| &of.slices);
            let difference = differences.into_iter().find(|at| at.from_mm == slice.from_mm);
            let ends = [slice.from_mm, slice.to_mm].map(|mm| format!("{:.0}", mm / 10.0));
            let legs = Side::FROM_FRONT.map(figure).into_iter();
            TableRow {
                head: ends.join("–"),
                figures: legs.chain(self.volume_difference(difference)).collect(),
            }
        };
        Some(Table {
            title: self.text("report.slices.title"),
            explanation: Some(self.text("report.slices.explanation")),
            columns: self.columns(self.text("report.slices.from_to"), &self.differences()),
            rows: longest.iter().rev().map(row).collect(),
            below: None,
        })
    }

    fn slice(&self, side: Side, at: &SliceFigures) -> ReportFigure {
        let Some(leg) = self.record.leg(side) else {
            return ReportFigure::missing(self.no_leg(side));
        };
        let slice = leg.volume.slices.iter().find(|slice| slice.from_mm == at.from_mm);
        match slice.and_then(|slice| Some((slice.ml?, slice.sd_ml))) {
            Some((ml, sd_ml)) => ReportFigure::ml(ml, sd_ml, self.language),
            None => ReportFigure::missing(self.language.text("report.missing.slice_not_whole")),
        }
    }
}

// How well the surfaces follow the scan, in plain words.

impl Report<'_> {
    pub(super) fn surfaces(&self) -> Section {
        Section {
            title: self.text("report.surfaces.title"),
            entries: Side::FROM_FRONT.into_iter().map(|side| self.surface(side)).collect(),
        }
    }

    fn surface(&self, side: Side) -> String {
        let heading = self.leg_heading(side);
        let words = match self.record.leg(side).map(|leg| &leg.surface) {
            Some(Some(surface)) => self.quality(surface),
            Some(None) => self.text("report.surfaces.none"),
            None => format!("{}.", self.no_leg(side)),
        };
        format!("{heading}: {words}")
    }

    fn quality(&self, of: &SurfaceFigures) -> String {
        let cm = |mm| cm_words(mm, self.language);
        let mm = |mm| number(mm, 2, self.language);
        let [from, to] = [of.from_height_mm, of.to_height_mm].map(cm);
        let [rms, p95, max] =
            [of.to_points.rms_mm, of.to_points.p95_mm, of.to_points.max_mm].map(mm);
        let quality = self.filled(
            "report.surfaces.quality",
            &[("from", &from), ("to", &to), ("rms", &rms), ("p95", &p95), ("max", &max)],
        );
        format!("{quality} {}", self.holes(of))
    }

    fn holes(&self, of: &SurfaceFigures) -> String {
        let Some(largest) = of.holes.first() else { return self.text("report.surfaces.no_holes") };
        let area = tenths_words(largest.area_cm2, self.language);
        let height = cm_words(largest.height_mm, self.language);
        match of.holes.len() {
            1 => self.filled("report.surfaces.one_hole", &[("area", &area), ("height", &height)]),
            count => self.filled(
                "report.surfaces.holes",
                &[("count", &count), ("area", &area), ("height", &height)],
            ),
        }
    }
}
