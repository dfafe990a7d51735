//! The girth curve: girth over height, measured section by section and fitted by a smooth
//! continuous curve (paper 1.2, fig. 3a).

use gaiter_spline::{Basis, Smoothing, Spline, fit};

use crate::sections::equidistant::Sections;
use crate::sections::section::{Girth, SPACING_MM};
use crate::statistics::median;

/// Length of the pieces of the fitted curve, mm: shorter than half of any muscle's bulge (60 mm).
const INTERVAL_MM: f64 = 12.0;

/// Sections this many rows apart share no mesh point: three times 5 mm is more than two edges of a
/// usual export.
const INDEPENDENT_ROWS: usize = 3;

/// Neighbouring sections share mesh points and thus errors; about this many of them are worth one
/// independent section.
const ROWS_PER_INDEPENDENT: f64 = 2.0;

/// A bridged gap up to this wide does not reduce a section's weight, degrees; beyond that, its
/// error grows with the square of the gap.
const FREE_GAP_DEG: f64 = 20.0;

/// Sections within this distance show how well the curve follows them, mm: about a section itself, its
/// neighbours too, whatever rounding does to their distance.
const MISFIT_REACH_MM: f64 = 1.1 * SPACING_MM;

/// The planes next to a place are within this distance, mm; about a plane itself, its neighbours are not.
const BESIDE_MM: f64 = 0.999 * SPACING_MM;

/// The curve begins here, as a share of stature: below, through heel and instep, the girth falls by
/// 7 mm per mm of height, and a smooth curve that followed that would also be bent at the ankle.
const FROM_STATURE_SHARE: f64 = 0.04;

/// Fewer measured sections than this are too few for a curve.
const ROWS_MIN: usize = 20;

/// Girth over the distance along the axis, with two continuous derivatives.
#[derive(Debug, Clone)]
pub struct GirthCurve {
    /// The measurements, one entry per section plane, ascending.
    pub rows: Vec<GirthRow>,
    tape: Spline,
    contour: Spline,
    /// Standard errors of the tape girth and of its first two derivatives, for sections that
    /// provide them, with their distance along the axis.
    known_sd: Vec<(f64, [f64; 3])>,
}

/// The girth of one section plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GirthRow {
    /// Distance along the axis, mm.
    pub along_mm: f64,
    /// Height of the section's centre and its girth; `None` if the section is open.
    pub measured: Option<(f64, Girth)>,
}

/// Fits the girth curve from the ankle up; `None` if too few sections were measured.
pub fn girth_curve(sections: &Sections, stature_mm: f64) -> Option<GirthCurve> {
    let fitted = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let measured: Vec<_> =
        fitted.filter(|section| section.along_mm >= FROM_STATURE_SHARE * stature_mm).collect();
    let (first, last) = (measured.first()?, measured.last()?);
    if measured.len() < ROWS_MIN {
        return None;
    }
    let (from_mm, to_mm) = (first.along_mm, last.along_mm);
    let intervals = ((to_mm - from_mm) / INTERVAL_MM).ceil() as usize;
    let basis = Basis::uniform_clamped(from_mm, to_mm, intervals).ok()?;
    let along: Vec<f64> = measured.iter().map(|section| section.along_mm).collect();
    let weight = |gap_deg: f64| (FREE_GAP_DEG / gap_deg.max(FREE_GAP_DEG)).powi(2);
    let weights: Vec<f64> = measured.iter().map(|s| weight(s.largest_gap_deg)).collect();
    let column = |girth: fn(&Girth) -> f64| -> Vec<f64> {
        measured.iter().map(|section| girth(&section.girth)).collect()
    };
    let tape_mm = column(|girth| girth.tape_mm);
    let smoothing = Smoothing::Fixed(lambda(&basis, &along, &tape_mm, &weights)?);
    let rows = sections.rows.iter().map(|row| GirthRow {
        along_mm: row.along_mm,
        measured: row.section.as_ref().map(|section| (section.height_mm, section.girth)),
    });
    Some(GirthCurve {
        rows: rows.collect(),
        tape: fit(&basis, &along, &tape_mm, &weights, smoothing).ok()?,
        contour: fit(&basis, &along, &column(|g| g.contour_mm), &weights, smoothing).ok()?,
        known_sd: measured.iter().filter_map(|s| Some((s.along_mm, s.girth_sd?))).collect(),
    })
}

