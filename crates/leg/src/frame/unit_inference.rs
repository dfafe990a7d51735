//! The size of a scan: the unit of its coordinates is the only one that makes it a plausible person
//! or leg.

use gaiter_scan::Scan;
use nalgebra::{Point3, Rotation3, Vector3};

use super::body_fault::{BodyFault, STATURE_MM};
use super::soles::long_axis;
use crate::method::{Method, Unit, UnitChoice};

/// Points below this height belong to a lone leg's foot, mm: under the ankle.
const LONE_FOOT_MM: f64 = 60.0;

/// Lengths of feet, mm, from a child's to the longest; the ratio of the limits is below that of
/// inch to centimetre, so at most one unit can be plausible.
const LONE_FOOT_LENGTH_MM: [f64; 2] = [150.0, 340.0];

/// Heights of scans of a lone leg or lower leg, mm: more than half a calf, less than a long leg.
const LONE_LEG_MM: [f64; 2] = [200.0, 1150.0];

/// Length of the foot as a share of stature (ANSUR II, mean of men and women).
pub(super) const FOOT_LENGTH_MEAN_SHARE: f64 = 0.152;

/// Lowest and highest corner of the points.
pub(crate) fn extent(points: impl Iterator<Item = Point3<f64>>) -> (Point3<f64>, Point3<f64>) {
    let none = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
    points.fold(none, |(low, high), p| (low.inf(&p), high.sup(&p)))
}

/// The unit of a standing body with this extent, upright, in export units, and its stature, mm. `is_child`: whether its
/// head is a child's.
pub(crate) fn whole_body(
    method: &Method,
    upright: &Rotation3<f64>,
    extent: Vector3<f64>,
    is_child: impl Fn() -> bool,
) -> Result<(Unit, f64), BodyFault> {
    let [least, most] = STATURE_MM;
    let plausible = |unit: &Unit| (least..=most).contains(&(extent.z * unit.in_mm()));
    let unit = match method.unit {
        UnitChoice::Declared(unit) if plausible(&unit) => unit,
        UnitChoice::Declared(unit) => {
            let stature_mm = extent.z * unit.in_mm();
            return Err(BodyFault::UnitImplausible { unit, stature_mm });
        }
        UnitChoice::Auto => {
            let mut found: Vec<Unit> = Unit::ALL.into_iter().filter(plausible).collect();
            found.sort_by(|a, b| a.in_mm().total_cmp(&b.in_mm()));
            match found.as_slice() {
                &[child, _, ..] if is_child() => child,
                &[.., adult] => adult,
                [] => {
                    let [x, y, z]: [f64; 3] = (upright.inverse() * extent).abs().into();
                    let (up, height) = (method.up, extent.z);
                    return Err(BodyFault::NoPlausibleUnit { up, height, x, y, z });
                }
            }
        }
    };
    Ok((unit, extent.z * unit.in_mm()))
}

/// The unit of a lone leg between two heights, export units, and the stature that search heights are relative to, mm:
/// inferred from its foot, because a leg may be cut anywhere.
pub(crate) fn lone_leg(
    scan: &Scan,
    method: &Method,
    upright: &Rotation3<f64>,
    [low, high]: [f64; 2],
) -> Result<(Unit, f64), BodyFault> {
    let foot_length = |unit: Unit| {
        let top = low + LONE_FOOT_MM / unit.in_mm();
        let points = scan.points.iter().map(|point| upright * point);
        let foot: Vec<[f64; 3]> = points.filter(|p| p.z < top).map(|p| [p.x, p.y, p.z]).collect();
        long_axis(&foot).length
    };
    let plausible = |unit: &Unit| {
        let (foot_mm, height_mm) = (foot_length(*unit) * unit.in_mm(), (high - low) * unit.in_mm());
        (LONE_FOOT_LENGTH_MM[0]..=LONE_FOOT_LENGTH_MM[1]).contains(&foot_mm)
            && (LONE_LEG_MM[0]..=LONE_LEG_MM[1]).contains(&height_mm)
    };
    let units: Vec<Unit> = match method.unit {
        UnitChoice::Declared(unit) => vec![unit],
        UnitChoice::Auto => Unit::ALL.to_vec(),
    };
    let found: Vec<Unit> = units.iter().copied().filter(plausible).collect();
    let &[unit] = found.as_slice() else {
        let foot = units.first().map_or(0.0, |unit| foot_length(*unit));
        return Err(BodyFault::NoPlausibleLeg { height: high - low, foot });
    };
    Ok((unit, foot_length(unit) * unit.in_mm() / FOOT_LENGTH_MEAN_SHARE))
}
