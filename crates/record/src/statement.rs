//! The content of a finding as data: a key for its text, and the figures in it. Records keep it next to
//! the English message, and other languages make their text from it.

use std::collections::BTreeMap;
use std::fmt;

use gaiter_cad::{CadFault, End};
use gaiter_language::{Language, fill};
use gaiter_leg::comparison::difference::LegsDiffer;
use gaiter_leg::comparison::opinion::{Measure, SecondOpinion};
use gaiter_leg::doubt::Doubt;
use gaiter_leg::frame::soles::FloorDoubt;
use gaiter_leg::frame::stance::FeetUnclear;
use gaiter_leg::level::By;
use gaiter_leg::levels::at_height::NoGirth;
use gaiter_leg::levels::extremum::Absence;
use gaiter_leg::sections::around::Around;
use gaiter_leg::sections::axis_fit::{AxisFault, CENTROIDS_MIN, NoThigh, POINTS_MIN};
use gaiter_leg::surface::nurbs::NoSurface;
use gaiter_leg::{LegFault, Level, Side, What};
use gaiter_spline::tessellate::TessellationFault;
use serde::{Deserialize, Serialize};

use super::rounding;

/// In the place of a figure that a statement does not have.
const NOT_KNOWN: &str = "?";

/// A statement of a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Statement {
    /// The stable key of its text.
    pub is: String,
    /// The figures in the text, by name. Names end with the unit.
    #[serde(flatten)]
    pub figures: BTreeMap<String, Figure>,
}

/// A figure in a statement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Figure {
    /// A number, to 10⁻⁶.
    Number(f64),
    /// The name of a level or file, or quoted words.
    Name(String),
    /// A nested statement.
    Statement(Box<Statement>),
}

impl Statement {
    fn of(key: &str) -> Statement {
        Statement { is: key.to_owned(), figures: BTreeMap::new() }
    }

    fn with(mut self, name: &str, figure: Figure) -> Statement {
        self.figures.insert(name.to_owned(), figure);
        self
    }

    /// A figure that is not finite is left out, because JSON cannot say it, and told as [`NOT_KNOWN`].
    fn number(self, name: &str, value: f64) -> Statement {
        if value.is_finite() {
            self.with(name, Figure::Number(rounding::share(value)))
        } else {
            self
        }
    }

    fn count(self, name: &str, count: usize) -> Statement {
        self.number(name, count as f64)
    }

    fn level(self, name: &str, level: Level) -> Statement {
        self.with(name, Figure::Name(level.name().to_owned()))
    }

    fn because(self, why: Statement) -> Statement {
        self.with("why", Figure::Statement(Box::new(why)))
    }

    /// With words that are English in every language: those of a file, or for experts.
    fn quoting(self, words: &impl fmt::Display) -> Statement {
        self.with("why", Figure::Name(words.to_string()))
    }

    /// Its text in English, as records keep it beside the statement.
    pub fn in_english(&self) -> String {
        self.in_words(Language::En).unwrap_or_else(|| self.is.clone())
    }

    /// Its text in a language. `None` if it, or a statement within it, is unknown.
    pub fn in_words(&self, language: Language) -> Option<String> {
        let template = language.find(&format!("statement.{}", self.is))?;
        fill(template, |name, decimals| {
            let Some(figure) = self.figures.get(name) else { return Some(NOT_KNOWN.to_owned()) };
            Some(match figure {
                Figure::Number(value) => match decimals {
                    "*" => rounding::shortest(*value, language),
                    "around" => {
                        let part = Around::at(*value).word();
                        language.word("around", part).to_owned()
                    }
                    "cm" => rounding::number(*value / 10.0, 0, language),
                    "" => rounding::number(*value, 0, language),
                    places => rounding::number(*value, places.parse().ok()?, language),
                },
                Figure::Name(name) => name.clone(),
                Figure::Statement(within) => within.in_words(language)?,
            })
        })
    }

