//! Errors of many extractions against the truth, summed up.

use std::f64::consts::PI;
use std::fmt;
use std::iter::Sum;

use gaiter_leg::{LegReport, Level, Method, Side, extract};
use gaiter_scan::Format;
use serde_json::Value;

use super::truth::{Compared, Profile, compared, quantiles};

/// The levels that are turning points of the girth curve.
const LEVELS: [Level; 3] = [Level::B, Level::C, Level::D];

/// Absolute errors, mm, and counts.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Tape girth at B, C, D.
    pub girth_mm: [Vec<f64>; 3],
    /// Height of B, C and D.
    pub height_mm: Vec<f64>,
    /// Tape girth of every section from the true B to the true D.
    pub curve_mm: Vec<f64>,
    /// Step of the radius at ±180°, in the sections of the levels.
    pub seam_mm: Vec<f64>,
    /// Levels that the bodies have.
    pub levels: usize,
    /// … and that were not found, those of refused legs among them.
    pub missed: usize,
    /// Levels found that the bodies do not have.
    pub invented: usize,
    /// Legs without a report.
    pub legs_refused: usize,
    /// What was refused, and why.
    pub refusals: Vec<String>,
}

impl Tally {
    /// One extraction against the truth of its body.
    pub fn measure(bytes: &[u8], method: &Method, truth: &Value, name: &str) -> Tally {
        let mut tally = Tally::default();
        let (legs, findings) = match extract(bytes, Format::Obj, method) {
            Ok(extraction) => (extraction.legs, extraction.findings),
            Err(refusal) => {
                tally.refusals.push(format!("{name}: {refusal}"));
                (Vec::new(), Vec::new())
            }
        };
        for side in Side::BOTH {
            let true_leg = &truth["legs"][side.word()];
            let leg = legs.iter().find(|leg| leg.side == side);
            tally.levels(leg, true_leg);
            if let Some(leg) = leg {
                tally.sections(leg, true_leg);
                continue;
            }
            tally.legs_refused += 1;
            let own = findings.iter().filter(|finding| finding.side == Some(side));
            let refused = own.map(|finding| format!("{name} {}: {:?}", side.word(), finding.what));
            tally.refusals.extend(refused);
        }
        tally
    }

    fn levels(&mut self, leg: Option<&LegReport>, truth: &Value) {
        for (level, girths) in LEVELS.into_iter().zip(&mut self.girth_mm) {
            self.levels += usize::from(truth["landmarks"].get(level.name()).is_some());
            match compared(leg, level, truth) {
                Compared::Errors { girth_mm, height_mm } => {
                    girths.push(girth_mm.abs());
                    self.height_mm.push(height_mm.abs());
                }
                Compared::Missed => self.missed += 1,
                Compared::Invented => self.invented += 1,
                Compared::Absent | Compared::Undecidable => {}
            }
        }
    }

    fn sections(&mut self, leg: &LegReport, truth: &Value) {
        let seam =
            |curve: &gaiter_leg::sections::section::Curve| curve.radius(PI) - curve.radius(-PI);
        self.seam_mm.extend(leg.level_sections.iter().map(|at| seam(&at.section.curve).abs()));
        let at = |level: Level| truth["landmarks"][level.name()]["height_mm"].as_f64();
        let (Some(from_mm), Some(to_mm)) = (at(Level::B), at(Level::D)) else { return };
        let profile = Profile::named(truth, "tape_mm");
        let measured = leg.girth_curve.rows.iter().filter_map(|row| row.measured);
        let between = measured.filter(|(height_mm, _)| (from_mm..=to_mm).contains(height_mm));
        let errors = between
            .filter_map(|(height_mm, girth)| Some((girth.tape_mm - profile.at(height_mm)?).abs()));
        self.curve_mm.extend(errors);
    }

    /// Takes the errors of another in.
    pub fn add(&mut self, other: Tally) {
        self.girth_mm.iter_mut().zip(other.girth_mm).for_each(|(all, more)| all.extend(more));
        self.height_mm.extend(other.height_mm);
        self.curve_mm.extend(other.curve_mm);
        self.seam_mm.extend(other.seam_mm);
        self.levels += other.levels;
        self.missed += other.missed;
        self.invented += other.invented;
        self.legs_refused += other.legs_refused;
        self.refusals.extend(other.refusals);
    }

    /// Median and 95th percentile of the girth error at all levels, and what was missed.
    pub fn girth_cell(&self) -> String {
        let girths = self.girth_mm.concat();
        let [half, most, _] = quantiles(&girths);
        match (girths.len(), self.missed) {
            (0, missed) => format!("missed {missed} of {}", self.levels),
            (_, 0) => format!("{half:.2} / {most:.2}"),
            (_, missed) => format!("{half:.2} / {most:.2}, missed {missed} of {}", self.levels),
        }
    }
}

impl Sum for Tally {
    fn sum<I: Iterator<Item = Tally>>(tallies: I) -> Tally {
        let mut sum = Tally::default();
        tallies.for_each(|tally| sum.add(tally));
        sum
    }
}

/// The cells of a table's row.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = self.girth_mm.iter().chain([&self.height_mm, &self.curve_mm, &self.seam_mm]);
        for errors in all {
            let [half, most, worst] = quantiles(errors);
            write!(f, "{half:.2} / {most:.2} / {worst:.2} | ")?;
        }
        let Tally { missed, levels, invented, legs_refused, .. } = self;
        write!(f, "{missed} of {levels} | {invented} | {legs_refused}")
    }
}
