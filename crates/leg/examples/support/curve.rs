//! A leg's girth curve beside the true one.

use gaiter_leg::{LegReport, Level};
use serde_json::Value;

use super::truth::Profile;

/// The curve is shifted by up to this much, mm: unseen soles put the floor no further off.
const SHIFT_MAX_MM: f64 = 8.0;

/// … in steps of a quarter of a millimetre.
const SHIFTS_PER_MM: f64 = 4.0;

/// Where the girth curve ends on a leg without D, as a share of the crotch's height: a knee.
const TO_CROTCH_SHARE: f64 = 0.55;

/// The curve is compared from this far below B to this far above D, mm.
const BEYOND_MM: [f64; 2] = [10.0, 20.0];

/// The measured sections from below the true B to above the true D, and a true profile.
pub struct Curve {
    /// Heights and tape girths, mm.
    pub measured: Vec<(f64, f64)>,
    profile: Profile,
    /// By how much the measured heights must be raised to fit the profile best, mm: the floor's
    /// error, which the heights of the levels already tell.
    pub shift_mm: f64,
}

impl Curve {
    /// The curve of a leg, whose own truth tells where B and D are, beside a profile.
    pub fn new(leg: &LegReport, own: &Value, beside: &Value, crotch_mm: f64) -> Curve {
        let at = |level: Level| own["landmarks"][level.name()]["height_mm"].as_f64();
        let from_mm = at(Level::B).unwrap_or(f64::NAN) - BEYOND_MM[0];
        let to_mm = at(Level::D).unwrap_or(TO_CROTCH_SHARE * crotch_mm) + BEYOND_MM[1];
        let rows = leg.girth_curve.rows.iter().filter_map(|row| row.measured);
        let between = rows.filter(|(height_mm, _)| (from_mm..=to_mm).contains(height_mm));
        let mut curve = Curve {
            measured: between.map(|(height_mm, girth)| (height_mm, girth.tape_mm)).collect(),
            profile: Profile::named(beside, "tape_mm"),
            shift_mm: 0.0,
        };
        let steps = (SHIFT_MAX_MM * SHIFTS_PER_MM) as i32;
        let shifts = (-steps..=steps).map(|step| f64::from(step) / SHIFTS_PER_MM);
        let squares = shifts.map(|shift_mm| (curve.mean_square(shift_mm), shift_mm));
        curve.shift_mm =
            squares.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, shift_mm)| shift_mm);
        curve
    }

    /// Girths measured minus true with the measured heights raised by so much, mm.
    pub fn errors(&self, raised_mm: f64) -> impl Iterator<Item = f64> {
        let error = move |&(height_mm, tape_mm): &(f64, f64)| {
            Some(tape_mm - self.profile.at(height_mm + raised_mm)?)
        };
        self.measured.iter().filter_map(error)
    }

    /// The mean square of the errors, mm².
    pub fn mean_square(&self, raised_mm: f64) -> f64 {
        let squares: Vec<f64> = self.errors(raised_mm).map(|error| error * error).collect();
        squares.iter().sum::<f64>() / squares.len() as f64
    }
}
