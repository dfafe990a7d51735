//! Distances along a leg's axis as records state them.
//!
//! Up to 0.08 of the stature they are counted along the axis of the shank, which meets the floor at 0;
//! from there along the line through the centres of the sections, so that they hold about a bent knee.

use super::equidistant::Sections;
use super::section::Section;
use crate::method::Tape;

/// The distances follow the centres of the sections from here on, as a share of stature: above the foot.
const FROM_STATURE_SHARE: f64 = 0.08;

/// From the coordinate along the straightened leg to the distance along its axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisLength {
    /// Coordinates with their distances, mm, ascending; the two are equal below the first.
    knots: Vec<[f64; 2]>,
}

impl AxisLength {
    /// The distances along the axis of these sections.
    pub fn new(sections: &Sections, stature_mm: f64, tape: Tape) -> AxisLength {
        let axis = &sections.axis;
        let from_mm = axis.along_at_height(FROM_STATURE_SHARE * stature_mm);
        let rows = sections.rows.iter().filter_map(|row| row.section.as_ref());
        let above: Vec<&Section> = match tape {
            Tape::Shank => rows.filter(|section| section.along_mm >= from_mm).collect(),
            // These axes are straight.
            Tape::Leg(_) | Tape::Horizontal => Vec::new(),
        };
        let centre = |section: &Section| axis.at(section.along_mm, &section.centre);
        let mut knots: Vec<[f64; 2]> =
            above.first().map(|first| [first.along_mm; 2]).into_iter().collect();
        for pair in above.windows(2) {
            let length_mm = knots.last().map_or(0.0, |[_, length_mm]| *length_mm);
            let step_mm = (centre(pair[1]) - centre(pair[0])).norm();
            knots.push([pair[1].along_mm, length_mm + step_mm]);
        }
        AxisLength { knots }
    }

    /// The distance along the axis at a coordinate, mm; linear between sections, and with slope 1 beyond
    /// them.
    pub fn at(&self, along_mm: f64) -> f64 {
        self.turned(along_mm, [0, 1])
    }

    /// The coordinate at a distance along the axis, mm: the inverse of [`AxisLength::at`].
    pub fn along_at(&self, length_mm: f64) -> f64 {
        self.turned(length_mm, [1, 0])
    }

    /// What one of the two is, given the other.
    fn turned(&self, mm: f64, [given, wanted]: [usize; 2]) -> f64 {
        let above = self.knots.partition_point(|knot| knot[given] < mm);
        let (Some(low), high) = (self.knots[..above].last(), self.knots.get(above)) else {
            return mm;
        };
        let slope =
            high.map_or(1.0, |high| (high[wanted] - low[wanted]) / (high[given] - low[given]));
        low[wanted] + (mm - low[given]) * slope
    }
}
