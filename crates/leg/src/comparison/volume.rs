//! Leg volume from section areas. The volume between two planes across the leg's axis is the integral of
//! the enclosed area over the distance along the axis, with a factor where the planes turn about the knee.

use std::f64::consts::{PI, TAU};

use super::tape_volume::MM3_PER_ML;
use crate::level::Level;
use crate::levels::girth::GirthCurve;
use crate::levels::landmark::Landmark;
use crate::sections::axis::LegAxis;
use crate::sections::equidistant::{Row, Sections};
use crate::sections::section::{Curve, Section};

/// Length of the slices that clinics chart, mm: tape measurements are taken every 4 cm from the floor.
const SLICE_MM: f64 = 40.0;

/// Nodes on (−1, 1) and weights of the four-point Gauss-Legendre rule, exact to degree 7.
const GAUSS: [[f64; 2]; 4] = [
    [-0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
    [-0.339_981_043_584_856_26, 0.652_145_154_862_546_1],
    [0.339_981_043_584_856_26, 0.652_145_154_862_546_1],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
];

/// Number of pieces of a full turn when the square of a polynomial of order 15 is integrated; the
/// rule's error is then below 10⁻⁹ of the area.
const POLYNOMIAL_PIECES: usize = 48;

/// Number of sections that one cubic of the area interpolates.
const STENCIL: usize = 4;

/// Volumes of one leg.
#[derive(Debug, Clone)]
pub struct LegVolume {
    /// Area of the sections over the distance along the axis.
    pub areas: AreaCurve,
    /// From the lowest measured section to the highest, which is at the crotch; `None` if a section
    /// between them is open.
    pub whole: Option<Volume>,
    /// Heights of the centres of these two sections, mm; `None` together with `whole`.
    pub whole_height_mm: Option<[f64; 2]>,
    /// Between the levels B and D; `None` if one of them is absent or a section is open.
    pub b_to_d: Option<Volume>,
    /// Slices of 4 cm along the axis, the first one from the floor, up to the highest section.
    pub slices: Vec<Slice>,
}

/// The volume between two planes across the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// The lower plane, mm along the axis.
    pub from_mm: f64,
    /// The upper plane, mm along the axis.
    pub to_mm: f64,
    /// The volume, mL.
    pub ml: f64,
    /// Its standard error, mL: from the errors of the girths, assumed fully correlated along the
    /// leg, which is the worst case.
    pub sd_ml: f64,
}

/// A slice of the leg along the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    /// Lower end, mm along the axis from the floor.
    pub from_mm: f64,
    /// Upper end, mm along the axis from the floor.
    pub to_mm: f64,
    /// The volume between the ends; `None` if the slice was not measured completely.
    pub volume: Option<Volume>,
}

/// The area enclosed by the sections over the distance along the axis.
#[derive(Debug, Clone)]
pub struct AreaCurve {
    /// Runs of neighbouring measured sections, ascending.
    runs: Vec<Vec<AreaRow>>,
}

/// The area of one section.
#[derive(Debug, Clone, Copy, PartialEq)]
struct AreaRow {
    along_mm: f64,
    height_mm: f64,
    /// Area and its standard error, mm².
    area_mm2: [f64; 2],
}

/// The volumes of a leg.
pub fn leg_volume(sections: &Sections, curve: &GirthCurve, landmarks: &[Landmark]) -> LegVolume {
    let areas = AreaCurve::new(sections, curve);
    let at = |level: Level| landmarks.iter().find(|l| l.level == level).map(|l| l.along_mm);
    let between = |[low, high]: [Level; 2]| areas.volume(at(low)?, at(high)?);
    let ends = areas.ends();
    let whole = ends.and_then(|[low, high]| areas.volume(low.along_mm, high.along_mm));
    let whole_height_mm = whole.and(ends).map(|ends| ends.map(|row| row.height_mm));
    let top_mm = sections.rows.last().map_or(0.0, |row| row.along_mm);
    let slice = |index: usize| {
        let [from_mm, to_mm] = [index, index + 1].map(|end| SLICE_MM * end as f64);
        Slice { from_mm, to_mm, volume: areas.volume(from_mm, to_mm) }
    };
    LegVolume {
        whole,
        whole_height_mm,
        b_to_d: between([Level::B, Level::D]),
        slices: (0..(top_mm / SLICE_MM).ceil() as usize).map(slice).collect(),
        areas,
    }
}

/// How far the centre of each section moves across its plane per distance along the axis: 1 between
/// parallel planes. Where planes turn, area times this is what they sweep (Pappus, Guldin).
fn sweeps(axis: &LegAxis, run: &[&Section]) -> Vec<f64> {
    if axis.bend.is_none() {
        return vec![1.0; run.len()];
    }
    let centre = |index: usize| axis.at(run[index].along_mm, &run[index].centre);
    let sweep = |index: usize| {
        let [low, high] = [index.saturating_sub(1), (index + 1).min(run.len() - 1)];
        let normal = axis.plane(run[index].along_mm).normal;
        let along_mm = run[high].along_mm - run[low].along_mm;
        if along_mm > 0.0 { normal.dot(&(centre(high) - centre(low))) / along_mm } else { 1.0 }
    };
    (0..run.len()).map(sweep).collect()
}

