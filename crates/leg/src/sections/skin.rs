//! The skin of a leg as one smooth function: radius over the distance along the axis and the angle
//! around it, fitted to every point of the scan at once.
//!
//! A section through it uses all the points near its plane, not only those within a few
//! millimetres, and none of the flat facets between them. Holes are bridged from all sides.
//! Cross-validation chooses the amount of smoothing along and around.
//!
//! What the smoothing removes from the slow waves around is restored by `waves`; `sag` gives how far the points of a
//! decimated mesh may lie off the skin.

use std::f64::consts::{SQRT_2, TAU};

use gaiter_spline::{Basis, Row, Scatter, TensorFit, fit_scatter, r2};
use nalgebra::{Point2, Vector2};

use super::axis::LegAxis;
use super::bend::{self, Middle};
use super::centroid::outline_centroid;
use super::cloth::{Cloth, DIRECTIONS, cloth, direction};
use super::hull::Hull;
use super::low_harmonics::{Left, Waves};
use super::sag::Sag;
use super::section::{Curve, GIRTH_ANGLES, Outline, Section, Spokes};
use crate::parting::segment::Leg;
use crate::statistics::largest_gap_deg;

/// Pieces of the function around: 7.5° each, which is 4 mm on a slim ankle and 11 mm on a thigh.
const INTERVALS_AROUND: usize = 48;

/// Length of the pieces along, mm: about the width of the smallest bump, a malleolus (σ 13 mm).
const INTERVAL_ALONG_MM: f64 = 12.0;

/// Minimum scale of residuals, mm, so that nothing within 1.4 mm is an outlier: a malleolus that
/// the first, smoothest fit cuts off must not lose its points. Scanners scatter by 0.5 to 1.5 mm.
const SCALE_MIN_MM: f64 = 0.3;

/// Minimum standard error of a girth, even if the points show no noise, mm: the remaining error of
/// girths on noise-free bodies of known shape, caused by the shape between the points.
const GIRTH_SD_MIN_MM: f64 = 0.1;

/// Maximum residual counted for an outlier, mm: a layer over the skin lies within it; a hand or a
/// speck does not, and its few points should not make a section appear to scatter.
const STRAY_MM: f64 = 6.0;

/// Distance between the outlines that determine the middle of the leg, mm.
const MIDDLE_SPACING_MM: f64 = 20.0;

/// A section counts as seen in a direction if there is a point within this many point spacings of
/// its plane.
const SEEN_SPACINGS: f64 = 1.5;

/// … or within this, mm, if that is more: sweeping scanners put their points in rows that are
/// further apart than the points within a row.
const SEEN_MIN_MM: f64 = 5.5;

/// A section is not measured if a wider angle of its skin was not seen, degrees: less than half of the leg
/// would determine the rest.
const SKIN_GAP_MAX_DEG: f64 = 150.0;

/// Standard error of a girth across a gap, as a share of the girth per cube of the gap in radians: root
/// mean square of bodies without the inner skin of 60, 80, 110 and 140° (docs/accuracy.md).
const GAP_SD_SHARE: f64 = 0.003;

/// A mean residual of up to this many standard errors is noise.
const NOISE_SDS: f64 = 2.0;

/// The error of a bridged gap changes along the leg over this length, mm: the size of a muscle.
const GAP_LENGTH_MM: f64 = 60.0;

/// A tilt by which the dependence of a girth on its plane is found, degrees: a small one.
const TILT_DEG: f64 = 1.0;

/// The slope of the skin along the leg is taken over this distance to each side, mm: a tilt of 3° moves a
/// calf's skin so far out of the plane.
const TILT_REACH_MM: f64 = 3.0;

/// Angles at which a tilted section is looked at.
const TILT_ANGLES: usize = 180;

/// The skin of one leg between two distances along its axis.
#[derive(Debug, Clone)]
pub struct Skin {
    /// The middle of the leg, (front, lateral) in mm from the axis, over the distance along it.
    middle: Middle,
    fit: TensorFit,
    /// The correction to the fitted radius.
    waves: Waves,
    /// How far points may lie off the skin.
    sag: Sag,
    /// The angles at which the girths of its sections are measured.
    spokes: Spokes,
    /// Points of the scan that the fit uses, ordered by their distance along the axis.
    points: Vec<SkinPoint>,
    /// The outliers, ordered likewise.
    outliers: Vec<SkinPoint>,
    /// Mean distance between neighbouring points, mm.
    spacing_mm: f64,
    /// Points per mm along the axis, averaged over the leg.
    points_per_mm: f64,
}

