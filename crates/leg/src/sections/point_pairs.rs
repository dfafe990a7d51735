//! The paper's points of a section (paper 1.1, steps 1 and 2; fig. 2b, 2c): each point near the
//! plane is paired with the nearest point on the plane's other side, and the line through both
//! intersects the plane.
//!
//! Only points are used, never triangles. The line is a chord of the skin: between points e apart
//! it lies up to e²/8R inside, which the paper accepts.

use nalgebra::{Point2, Point3};

use super::axis::LegAxis;
use super::polynomial;
use super::section::SPACING_MM;
use crate::parting::segment::Leg;

/// Points near a plane: the square of the polynomial's order. About this many random points keep a
/// least-squares polynomial from oscillating (Cohen, Davenport and Leviatan, On the stability and
/// accuracy of least squares approximations, 2013); with half as many, its girths are off by
/// centimetres.
const NEAR_POINTS: f64 = (polynomial::ORDER * polynomial::ORDER) as f64;

/// The points of a leg in the frame of its axis, ready for pairing across planes.
#[derive(Debug, Clone)]
pub struct Pairs {
    /// (Front, lateral, along) in mm, ascending along the axis.
    points: Vec<Point3<f64>>,
    /// A point up to this far from a plane is near it, mm.
    threshold_mm: f64,
}

impl Pairs {
    /// All points of a leg; `None` if none lies between the two distances along the axis.
    ///
    /// The paper's threshold is "preset" and not given. Here it is the distance within which an
    /// average plane between the two distances has 225 points. It is at least the distance between
    /// planes, so that each plane has points nearby even if the scanner puts its points in rows.
    pub fn find(leg: &Leg, axis: &LegAxis, [from_mm, to_mm]: [f64; 2]) -> Option<Pairs> {
        let place = |point: &Point3<f64>| {
            let (along_mm, in_plane) = axis.place(point);
            Point3::new(in_plane.x, in_plane.y, along_mm)
        };
        let mut points: Vec<Point3<f64>> = leg.mesh.points().iter().map(place).collect();
        points.sort_by(|p, q| {
            p.z.total_cmp(&q.z).then(p.x.total_cmp(&q.x)).then(p.y.total_cmp(&q.y))
        });
        let within = points.iter().filter(|point| (from_mm..=to_mm).contains(&point.z)).count();
        if within == 0 {
            return None;
        }
        let points_per_mm = within as f64 / (to_mm - from_mm);
        let threshold_mm = (NEAR_POINTS / points_per_mm / 2.0).max(SPACING_MM);
        Some(Pairs { points, threshold_mm })
    }

    /// Points where the lines of the pairs intersect the plane at a distance along the axis,
    /// (front, lateral) in mm. Two points that are each other's nearest give their point twice.
    pub fn on_plane(&self, along_mm: f64) -> Vec<Point2<f64>> {
        let (below, above) =
            self.points.split_at(self.points.partition_point(|point| point.z < along_mm));
        let is_near = |point: &&Point3<f64>| (point.z - along_mm).abs() <= self.threshold_mm;
        let lower = below.iter().rev().take_while(is_near);
        let upper = above.iter().take_while(is_near);
        let upwards = lower.filter_map(|own| Some((own, nearest(own, above.iter())?)));
        let downwards = upper.filter_map(|own| Some((own, nearest(own, below.iter().rev())?)));
        upwards.chain(downwards).map(|(own, other)| meeting(own, other, along_mm)).collect()
    }
}

/// The nearest to a point among others in order of increasing distance along the axis: once that
/// distance exceeds the distance to the best one, none that follow can be nearer.
fn nearest<'a>(
    own: &Point3<f64>,
    others: impl Iterator<Item = &'a Point3<f64>>,
) -> Option<&'a Point3<f64>> {
    let mut best: Option<(&Point3<f64>, f64)> = None;
    for other in others {
        let along = other.z - own.z;
        let square = (other - own).norm_squared();
        match best {
            Some((_, least)) if along * along >= least => break,
            Some((_, least)) if square >= least => {}
            _ => best = Some((other, square)),
        }
    }
    best.map(|(point, _)| point)
}