    /// The statement about a file that was not made.
    pub fn of_missing_file(name: &str, fault: &CadFault) -> Statement {
        let why = match *fault {
            CadFault::EndNotPlane(fault) => {
                let key = match fault.end {
                    End::First => "lower-end-not-plane",
                    End::Last => "upper-end-not-plane",
                };
                Statement::of(key).number("off_mm", fault.off_mm)
            }
            CadFault::Tessellation(TessellationFault::NoTolerance { tolerance_mm }) => {
                Statement::of("mesh-no-tolerance").number("tolerance_mm", tolerance_mm)
            }
            CadFault::Tessellation(TessellationFault::TooFine { tolerance_mm, triangles }) => {
                let fine = Statement::of("mesh-too-fine").number("tolerance_mm", tolerance_mm);
                fine.number("triangles", triangles)
            }
            CadFault::Tessellation(TessellationFault::Degenerate { u, v }) => {
                Statement::of("surface-no-tube").number("u", u).number("v", v)
            }
        };
        let file = Figure::Name(name.to_owned());
        Statement::of("file-not-made").with("file", file).because(why)
    }

    /// The statement of a finding.
    pub fn of_finding(what: &What) -> Statement {
        match what {
            What::LevelAbsent(absence) => Statement::of("level-absent").because(absence.into()),
            What::LevelImplausible { girth_mm } => {
                Statement::of("level-implausible").number("girth_mm", *girth_mm)
            }
            What::FacingUnchecked(why) => Statement::of("facing-unchecked").because(why.into()),
            What::FacingByCalves(why) => Statement::of("facing-by-calves").because(why.into()),
            What::FloorUnclear(FloorDoubt::Uneven { spread_mm }) => {
                Statement::of("floor-uneven").number("spread_mm", *spread_mm)
            }
            What::FloorUnclear(FloorDoubt::NotTurning) => Statement::of("feet-cut"),
            What::FloorUnclear(FloorDoubt::Raised { toes_mm }) => {
                Statement::of("toes-high").number("toes_mm", *toes_mm)
            }
            What::MirrorUnchecked => Statement::of("mirror-unchecked"),
            What::NoFaces => Statement::of("no-faces"),
            What::NoLineEnd => Statement::of("no-line-end"),
            What::Coarse { spacing_mm, ankle_sd_mm } => Statement::of("coarse")
                .number("spacing_mm", *spacing_mm)
                .number("girth_off_mm", 2.0 * ankle_sd_mm),
            What::FootForward { by_mm } => Statement::of("foot-forward").number("by_mm", *by_mm),
            What::ThighsTouch { from_mm } => {
                Statement::of("thighs-touch").number("from_mm", *from_mm)
            }
            What::Proportions { percent } => {
                Statement::of("proportions").number("percent", *percent)
            }
            What::CrownNotSeen { stature_mm } => {
                Statement::of("crown-not-seen").number("stature_mm", *stature_mm)
            }
            What::ThighAxisMissing(why) => Statement::of("thigh-axis-missing").because(why.into()),
            What::CrotchUncertain { sd_mm } => {
                Statement::of("crotch-uncertain").number("sd_mm", *sd_mm)
            }
            What::CrotchNotSeen => Statement::of("crotch-not-seen"),
            What::LegCut { end_mm } => Statement::of("leg-cut").number("end_mm", *end_mm),
            What::Doubtful(doubt) => doubt.into(),
            What::LegNotMeasured(fault) => Statement::of("leg-not-measured").because(fault.into()),
            What::NoSurface(fault) => fault.into(),
            What::SurfaceShort { from_mm, to_mm, wanted_from_mm, wanted_to_mm } => {
                Statement::of("surface-short")
                    .number("from_mm", *from_mm)
                    .number("to_mm", *to_mm)
                    .number("wanted_from_mm", *wanted_from_mm)
                    .number("wanted_to_mm", *wanted_to_mm)
            }
            What::HolesFilled { count, length_mm, width_mm, height_mm } => {
                Statement::of(if *count == 1 { "hole-filled" } else { "holes-filled" })
                    .count("count", *count)
                    .number("length_mm", *length_mm)
                    .number("width_mm", *width_mm)
                    .number("height_mm", *height_mm)
            }
            What::SurfaceHoles { count, length_mm, width_mm, height_mm, angle_deg } => {
                Statement::of(if *count == 1 { "surface-hole" } else { "surface-holes" })
                    .count("count", *count)
                    .number("length_mm", *length_mm)
                    .number("width_mm", *width_mm)
                    .number("height_mm", *height_mm)
                    .number("angle_deg", *angle_deg)
            }
            What::HeightNotMeasured { height_mm, why } => Statement::of("height-not-measured")
                .number("height_mm", *height_mm)
                .because(why.into()),
            What::LegsDiffer(differ) => differ.into(),
            What::SecondOpinion(opinion) => opinion.into(),
        }
    }
}

