//! Checks a record that was read back. The file may have been changed since it was written, so its
//! figures must be possible for a leg before they are drawn or printed.

use gaiter_leg::Side;

use super::Record;
use super::measure::amendment::AmendFault;
use super::schema::LegFigures;
use super::shape::{OutlineFigures, ShapeFigures};

/// Heights above the floor, mm: no leg reaches higher, and none far below the floor.
const HEIGHTS_MM: [f64; 2] = [-500.0, 3000.0];

/// Girths, standard errors and lengths along the skin, mm.
const LENGTHS_MM: [f64; 2] = [0.0, 3000.0];

/// Radii of a section, mm.
const RADII_MM: [f64; 2] = [0.0, 1000.0];

/// Curvatures, 1/mm: the finest waves of a section have less than 1.
const CURVATURES_PER_MM: [f64; 2] = [-2.0, 2.0];

/// Growth of the girth along the leg, mm per mm: heel and instep have about 10.
const SLOPES: [f64; 2] = [-100.0, 100.0];

/// Angles around a section, degrees.
const ANGLES_DEG: [f64; 2] = [-180.0, 180.0];

/// Why a record is not valid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecordFault {
    /// A leg is neither left nor right, or a side occurs twice.
    #[error(
        "side {side:?} in legs[{index}]: each leg must be left or right, and no side may occur \
         twice"
    )]
    Side {
        /// Which leg, from 0.
        index: usize,
        /// Its side as written.
        side: String,
    },
    /// A figure is outside its possible range.
    #[error("{side} leg, {place}: {found} is not within {low} to {high}")]
    Range {
        /// The leg's side.
        side: String,
        /// The figure.
        place: String,
        /// The value found.
        found: f64,
        /// The smallest possible value.
        low: f64,
        /// The largest possible value.
        high: f64,
    },
    /// A measure that a person set is not possible.
    #[error("set by hand: {0}")]
    Amendment(#[from] AmendFault),
    /// A row has a different number of figures than the row it belongs to.
    #[error("{side} leg, {place}: {found} figures, where there must be {needed}")]
    Count {
        /// The leg's side.
        side: String,
        /// The row.
        place: String,
        /// The number found.
        found: usize,
        /// The required number.
        needed: usize,
    },
}

impl Record {
    /// Returns the record if its figures are possible for a leg.
    ///
    /// # Errors
    /// The first [`RecordFault`].
    pub fn checked(self) -> Result<Record, RecordFault> {
        for (index, leg) in self.legs.iter().enumerate() {
            let is_side = Side::of_word(&leg.side).is_some();
            if !is_side || self.legs[..index].iter().any(|before| before.side == leg.side) {
                return Err(RecordFault::Side { index, side: leg.side.clone() });
            }
            Checked { side: &leg.side }.leg(leg)?;
        }
        for amendment in &self.amendments {
            amendment.checked()?;
        }
        Ok(self)
    }
}

/// The leg being checked.
struct Checked<'a> {
    side: &'a str,
}

