//! The measuring sheet: girth and height at every level in the order of order forms, feet, inside leg.

use std::fmt::Display;

use gaiter_leg::method::Tape;
use gaiter_leg::{Level, Side};

use super::super::{grouped, title};
use super::{LevelFigures, LevelRow, Levels, Report, ReportFigure, SheetColumns, SheetRow};
use crate::measure::amendment::{ByHand, Subject};
use crate::measure::{Absent, Length, Measure, girth_mm_at, why_absent};
use crate::report::Reliability;
use crate::rounding::{cm_words, number, tenths_words};
use crate::schema::LegFigures;
use crate::shown;

impl Report<'_> {
    pub(super) fn levels(&self) -> Levels {
        let rows: Vec<LevelRow> =
            Level::ALL.into_iter().rev().map(|level| self.row(level)).collect();
        Levels {
            title: self.text("report.sheet.title"),
            columns: SheetColumns {
                level: self.text("report.sheet.level"),
                legs: Side::FROM_FRONT.map(|side| self.leg_heading(side)),
                girth: self.text("report.sheet.girth"),
                height: self.text("report.sheet.height"),
                by_hand: [
                    self.text("report.sheet.girth_by_hand"),
                    self.text("report.sheet.height_by_hand"),
                ],
            },
            key: self.key(&rows),
            rows,
            lengths: self.lengths(),
            doubts: self.doubts_of_levels(),
            by_hand: self.by_hand(),
            tilted: self.tilted(),
        }
    }

    fn row(&self, level: Level) -> LevelRow {
        LevelRow {
            level: level.name().to_owned(),
            place: self.language.word("level", level.name()).to_owned(),
            is_needed: self.garment.levels().contains(&level),
            has_height: level >= Level::B,
            legs: Side::FROM_FRONT.map(|side| self.level(side, level)),
        }
    }

    fn level(&self, side: Side, level: Level) -> LevelFigures {
        match Measure::find(self.record, side, level) {
            Ok(measure) => self.measured(&measure),
            Err(absent) => missing(self.no_level(side, level, absent)),
        }
    }

    fn measured(&self, measure: &Measure<'_>) -> LevelFigures {
        let figure = |length: Length| self.length(length, measure.mark_of(length));
        LevelFigures {
            girth: figure(measure.girth),
            height: measure.height.map_or_else(|| ReportFigure::plain(NO_HEIGHT), figure),
        }
    }

    /// A length. What a person set has no uncertainty that is known here.
    fn length(&self, Length { mm, sd_mm, is_by_hand }: Length, mark: Reliability) -> ReportFigure {
        let figure = ReportFigure::cm(mm, sd_mm, mark, self.language);
        match is_by_hand {
            true => ReportFigure { margin: None, ..figure },
            false => figure,
        }
    }

    /// Why a level has no figure on a leg that was measured; where the other leg has it, also the girth at
    /// the other leg's height.
    fn no_level(&self, side: Side, level: Level, absent: Absent) -> String {
        let why = why_absent(self.record, side, level, absent);
        let at_other = self.girth_at_other_height(side, level);
        match at_other.filter(|_| absent == Absent::NotFound) {
            Some((height_mm, girth_mm)) => {
                let [height, girth] = [height_mm, girth_mm].map(|mm| cm_words(mm, self.language));
                let words: [(&str, &dyn Display); 3] =
                    [("why", &self.text(why)), ("height", &height), ("girth", &girth)];
                self.filled("report.missing.level_at_other", &words)
            }
            None => self.text(why),
        }
    }

    /// Height of the level on the other leg, and the girth of this leg there, mm.
    fn girth_at_other_height(&self, side: Side, level: Level) -> Option<(f64, f64)> {
        let height_mm = self.record.leg(side.other())?.landmarks.get(level.name())?.height_mm;
        Some((height_mm, girth_mm_at(self.record.leg(side)?, height_mm)?))
    }

    /// Foot and inside leg, which have one figure a leg.
    fn lengths(&self) -> Vec<SheetRow> {
        let row = |key: &'static str, subject: Subject| SheetRow {
            head: self.text(key),
            figures: Side::FROM_FRONT.map(|side| self.length_of(side, subject)),
        };
        vec![
            row("report.sheet.foot_length", Subject::FootLength),
            row("report.sheet.foot_breadth", Subject::FootBreadth),
            row("report.sheet.inside_leg", Subject::InsideLeg),
        ]
    }

    fn length_of(&self, side: Side, subject: Subject) -> ReportFigure {
        let is_inside_leg = subject == Subject::InsideLeg;
        let is_doubted = is_inside_leg && self.record.has_finding("crotch-uncertain");
        match Length::find(self.record, side, subject) {
            Ok(length) if length.is_by_hand => self.length(length, Reliability::ByHand),
            Ok(length) if is_inside_leg => self
                .length(length, if is_doubted { Reliability::Doubtful } else { Reliability::Sure }),
            // A foot's length has no standard error.
            Ok(length) => ReportFigure::plain(cm_words(length.mm, self.language)),
            Err(Absent::NotMeasurable) => {
                ReportFigure::missing(self.language.text("report.missing.not_measurable"))
            }
            Err(Absent::NotFound) if self.record.leg(side).is_none() => {
                ReportFigure::missing(self.no_leg(side))
            }
            Err(Absent::NotFound) if is_inside_leg => {
                ReportFigure::missing(self.language.text("report.missing.level_not_seen"))
            }
            Err(Absent::NotFound) => {
                ReportFigure::missing(self.language.text("report.missing.foot_not_seen"))
            }
        }
    }

    /// How to read the signs on the sheet.
    fn key(&self, rows: &[LevelRow]) -> String {
        let figures = rows.iter().flat_map(|row| &row.legs);
        let figures = figures.flat_map(|leg| [&leg.girth, &leg.height]);
        let marks: Vec<Reliability> = figures.map(|figure| figure.mark).collect();
        let has = |mark| marks.contains(&mark);
        let keys = [
            (true, "report.sheet.key_bold"),
            (true, "report.sheet.key_margin"),
            (has(Reliability::Estimated), "report.sheet.key_estimated"),
            (has(Reliability::Doubtful), "report.sheet.key_doubtful"),
            (has(Reliability::ByHand), "report.sheet.key_by_hand"),
        ];
        let words = keys.into_iter().filter(|(is_used, _)| *is_used);
        words.map(|(_, key)| self.language.text(key)).collect::<Vec<_>>().join(" ")
    }

    /// The doubts about measured figures of the sheet, a line for each leg that has any: `Right leg – Height uncertain:
    /// B1; Skin partly not seen: C, B.`
    fn doubts_of_levels(&self) -> Vec<String> {
        let of_leg = |side: Side| {
            let doubted = Level::ALL
                .into_iter()
                .rev()
                .filter_map(|level| Some((level, Measure::find(self.record, side, level).ok()?)))
                // An estimate bears its own mark, and is measured by hand anyhow.
                .filter(|(_, of)| !of.is_estimate)
                .flat_map(|(level, of)| {
                    let named = move |code| (title(code, self.language), level.name());
                    of.doubts.into_iter().map(named)
                });
            let group =
                |(word, levels): &(&str, Vec<&str>)| format!("{word}: {}", levels.join(", "));
            let sentences: Vec<String> = grouped(doubted).iter().map(group).collect();
            let leg = self.leg_heading(side);
            (!sentences.is_empty()).then(|| format!("{leg} – {}.", sentences.join("; ")))
        };
        Side::FROM_FRONT.into_iter().filter_map(of_leg).collect()
    }
}

