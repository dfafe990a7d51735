//! A leg at one visit: its girths at fixed places, its volume from them, and how it stood.

use std::collections::{BTreeMap, BTreeSet};

use gaiter_leg::comparison::tape_volume::{Piece, VolumeBy};
use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_record::chart::AlongFigures;
use gaiter_record::schema::{BodyFigures, LegFigures};

use super::place::{Step, along_mm};
use super::quantity::{Parts, Quantity};
use super::stance::Stance;

/// A leg at one visit.
#[derive(Debug, Clone, PartialEq)]
pub struct LegAtVisit {
    /// Girths at the places where there are any.
    pub places: BTreeMap<Step, GirthAtPlace>,
    /// Standard error of the whole leg's volume as in the report of its scan, mL; `None` if the record states none.
    pub volume_sd_ml: Option<f64>,
    /// How it stood; `None` if the record does not state it.
    pub stance: Option<Stance>,
}

/// The girth at a fixed place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GirthAtPlace {
    /// Tape girth, mm.
    pub girth_mm: f64,
    /// Standard error of the girth at this place alone, mm.
    pub girth_sd_mm: f64,
    /// Whether the record has a doubt about it.
    pub is_doubtful: bool,
}

/// The errors that all girths of one scan have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Common {
    /// Standard error of all girths, mm: the scanner's calibration.
    pub girth_mm: f64,
    /// Standard error of the floor's height, mm.
    pub floor_mm: f64,
}

impl LegAtVisit {
    /// The leg of a record. A girth of unknown uncertainty is left out: its change cannot be judged.
    pub fn new(body: &BodyFigures, leg: &LegFigures) -> LegAtVisit {
        LegAtVisit {
            places: leg.along.iter().filter_map(place).collect(),
            volume_sd_ml: leg.volume.sd_ml,
            stance: Stance::new(body, leg),
        }
    }

    /// The girth at a place.
    pub fn girth(&self, step: Step, common: &Common) -> Option<Quantity> {
        let place = self.places.get(&step)?;
        let parts = Parts {
            random: place.girth_sd_mm,
            girths: common.girth_mm,
            floor: self.slope(step) * common.floor_mm,
        };
        Some(Quantity::new(place.girth_mm, parts))
    }

    /// The pieces of the leg that its girths give, each by the number of its (lower) place.
    pub fn pieces(&self, by: VolumeBy) -> BTreeMap<Step, Piece> {
        let piece = |step: &Step| Some((*step, self.piece(by, *step)?));
        self.places.keys().filter_map(piece).collect()
    }

    /// The volume of some of its pieces together, mL; `None` if there is none, or if one of them is missing.
    pub fn volume(&self, by: VolumeBy, of: &BTreeSet<Step>, common: &Common) -> Option<Quantity> {
        let mut ml = 0.0;
        let mut ml_per_mm: BTreeMap<Step, f64> = BTreeMap::new();
        for step in of {
            let piece = self.piece(by, *step)?;
            ml += piece.ml;
            for (place, growth) in [*step, step + 1].into_iter().zip(piece.ml_per_mm) {
                *ml_per_mm.entry(place).or_default() += growth;
            }
        }
        let errors = || {
            ml_per_mm.iter().filter_map(|(step, growth)| {
                let place = self.places.get(step)?;
                Some(growth * place.girth_sd_mm)
            })
        };
        let parts = Parts {
            random: errors().fold(0.0, f64::hypot),
            girths: common.girth_mm * ml_per_mm.values().sum::<f64>(),
            floor: common.floor_mm
                * ml_per_mm.iter().map(|(step, growth)| growth * self.slope(*step)).sum::<f64>(),
        };
        // As the report of a scan has it, where the errors of all girths may be one.
        let sd: f64 = errors().sum();
        (!of.is_empty()).then_some(Quantity { value: ml, sd, parts })
    }

    fn piece(&self, by: VolumeBy, step: Step) -> Option<Piece> {
        let girth_mm = |step: Step| self.places.get(&step).map(|place| place.girth_mm);
        by.piece(along_mm(step), PROFILE_STEP_MM, [girth_mm(step), girth_mm(step + 1)])
    }

