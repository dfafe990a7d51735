//! Leg volume from girths at fixed places, as clinics compute it from a tape: from truncated cones between
//! neighbouring places, or from discs about each place.
//!
//! The two differ by up to 5 % on a tapering leg with the girths at a disc's end, and by less than 1 % with
//! the girth at its middle, as here. Volumes of different methods are never compared.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

/// Cubic millimetres in a millilitre.
pub(super) const MM3_PER_ML: f64 = 1000.0;

word_enum! {
    /// How a volume is made of girths at fixed places.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub enum VolumeBy {
        /// Truncated cones between neighbouring places: h / 12π · (C₁² + C₁C₂ + C₂²).
        #[default]
        Cones => "cones",
        /// Discs, each with its place in the middle: h / 4π · C². With h = 4 cm, the sum of C² / π (Kuhnke).
        Discs => "discs",
    }
}

/// A part of the leg whose volume follows from one girth or two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Lower end, mm along the axis from the floor.
    pub from_mm: f64,
    /// Upper end, mm along the axis from the floor.
    pub to_mm: f64,
    /// The volume, mL.
    pub ml: f64,
    /// How much the volume grows with the girth at its lower place and at its upper one, mL per mm. A disc
    /// has only the first.
    pub ml_per_mm: [f64; 2],
}

impl VolumeBy {
    /// The piece that begins at a place, mm along the axis, or has it in its middle. `girths_mm` are the
    /// girths there and one step above. `None` if the method needs a girth that is missing.
    pub fn piece(self, at_mm: f64, step_mm: f64, girths_mm: [Option<f64>; 2]) -> Option<Piece> {
        let [low, high] = girths_mm;
        match self {
            VolumeBy::Cones => {
                let (low, high) = (low?, high?);
                let factor = step_mm / (12.0 * PI) / MM3_PER_ML;
                Some(Piece {
                    from_mm: at_mm,
                    to_mm: at_mm + step_mm,
                    ml: factor * (low * low + low * high + high * high),
                    ml_per_mm: [2.0 * low + high, low + 2.0 * high].map(|sum| factor * sum),
                })
            }
            VolumeBy::Discs => {
                let low = low?;
                let factor = step_mm / (4.0 * PI) / MM3_PER_ML;
                Some(Piece {
                    from_mm: at_mm - step_mm / 2.0,
                    to_mm: at_mm + step_mm / 2.0,
                    ml: factor * low * low,
                    ml_per_mm: [2.0 * factor * low, 0.0],
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_MM: f64 = 40.0;

    /// Girth of a straight cone: 200 mm at the floor, 0.5 mm more per mm.
    fn girth_mm(at_mm: f64) -> f64 {
        200.0 + 0.5 * at_mm
    }

    /// The exact volume of that cone between two places: the integral of C² / 4π, mL.
    fn exact_ml(from_mm: f64, to_mm: f64) -> f64 {
        let cube = |at_mm: f64| girth_mm(at_mm).powi(3) / (3.0 * 0.5);
        (cube(to_mm) - cube(from_mm)) / (4.0 * PI) / 1000.0
    }

    fn pieces(by: VolumeBy) -> Vec<Piece> {
        let piece = |step: u32| {
            let at_mm = STEP_MM * f64::from(step);
            let girths_mm = [at_mm, at_mm + STEP_MM].map(|at_mm| Some(girth_mm(at_mm)));
            by.piece(at_mm, STEP_MM, girths_mm)
        };
        (2..16).filter_map(piece).collect()
    }

    #[test]
    fn cones_of_a_cone_are_exact() {
        let sum: f64 = pieces(VolumeBy::Cones).iter().map(|piece| piece.ml).sum();
        assert!((sum / exact_ml(80.0, 640.0) - 1.0).abs() < 1e-12, "{sum}");
    }

    #[test]
    fn discs_of_4_cm_are_the_sum_of_squared_girths_in_cm_over_pi() {
        let discs = pieces(VolumeBy::Discs);
        let sum: f64 = discs.iter().map(|piece| piece.ml).sum();
        let kuhnke: f64 =
            (2..16).map(|step| (girth_mm(STEP_MM * f64::from(step)) / 10.0).powi(2) / PI).sum();
        assert!((sum / kuhnke - 1.0).abs() < 1e-12, "{sum} {kuhnke}");
        assert_eq!((discs[0].from_mm, discs[13].to_mm), (60.0, 620.0));
        let share = sum / exact_ml(60.0, 620.0) - 1.0;
        assert!((-0.002..0.0).contains(&share), "discs lack the curvature within them: {share}");
    }

    #[test]
    fn the_growth_with_the_girths_is_the_derivative() {
        for by in [VolumeBy::Cones, VolumeBy::Discs] {
            let at = |low: f64, high: f64| {
                by.piece(80.0, STEP_MM, [Some(low), Some(high)]).map_or(f64::NAN, |piece| piece.ml)
            };
            let piece = by.piece(80.0, STEP_MM, [Some(300.0), Some(320.0)]);
            let [low, high] = piece.map_or([f64::NAN; 2], |piece| piece.ml_per_mm);
            assert!(((at(300.5, 320.0) - at(299.5, 320.0)) - low).abs() < 1e-9);
            assert!(((at(300.0, 320.5) - at(300.0, 319.5)) - high).abs() < 1e-9);
        }
    }

    #[test]
    fn a_missing_girth_gives_no_cone_on_either_side_of_it() {
        for girths in [[None, Some(300.0)], [Some(300.0), None]] {
            assert_eq!(VolumeBy::Cones.piece(80.0, STEP_MM, girths), None);
        }
        assert_eq!(VolumeBy::Discs.piece(80.0, STEP_MM, [None, Some(300.0)]), None);
        assert!(VolumeBy::Discs.piece(80.0, STEP_MM, [Some(300.0), None]).is_some());
    }
}