impl From<&NoSurface> for Statement {
    fn from(fault: &NoSurface) -> Statement {
        match *fault {
            NoSurface::TooFewRows { rows, needed, from_mm, to_mm } => {
                Statement::of("no-surface-too-few-sections")
                    .count("rows", rows)
                    .count("needed", needed)
                    .number("from_mm", from_mm)
                    .number("to_mm", to_mm)
            }
            NoSurface::Folded { height_mm } => {
                Statement::of("no-surface-folded").number("height_mm", height_mm)
            }
            NoSurface::NothingSeen => Statement::of("no-surface-nothing-seen"),
            NoSurface::Fit(ref fault) => Statement::of("no-surface-fit").quoting(fault),
        }
    }
}

impl From<&SecondOpinion> for Statement {
    fn from(opinion: &SecondOpinion) -> Statement {
        match *opinion {
            SecondOpinion::Unreadable { ref why } => Statement::of("ord-unreadable").quoting(why),
            SecondOpinion::Ambiguous { files } => {
                Statement::of("ord-ambiguous").count("files", files)
            }
            SecondOpinion::Unit { theirs_mm, ours_mm, factor } => Statement::of("ord-unit")
                .number("theirs_mm", theirs_mm)
                .number("ours_mm", ours_mm)
                .number("factor", factor),
            SecondOpinion::Disagrees { measure, theirs_mm, ours_mm } => {
                Statement::of(match measure {
                    Measure::Stature => "ord-stature-disagrees",
                    Measure::Calf => "ord-calf-disagrees",
                    Measure::Ankle => "ord-ankle-disagrees",
                })
                .number("theirs_mm", theirs_mm)
                .number("ours_mm", ours_mm)
            }
            SecondOpinion::Sides { left_mm, right_mm } => {
                Statement::of("ord-sides").number("left_mm", left_mm).number("right_mm", right_mm)
            }
        }
    }
}

impl From<&Doubt> for Statement {
    fn from(doubt: &Doubt) -> Statement {
        let said = Statement::of(doubt.code());
        match *doubt {
            Doubt::Shallow { prominence_mm } => said.number("prominence_mm", prominence_mm),
            Doubt::Flat { height_sd_mm } => said.number("height_sd_mm", height_sd_mm),
            Doubt::Double { other_height_mm } => said.number("other_height_mm", other_height_mm),
            Doubt::Several { other_height_mm } => said.number("other_height_mm", other_height_mm),
            Doubt::UnusualHeight { percent } => said.number("percent", percent),
            Doubt::Edge { end_mm } => said.number("end_mm", end_mm),
            Doubt::Gap { gap_deg } => said.number("gap_deg", gap_deg),
            Doubt::Scatter { rms_mm } => said.number("rms_mm", rms_mm),
            Doubt::Cloth { step_mm, height_mm } => {
                said.number("step_mm", step_mm).number("height_mm", height_mm)
            }
            // Two standard errors, as everywhere where a person reads how far off something may be.
            Doubt::ViewsApart { step_mm, girth_sd_mm } => {
                said.number("step_mm", step_mm).number("girth_off_mm", 2.0 * girth_sd_mm)
            }
            Doubt::Smoothed { girth_sd_mm } => said.number("girth_off_mm", 2.0 * girth_sd_mm),
            Doubt::GirthUncertain { girth_sd_mm } => said.number("girth_sd_mm", girth_sd_mm),
            Doubt::Folds { percent } => said.number("percent", percent),
            Doubt::KneeBent { bend_deg } => said.number("bend_deg", bend_deg),
            Doubt::BelowD { d_height_mm } => said.number("d_height_mm", d_height_mm),
            Doubt::NotSeen | Doubt::SoleNotSeen => said,
        }
    }
}

impl From<&Absence> for Statement {
    fn from(absence: &Absence) -> Statement {
        match *absence {
            Absence::NoTurn => Statement::of("no-turn"),
            Absence::BelowSearch { along_mm } => {
                Statement::of("below-search").number("along_mm", along_mm)
            }
            Absence::AboveSearch { along_mm } => {
                Statement::of("above-search").number("along_mm", along_mm)
            }
            Absence::Needs(level) => Statement::of("needs-level").level("level", level),
            Absence::Beyond(level) => Statement::of("beyond-level").level("level", level),
        }
    }
}