/// A point of the scan in the skin's coordinates.
#[derive(Debug, Clone, Copy)]
struct SkinPoint {
    /// Which point of the mesh it is.
    index: usize,
    along_mm: f64,
    angle: f64,
    radius_mm: f64,
    /// Distance outside the fitted skin.
    residual_mm: f64,
}

impl Skin {
    /// Fits the skin of a leg between two distances along its axis; `None` if there are too few points.
    pub fn fit(leg: &Leg, axis: &LegAxis, from_mm: f64, to_mm: f64) -> Option<Skin> {
        let middle = middle(leg, axis, from_mm, to_mm)?;
        let place = |along_mm: f64| {
            // Both curves have the same basis.
            let row = middle[0].basis.row(along_mm);
            let [front, lateral] = middle.each_ref().map(|curve| row.dot(&curve.coefficients));
            Point2::new(front, lateral)
        };
        let mut points: Vec<SkinPoint> = Vec::new();
        for (index, point) in leg.mesh.points().iter().enumerate() {
            let (along_mm, in_plane) = axis.place(point);
            if (from_mm..=to_mm).contains(&along_mm) {
                let arm = in_plane - place(along_mm);
                let (angle, radius_mm) = (arm.y.atan2(arm.x), arm.norm());
                points.push(SkinPoint { index, along_mm, angle, radius_mm, residual_mm: 0.0 });
            }
        }
        points.sort_unstable_by(|p, q| p.along_mm.total_cmp(&q.along_mm));
        let intervals = ((to_mm - from_mm) / INTERVAL_ALONG_MM).ceil() as usize;
        let along = Basis::uniform_clamped(from_mm, to_mm, intervals).ok()?;
        let column = |value: fn(&SkinPoint) -> f64| points.iter().map(value).collect::<Vec<_>>();
        let (u, v) = (column(|p| p.along_mm), column(|p| p.angle));
        let radii = column(|p| p.radius_mm);
        let data = Scatter { u: &u, v: &v, value: &radii };
        let fit = fit_scatter(&data, along.clone(), INTERVALS_AROUND, SCALE_MIN_MM).ok()?;
        let around = fit.function.around().clone();
        let (weight, sigma) = (fit.weights.as_slice(), fit.sigma);
        let left = Left { along: &u, angle: &v, value: &fit.residuals, weight, sigma };
        let (waves, residuals) = Waves::fit(&left, &along, &around)?;
        for (point, residual) in points.iter_mut().zip(residuals) {
            point.residual_mm = residual;
        }
        let all = points.into_iter().zip(&fit.weights);
        let (believed, others): (Vec<_>, Vec<_>) = all.partition(|(_, weight)| **weight > 0.0);
        let [points, outliers] = [believed, others]
            .map(|part| part.into_iter().map(|(point, _)| point).collect::<Vec<SkinPoint>>());
        let mut places = vec![None; leg.mesh.points().len()];
        points.iter().for_each(|p| places[p.index] = Some([p.along_mm, p.angle]));
        let sag = Sag::measure(&leg.mesh, &places, &fit.function);
        let count = points.len() as f64;
        let area: f64 =
            points.iter().map(|p| TAU * p.radius_mm).sum::<f64>() / count * (to_mm - from_mm);
        let (spacing_mm, points_per_mm) = ((area / count).sqrt(), count / (to_mm - from_mm));
        let spokes = Spokes::at(GIRTH_ANGLES, &around);
        Some(Skin { middle, fit, waves, sag, spokes, points, outliers, spacing_mm, points_per_mm })
    }

    /// The section at a distance along the axis; `None` outside the skin or if too much of it was
    /// not seen.
    pub fn section(&self, axis: &LegAxis, along_mm: f64) -> Option<Section> {
        let near = self.near(&self.points, along_mm);
        let largest_gap_deg = self.largest_gap_deg(along_mm);
        if largest_gap_deg > SKIN_GAP_MAX_DEG {
            return None;
        }
        let coefficients = self.coefficients(along_mm)?;
        let centre = self.centre(along_mm);
        let (r2, rms_mm) = Skin::goodness(near, self.near(&self.outliers, along_mm));
        let girth = self.spokes.girth(&coefficients)?;
        let gap_sd_mm = GAP_SD_SHARE * largest_gap_deg.to_radians().powi(3) * girth.tape_mm;
        let [noise_sd_mm, slope_sd, bend_sd] = self.girth_sd(along_mm, near.len(), gap_sd_mm);
        let missed_mm = TAU * self.missed_mm(along_mm);
        let girth_sd_mm = noise_sd_mm.hypot(missed_mm).hypot(self.sag.girth_sd_mm(along_mm));
        Some(Section {
            along_mm,
            height_mm: axis.at(along_mm, &centre).z,
            centre,
            girth,
            girth_sd: Some([girth_sd_mm, slope_sd, bend_sd]),
            wave_sd_mm: Some(self.waves.sd(along_mm).max(SQRT_2 * noise_sd_mm / TAU)),
            points: near.len(),
            r2,
            rms_mm,
            largest_gap_deg,
            curve: self.curve(coefficients),
        })
    }

