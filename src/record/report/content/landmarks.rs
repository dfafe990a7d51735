//! Every figure of the levels in mm.

use super::super::words;
use super::super::words::findings::short;
use super::{Figure, Report, Table, TableRow};
use crate::leg::{Level, Side};
use crate::record::schema::{EstimateFigures, LandmarkFigures};

impl Report<'_> {
    /// Every figure of the levels, with the digits of `record.json`.
    pub(super) fn landmarks(&self) -> Table {
        let columns = [
            ("Level", "Messpunkt"),
            ("Height", "Höhe"),
            ("Its standard error", "Standardfehler"),
            ("Along the axis", "Entlang der Achse"),
            ("Along the skin", "Entlang der Haut"),
            ("Girth by tape", "Umfang mit Band"),
            ("Its standard error", "Standardfehler"),
            ("Girth along the skin", "Umfang der Haut"),
            ("Found by", "Gefunden durch"),
            ("Doubts", "Zweifel"),
        ];
        let rows = Side::FROM_FRONT.into_iter().flat_map(|side| self.landmarks_of(side)).collect();
        Table {
            title: self.say("All levels as recorded (mm)", "Alle Messpunkte wie im Datensatz (mm)"),
            explanation: Some(self.say(
                "The exact digits of record.json, with one standard error, not two. Heights are \
                 vertical above the floor.",
                "Ziffer für Ziffer wie in record.json, mit einem Standardfehler, nicht zweien. Höhen \
                 sind senkrecht über dem Boden.",
            )),
            columns: columns.map(|(english, german)| self.say(english, german)).into(),
            rows,
        }
    }

    fn landmarks_of(&self, side: Side) -> Vec<TableRow> {
        let Some(leg) = self.record.leg(side) else { return Vec::new() };
        let head = |level: Level, about: &str| {
            format!("{}, {}{about}", level.name(), words::leg(side, self.language))
        };
        let estimated = self.say(", estimated", ", geschätzt");
        let row =
            |level: Level| match (leg.landmarks.get(level.name()), leg.estimates.get(level.name()))
            {
                (Some(found), _) => {
                    Some(TableRow { head: head(level, ""), figures: self.found_in_mm(found) })
                }
                (None, Some(of)) => Some(TableRow {
                    head: head(level, &estimated),
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
            self.digits(Some(of.girth_contour_mm)),
            Figure::plain(words::statements::told(of.rule.as_ref(), &of.by, self.language).0),
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
            self.digits(None),
            Figure::plain(words::statements::told(of.rule.as_ref(), &of.by, self.language).0),
            self.doubts_in_words(&of.doubts),
        ]
    }

    /// A figure as JSON writes it.
    fn digits(&self, mm: Option<f64>) -> Figure {
        match mm {
            Some(mm) => Figure::plain(format!("{mm:?}")),
            None => Figure::missing(self.language.pick("not known", "nicht bekannt")),
        }
    }

    fn doubts_in_words(&self, codes: &[String]) -> Figure {
        match codes {
            [] => Figure::plain(self.say("none", "keine")),
            codes => {
                let words: Vec<String> =
                    codes.iter().map(|code| short(code, self.language)).collect();
                Figure::plain(words.join(", "))
            }
        }
    }
}