/// In the place of the height of a level on the foot, where the tape is not level.
const NO_HEIGHT: &str = "–";

fn missing(why: String) -> LevelFigures {
    let figure = || ReportFigure::missing(&why);
    LevelFigures { girth: figure(), height: figure() }
}

// What people set in place of the scan's figures.

impl Report<'_> {
    /// A line for each measure that a person set: the value, the scan's beside it, why, who and when.
    pub(super) fn by_hand(&self) -> Vec<String> {
        let sides = Side::FROM_FRONT.into_iter();
        let of_leg = |side| Subject::all().filter_map(move |of| self.set_by_hand(side, of));
        sides.flat_map(of_leg).collect()
    }

    fn set_by_hand(&self, side: Side, subject: Subject) -> Option<String> {
        let hand = self.record.by_hand(side, subject)?;
        let values = match subject {
            _ if hand.is_not_measurable => self.text("report.missing.not_measurable"),
            Subject::Level(level) => self.level_by_hand(side, level, &hand),
            length => {
                let scanned = Length::scanned_of(self.record, side, length).map(|of| of.mm);
                self.with_scanned("report.by_hand.length", hand.length_mm?, scanned)
            }
        };
        let words: [(&str, &dyn Display); 6] = [
            ("leg", &self.leg_heading(side)),
            ("measure", &subject.name(self.language)),
            ("values", &values),
            ("reason", &shown::id(&hand.last.reason)),
            ("by", &shown::id(&hand.last.by)),
            ("when", &self.local(hand.last.at)),
        ];
        Some(self.filled("report.by_hand.line", &words))
    }

    fn level_by_hand(&self, side: Side, level: Level, hand: &ByHand<'_>) -> String {
        let scanned = self.record.leg(side).and_then(|leg| Measure::scanned(leg, level));
        let girth_mm = scanned.as_ref().map(|of| of.girth.mm);
        let height_mm = scanned.and_then(|of| of.height).map(|of| of.mm);
        let girth = hand.girth_mm.map(|mm| ("report.by_hand.girth", mm, girth_mm));
        let height = hand.height_mm.map(|mm| ("report.by_hand.height", mm, height_mm));
        // Where only the height was set, the girth is another than at the scan's height.
        let there = Measure::find(self.record, side, level).ok().filter(|of| !of.girth.is_by_hand);
        let there = there.filter(|_| hand.height_mm.is_some());
        let there = there.map(|of| ("report.by_hand.girth_there", of.girth.mm, girth_mm));
        let text = |(key, mm, scanned_mm)| self.with_scanned(key, mm, scanned_mm);
        [girth, height, there].into_iter().flatten().map(text).collect::<Vec<_>>().join(", ")
    }

    /// `girth 38.5 cm (scan: 38.2)`
    fn with_scanned(&self, key: &'static str, mm: f64, scanned_mm: Option<f64>) -> String {
        let scanned = match scanned_mm {
            Some(mm) => cm_words(mm, self.language),
            None => self.text("report.missing.level_absent"),
        };
        self.filled(key, &[("cm", &cm_words(mm, self.language)), ("scan", &scanned)])
    }
}

