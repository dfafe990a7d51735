//! Sections: closed curves where planes across the leg's axis meet the skin (paper 1.1, fig. 2d),
//! as radius over angle about the section's centre.

use std::f64::consts::{PI, TAU};

use gaiter_spline::{Basis, Row};
use nalgebra::{Point2, Point3, Vector2};

use super::hull::Hull;
use super::plane_frame::PlaneFrame;
use super::polynomial::Polynomial;

/// Number of angles at which a curve's girth is measured; the chord error is 3·10⁻⁶ of the girth.
pub(super) const GIRTH_ANGLES: usize = 720;

/// Distance between neighbouring sections along the axis, mm.
pub const SPACING_MM: f64 = 5.0;

/// A measured section.
#[derive(Debug, Clone)]
pub struct Section {
    /// Distance of the plane along the axis, mm.
    pub along_mm: f64,
    /// Height of the section's centre above the floor, mm.
    pub height_mm: f64,
    /// The centroid of the enclosed area, (front, lateral) in mm from the axis.
    pub centre: Point2<f64>,
    /// Radius over angle about `centre`.
    pub curve: Curve,
    /// Circumference.
    pub girth: Girth,
    /// Standard error of the girth and of its first two derivatives along the axis, if the fit
    /// provides them.
    pub girth_sd: Option<[f64; 3]>,
    /// Standard error of the sine and of the cosine of a slow wave of the radius, mm, if the fit
    /// provides it.
    pub wave_sd_mm: Option<f64>,
    /// Number of points on the plane.
    pub points: usize,
    /// Coefficient of determination of the radius over all points.
    pub r2: f64,
    /// Root mean square of the radial residuals, outliers with their weight, mm.
    pub rms_mm: f64,
    /// Widest gap between neighbouring points as seen from the centre, degrees.
    pub largest_gap_deg: f64,
}

/// The position of a section's curve: the part that the surface needs.
#[derive(Debug, Clone)]
pub struct Outline {
    /// Distance of the plane along the axis, mm.
    pub along_mm: f64,
    /// The origin of radius and angle, (front, lateral) in mm from the axis.
    pub centre: Point2<f64>,
    /// Radius over angle about `centre`.
    pub curve: Curve,
}

impl Outline {
    /// The skin's point at an angle, in the body frame; `plane` is the section's.
    pub fn point(&self, plane: &PlaneFrame, angle: f64) -> Point3<f64> {
        plane.point(&(self.centre + self.curve.point(angle).coords))
    }
}

impl From<&Section> for Outline {
    fn from(section: &Section) -> Outline {
        let Section { along_mm, centre, ref curve, .. } = *section;
        Outline { along_mm, centre, curve: curve.clone() }
    }
}

/// Circumference of a section, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Girth {
    /// Of the convex hull: the reading of a tape, which bridges hollows.
    pub tape_mm: f64,
    /// Along the skin.
    pub contour_mm: f64,
}

/// Radius over angle, mm over radians; angle 0 is the front, positive towards the lateral side.
#[derive(Debug, Clone)]
pub enum Curve {
    /// A periodic cubic spline.
    Periodic {
        /// Its basis, over angles in radians.
        basis: Basis,
        /// Its coefficients, mm.
        coefficients: Vec<f64>,
    },
    /// The paper's polynomial.
    Polynomial(Polynomial),
}

impl Curve {
    /// Radius at an angle, mm.
    #[inline]
    pub fn radius(&self, angle: f64) -> f64 {
        match self {
            Curve::Periodic { basis, coefficients } => basis.row(angle).dot(coefficients),
            Curve::Polynomial(polynomial) => polynomial.derivatives(angle)[0],
        }
    }