    /// The skin's outline at a distance along the axis, bridged where it was not seen; `None`
    /// outside the skin.
    pub fn outline(&self, along_mm: f64) -> Option<Outline> {
        let curve = self.curve(self.coefficients(along_mm)?);
        Some(Outline { along_mm, centre: self.centre(along_mm), curve })
    }

    /// The coefficients of the radius around at a distance along the axis; `None` outside the skin.
    fn coefficients(&self, along_mm: f64) -> Option<Vec<f64>> {
        let (from_mm, to_mm) = self.fit.function.along().domain();
        if !(from_mm..=to_mm).contains(&along_mm) {
            return None;
        }
        let fitted = self.fit.function.around_at(along_mm).into_iter();
        let slow = self.waves.coefficients(along_mm);
        Some(fitted.zip(slow).map(|(fitted, slow)| fitted + slow).collect())
    }

    /// How the tape girth changes where the plane is tilted so that its normal leans to the front, and to
    /// the lateral side, mm per degree; `None` outside the skin.
    pub fn girth_per_deg(&self, along_mm: f64) -> Option<[f64; 2]> {
        let beside = [along_mm - TILT_REACH_MM, along_mm + TILT_REACH_MM];
        let here = self.curve(self.coefficients(along_mm)?);
        let [below, above] = beside.map(|along_mm| self.coefficients(along_mm));
        let [below, above] = [self.curve(below?), self.curve(above?)];
        let drift = (self.centre(beside[1]) - self.centre(beside[0])) / (2.0 * TILT_REACH_MM);
        let point = |angle: f64| {
            let slope = (above.radius(angle) - below.radius(angle)) / (2.0 * TILT_REACH_MM);
            let direction = Vector2::new(angle.cos(), angle.sin());
            (direction * here.radius(angle), direction * slope + drift)
        };
        let points: Vec<_> =
            (0..TILT_ANGLES).map(|i| point(TAU * i as f64 / TILT_ANGLES as f64)).collect();
        let girth_mm = |tilt: Vector2<f64>| {
            let tilted = points.iter().map(|(arm, slope)| {
                let rise_mm = -tilt.dot(arm);
                let moved = arm + slope * rise_mm;
                Point2::from(moved + tilt * (tilt.dot(&moved) / 2.0))
            });
            Some(Hull::from_points(&tilted.collect::<Vec<_>>())?.perimeter())
        };
        let [front, lateral] = [Vector2::x(), Vector2::y()].map(|direction| {
            let tilt = direction * TILT_DEG.to_radians();
            Some((girth_mm(tilt)? - girth_mm(-tilt)?) / (2.0 * TILT_DEG))
        });
        Some([front?, lateral?])
    }

    /// What covers it between two distances along the axis.
    pub fn cloth(&self, span_mm: [f64; 2]) -> Cloth {
        let around = self.fit.function.around();
        let rows: [Row; DIRECTIONS] = std::array::from_fn(|at| around.row(direction(at)));
        let fitted = |along_mm: f64| {
            let coefficients = self.coefficients(along_mm)?;
            Some(rows.each_ref().map(|row| row.dot(&coefficients)))
        };
        let points = self.points.iter().chain(&self.outliers);
        let points = points.map(|point| [point.along_mm, point.angle, point.residual_mm]);
        cloth(points, fitted, self.fit.sigma, span_mm)
    }

    fn curve(&self, coefficients: Vec<f64>) -> Curve {
        Curve::Periodic { coefficients, basis: self.fit.function.around().clone() }
    }

    /// The middle of the leg at a distance along the axis, (front, lateral) in mm from the axis.
    pub fn centre(&self, along_mm: f64) -> Point2<f64> {
        let [front, lateral] = self.middle.each_ref().map(|middle| middle.value(along_mm));
        Point2::new(front, lateral)
    }

