//! Girths and lengths at the levels, and the differences between the legs there.

use super::super::words::short;
use super::{Figure, LevelColumns, LevelFigures, LevelRow, Levels, Report};
use crate::leg::{Level, Side};
use crate::record::report::Mark;
use crate::record::schema::{EstimateFigures, LandmarkFigures, LegFigures};

impl Report<'_> {
    pub(super) fn levels(&self) -> Levels {
        let (shown, others): (Vec<_>, Vec<_>) =
            Level::ALL.into_iter().rev().partition(|level| self.record.has_row(*level));
        let names: Vec<&str> = others.iter().map(|level| level.name()).collect();
        let left_out = (!names.is_empty())
            .then(|| self.filled("report.levels.left_out", &[("levels", &names.join(", "))]));
        Levels {
            title: self.text("report.levels.title"),
            columns: LevelColumns {
                level: self.text("report.levels.level"),
                legs: Side::FROM_FRONT.map(|side| self.leg_heading(side)),
                girth: self.text("report.levels.girth"),
                length: self.text("report.levels.length"),
                difference: self.text("report.levels.difference"),
            },
            rows: shown.into_iter().map(|level| self.row(level)).collect(),
            left_out,
            tilted: self.tilted(),
        }
    }

    /// Levels that are searched on every leg always have a row, the others if there is a figure.
    fn row(&self, level: Level) -> LevelRow {
        LevelRow {
            level: level.name().to_owned(),
            place: self.language.word("level", level.name()).to_owned(),
            is_sought: Level::SOUGHT.contains(&level),
            legs: Side::FROM_FRONT.map(|side| self.level(side, level)),
            difference: self.difference(level),
        }
    }

    fn level(&self, side: Side, level: Level) -> LevelFigures {
        let name = level.name();
        let Some(leg) = self.record.leg(side) else {
            return missing(self.no_leg(side));
        };
        match (leg.landmarks.get(name), leg.estimates.get(name)) {
            (Some(found), _) => self.found(found),
            (None, Some(estimate)) => self.estimated(level, estimate),
            (None, None) => missing(self.no_level(side, name)),
        }
    }

    fn found(&self, found: &LandmarkFigures) -> LevelFigures {
        let mark = if found.doubts.is_empty() { Mark::Sure } else { Mark::Doubtful };
        let length = match found.surface_length_mm {
            Some(mm) => Figure::cm(mm, found.height_sd_mm, mark, self.language),
            None => Figure::missing(self.on_the_foot()),
        };
        let girth = Figure::cm(found.girth_tape_mm, found.girth_sd_mm, mark, self.language);
        LevelFigures { girth, length, doubts: self.short(&found.doubts) }
    }

    fn estimated(&self, level: Level, of: &EstimateFigures) -> LevelFigures {
        let figure = |mm, sd_mm| Figure::cm(mm, sd_mm, Mark::Estimated, self.language);
        let length = if level < Level::B {
            Figure::missing(self.on_the_foot())
        } else {
            let height = figure(of.height_mm, of.height_sd_mm);
            Figure { value: format!("h {}", height.value), ..height }
        };
        LevelFigures {
            girth: figure(of.girth_tape_mm, of.girth_sd_mm),
            length,
            doubts: self.short(&of.doubts),
        }
    }

    fn on_the_foot(&self) -> &'static str {
        self.language.text("report.missing.on_foot")
    }

    fn short(&self, doubts: &[String]) -> Vec<String> {
        doubts.iter().map(|code| short(code, self.language)).collect()
    }

    /// Why a level has no figure on a leg that was measured.
    fn no_level(&self, side: Side, level: &str) -> &'static str {
        let (absent, implausible) = ("level-absent", "level-implausible");
        if self.is_found(absent, side, Some(level)) {
            self.language.text("report.missing.level_absent")
        } else if self.is_found(implausible, side, Some(level)) {
            self.language.text("report.missing.level_implausible")
        } else {
            self.language.text("report.missing.level_not_seen")
        }
    }

    fn difference(&self, level: Level) -> Figure {
        let levels = self.record.differences.iter().flat_map(|of| &of.levels);
        let mut of_level = levels.filter(|at| at.level == level.name());
        match of_level.next() {
            Some(at) => Figure::cm_difference(at.girth_tape_mm, at.girth_sd_mm, self.language),
            None if self.is_estimated_only(level) => {
                Figure::missing(self.language.text("report.missing.only_estimated"))
            }
            None => Figure::missing(self.language.text("report.missing.not_on_both")),
        }
    }

    /// Whether both legs have a level, but at least one of them only by estimate.
    fn is_estimated_only(&self, level: Level) -> bool {
        let has = |leg: &LegFigures| {
            let name = level.name();
            leg.landmarks.contains_key(name) || leg.estimates.contains_key(name)
        };
        self.legs().into_iter().all(|leg| leg.is_some_and(has))
    }
}

fn missing(why: &str) -> LevelFigures {
    let figure = || Figure::missing(why);
    LevelFigures { girth: figure(), length: figure(), doubts: Vec::new() }
}