/// The penalty found by cross-validation on sections that share no mesh point: the median over the
/// possible choices. It is relative to the data, so it is valid for all sections.
fn lambda(basis: &Basis, along: &[f64], tape_mm: &[f64], weights: &[f64]) -> Option<f64> {
    let every = |values: &[f64], first: usize| -> Vec<f64> {
        values.iter().skip(first).step_by(INDEPENDENT_ROWS).copied().collect()
    };
    let one = |first: usize| {
        let data = [along, tape_mm, weights].map(|values| every(values, first));
        fit(basis, &data[0], &data[1], &data[2], Smoothing::Gcv).ok().map(|fit| fit.lambda)
    };
    median((0..INDEPENDENT_ROWS).filter_map(one).collect())
}

impl GirthCurve {
    /// The range of the curve, mm along the axis.
    pub fn domain(&self) -> (f64, f64) {
        self.tape.basis.domain()
    }

    /// Tape girth and its first three derivatives with respect to the distance along the axis.
    pub fn tape(&self, along_mm: f64) -> [f64; 4] {
        self.tape.derivatives(along_mm)
    }

    /// Tape and contour girth at a fixed place, mm. Sections that know their own standard errors are smooth
    /// already: there the girth goes through them, also where the curve cuts a fold off.
    pub fn girth(&self, along_mm: f64) -> Girth {
        let curve = |along_mm: f64| Girth {
            tape_mm: self.tape.value(along_mm),
            contour_mm: self.contour.value(along_mm),
        };
        let own = curve(along_mm);
        let above = self.rows.partition_point(|row| row.along_mm <= along_mm);
        let pair = above.checked_sub(1).and_then(|below| self.rows.get(below..=above));
        let Some([low, high]) = pair.filter(|_| !self.known_sd.is_empty()) else { return own };
        let (Some((_, below)), Some((_, beyond))) = (low.measured, high.measured) else {
            return own;
        };
        let share = (along_mm - low.along_mm) / (high.along_mm - low.along_mm);
        let [at_low, at_high] = [low, high].map(|row| curve(row.along_mm));
        let off = |of: fn(&Girth) -> f64| {
            (1.0 - share) * (of(&below) - of(&at_low)) + share * (of(&beyond) - of(&at_high))
        };
        Girth {
            tape_mm: own.tape_mm + off(|girth| girth.tape_mm),
            contour_mm: own.contour_mm + off(|girth| girth.contour_mm),
        }
    }

    /// Standard error of the tape girth (`derivative` 0) or of one of its derivatives.
    pub fn tape_sd(&self, along_mm: f64, derivative: usize) -> f64 {
        let far = |known: &&(f64, [f64; 3])| (known.0 - along_mm).abs();
        let nearest = self.known_sd.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        let known = nearest.and_then(|(_, sd)| sd.get(derivative).copied());
        let sd = known
            .unwrap_or_else(|| ROWS_PER_INDEPENDENT.sqrt() * self.tape.sd(along_mm, derivative));
        if derivative == 0 { sd.hypot(self.misfit_mm(along_mm)) } else { sd }
    }

    /// How far the measured sections about a distance along the axis lie from the curve, mm: more than
    /// noise where the girth turns within a piece of the curve, as in a fold.
    fn misfit_mm(&self, along_mm: f64) -> f64 {
        let near =
            self.rows.iter().filter(|row| (row.along_mm - along_mm).abs() <= MISFIT_REACH_MM);
        let off =
            near.filter_map(|row| Some(row.measured?.1.tape_mm - self.tape.value(row.along_mm)));
        let (count, squares) = off.fold((0, 0.0), |(count, sum), off| (count + 1, sum + off * off));
        if count > 0 { (squares / f64::from(count)).sqrt() } else { 0.0 }
    }

    /// Coefficient of determination of the tape curve over the measured sections.
    pub fn r2(&self) -> f64 {
        self.tape.r2
    }

    /// Root mean square of the measured sections' deviations from the tape curve, mm.
    pub fn rms_mm(&self) -> f64 {
        self.tape.rms
    }

    /// Height above the floor of the section at this distance along the axis, interpolated between
    /// the nearest measured ones; `None` outside them.
    pub fn height_mm(&self, along_mm: f64) -> Option<f64> {
        let measured = self.rows.iter().filter_map(|row| Some((row.along_mm, row.measured?.0)));
        let below = measured.clone().rfind(|(along, _)| *along <= along_mm)?;
        let above = measured.clone().find(|(along, _)| *along >= along_mm)?;
        let share = match above.0 - below.0 {
            0.0 => 0.0,
            span => (along_mm - below.0) / span,
        };
        Some(below.1 + share * (above.1 - below.1))
    }

    /// Whether the nearest section planes on both sides were measured.
    pub fn is_seen(&self, along_mm: f64) -> bool {
        let near = self.rows.iter().filter(|row| (row.along_mm - along_mm).abs() <= BESIDE_MM);
        near.clone().count() > 0 && near.clone().all(|row| row.measured.is_some())
    }
}
