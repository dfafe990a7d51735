//! A leg at one visit laid over the same leg at another one, by the shank.
//!
//! The shank is the part that is least deformed from visit to visit. The axes of both shanks are laid on each
//! other first; then the skin of the shank is fitted, point to plane (Chen and Medioni 1992). An even
//! swelling of a height changes nothing, because only what differs around the leg counts, and the length from
//! the floor is kept: it is what girths are compared by.

use gaiter_record::Record;
use gaiter_record::schema::LegFigures;
use gaiter_record::shape::{AxisFigures, Packed};
use nalgebra::{Matrix3, Matrix6, Point3, Rotation3, Unit, Vector3, Vector6};

use super::stance::KNEE_SHARE;

/// The lowest and, below the knee, the highest place of the skin that counts, mm: between the malleoli and the
/// hollow of the knee.
const SHANK_MM: [f64; 2] = [120.0, 60.0];

/// Where the knee is taken for if the stature is not known, mm.
const KNEE_UNKNOWN_MM: f64 = 440.0;

/// Steps of the fit; it converges in about five.
const STEPS: usize = 12;

/// The fewest rings of skin that a shank needs.
const RINGS_MIN: usize = 6;

/// Only points of the other skin within this height can be the nearest, mm; rows are 10 mm apart.
const REACH_MM: f64 = 25.0;

/// A place farther from the nearest point of the other skin, along it, has no distance, mm.
const ASIDE_MAX_MM: f64 = 12.0;

/// How strongly the length from the floor is kept, against the number of points.
const KEPT: f64 = 10.0;

/// A leg laid over another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    rotation: Rotation3<f64>,
    shift: Vector3<f64>,
    /// What still differs around the shank, root mean square, mm: the error of the registration, and what of
    /// the leg has changed unevenly.
    pub error_mm: f64,
}

/// The skin of a leg in closed rings from the bottom up.
#[derive(Debug, Clone, PartialEq)]
pub struct Rings {
    rings: Vec<Ring>,
}

#[derive(Debug, Clone, PartialEq)]
struct Ring {
    /// Mean height, mm.
    height_mm: f64,
    points: Vec<Point3<f64>>,
    /// Unit vectors outwards.
    normals: Vec<Vector3<f64>>,
}

impl Registration {
    /// Lays the earlier leg over the later one. `None` if one of them has too little of the shank.
    pub fn new(record: &Record, earlier: &LegFigures, later: &LegFigures) -> Option<Registration> {
        let (from, to) = (&earlier.axis, &later.axis);
        let knee_mm = record.body.stature_mm.map_or(KNEE_UNKNOWN_MM, |mm| KNEE_SHARE * mm);
        let [skin, target] =
            [earlier, later].map(|leg| Rings::new(&leg.shape.skin.points, leg.shape.skin.columns));
        let shank = SHANK_MM[0]..knee_mm - SHANK_MM[1];
        let shank: Vec<&Ring> =
            skin.rings.iter().filter(|ring| shank.contains(&ring.height_mm)).collect();
        if shank.len() < RINGS_MIN || target.rings.len() < RINGS_MIN {
            return None;
        }
        let mut fitted = Registration::by_axes(from, to);
        let up = Vector3::from(to.direction);
        for _ in 0..STEPS {
            fitted = fitted.refined(&shank, &target, &up)?;
        }
        Some(fitted)
    }

    /// A place of the earlier leg, laid over the later one.
    pub fn at(&self, point: &Point3<f64>) -> Point3<f64> {
        self.rotation * point + self.shift
    }

    fn by_axes(from: &AxisFigures, to: &AxisFigures) -> Registration {
        let frame = |axis: &AxisFigures| {
            let columns = [axis.front, axis.lateral, axis.direction].map(Vector3::from);
            Matrix3::from_columns(&columns)
        };
        let rotation = Rotation3::from_matrix(&(frame(to) * frame(from).transpose()));
        let shift = Vector3::from(to.foot_mm) - rotation * Vector3::from(from.foot_mm);
        Registration { rotation, shift, error_mm: f64::INFINITY }
    }