    /// Growth of the girth along the leg at a place, mm per mm, from its neighbours; 0 without any.
    fn slope(&self, step: Step) -> f64 {
        let below = step.checked_sub(1).filter(|below| self.places.contains_key(below));
        let above = Some(step + 1).filter(|above| self.places.contains_key(above));
        let (low, high) = (below.unwrap_or(step), above.unwrap_or(step));
        let girth_mm = |step: Step| self.places.get(&step).map_or(0.0, |place| place.girth_mm);
        match high - low {
            0 => 0.0,
            steps => (girth_mm(high) - girth_mm(low)) / along_mm(steps),
        }
    }
}

fn place(at: &AlongFigures) -> Option<(Step, GirthAtPlace)> {
    let place = GirthAtPlace {
        girth_mm: at.girth_tape_mm?,
        girth_sd_mm: at.girth_sd_mm?,
        is_doubtful: !at.doubts.is_empty(),
    };
    Some(((at.along_axis_mm / PROFILE_STEP_MM).round() as Step, place))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cone with a girth of 200 mm at the floor that grows by `slope`, measured to `girth_sd_mm` at 2 to 16
    /// steps.
    fn cone(slope: f64, girth_sd_mm: f64) -> LegAtVisit {
        let place = |step: Step| {
            let girth_mm = 200.0 + slope * along_mm(step);
            (step, GirthAtPlace { girth_mm, girth_sd_mm, is_doubtful: false })
        };
        LegAtVisit { places: (2..=16).map(place).collect(), volume_sd_ml: None, stance: None }
    }

    fn all(leg: &LegAtVisit) -> BTreeSet<Step> {
        leg.pieces(VolumeBy::Cones).into_keys().collect()
    }

    fn volume(leg: &LegAtVisit, common: &Common) -> Quantity {
        leg.volume(VolumeBy::Cones, &all(leg), common).unwrap()
    }

    #[test]
    fn a_common_millimetre_and_a_raised_floor_do_to_the_volume_what_they_do_to_each_girth() {
        let exact = Common { girth_mm: 1.0, floor_mm: 1.0 };
        let leg = cone(0.5, 0.0);
        let found = volume(&leg, &exact);
        let moved = |by_mm: f64| {
            let mut leg = leg.clone();
            leg.places.values_mut().for_each(|place| place.girth_mm += by_mm);
            volume(&leg, &exact).value
        };
        let expected = (moved(0.5) - moved(-0.5)) / 1.0;
        assert!((found.parts.girths - expected).abs() < 1e-6, "{found:?} {expected}");
        // A floor that lies 1 mm lower makes each girth that of a place 1 mm higher: 0.5 mm more.
        let expected = moved(0.25) - moved(-0.25);
        assert!((found.parts.floor - expected).abs() < 1e-6, "{found:?} {expected}");
        assert_eq!(found.parts.random, 0.0);
    }

    /// The reference's estimate for a leg of 60 cm: independent 2 mm are 0.25 % of the volume, a common one
    /// 0.49 %.
    #[test]
    fn independent_errors_average_out_and_a_common_one_does_not() {
        let leg = cone(0.5, 2.0);
        let found = volume(&leg, &Common { girth_mm: 1.0, floor_mm: 0.0 });
        let percent = |ml: f64| 100.0 * ml / found.value;
        assert!((0.2..0.35).contains(&percent(found.parts.random)), "{found:?}");
        assert!((0.4..0.6).contains(&percent(found.parts.girths)), "{found:?}");
    }

    #[test]
    fn a_volume_over_a_missing_place_is_none() {
        let mut leg = cone(0.5, 0.5);
        let of = all(&leg);
        leg.places.remove(&7);
        let common = Common { girth_mm: 1.0, floor_mm: 0.0 };
        assert_eq!(leg.volume(VolumeBy::Cones, &of, &common), None);
        assert_eq!(leg.volume(VolumeBy::Cones, &BTreeSet::new(), &common), None);
        assert!(!all(&leg).contains(&6) && !all(&leg).contains(&7) && all(&leg).contains(&8));
    }
}
