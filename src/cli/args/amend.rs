//! `gaiter amend`.

use std::ffi::OsString;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use gaiter_leg::Side;
use gaiter_record::measure::amendment::Subject;

use super::{AskArgs, of_words};
use crate::config::words::Words;

/// The words for the legs.
const LEGS: Words<Side> = &[("right", Side::Right), ("left", Side::Left)];

/// `gaiter amend`
#[derive(Debug, clap::Args)]
pub struct AmendArgs {
    /// A record's folder; or a scan of the station: the first digits of its id, at least four
    #[arg(value_name = "RECORD|ID")]
    pub record: OsString,
    /// The leg
    #[arg(long, value_parser = of_words(LEGS))]
    pub leg: Side,
    /// The level, or a length of the foot or of the inside of the leg
    #[arg(long, value_parser = level(), ignore_case = true)]
    pub level: Subject,
    /// Girth of the level by tape, cm
    #[arg(long, value_name = "CM", value_parser = cm)]
    pub girth_cm: Option<f64>,
    /// Height of the level above the floor, cm; without --girth-cm the scan's girth there counts
    #[arg(long, value_name = "CM", value_parser = cm)]
    pub height_cm: Option<f64>,
    /// Length or breadth of the foot, or length of the inside of the leg, cm
    #[arg(long, value_name = "CM", value_parser = cm,
          conflicts_with_all = ["girth_cm", "height_cm"])]
    pub length_cm: Option<f64>,
    /// It cannot be measured on this patient
    #[arg(long, conflicts_with_all = ["girth_cm", "height_cm", "length_cm"])]
    pub not_measurable: bool,
    /// Take back what was set by hand: the scan's value counts again
    #[arg(long,
          conflicts_with_all = ["girth_cm", "height_cm", "length_cm", "not_measurable"])]
    pub take_back: bool,
    /// Why, in a line; it is printed
    #[arg(long, value_name = "TEXT")]
    pub reason: String,
    /// Who measured; it is printed
    #[arg(long, value_name = "NAME")]
    pub by: String,
    /// Accept a value that is more than 15 % off the scan's
    #[arg(long)]
    pub sure: bool,
    /// Ask for the patient's id: needed if the scan belongs to more than one patient
    #[arg(long)]
    pub of: bool,
    /// The station, and the output format. Its configuration also gives language, garment and paper of a
    /// record in a folder.
    #[command(flatten)]
    pub ask: AskArgs,
}

fn level() -> impl TypedValueParser<Value = Subject> {
    PossibleValuesParser::new(Subject::all().map(Subject::word))
        .try_map(|text| Subject::of_any_case(&text).ok_or("no such level"))
}

/// Parses a length in cm, with a decimal point or comma.
fn cm(text: &str) -> Result<f64, String> {
    let cm = text.replace(',', ".").parse::<f64>().ok().filter(|cm| cm.is_finite());
    cm.ok_or_else(|| "write a length in cm as 38.5 or 38,5, without a unit".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_has_a_point_or_a_comma_and_no_unit() {
        for text in ["38.5", "38,5"] {
            assert_eq!(cm(text), Ok(38.5));
        }
        for text in ["38.5cm", "38,5 cm", "", "inf", "1.000,5"] {
            assert!(cm(text).is_err(), "{text}");
        }
    }
}
