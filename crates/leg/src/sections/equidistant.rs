//! The sections of a whole leg, equidistant along its axis (paper 1.1, fig. 2e).

use std::f64::consts::FRAC_PI_2;

use rayon::prelude::*;

use super::axis::LegAxis;
use super::cloth::Cloth;
use super::plane::{self, PlaneFit};
use super::point_pairs::Pairs;
use super::section::{Outline, SPACING_MM, Section};
use super::skin::Skin;
use super::slice::Crossing;
use crate::method::SectionFit;
use crate::parting::segment::Leg;

/// The medial side, where fitters place the tape along the leg, as an angle around a section.
const MEDIAL: f64 = -FRAC_PI_2;

/// The sections of a leg from the foot to the groin.
#[derive(Debug, Clone)]
pub struct Sections {
    /// The frame the sections lie in.
    pub axis: LegAxis,
    /// The source of all sections.
    pub source: Source,
    /// One entry per plane, [`SPACING_MM`] apart, ascending.
    pub rows: Vec<Row>,
}

/// One section plane.
#[derive(Debug, Clone)]
pub struct Row {
    /// Distance of the plane along the axis, mm.
    pub along_mm: f64,
    /// The section, if it could be measured.
    pub section: Option<Section>,
}

/// The source of the sections of one leg.
#[derive(Debug, Clone)]
pub enum Source {
    /// The skin as one function, fitted to all points.
    Skin(Box<Skin>),
    /// Each plane's own intersections with the mesh, as periodic splines.
    Crossings {
        /// Their penalty, see [`PlaneFit::Periodic`].
        lambda: f64,
    },
    /// The paper's pairs of points across each plane, as polynomials.
    Pairs(Pairs),
}

/// Cuts a leg into sections between two distances along its axis, from above the foot to the
/// crotch; `None` if the leg has hardly any points.
pub fn sections(
    leg: &Leg,
    axis: LegAxis,
    [from_mm, to_mm]: [f64; 2],
    fit: SectionFit,
) -> Option<Sections> {
    let count = ((to_mm - from_mm) / SPACING_MM).max(0.0) as usize;
    let along_mm: Vec<f64> = (0..count).map(|i| from_mm + SPACING_MM * i as f64).collect();
    let source = match fit {
        SectionFit::Skin => Source::Skin(Box::new(Skin::fit(leg, &axis, from_mm, to_mm)?)),
        SectionFit::Periodic => Source::Crossings {
            lambda: plane::lambda(&axis, &along_mm, &axis.slices(leg, &along_mm)),
        },
        SectionFit::Paper => Source::Pairs(Pairs::find(leg, &axis, [from_mm, to_mm])?),
    };
    let mut sections = Sections { axis, source, rows: Vec::new() };
    let found = sections.at(leg, &along_mm);
    let rows = along_mm.into_iter().zip(found);
    sections.rows = rows.map(|(along_mm, section)| Row { along_mm, section }).collect();
    Some(sections)
}

impl Sections {
    /// The section of the plane nearest to a distance along the axis; `None` if it is open.
    pub fn nearest(&self, along_mm: f64) -> Option<&Section> {
        let far = |row: &&Row| (row.along_mm - along_mm).abs();
        let row = self.rows.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        row.and_then(|row| row.section.as_ref())
    }

    /// Length from the floor to a level along the medial skin, mm: straight lines from section to
    /// section, across any gaps, and straight down from the lowest section, because the tape hangs
    /// beside the foot there. `None` outside the measured sections.
    pub(crate) fn surface_length_mm(&self, along_mm: f64) -> Option<f64> {
        let measured = self.rows.iter().filter_map(|row| row.section.as_ref());
        let point = |section: &Section| section.point(&self.axis.plane(section.along_mm), MEDIAL);
        let mut below = measured.clone().next().filter(|section| section.along_mm <= along_mm)?;
        let mut length_mm = point(below).z;
        for section in measured.skip(1) {
            let step_mm = (point(section) - point(below)).norm();
            if section.along_mm >= along_mm {
                let share = (along_mm - below.along_mm) / (section.along_mm - below.along_mm);
                return Some(length_mm + share * step_mm);
            }
            length_mm += step_mm;
            below = section;
        }
        None
    }

    /// What covers the leg between two distances along the axis; only the fit of all of the skin knows.
    pub fn cloth(&self, span_mm: [f64; 2]) -> Cloth {
        match &self.source {
            Source::Skin(skin) => skin.cloth(span_mm),
            Source::Crossings { .. } | Source::Pairs(_) => Cloth::default(),
        }
    }

    /// The outline of a row, bridged if up to `gap_deg` of the skin was not seen; `None` if more is
    /// missing.
    pub fn outline(&self, row: &Row, gap_deg: f64) -> Option<Outline> {
        match (&row.section, &self.source) {
            (Some(section), _) => Some(section.into()),
            (None, Source::Skin(skin)) if skin.largest_gap_deg(row.along_mm) <= gap_deg => {
                skin.outline(row.along_mm)
            }
            // The other sources know only the points of the section itself.
            _ => None,
        }
    }

    /// The sections of the same leg at other distances along the axis, which must ascend, from the
    /// same source; `None` where the skin is not closed.
    pub fn at(&self, leg: &Leg, along_mm: &[f64]) -> Vec<Option<Section>> {
        match &self.source {
            Source::Skin(skin) => {
                along_mm.par_iter().map(|along_mm| skin.section(&self.axis, *along_mm)).collect()
            }
            &Source::Crossings { lambda } => {
                let slices = self.axis.slices(leg, along_mm);
                let one = |(&along_mm, slice): (&f64, &Vec<Crossing>)| {
                    let points = self.axis.points(along_mm, slice);
                    plane::section(&self.axis, along_mm, &points, PlaneFit::Periodic { lambda })
                };
                along_mm.par_iter().zip(&slices).map(one).collect()
            }
            Source::Pairs(pairs) => {
                let one = |&along_mm: &f64| {
                    let points = pairs.on_plane(along_mm);
                    plane::section(&self.axis, along_mm, &points, PlaneFit::Polynomial)
                };
                along_mm.par_iter().map(one).collect()
            }
        }
    }
}
