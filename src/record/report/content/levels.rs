//! The measuring sheet: girth and height at every level in the order of order forms, feet, inside leg.

use super::super::words::short;
use super::{Figure, LevelFigures, LevelRow, Levels, Report, SheetColumns, SheetRow};
use crate::leg::{Level, Side};
use crate::record::measure::{Length, Measure};
use crate::record::report::Mark;
use crate::record::rounding::cm_words;
use crate::record::schema::{FootFigures, LegFigures};

impl Report<'_> {
    pub(super) fn levels(&self) -> Levels {
        Levels {
            title: self.text("report.sheet.title"),
            columns: SheetColumns {
                level: self.text("report.sheet.level"),
                legs: Side::FROM_FRONT.map(|side| self.leg_heading(side)),
                girth: self.text("report.sheet.girth"),
                height: self.text("report.sheet.height"),
                by_hand: self.text("report.sheet.by_hand"),
            },
            rows: Level::ALL.into_iter().rev().map(|level| self.row(level)).collect(),
            lengths: self.lengths(),
            doubts: self.doubts_of_levels(),
            tilted: self.tilted(),
        }
    }

    fn row(&self, level: Level) -> LevelRow {
        LevelRow {
            level: level.name().to_owned(),
            place: self.language.word("level", level.name()).to_owned(),
            is_needed: self.garment().levels().contains(&level),
            legs: Side::FROM_FRONT.map(|side| self.level(side, level)),
        }
    }

    fn level(&self, side: Side, level: Level) -> LevelFigures {
        let Some(leg) = self.record.leg(side) else {
            return missing(self.no_leg(side).to_owned());
        };
        match Measure::of(leg, level) {
            Some(measure) => self.measured(&measure),
            None => missing(self.no_level(side, level)),
        }
    }

    fn measured(&self, measure: &Measure<'_>) -> LevelFigures {
        let figure = |Length { mm, sd_mm }| Figure::cm(mm, sd_mm, measure.mark(), self.language);
        LevelFigures {
            girth: figure(measure.girth),
            height: measure.height.map_or_else(|| Figure::plain(NO_HEIGHT), figure),
        }
    }

    /// Why a level has no figure on a leg that was measured; where the other leg has it, also the girth at
    /// the other leg's height.
    fn no_level(&self, side: Side, level: Level) -> String {
        let is_found = |code| self.is_found(code, side, Some(level.name()));
        let why = if is_found("level-absent") {
            "report.missing.level_absent"
        } else if is_found("level-implausible") {
            "report.missing.level_implausible"
        } else {
            "report.missing.level_not_seen"
        };
        match self.girth_at_other_height(side, level) {
            Some((height_mm, girth_mm)) => {
                let [height, girth] = [height_mm, girth_mm].map(|mm| cm_words(mm, self.language));
                let words: [(&str, &dyn std::fmt::Display); 3] =
                    [("why", &self.text(why)), ("height", &height), ("girth", &girth)];
                self.filled("report.missing.level_at_other", &words)
            }
            None => self.text(why),
        }
    }

    /// Height of the level on the other leg, and the girth of this leg there, mm.
    fn girth_at_other_height(&self, side: Side, level: Level) -> Option<(f64, f64)> {
        let other = Side::FROM_FRONT.into_iter().find(|other| *other != side)?;
        let height_mm = self.record.leg(other)?.landmarks.get(level.name())?.height_mm;
        Some((height_mm, girth_mm(self.record.leg(side)?, height_mm)?))
    }

    /// Foot and inside leg, which have one figure a leg.
    fn lengths(&self) -> Vec<SheetRow> {
        let foot = |key: &'static str, of: fn(&FootFigures) -> f64| SheetRow {
            head: self.text(key),
            figures: Side::FROM_FRONT.map(|side| self.foot(side, of)),
        };
        vec![
            foot("report.sheet.foot_length", |foot| foot.length_mm),
            foot("report.sheet.foot_breadth", |foot| foot.breadth_mm),
            self.inside_leg(),
        ]
    }

    fn foot(&self, side: Side, of: fn(&FootFigures) -> f64) -> Figure {
        match self.record.leg(side).map(|leg| leg.foot.as_ref()) {
            Some(Some(foot)) => Figure::plain(cm_words(of(foot), self.language)),
            Some(None) => Figure::missing(self.language.text("report.missing.foot_not_seen")),
            None => Figure::missing(self.no_leg(side)),
        }
    }

    /// The height of the crotch, which both legs share.
    fn inside_leg(&self) -> SheetRow {
        let body = &self.record.body;
        let is_doubted = self.record.has_finding("crotch-uncertain");
        let mark = if is_doubted { Mark::Doubtful } else { Mark::Sure };
        let figure = |side: Side| match (self.record.leg(side), body.crotch_height_mm) {
            (Some(_), Some(mm)) => Figure::cm(mm, body.crotch_sd_mm, mark, self.language),
            (Some(_), None) => Figure::missing(self.language.text("report.missing.level_not_seen")),
            (None, _) => Figure::missing(self.no_leg(side)),
        };
        SheetRow {
            head: self.text("report.sheet.inside_leg"),
            figures: Side::FROM_FRONT.map(figure),
        }
    }

    /// The doubts about figures of the sheet, a line for each leg that has any: `Right leg – B1: height
    /// uncertain; C: skin partly not seen`.
    fn doubts_of_levels(&self) -> Vec<String> {
        let of_leg = |side: Side| {
            let leg = self.record.leg(side)?;
            let of_level = |level: Level| {
                let codes = Measure::of(leg, level)?.doubts.iter();
                let words: Vec<String> = codes.map(|code| short(code, self.language)).collect();
                (!words.is_empty()).then(|| format!("{}: {}", level.name(), words.join(", ")))
            };
            let levels: Vec<String> = Level::ALL.into_iter().rev().filter_map(of_level).collect();
            let leg = self.leg_heading(side);
            (!levels.is_empty()).then(|| format!("{leg} – {}.", levels.join("; ")))
        };
        Side::FROM_FRONT.into_iter().filter_map(of_leg).collect()
    }
}

/// In the place of the height of a level on the foot, where the tape is not level.
const NO_HEIGHT: &str = "–";

/// The girth of a leg at a height, mm, between the two sections around it; `None` where one was not measured.
fn girth_mm(leg: &LegFigures, height_mm: f64) -> Option<f64> {
    let curve = &leg.girth_curve;
    let measured: Vec<(f64, Option<f64>)> = curve
        .height_mm
        .iter()
        .zip(&curve.tape_mm)
        .filter_map(|(height_mm, tape_mm)| Some(((*height_mm)?, *tape_mm)))
        .collect();
    let around =
        measured.windows(2).find(|pair| pair[0].0 <= height_mm && height_mm <= pair[1].0)?;
    let [(low_mm, low), (high_mm, high)] = around.try_into().ok()?;
    let share = if high_mm > low_mm { (height_mm - low_mm) / (high_mm - low_mm) } else { 0.0 };
    Some(low? + share * (high? - low?))
}

fn missing(why: String) -> LevelFigures {
    let figure = || Figure::missing(&why);
    LevelFigures { girth: figure(), height: figure() }
}