    /// One Gauss–Newton step on the distances of the shank's points from the planes nearest to them, each less
    /// the mean of its ring.
    fn refined(&self, shank: &[&Ring], target: &Rings, up: &Vector3<f64>) -> Option<Registration> {
        let centre = Vector3::from(target.rings[0].points[0].coords);
        let (mut normal, mut right) = (Matrix6::zeros(), Vector6::zeros());
        let (mut squares, mut count) = (0.0, 0.0);
        for ring in shank {
            let mut rows: Vec<(Vector6<f64>, f64)> = Vec::new();
            for point in &ring.points {
                let at = self.at(point);
                let Some((distance_mm, outwards)) = target.distance(&at) else { continue };
                let turn = (at.coords - centre).cross(&outwards);
                rows.push((
                    Vector6::new(turn.x, turn.y, turn.z, outwards.x, outwards.y, outwards.z),
                    distance_mm,
                ));
            }
            let own = rows.len() as f64;
            if own < 3.0 {
                continue;
            }
            let mean = rows.iter().fold((Vector6::zeros(), 0.0), |(row, distance), of| {
                (row + of.0 / own, distance + of.1 / own)
            });
            for (row, distance_mm) in rows {
                let (row, distance_mm) = (row - mean.0, distance_mm - mean.1);
                normal += row * row.transpose();
                right -= row * distance_mm;
                squares += distance_mm * distance_mm;
                count += 1.0;
            }
        }
        let kept = Vector6::new(0.0, 0.0, 0.0, up.x, up.y, up.z);
        normal += kept * kept.transpose() * (KEPT * count);
        let step = normal.cholesky()?.solve(&right);
        let (turn, shift) = (Vector3::new(step[0], step[1], step[2]), step.fixed_rows::<3>(3));
        let angle = turn.norm();
        let turn = match angle > 0.0 {
            true => Rotation3::from_axis_angle(&Unit::new_normalize(turn), angle),
            false => Rotation3::identity(),
        };
        Some(Registration {
            rotation: turn * self.rotation,
            shift: turn * (self.shift - centre) + centre + shift,
            error_mm: (squares / count).sqrt(),
        })
    }
}

impl Rings {
    /// The rings of this many points each; those that do not close are left out.
    pub fn new(points: &Packed, columns: usize) -> Rings {
        let points = points.as_points();
        let rows = points.chunks(columns.max(3));
        let rows: Vec<Vec<Point3<f64>>> =
            rows.filter_map(|row| row.iter().copied().collect()).collect();
        let last = rows.len().saturating_sub(1);
        let ring = |(at, row): (usize, &Vec<Point3<f64>>)| {
            let (below, above) = (&rows[at.saturating_sub(1)], &rows[(at + 1).min(last)]);
            let centre =
                row.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / row.len() as f64;
            let normal = |column: usize| {
                let around =
                    row[(column + 1) % row.len()] - row[(column + row.len() - 1) % row.len()];
                let upwards = above[column] - below[column];
                let normal = around.cross(&upwards);
                let outwards = row[column].coords - centre;
                let normal = if normal.dot(&outwards) < 0.0 { -normal } else { normal };
                normal.try_normalize(f64::EPSILON).unwrap_or(outwards)
            };
            let normals = (0..row.len()).map(normal).collect();
            Ring { height_mm: centre.z, points: row.clone(), normals }
        };
        Rings { rings: rows.iter().enumerate().map(ring).collect() }
    }

    /// The rings laid over another leg.
    pub fn laid(&self, by: &Registration) -> Rings {
        let ring = |ring: &Ring| {
            let points: Vec<Point3<f64>> = ring.points.iter().map(|point| by.at(point)).collect();
            let normals = ring.normals.iter().map(|normal| by.rotation * normal).collect();
            let sum: f64 = points.iter().map(|point| point.z).sum();
            Ring { height_mm: sum / points.len() as f64, points, normals }
        };
        Rings { rings: self.rings.iter().map(ring).collect() }
    }

    /// All points.
    pub fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.rings.iter().flat_map(|ring| &ring.points)
    }

    /// How far a place lies outside this skin, mm, negative inside, and the direction outwards there; `None`
    /// if the skin does not reach there.
    pub fn distance(&self, at: &Point3<f64>) -> Option<(f64, Vector3<f64>)> {
        let near = self.rings.iter().filter(|ring| (ring.height_mm - at.z).abs() < REACH_MM);
        let points = near.flat_map(|ring| ring.points.iter().zip(&ring.normals));
        let (point, normal) = points.min_by(|one, other| {
            (one.0 - at).norm_squared().total_cmp(&(other.0 - at).norm_squared())
        })?;
        let arm = at - point;
        let distance_mm = arm.dot(normal);
        let aside_mm = (arm.norm_squared() - distance_mm * distance_mm).max(0.0).sqrt();
        (aside_mm < ASIDE_MAX_MM).then_some((distance_mm, *normal))
    }
}
