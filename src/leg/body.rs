//! The body frame: right-handed, millimetres, +Z up from the floor, −Y where the toes point, +X
//! the patient's left, origin midway between the feet.

use nalgebra::{Matrix4, Point2, Point3, Rotation3, Translation3, Vector2, Vector3};

use super::method::{Axis, FacingChoice, Method, Unit, UnitChoice, Up};
use super::shell::without_fragments;
use super::slice::Mesh;
use super::stance::{FeetUnclear, NotTwoLegs, Stance, stance};
use crate::scan::Scan;

/// Plausible statures, mm. The ratio of the limits is below that of inch to centimetre, so at most
/// one unit can be plausible.
pub const STATURE_MM: [f64; 2] = [1000.0, 2300.0];

/// A declared facing and the feet must agree within this angle, degrees.
const DECLARED_FACING_MAX_DEG: f64 = 45.0;

/// A scan in the body frame.
#[derive(Debug, Clone)]
pub struct Body {
    /// The skin in the body frame, fragments left out.
    pub mesh: Mesh,
    /// Height of the highest point above the floor, mm.
    pub stature_mm: f64,
    /// Middle of the right and of the left shank, looking along −Z, mm.
    pub shanks: Sides<Point2<f64>>,
    /// Where the toes point in the export: degrees about up, counter-clockwise from above.
    pub facing_deg: f64,
    /// What `facing_deg` was taken from.
    pub facing_from: FacingFrom,
    /// The unit of the export.
    pub unit: Unit,
    /// Whether the unit was found rather than declared.
    pub unit_inferred: bool,
    /// From the export's coordinates, in its own unit, to the body frame.
    pub from_export: Matrix4<f64>,
}

/// One thing for each of the patient's sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides<T> {
    /// The patient's left.
    pub left: T,
    /// The patient's right.
    pub right: T,
}

/// What the facing was taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FacingFrom {
    /// The toes.
    Feet,
    /// The declaration; the feet say nothing, for this reason.
    Declared(FeetUnclear),
}

/// Why a scan is no standing body that can be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BodyFault {
    /// All shells are tiny.
    #[error("nothing but fragments: no connected surface holds more than 0.5 % of the points")]
    OnlyFragments,
    /// No unit gives a plausible stature.
    #[error(
        "no unit makes this a standing person: {} units high along {} ({} × {} × {}); \
         is the body whole in the scan, and is `up` right?",
        figure(*height), up.word(), figure(*x), figure(*y), figure(*z)
    )]
    NoPlausibleUnit {
        /// The axis taken as up.
        up: Up,
        /// Extent along it, export units.
        height: f64,
        /// Extent along x, export units.
        x: f64,
        /// Extent along y, export units.
        y: f64,
        /// Extent along z, export units.
        z: f64,
    },
    /// The declared unit gives no plausible stature.
    #[error(
        "the declared unit {} makes the stature {} mm, outside {} to {} mm: set `unit` to auto, or \
         to what the scanner exports",
        unit.word(), figure(*stature_mm), STATURE_MM[0], STATURE_MM[1]
    )]
    UnitImplausible {
        /// As declared.
        unit: Unit,
        /// What it leads to, mm.
        stature_mm: f64,
    },
    /// There are not two legs on the floor.
    #[error(
        "two shanks are seen at only {pairs} of {heights} heights between 8 % and 15 % of the \
         stature ({most} at most at one height): is nobody there, is a leg hidden, do the legs \
         touch, or is somebody or something beside the patient?"
    )]
    NotTwoLegs {
        /// Heights at which exactly two were seen.
        pairs: usize,
        /// Heights that were looked at.
        heights: usize,
        /// The most that were seen at one height.
        most: usize,
    },
    /// The feet do not show where the body faces and nobody declared it.
    #[error(
        "left and right cannot be told: {0}; both feet must be seen whole, with nothing else on \
         the floor"
    )]
    FacingUnclear(FeetUnclear),
    /// The declared facing and the feet disagree.
    #[error(
        "the declared facing is {off_deg:.0} degrees from where the toes point: set `facing` to \
         auto, or to what the scanner exports"
    )]
    FacingContradicted {
        /// Angle between them, degrees.
        off_deg: f64,
    },
    /// The declared facing is the up axis.
    #[error("the declared facing is along the up axis")]
    FacingVertical,
}

impl BodyFault {
    /// The stable code of this fault, for `reason.json` and programs.
    pub fn code(&self) -> &'static str {
        match self {
            BodyFault::OnlyFragments => "body-only-fragments",
            BodyFault::NoPlausibleUnit { .. } => "body-no-plausible-unit",
            BodyFault::UnitImplausible { .. } => "body-unit-implausible",
            BodyFault::NotTwoLegs { .. } => "body-not-two-legs",
            BodyFault::FacingUnclear(_) => "body-facing-unclear",
            BodyFault::FacingContradicted { .. } => "body-facing-contradicted",
            BodyFault::FacingVertical => "body-facing-vertical",
        }
    }
}

/// A length of unknown unit for people: one decimal, or powers of ten where it is absurd.
fn figure(value: f64) -> String {
    let usual = (0.1..1e6).contains(&value);
    if usual { format!("{value:.1}") } else { format!("{value:.1e}") }
}

impl From<NotTwoLegs> for BodyFault {
    fn from(NotTwoLegs { pairs, heights, most }: NotTwoLegs) -> BodyFault {
        BodyFault::NotTwoLegs { pairs, heights, most }
    }
}