impl AreaCurve {
    /// The areas of a leg's sections; `curve` provides the standard errors of their girths.
    pub fn new(sections: &Sections, curve: &GirthCurve) -> AreaCurve {
        let (from_mm, to_mm) = curve.domain();
        let row = |section: &Section| {
            let area_mm2 = area_mm2(&section.curve);
            // Below the curve's range, the curve's error at its lower end is used for the section.
            let girth_sd_mm = curve.tape_sd(section.along_mm.clamp(from_mm, to_mm), 0);
            let sd_mm2 = 2.0 * area_mm2 * girth_sd_mm / section.girth.tape_mm;
            let (along_mm, height_mm) = (section.along_mm, section.height_mm);
            AreaRow { along_mm, height_mm, area_mm2: [area_mm2, sd_mm2] }
        };
        let runs = sections.rows.split(|row| row.section.is_none());
        let measured = |run: &[Row]| -> Vec<AreaRow> {
            let run: Vec<&Section> = run.iter().filter_map(|row| row.section.as_ref()).collect();
            let rows = run.iter().map(|section| row(section)).zip(sweeps(&sections.axis, &run));
            let swept = |(row, sweep): (AreaRow, f64)| AreaRow {
                area_mm2: row.area_mm2.map(|area_mm2| area_mm2 * sweep),
                ..row
            };
            rows.map(swept).collect()
        };
        let runs = runs.map(measured);
        AreaCurve { runs: runs.filter(|run| !run.is_empty()).collect() }
    }

    /// The volume between two planes, mm along the axis; `None` if they are not a valid range, or
    /// if one of them or a section between them was not measured.
    pub fn volume(&self, from_mm: f64, to_mm: f64) -> Option<Volume> {
        let holds = |run: &&Vec<AreaRow>| {
            let ends = run.first().zip(run.last());
            let within = |(low, high): (&AreaRow, &AreaRow)| {
                low.along_mm <= from_mm && from_mm < to_mm && to_mm <= high.along_mm
            };
            run.len() >= STENCIL && ends.is_some_and(within)
        };
        let run = self.runs.iter().find(holds)?;
        let [mut ml, mut sd_ml] = [0.0; 2];
        for (index, cell) in run.windows(2).enumerate() {
            let [low, high] = [cell[0].along_mm.max(from_mm), cell[1].along_mm.min(to_mm)];
            if low < high {
                let first = index.saturating_sub(1).min(run.len() - STENCIL);
                let near = &run[first..first + STENCIL];
                ml += integral(low, high, |along| cubic(near, along, 0)) / MM3_PER_ML;
                sd_ml += integral(low, high, |along| cubic(near, along, 1)) / MM3_PER_ML;
            }
        }
        Some(Volume { from_mm, to_mm, ml, sd_ml })
    }

    /// The lowest and the highest measured section.
    fn ends(&self) -> Option<[AreaRow; 2]> {
        Some([*self.runs.first()?.first()?, *self.runs.last()?.last()?])
    }
}

/// The cubic through the areas (`which` 0) or their standard errors (1) of neighbouring sections,
/// by Lagrange's formula.
fn cubic(rows: &[AreaRow], along_mm: f64, which: usize) -> f64 {
    let share = |own: &AreaRow| {
        let others = rows.iter().filter(|other| other.along_mm != own.along_mm);
        let factor = |o: &AreaRow| (along_mm - o.along_mm) / (own.along_mm - o.along_mm);
        others.map(factor).product::<f64>()
    };
    rows.iter().map(|own| share(own) * own.area_mm2[which]).sum()
}

/// The area enclosed by a section, ∮ r²/2 dθ in mm²: exact for the pieces of a periodic spline,
/// whose square has degree 6.
pub fn area_mm2(curve: &Curve) -> f64 {
    let ends = match curve {
        Curve::Periodic { basis, .. } => basis.breakpoints().to_vec(),
        Curve::Polynomial(_) => {
            let end = |index: usize| -PI + TAU * index as f64 / POLYNOMIAL_PIECES as f64;
            (0..=POLYNOMIAL_PIECES).map(end).collect()
        }
    };
    let piece = |ends: &[f64]| integral(ends[0], ends[1], |a| curve.radius(a).powi(2) / 2.0);
    ends.windows(2).map(piece).sum()
}

/// The integral of a function between two abscissas.
fn integral(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
    let sum: f64 = GAUSS.iter().map(|[node, weight]| weight * function(middle + half * node)).sum();
    half * sum
}
