//! The content of a finding as data: a key for its text, and the figures in it. Records keep it next to
//! the English message, and other languages make their text from it.

use std::collections::BTreeMap;

use gaiter_cad::{CadFault, End};
use gaiter_language::{Language, fill};
use gaiter_leg::comparison::difference::LegsDiffer;
use gaiter_leg::comparison::opinion::{Measure, SecondOpinion};
use gaiter_leg::figure::{self, Said};
use gaiter_leg::frame::soles::FloorDoubt;
use gaiter_leg::sections::around::Around;
use gaiter_leg::{Side, What};
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
    pub figures: BTreeMap<String, StatementFigure>,
}

/// A figure in a statement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema), schemars(rename = "Figure"))]
#[serde(untagged)]
pub enum StatementFigure {
    /// A number, to 10⁻⁶.
    Number(f64),
    /// The name of a level or file, or quoted words.
    Name(String),
    /// A nested statement.
    Statement(Box<Statement>),
}

impl Statement {
    fn new(key: &str) -> Statement {
        Statement { is: key.to_owned(), figures: BTreeMap::new() }
    }

    fn with(mut self, name: &str, figure: StatementFigure) -> Statement {
        self.figures.insert(name.to_owned(), figure);
        self
    }

    /// A figure that is not finite is left out, because JSON cannot hold it, and shown as [`NOT_KNOWN`].
    fn number(self, name: &str, value: f64) -> Statement {
        if value.is_finite() {
            self.with(name, StatementFigure::Number(rounding::share(value)))
        } else {
            self
        }
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
                StatementFigure::Number(value) => match decimals {
                    "*" => rounding::shortest(*value, language),
                    "around" => {
                        let part = Around::at(*value).word();
                        language.word("around", part).to_owned()
                    }
                    "cm" => rounding::number(*value / 10.0, 0, language),
                    "" => rounding::number(*value, 0, language),
                    places => rounding::number(*value, places.parse().ok()?, language),
                },
                StatementFigure::Name(name) => name.clone(),
                StatementFigure::Statement(within) => within.in_words(language)?,
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
                Statement::new(key).number("off_mm", fault.off_mm)
            }
            CadFault::Tessellation(TessellationFault::NoTolerance { tolerance_mm }) => {
                Statement::new("mesh-no-tolerance").number("tolerance_mm", tolerance_mm)
            }
            CadFault::Tessellation(TessellationFault::TooFine { tolerance_mm, triangles }) => {
                let fine = Statement::new("mesh-too-fine").number("tolerance_mm", tolerance_mm);
                fine.number("triangles", triangles)
            }
            CadFault::Tessellation(TessellationFault::Degenerate { u, v }) => {
                Statement::new("surface-no-tube").number("u", u).number("v", v)
            }
        };
        let file = StatementFigure::Name(name.to_owned());
        Statement::new("file-not-made")
            .with("file", file)
            .with("why", StatementFigure::Statement(Box::new(why)))
    }

    /// The statement of a finding.
    pub fn of_finding(what: &What) -> Statement {
        let statement = Statement::from(what.said());
        Statement { is: text_key(what).map_or(statement.is, str::to_owned), ..statement }
    }
}

/// The key of a finding's text where its figures choose between several; `None` where the key is the code.
fn text_key(what: &What) -> Option<&'static str> {
    Some(match what {
        What::FloorUnclear(FloorDoubt::Raised { .. }) => "toes-high",
        What::HolesFilled { count: 1, .. } => "hole-filled",
        What::SurfaceHoles { count: 1, .. } => "surface-hole",
        What::LegsDiffer(LegsDiffer::Girth { larger, .. }) => match larger {
            Side::Left => "left-girth-larger",
            Side::Right => "right-girth-larger",
        },
        What::LegsDiffer(LegsDiffer::Volume { larger, .. }) => match larger {
            Side::Left => "left-volume-larger",
            Side::Right => "right-volume-larger",
        },
        What::SecondOpinion(SecondOpinion::Disagrees { measure, .. }) => match measure {
            Measure::Stature => "ord-stature-disagrees",
            Measure::Calf => "ord-calf-disagrees",
            Measure::Ankle => "ord-ankle-disagrees",
        },
        _ => return None,
    })
}

impl From<Said> for Statement {
    fn from(said: Said) -> Statement {
        said.figures.into_iter().fold(Statement::new(said.code), |statement, (name, figure)| {
            match figure {
                figure::Figure::Number(value) => statement.number(name, value),
                figure::Figure::Name(words) => statement.with(name, StatementFigure::Name(words)),
                figure::Figure::Reason(why) => {
                    statement.with(name, StatementFigure::Statement(Box::new(why.into())))
                }
            }
        })
    }
}