/// Brings a scan into the body frame.
///
/// # Errors
/// A [`BodyFault`] where the scan is no whole standing body or its sides cannot be told.
pub fn body(scan: &Scan, method: &Method) -> Result<Body, BodyFault> {
    let scan = &without_fragments(scan);
    if scan.triangles.is_empty() {
        return Err(BodyFault::OnlyFragments);
    }
    let upright = upright(method.up);
    let (unit, low) = unit(scan, method, &upright)?;
    let to_mm = Translation3::new(0.0, 0.0, -low.z * unit.in_mm()).to_homogeneous()
        * Matrix4::new_scaling(unit.in_mm())
        * upright.to_homogeneous();
    let standing = moved(scan, &to_mm);
    let top_mm = standing.highest_mm();
    let stance = stance(&standing, top_mm)?;
    let (toes, facing_from) = facing(&stance, method.facing, &upright)?;
    let facing = toes.x.atan2(-toes.y);
    let origin = nalgebra::center(&stance.feet[0], &stance.feet[1]);
    let to_body = Rotation3::from_axis_angle(&Vector3::z_axis(), -facing).to_homogeneous()
        * Translation3::new(-origin.x, -origin.y, -stance.floor_mm).to_homogeneous();
    let in_body = |p: Point2<f64>| to_body.transform_point(&Point3::new(p.x, p.y, 0.0)).xy();
    let [a, b] = stance.shanks.map(in_body);
    let (left, right) = if a.x > b.x { (a, b) } else { (b, a) };
    Ok(Body {
        mesh: moved(scan, &(to_body * to_mm)),
        stature_mm: top_mm - stance.floor_mm,
        shanks: Sides { left, right },
        facing_deg: facing.to_degrees(),
        facing_from,
        unit,
        unit_inferred: method.unit == UnitChoice::Auto,
        from_export: to_body * to_mm,
    })
}

/// The rotation that brings the export's up axis to +z and keeps it right-handed.
fn upright(up: Up) -> Rotation3<f64> {
    let columns = match up {
        Up::Y => [Vector3::x(), Vector3::z(), -Vector3::y()],
        Up::Z => [Vector3::x(), Vector3::y(), Vector3::z()],
        Up::X => [Vector3::z(), Vector3::x(), Vector3::y()],
    };
    Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_columns(&columns))
}

/// The unit of the export and the lowest corner of the upright body in it.
fn unit(
    scan: &Scan,
    method: &Method,
    upright: &Rotation3<f64>,
) -> Result<(Unit, Point3<f64>), BodyFault> {
    let points = scan.points.iter().map(|point| upright * point);
    let none = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
    let (low, high) = points.fold(none, |(low, high), p| (low.inf(&p), high.sup(&p)));
    let extent = high - low;
    let [least, most] = STATURE_MM;
    let plausible = |unit: &Unit| (least..=most).contains(&(extent.z * unit.in_mm()));
    let found = match method.unit {
        UnitChoice::Declared(unit) if plausible(&unit) => unit,
        UnitChoice::Declared(unit) => {
            let stature_mm = extent.z * unit.in_mm();
            return Err(BodyFault::UnitImplausible { unit, stature_mm });
        }
        UnitChoice::Auto => Unit::ALL.into_iter().find(plausible).ok_or_else(|| {
            let own = (upright.inverse() * extent).abs();
            let (up, height) = (method.up, extent.z);
            BodyFault::NoPlausibleUnit { up, height, x: own.x, y: own.y, z: own.z }
        })?,
    };
    Ok((found, low))
}

/// The scan's mesh under an affine map.
fn moved(scan: &Scan, map: &Matrix4<f64>) -> Mesh {
    let points = scan.points.iter().map(|p| map.transform_point(p)).collect();
    Mesh::new(points, scan.triangles.clone())
}

/// Where the toes point in the upright frame, by the feet, checked against the declaration.
fn facing(
    stance: &Stance,
    choice: FacingChoice,
    upright: &Rotation3<f64>,
) -> Result<(Vector2<f64>, FacingFrom), BodyFault> {
    let FacingChoice::Declared(axis) = choice else {
        return stance.toes.map(|t| (t, FacingFrom::Feet)).map_err(BodyFault::FacingUnclear);
    };
    let declared = (upright * direction(axis)).xy();
    if declared.norm() < 0.5 {
        return Err(BodyFault::FacingVertical);
    }
    let toes = match stance.toes {
        Ok(toes) => toes,
        // The floor is not where it seems, so heights would be wrong as well.
        Err(unclear @ FeetUnclear::NoFoot { .. }) => return Err(BodyFault::FacingUnclear(unclear)),
        Err(unclear) => return Ok((declared, FacingFrom::Declared(unclear))),
    };
    let off_deg = declared.angle(&toes).to_degrees();
    if off_deg > DECLARED_FACING_MAX_DEG {
        return Err(BodyFault::FacingContradicted { off_deg });
    }
    Ok((toes, FacingFrom::Feet))
}

fn direction(axis: Axis) -> Vector3<f64> {
    match axis {
        Axis::PlusX => Vector3::x(),
        Axis::MinusX => -Vector3::x(),
        Axis::PlusY => Vector3::y(),
        Axis::MinusY => -Vector3::y(),
        Axis::PlusZ => Vector3::z(),
        Axis::MinusZ => -Vector3::z(),
    }
}