    /// Radii at equal angles from −180° on; quickest with spokes for this many angles in this curve's basis.
    pub fn radii(&self, count: usize, spokes: Option<&Spokes>) -> Vec<f64> {
        match (self, spokes) {
            (Curve::Periodic { basis, coefficients }, Some(spokes)) if spokes.basis == *basis => {
                spokes.spokes.iter().map(|(row, _)| row.dot(coefficients)).collect()
            }
            _ => (0..count)
                .map(|index| self.radius(-PI + TAU * index as f64 / count as f64))
                .collect(),
        }
    }

    /// Spokes for curves in this one's basis; `None` for the paper's polynomial.
    pub fn spokes(&self, count: usize) -> Option<Spokes> {
        match self {
            Curve::Periodic { basis, .. } => Some(Spokes::at(count, basis)),
            Curve::Polynomial(_) => None,
        }
    }

    /// Radius and its first two derivatives with respect to the angle.
    pub fn derivatives(&self, angle: f64) -> [f64; 3] {
        match self {
            Curve::Periodic { basis, coefficients } => {
                let (span, values) = basis.rows_to_second(angle);
                let indices = basis.indices(span);
                values.map(|values| Row { indices, values }.dot(coefficients))
            }
            Curve::Polynomial(polynomial) => polynomial.derivatives(angle),
        }
    }

    /// The point at an angle, relative to the centre, (front, lateral) in mm.
    pub fn point(&self, angle: f64) -> Point2<f64> {
        let radius = self.radius(angle);
        Point2::new(radius * angle.cos(), radius * angle.sin())
    }

    /// `count` points at equal angles, starting at −180°.
    pub fn points(&self, count: usize) -> Vec<Point2<f64>> {
        (0..count).map(|index| self.point(-PI + TAU * index as f64 / count as f64)).collect()
    }
}

impl Section {
    /// The skin's point at an angle, in the body frame; `plane` is the section's.
    pub fn point(&self, plane: &PlaneFrame, angle: f64) -> Point3<f64> {
        plane.point(&(self.centre + self.curve.point(angle).coords))
    }
}

/// Circumference of a closed curve; `None` if it encloses no area.
pub fn girth(curve: &Curve) -> Option<Girth> {
    let points = curve.points(GIRTH_ANGLES);
    Girth::from_polygon(&points, Hull::from_points(&points))
}

impl Girth {
    /// Circumference of a closed polygon with this hull; `None` if it encloses no area.
    fn from_polygon(points: &[Point2<f64>], hull: Option<Hull>) -> Option<Girth> {
        let (first, last) = (points.first()?, points.last()?);
        let steps = points.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        let contour_mm = steps.sum::<f64>() + (first - last).norm();
        Some(Girth { tape_mm: hull?.perimeter(), contour_mm })
    }
}

/// Equal angles from −180° on, reusable for all periodic curves in one basis.
#[derive(Debug, Clone)]
pub struct Spokes {
    basis: Basis,
    /// For each angle, the basis' values and the direction.
    spokes: Vec<(Row, Vector2<f64>)>,
}

impl Spokes {
    /// `count` angles for curves in a basis.
    pub fn at(count: usize, basis: &Basis) -> Spokes {
        let angles = (0..count).map(|index| -PI + TAU * index as f64 / count as f64);
        let spoke = |angle: f64| (basis.row(angle), Vector2::new(angle.cos(), angle.sin()));
        Spokes { basis: basis.clone(), spokes: angles.map(spoke).collect() }
    }

    /// Like [`girth`], for the curve with these coefficients.
    pub fn girth(&self, coefficients: &[f64]) -> Option<Girth> {
        // Where no coefficient is negative, no radius is, and the points lie in order around the centre.
        let is_ring = coefficients.iter().all(|radius| *radius > 0.0);
        let point = |(row, direction): &(Row, Vector2<f64>)| {
            Point2::from(direction * row.dot(coefficients))
        };
        let points: Vec<_> = self.spokes.iter().map(point).collect();
        Girth::from_polygon(
            &points,
            if is_ring { Hull::of_ring(&points) } else { Hull::from_points(&points) },
        )
    }
}