// Where a tape that is not held square reads another girth.

/// The tilt that is reported, degrees: one that nobody sees while laying the tape, a difference in height of
/// 6 mm between the two sides of a calf of 110 mm.
const TILT_DEG: f64 = 3.0;

/// Only a difference above this is reported, mm. Less is lost in the scatter of tapes: one person's readings
/// of a leg differ by 3 % (te Slaa 2011), and order forms have steps of up to 5 mm.
const REPORTED_MM: f64 = 2.0;

impl Report<'_> {
    /// Where the tilt matters, on both legs, and how to hold the tape; `None` where it does not.
    pub(super) fn tilted(&self) -> Option<String> {
        let off = |side: Side| Some((side, off_by_tilt(self.record.leg(side)?)));
        let legs = Side::FROM_FRONT.into_iter().filter_map(off);
        let legs: Vec<(Side, Vec<(Level, f64)>)> =
            legs.filter(|(_, off)| !off.is_empty()).collect();
        let highest = legs.iter().filter_map(|(_, off)| Some(off.first()?.0)).max()?;
        let per_leg: Vec<String> =
            legs.iter().map(|(side, off)| self.tilted_at(*side, off)).collect();
        let deg = number(TILT_DEG, 0, self.language);
        let words: [(&str, &dyn Display); 2] = [("deg", &deg), ("legs", &per_leg.join("; "))];
        let sentence = self.filled("report.levels.tilted", &words);
        // In the other planes, a tape that is held square reads another girth than that of the record.
        let plane = self.record.made_by.method.get("tape").map(String::as_str);
        let hold = match highest > Level::D {
            true => "report.levels.hold_square_to_both",
            false => "report.levels.hold_square",
        };
        let how = (plane == Some(Tape::Shank.word())).then(|| self.text(hold));
        Some([Some(sentence), how].into_iter().flatten().collect::<Vec<_>>().join(" "))
    }

    /// `right leg D 2.7 mm, C 2.1 mm`
    fn tilted_at(&self, side: Side, off: &[(Level, f64)]) -> String {
        let at = |(level, off_mm): &(Level, f64)| {
            let mm = tenths_words(*off_mm, self.language);
            self.filled("report.levels.tilted_at", &[("level", &level.name()), ("mm", &mm)])
        };
        let levels = off.iter().map(at).collect::<Vec<_>>().join(", ");
        format!("{} {levels}", self.leg(side))
    }
}

/// The levels where the tilt matters, highest first, and what it does to their girths, mm.
fn off_by_tilt(leg: &LegFigures) -> Vec<(Level, f64)> {
    let off = |level: Level| {
        let off_mm = TILT_DEG * leg.landmarks.get(level.name())?.girth_per_deg_mm?;
        (off_mm > REPORTED_MM).then_some((level, off_mm))
    };
    Level::ALL.into_iter().rev().filter_map(off).collect()
}
