//! The body frame: right-handed, millimetres, +Z up from the floor, −Y in the direction of the
//! toes, +X the patient's left, origin midway between the feet.

use gaiter_scan::Scan;
use nalgebra::{
    Matrix4, Point2, Point3, Rotation3, Translation3, UnitQuaternion, Vector2, Vector3,
};

use super::body_fault::BodyFault;
use super::components::without_fragments;
use super::floor_plane::above_floor;
use super::layers::unlinked_share;
use super::point_cloud;
use super::soles::FloorDoubt;
use super::stance::{FeetUnclear, Stance, stance};
use super::unit_inference::{Size, extent, lone_leg, whole_body};
use super::winding;
use crate::method::{Axis, FacingChoice, Method, Scope, Unit, UnitChoice, Up};
use crate::parting::cluster::clusters;
use crate::parting::leg_tracking::{link_mm, slices};
use crate::sections::gap::{GAP_MAX_DEG, largest_gap_deg};
use crate::sections::hull::Hull;
use crate::sections::slice::Mesh;
use crate::side::{Side, Sides};

/// A declared facing and the feet must agree within this angle, degrees.
const DECLARED_FACING_MAX_DEG: f64 = 45.0;

/// Heights at which the trunk is examined, as shares of stature: above every crotch, below the ribs.
const TRUNK_SHARES: [f64; 4] = [0.57, 0.59, 0.61, 0.63];

/// A lone leg stands at least this far from the trunk's middle, mm; hips are 80 to 100 mm from it,
/// and a patient who stands on one leg moves that leg inwards.
const BESIDE_TRUNK_MIN_MM: f64 = 40.0;

/// Standard error of the stature by the crown, as a share: hair, a cap, a bent neck.
const CROWN_SD_SHARE: f64 = 0.01;

/// … and by the length of a foot, of which people's differ (ANSUR II: 0.152 ± 0.006).
const FOOT_SD_SHARE: f64 = 0.04;

/// Legs of which a larger share of points lies beside another skin are two skins, see [`unlinked_share`].
const UNLINKED_MAX_SHARE: f64 = 0.4;

/// A scan in the body frame.
#[derive(Debug, Clone)]
pub struct Body {
    /// The skin in the body frame, fragments left out.
    pub mesh: Mesh,
    /// Height of the highest point above the floor, mm; `None` if only a leg was scanned.
    pub stature_mm: Option<f64>,
    /// The stature that search heights are relative to: the body's own, or one inferred from a lone
    /// leg's foot, mm.
    pub scale_mm: f64,
    /// Standard error of `scale_mm`, as a share of it.
    pub scale_sd_share: f64,
    /// Middle of each shank that is present, looking along −Z, mm.
    pub shanks: Sides<Option<Point2<f64>>>,
    /// Standard error of the floor's height, mm.
    pub floor_sd_mm: f64,
    /// What speaks against the floor.
    pub floor_doubt: Option<FloorDoubt>,
    /// Direction of the toes in the export: degrees about up, counter-clockwise from above.
    pub facing_deg: f64,
    /// The source of `facing_deg`.
    pub facing_from: FacingFrom,
    /// Whether the triangles show that the export is not mirrored.
    pub is_mirror_checked: bool,
    /// The unit of the export.
    pub unit: Unit,
    /// Whether the unit was inferred rather than declared.
    pub unit_inferred: bool,
    /// Transform from the export's coordinates, in its own unit, to the body frame.
    pub from_export: Matrix4<f64>,
}

/// The source of the facing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FacingFrom {
    /// The toes.
    Feet,
    /// The declaration, because the feet do not show the facing, for this reason.
    Declared(FeetUnclear),
}

/// Transforms a scan into the body frame.
///
/// # Errors
/// A [`BodyFault`] if the scan is not a whole standing body, or not a lone leg where one was
/// declared, or if its sides cannot be determined.
pub fn body(scan: &Scan, method: &Method) -> Result<Body, BodyFault> {
    let scan = &without_fragments(scan);
    if scan.points.is_empty() {
        return Err(BodyFault::OnlyFragments);
    }
    let upright = upright(method.up);
    let above = match method.scope {
        Scope::Body => above_floor(scan, &upright),
        Scope::Leg(_) => None,
    };
    let (above, floor) = above.unzip();
    let above = above.map(|above| without_fragments(&above));
    let scan = above.as_ref().unwrap_or(scan);
    let (low, high) = extent(scan.points.iter().map(|point| upright * point));
    let size = match method.scope {
        Scope::Body => whole_body(method, &upright, high - low)?,
        Scope::Leg(_) => lone_leg(scan, method, &upright, [low.z, high.z])?,
    };
    let unit = size.unit;
    let to_mm = Translation3::new(0.0, 0.0, -low.z * unit.in_mm()).to_homogeneous()
        * Matrix4::new_scaling(unit.in_mm())
        * upright.to_homogeneous();
    let standing = moved(scan, &to_mm, unit);
    let (stance, (wound, unlinked_share)) = rayon::join(
        || stance(&standing, size.scale_mm, floor.map(|floor| (floor - low.z) * unit.in_mm())),
        || (winding::check(&standing, method.winding), unlinked_share(&standing, size.scale_mm)),
    );
    let stance = stance?;
    let is_mirror_checked = wound?;
    if unlinked_share > UNLINKED_MAX_SHARE {
        return Err(BodyFault::Layers { percent: 100.0 * unlinked_share });
    }
    let (toes, facing_from) = facing(&stance, method.facing, &upright)?;
    let facing = toes.x.atan2(-toes.y);
    let (sides, origin) = sides(&standing, &stance, toes, &size, method.scope)?;
    let to_body = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -facing)
        * Translation3::new(-origin.x, -origin.y, -stance.floor.height_mm);
    let in_body = |p: Point2<f64>| (to_body * Point3::new(p.x, p.y, 0.0)).xy();
    let stature_mm = size.is_whole.then(|| standing.highest_mm() - stance.floor.height_mm);
    Ok(Body {
        mesh: standing.moved(&to_body),
        stature_mm,
        scale_mm: stature_mm.unwrap_or(size.scale_mm),
        scale_sd_share: if stature_mm.is_some() { CROWN_SD_SHARE } else { FOOT_SD_SHARE },
        shanks: Sides { left: sides.left.map(in_body), right: sides.right.map(in_body) },
        floor_sd_mm: stance.floor.sd_mm,
        floor_doubt: stance.floor.doubt,
        facing_deg: facing.to_degrees(),
        facing_from,
        is_mirror_checked,
        unit,
        unit_inferred: method.unit == UnitChoice::Auto,
        from_export: to_body.to_homogeneous() * to_mm,
    })
}