impl From<&FeetUnclear> for Statement {
    fn from(feet: &FeetUnclear) -> Statement {
        match *feet {
            FeetUnclear::NotSeen { points } => {
                Statement::of("foot-not-seen").count("points", points)
            }
            FeetUnclear::NoFoot { length_percent, width_percent } => Statement::of("no-foot")
                .number("length_percent", length_percent)
                .number("width_percent", width_percent),
            FeetUnclear::NoToes { ratio } => Statement::of("no-toes").number("ratio", ratio),
            FeetUnclear::Apart { spread_deg } => {
                Statement::of("feet-apart").number("spread_deg", spread_deg)
            }
            FeetUnclear::NotSquare { off_deg } => {
                Statement::of("toes-not-square").number("off_deg", off_deg)
            }
        }
    }
}

impl From<&LegFault> for Statement {
    fn from(fault: &LegFault) -> Statement {
        match *fault {
            LegFault::NotThere => Statement::of("leg-not-there"),
            LegFault::Axis(AxisFault::TooFewSections { found }) => {
                Statement::of("axis-too-few-sections")
                    .count("found", found)
                    .count("needed", CENTROIDS_MIN)
            }
            LegFault::Axis(AxisFault::TooFewPoints { found }) => {
                Statement::of("axis-too-few-points")
                    .count("found", found)
                    .count("needed", POINTS_MIN)
            }
            LegFault::Axis(AxisFault::Leaning { tilt_deg }) => {
                Statement::of("axis-leans").number("tilt_deg", tilt_deg)
            }
            LegFault::TooFewPoints => Statement::of("leg-too-few-points"),
            LegFault::TooFewSections { measured, planes } => Statement::of("leg-too-few-sections")
                .count("measured", measured)
                .count("planes", planes),
        }
    }
}

impl From<&NoThigh> for Statement {
    fn from(why: &NoThigh) -> Statement {
        match *why {
            NoThigh::NotSeen => Statement::of("thigh-not-seen"),
            NoThigh::TooBent { bend_deg } => {
                Statement::of("knee-bent-too-far").number("bend_deg", bend_deg)
            }
        }
    }
}

impl From<&NoGirth> for Statement {
    fn from(why: &NoGirth) -> Statement {
        match *why {
            NoGirth::Outside { from_mm, to_mm } => {
                Statement::of("outside-girths").number("from_mm", from_mm).number("to_mm", to_mm)
            }
            NoGirth::NotSeen => Statement::of("skin-not-seen"),
        }
    }
}

impl From<&LegsDiffer> for Statement {
    fn from(differ: &LegsDiffer) -> Statement {
        let key = |larger, [left, right]: [&'static str; 2]| match larger {
            Side::Left => left,
            Side::Right => right,
        };
        match *differ {
            LegsDiffer::Girth { larger, by_mm, sd_mm } => {
                Statement::of(key(larger, ["left-girth-larger", "right-girth-larger"]))
                    .number("by_mm", by_mm)
                    .number("sd_mm", sd_mm)
            }
            LegsDiffer::Volume { larger, by_ml, percent, sd_ml } => {
                Statement::of(key(larger, ["left-volume-larger", "right-volume-larger"]))
                    .number("by_ml", by_ml)
                    .number("percent", percent)
                    .number("sd_ml", sd_ml)
            }
        }
    }
}

impl From<&By> for Statement {
    fn from(by: &By) -> Statement {
        match *by {
            By::Turn => Statement::of("turning-point"),
            By::Steepest => Statement::of("largest-slope"),
            By::AboveB { distance_mm } => {
                Statement::of("above-b").number("distance_mm", distance_mm)
            }
            By::BelowCrotch { distance_mm } => {
                Statement::of("below-crotch").number("distance_mm", distance_mm)
            }
            By::HeelTape => Statement::of("heel-tape"),
            By::Knee { stature_share, above_d_mm: None } => {
                Statement::of("stature-share").number("share", stature_share)
            }
            By::Knee { stature_share, above_d_mm: Some(above_d_mm) } => Statement::of("knee")
                .number("stature_share", stature_share)
                .number("above_d_mm", above_d_mm),
            By::Between(low, high) => {
                Statement::of("halfway").level("low", low).level("high", high)
            }
            By::FootShares { medial, lateral } => {
                Statement::of("foot-shares").number("medial", medial).number("lateral", lateral)
            }
        }
    }
}
