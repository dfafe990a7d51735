//! The legs of two visits laid over each other, as a record that the 3D view and the map of distances show:
//! the later legs, on their surface the distance from the earlier ones, and the earlier skin as points.

use gaiter_leg::Side;
use gaiter_leg::side::Sides;
use gaiter_record::Record;
use gaiter_record::schema::LegFigures;
use gaiter_record::shape::{CloudFigures, Packed};

use super::registration::{Registration, Rings};

/// Two visits laid over each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// The later record; the error of its surfaces is the distance outside the earlier skin.
    pub record: Record,
    /// Error of the registration of each leg, mm; `None` for one that is not shown.
    pub error_mm: Sides<Option<f64>>,
    /// The largest distance, mm, without the farthest hundredth.
    pub largest_mm: f64,
}

/// The share of the distances that the scale holds.
const SHARE: f64 = 0.99;

impl Overlay {
    /// Lays the legs of the earlier record over those of the later one. `None` if no leg can be.
    pub fn new(earlier: &Record, later: &Record) -> Option<Overlay> {
        let mut record = later.clone();
        let mut error_mm = Sides::of_each(|_| None);
        let mut all: Vec<f64> = Vec::new();
        let mut lay = |leg: &mut LegFigures| {
            let side = Side::of_word(&leg.side)?;
            let before = earlier.leg(side)?;
            let registration = Registration::new(later, before, leg)?;
            let surface = leg.shape.surface.as_mut()?;
            let skin = before.shape.surface.as_ref()?;
            let laid = Rings::new(&skin.points, skin.columns).laid(&registration);
            let distances: Vec<Option<f64>> = surface
                .points
                .as_points()
                .iter()
                .map(|point| laid.distance(&(*point)?).map(|(distance_mm, _)| distance_mm))
                .collect();
            all.extend(distances.iter().flatten().map(|mm| mm.abs()));
            surface.error = Packed::errors(&distances);
            leg.shape.scan = CloudFigures { points: Packed::points(laid.points().map(Some)) };
            *error_mm.get_mut(side) = Some(registration.error_mm);
            Some(())
        };
        record.legs.retain_mut(|leg| lay(leg).is_some());
        all.sort_by(f64::total_cmp);
        let largest_mm = *all.get((SHARE * all.len() as f64) as usize)?;
        Some(Overlay { record, error_mm, largest_mm })
    }
}