    /// Widest angle without points at a distance along the axis, degrees.
    pub fn largest_gap_deg(&self, along_mm: f64) -> f64 {
        let near = self.near(&self.points, along_mm);
        largest_gap_deg(&near.iter().map(|point| point.angle).collect::<Vec<_>>())
    }

    /// Points within this distance of a plane show that it was seen, mm.
    fn reach_mm(&self) -> f64 {
        (SEEN_SPACINGS * self.spacing_mm).max(SEEN_MIN_MM)
    }

    /// The points within that distance of a plane.
    fn near<'p>(&self, points: &'p [SkinPoint], along_mm: f64) -> &'p [SkinPoint] {
        within(points, along_mm, self.reach_mm())
    }

    /// Coefficient of determination of the used points of a section, and root mean square residual
    /// of all points, mm: cloth or a second layer is excluded from the fit, but must be reported.
    fn goodness(believed: &[SkinPoint], outliers: &[SkinPoint]) -> (f64, f64) {
        let count = believed.len() as f64;
        let mean = believed.iter().map(|point| point.radius_mm).sum::<f64>() / count;
        let (mut rss, mut spread) = (0.0, 0.0);
        for point in believed {
            rss += point.residual_mm.powi(2);
            spread += (point.radius_mm - mean).powi(2);
        }
        let off = outliers.iter().map(|point| point.residual_mm.abs().min(STRAY_MM).powi(2));
        let all = count + outliers.len() as f64;
        let rms_mm = ((rss + off.sum::<f64>()) / all).sqrt();
        (r2(rss, spread, mean * mean * count), rms_mm)
    }

    /// Standard error of the girth and of its first two derivatives along the axis, mm: 2π times
    /// that of the mean radius, adjusted to the local number of points, and that of a bridged gap.
    fn girth_sd(&self, along_mm: f64, near: usize, gap_sd_mm: f64) -> [f64; 3] {
        let here = near as f64 / (2.0 * self.reach_mm());
        let scarcity = (self.points_per_mm / here).sqrt();
        let sd = |order| {
            let fitted = scarcity * self.fit.mean_around_sd(along_mm, order);
            TAU * fitted.max(self.waves.mean_sd(along_mm, order))
        };
        let over = |order| gap_sd_mm / GAP_LENGTH_MM.powi(order);
        let [girth, slope, bend] = [0, 1, 2].map(|order| sd(order).hypot(over(order as i32)));
        [girth.hypot(GIRTH_SD_MIN_MM), slope, bend]
    }

    /// How far the points at a plane lie outside or inside the fitted skin on average, mm, beyond what
    /// noise explains: a fold that is narrower than a piece of the fit.
    fn missed_mm(&self, along_mm: f64) -> f64 {
        let near = within(&self.points, along_mm, self.reach_mm() / 2.0);
        let count = near.len().max(1) as f64;
        let mean_mm = near.iter().map(|point| point.residual_mm).sum::<f64>() / count;
        let noise_mm = NOISE_SDS * self.fit.sigma / count.sqrt();
        (mean_mm.powi(2) - noise_mm.powi(2)).max(0.0).sqrt()
    }
}

/// The points (which ascend) within a distance of a plane.
fn within(points: &[SkinPoint], along_mm: f64, reach_mm: f64) -> &[SkinPoint] {
    let first = points.partition_point(|point| point.along_mm < along_mm - reach_mm);
    let last = points.partition_point(|point| point.along_mm <= along_mm + reach_mm);
    &points[first..last]
}

/// The middle of the leg as two smooth curves through the centroids of outlines.
fn middle(leg: &Leg, axis: &LegAxis, from_mm: f64, to_mm: f64) -> Option<Middle> {
    let count = ((to_mm - from_mm) / MIDDLE_SPACING_MM).ceil() as usize;
    let step = (to_mm - from_mm) / count.max(1) as f64;
    let along: Vec<f64> = (0..=count).map(|index| from_mm + step * index as f64).collect();
    let slices = axis.slices(leg, &along);
    let centroids = along.iter().zip(&slices);
    let (places, points): (Vec<f64>, Vec<Point2<f64>>) = centroids
        .filter_map(|(along, slice)| Some((*along, outline_centroid(&axis.points(*along, slice))?)))
        .unzip();
    bend::middle([from_mm, to_mm], &places, &points)
}