/// The intersection of a plane with the line through a point below it and one above it, in either
/// order.
fn meeting(p: &Point3<f64>, q: &Point3<f64>, along_mm: f64) -> Point2<f64> {
    p.xy() + (q.xy() - p.xy()) * ((along_mm - p.z) / (q.z - p.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sections::slice::Mesh;
    use crate::side::Side;
    use nalgebra::Vector3;
    use std::f64::consts::{PI, TAU};

    const SPAN_MM: [f64; 2] = [20.0, 180.0];

    /// A leg without triangles.
    fn leg(side: Side, points: Vec<Point3<f64>>) -> Leg {
        Leg { side, mesh: Mesh::cloud(points, 1.0), cut_mm: None }
    }

    fn upright(side: Side) -> LegAxis {
        LegAxis::straight(Point3::origin(), &Vector3::z(), side)
    }

    /// Points in golden-angle turns on a tube up to 200 mm: evenly spread, none directly above another.
    fn spiral(count: u32, radius: impl Fn(f64) -> f64) -> Vec<Point3<f64>> {
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let at = |i: u32| {
            let (angle, z) = (golden * f64::from(i), 200.0 * f64::from(i) / f64::from(count));
            Point3::new(radius(angle) * angle.sin(), -radius(angle) * angle.cos(), z)
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn places_on_a_cylinder_lie_inside_it_by_no_more_than_the_sagitta_of_a_pair() {
        let (radius_mm, count) = (30.0, 1500);
        let leg = leg(Side::Left, spiral(count, |_| radius_mm));
        let pairs = Pairs::find(&leg, &upright(Side::Left), SPAN_MM).unwrap();
        let spacing_mm = (TAU * radius_mm * 200.0 / f64::from(count)).sqrt();
        // A point is paired with one near its own projection onto the plane: less than two spacings
        // aside.
        let sagitta_mm = (2.0 * spacing_mm).powi(2) / (8.0 * radius_mm);
        for along_mm in (20..180).map(|z| f64::from(z) + 0.3) {
            let places = pairs.on_plane(along_mm);
            assert!(places.len() > 30, "{along_mm} mm: {} places", places.len());
            for place in places {
                let inside_mm = radius_mm - place.coords.norm();
                assert!((-1e-9..sagitta_mm).contains(&inside_mm), "{along_mm} mm: {inside_mm}");
            }
        }
    }

    #[test]
    fn places_on_a_cone_of_rows_are_the_cone_at_the_plane_itself() {
        // Rows of points directly above each other: every pair lies on a straight line of the cone.
        let at = |row: u32, column: u32| {
            let (angle, z) = (TAU * f64::from(column) / 60.0, 4.0 * f64::from(row));
            let radius = 20.0 + 0.1 * z;
            Point3::new(radius * angle.sin(), -radius * angle.cos(), z)
        };
        let points = (0..50).flat_map(|row| (0..60).map(move |column| at(row, column))).collect();
        let pairs = Pairs::find(&leg(Side::Left, points), &upright(Side::Left), SPAN_MM).unwrap();
        for along_mm in [41.0, 57.9, 60.0, 123.4] {
            let places = pairs.on_plane(along_mm);
            assert!(places.len() >= 120, "both rows of a plane: {}", places.len());
            for place in places {
                let off = place.coords.norm() - (20.0 + 0.1 * along_mm);
                assert!(off.abs() < 1e-9, "{along_mm} mm: {off}");
            }
        }
    }

    #[test]
    fn pairs_are_those_of_comparing_every_point() {
        let leg = leg(Side::Left, spiral(900, |angle| 40.0 + 6.0 * (3.0 * angle).cos()));
        let pairs = Pairs::find(&leg, &upright(Side::Left), SPAN_MM).unwrap();
        for along_mm in [30.0, 77.7, 140.0] {
            let is_below = |point: &Point3<f64>| point.z < along_mm;
            let mut expected = Vec::new();
            for own in &pairs.points {
                if (own.z - along_mm).abs() <= pairs.threshold_mm {
                    let far = |p: &&Point3<f64>| (*p - own).norm_squared();
                    let others = pairs.points.iter().filter(|p| is_below(p) != is_below(own));
                    let other = others.min_by(|p, q| far(p).total_cmp(&far(q))).unwrap();
                    expected.push(meeting(own, other, along_mm));
                }
            }
            let mut found = pairs.on_plane(along_mm);
            let order =
                |p: &Point2<f64>, q: &Point2<f64>| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y));
            found.sort_by(order);
            expected.sort_by(order);
            assert_eq!(found, expected, "{along_mm} mm");
        }
    }

    #[test]
    fn a_mirrored_leg_of_the_other_side_has_the_same_places() {
        let points = spiral(900, |angle| 40.0 + 6.0 * (angle - 0.4).cos());
        let mirrored = points.iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect();
        let of = |side, points| Pairs::find(&leg(side, points), &upright(side), SPAN_MM).unwrap();
        let (left, right) = (of(Side::Left, points), of(Side::Right, mirrored));
        assert_eq!(left.on_plane(101.5), right.on_plane(101.5));
    }

    #[test]
    fn the_average_plane_has_225_points_near_it_unless_the_planes_are_further_apart() {
        let threshold_mm = |count| {
            let leg = leg(Side::Left, spiral(count, |_| 50.0));
            Pairs::find(&leg, &upright(Side::Left), SPAN_MM).unwrap().threshold_mm
        };
        // 4 points per millimetre, then 100.
        assert!((threshold_mm(800) - 225.0 / 4.0 / 2.0).abs() < 0.2, "{}", threshold_mm(800));
        assert_eq!(threshold_mm(20_000), SPACING_MM);
    }

    #[test]
    fn a_plane_with_points_on_one_side_only_has_no_place() {
        let leg = leg(Side::Left, spiral(900, |_| 40.0));
        let pairs = Pairs::find(&leg, &upright(Side::Left), SPAN_MM).unwrap();
        assert!(pairs.on_plane(200.5).is_empty() && pairs.on_plane(-0.5).is_empty());
        assert!(Pairs::find(&leg, &upright(Side::Left), [300.0, 400.0]).is_none());
    }
}