/// Middle of each shank that is present.
type Shanks = Sides<Option<Point2<f64>>>;

/// The shank of each side, and the point on the floor that becomes the origin.
fn sides(
    standing: &Mesh,
    stance: &Stance,
    toes: Vector2<f64>,
    size: &Size,
    scope: Scope,
) -> Result<(Shanks, Point2<f64>), BodyFault> {
    let left = Vector2::new(-toes.y, toes.x);
    match (scope, stance.shanks.as_slice(), stance.feet.as_slice()) {
        (Scope::Body, &[a, b], &[foot_a, foot_b]) => {
            let (left, right) = if (a - b).dot(&left) > 0.0 { (a, b) } else { (b, a) };
            let both = Sides { left: Some(left), right: Some(right) };
            Ok((both, nalgebra::center(&foot_a, &foot_b)))
        }
        (Scope::Body, &[shank], &[foot]) => {
            let trunk = trunk_middle(standing, size.scale_mm).unwrap_or(shank);
            let off_mm = (shank - trunk).dot(&left);
            if off_mm.abs() < BESIDE_TRUNK_MIN_MM {
                return Err(BodyFault::SideUnclear { off_mm: off_mm.abs() });
            }
            let side = if off_mm > 0.0 { Side::Left } else { Side::Right };
            Ok((only(side, shank), trunk + toes * (foot - trunk).dot(&toes)))
        }
        (Scope::Leg(side), &[shank], &[foot]) => Ok((only(side, shank), foot)),
        _ => Err(BodyFault::TwoLegs),
    }
}

fn only(side: Side, shank: Point2<f64>) -> Shanks {
    Sides::of_each(|of| (of == side).then_some(shank))
}

/// The middle of the trunk: of the largest outline at heights above the crotch. `None` if it is not
/// seen from all sides, because the middle of half a trunk is elsewhere.
fn trunk_middle(standing: &Mesh, stature_mm: f64) -> Option<Point2<f64>> {
    let heights: Vec<f64> = TRUNK_SHARES.iter().map(|share| share * stature_mm).collect();
    let link_mm = link_mm(standing);
    let slices = slices(standing, &heights);
    let middles: Vec<Point2<f64>> =
        slices.iter().filter_map(|slice| outline_middle(slice, link_mm)).collect();
    let sum: Vector2<f64> = middles.iter().map(|middle| middle.coords).sum();
    (!middles.is_empty()).then(|| (sum / middles.len() as f64).into())
}

/// The middle of the largest outline in a slice, if it is closed.
fn outline_middle(slice: &[Point2<f64>], link_mm: f64) -> Option<Point2<f64>> {
    let outlines = clusters(slice, link_mm).into_iter();
    let hulls = outlines.filter_map(|outline| Some((Hull::of(&outline)?, outline)));
    let (hull, outline) = hulls.max_by(|a, b| a.0.perimeter().total_cmp(&b.0.perimeter()))?;
    let middle = hull.centroid();
    let angles: Vec<f64> =
        outline.iter().map(|point| (point.y - middle.y).atan2(point.x - middle.x)).collect();
    (largest_gap_deg(&angles) < GAP_MAX_DEG).then_some(middle)
}

/// The rotation that turns the export's up axis to +z and stays right-handed.
pub(crate) fn upright(up: Up) -> Rotation3<f64> {
    let columns = match up {
        Up::Y => [Vector3::x(), Vector3::z(), -Vector3::y()],
        Up::Z => [Vector3::x(), Vector3::y(), Vector3::z()],
        Up::X => [Vector3::z(), Vector3::x(), Vector3::y()],
    };
    Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_columns(&columns))
}

/// The scan's skin after an affine transform from this unit to millimetres.
pub(crate) fn moved(scan: &Scan, map: &Matrix4<f64>, unit: Unit) -> Mesh {
    let points: Vec<Point3<f64>> = scan.points.iter().map(|p| map.transform_point(p)).collect();
    if scan.triangles.is_empty() {
        let spacing_mm = point_cloud::spacing(&scan.points) * unit.in_mm();
        return Mesh::cloud(points, spacing_mm);
    }
    Mesh::new(points, scan.triangles.clone())
}

/// The direction of the toes in the upright frame, from the feet, checked against the declaration.
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
        // The floor is not where it seems, so heights would be wrong too: a plate, or legs that are cut above the foot.
        Err(unclear @ FeetUnclear::NoFoot { .. })
            if unclear.is_larger_than_a_foot()
                || stance.floor.doubt == Some(FloorDoubt::NotTurning) =>
        {
            return Err(BodyFault::FacingUnclear(unclear));
        }
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