impl Checked<'_> {
    fn leg(&self, leg: &LegFigures) -> Result<(), RecordFault> {
        for (level, of) in &leg.landmarks {
            let sds_mm = [of.height_sd_mm, of.girth_sd_mm, of.girth_of_level_sd_mm];
            self.level(level, of.height_mm, of.girth_tape_mm, sds_mm)?;
            let others = [Some(of.girth_contour_mm), of.surface_length_mm];
            self.all(level, others.into_iter().flatten(), LENGTHS_MM)?;
        }
        for (level, of) in &leg.estimates {
            let sds_mm = [of.height_sd_mm, of.girth_sd_mm, of.girth_of_level_sd_mm];
            self.level(level, of.height_mm, of.girth_tape_mm, sds_mm)?;
        }
        for at in &leg.along {
            let place = format!("{} mm along the leg", at.along_axis_mm);
            self.all(&place, [at.along_axis_mm].into_iter().chain(at.height_mm), HEIGHTS_MM)?;
            self.all(&place, at.girth_tape_mm.into_iter().chain(at.girth_sd_mm), LENGTHS_MM)?;
        }
        self.girth_curve(leg)?;
        for section in &leg.sections {
            self.outline(&format!("outline of {}", section.level), &section.outline)?;
        }
        for feature in &leg.features {
            let place = format!("{} of {}", feature.label, feature.level);
            self.all(&place, [feature.angle_deg], ANGLES_DEG)?;
            self.all(&place, [feature.curvature_per_mm], CURVATURES_PER_MM)?;
        }
        self.shape(&leg.shape)
    }

    fn level(
        &self,
        level: &str,
        height_mm: f64,
        girth_mm: f64,
        errors_mm: [Option<f64>; 3],
    ) -> Result<(), RecordFault> {
        self.all(&format!("height of {level}"), [height_mm], HEIGHTS_MM)?;
        self.all(&format!("girth of {level}"), [girth_mm], LENGTHS_MM)?;
        let errors = errors_mm.into_iter().flatten();
        self.all(&format!("standard errors of {level}"), errors, LENGTHS_MM)
    }

    fn girth_curve(&self, leg: &LegFigures) -> Result<(), RecordFault> {
        let curve = &leg.girth_curve;
        let needed = curve.height_mm.len();
        for (place, found) in [
            ("girth_curve.along_axis_mm", curve.along_axis_mm.len()),
            ("girth_curve.tape_mm", curve.tape_mm.len()),
            ("girth_curve.contour_mm", curve.contour_mm.len()),
            ("girth_curve.slope", curve.slope.len()),
        ] {
            self.count(place, found, needed)?;
        }
        self.all("girth_curve.height_mm", curve.height_mm.iter().flatten().copied(), HEIGHTS_MM)?;
        self.all("girth_curve.tape_mm", curve.tape_mm.iter().flatten().copied(), LENGTHS_MM)?;
        self.all("girth_curve.contour_mm", curve.contour_mm.iter().flatten().copied(), LENGTHS_MM)?;
        self.all("girth_curve.slope", curve.slope.iter().flatten().copied(), SLOPES)
    }

    fn outline(&self, place: &str, outline: &OutlineFigures) -> Result<(), RecordFault> {
        let angles = outline.radius_mm.len().max(1);
        self.count(&format!("{place}, radius_mm"), outline.radius_mm.len(), angles)?;
        let curvatures = &outline.curvature_per_mm;
        self.count(&format!("{place}, curvature_per_mm"), curvatures.len(), angles)?;
        let (seen, places) = (&outline.scan_radius_mm, &outline.scan_angle_deg);
        self.count(&format!("{place}, scan_radius_mm"), seen.len(), places.len())?;
        self.all(place, outline.radius_mm.iter().chain(seen).copied(), RADII_MM)?;
        self.all(place, curvatures.iter().copied(), CURVATURES_PER_MM)?;
        self.all(place, places.iter().copied(), ANGLES_DEG)
    }

    fn shape(&self, shape: &ShapeFigures) -> Result<(), RecordFault> {
        let skin = &shape.skin;
        let places = skin.rows.saturating_mul(skin.columns);
        self.count("skin of its shape", skin.points.as_points().len(), places)?;
        let Some(surface) = &shape.surface else { return Ok(()) };
        let places = surface.rows.saturating_mul(surface.columns);
        self.count("surface of its shape", surface.points.as_points().len(), places)?;
        self.count("error of its surface", surface.error.as_errors_mm().len(), places)
    }

    fn count(&self, place: &str, found: usize, needed: usize) -> Result<(), RecordFault> {
        if found == needed {
            return Ok(());
        }
        let (side, place) = (self.side.to_owned(), place.to_owned());
        Err(RecordFault::Count { side, place, found, needed })
    }

    fn all(
        &self,
        place: &str,
        figures: impl IntoIterator<Item = f64>,
        [low, high]: [f64; 2],
    ) -> Result<(), RecordFault> {
        match figures.into_iter().find(|figure| !(low..=high).contains(figure)) {
            None => Ok(()),
            Some(found) => {
                let (side, place) = (self.side.to_owned(), place.to_owned());
                Err(RecordFault::Range { side, place, found, low, high })
            }
        }
    }
}
