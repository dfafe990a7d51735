//! The arguments of `gaiter calibrate`.

use std::path::PathBuf;

use gaiter_leg::method::{UnitChoice, Up};
use gaiter_leg::phantom::Phantom;

use super::of_words;
use crate::config::words::{UNITS, UPS};

/// `gaiter calibrate`
#[derive(Debug, clap::Args)]
pub struct CalibrateArgs {
    /// The scan of the known body
    #[arg(value_name = "SCAN")]
    pub scan: PathBuf,
    /// Its girths in cm: 35.2 for a cylinder, or girths at heights, 10:35.2,30:38.1 [default: those of
    /// --config]
    #[arg(long, value_name = "GIRTHS", required_unless_present = "config")]
    pub girths: Option<Phantom>,
    /// The largest difference that counts as none, in mm [default: 2, or that of --config]
    #[arg(long, value_name = "MM", value_parser = tolerance_mm)]
    pub tolerance: Option<f64>,
    /// The unit of the scan's coordinates; auto finds it from the girths
    #[arg(long, value_parser = of_words(UNITS))]
    pub unit: Option<UnitChoice>,
    /// The axis of the scan that points up [default: y]
    #[arg(long, value_parser = of_words(UPS))]
    pub up: Option<Up>,
    /// Print the check as JSON, for programs
    #[arg(long)]
    pub json: bool,
    /// Take girths, tolerance, unit, up and method from this configuration, unless an option overrides
    /// them
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

/// Parses a tolerance in mm: from the noise of a girth to what no scanner is off by, as `phantom.tolerance`.
fn tolerance_mm(text: &str) -> Result<f64, String> {
    let mm = text.trim().parse::<f64>().ok().filter(|mm| (0.5..=20.0).contains(mm));
    mm.ok_or_else(|| "a tolerance in mm is at least 0.5 and at most 20".to_owned())
}
