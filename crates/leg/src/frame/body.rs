//! The body frame: right-handed, millimetres, +Z up from the floor, −Y in the direction of the
//! toes, +X the patient's left, origin midway between the feet.

use gaiter_scan::Scan;
use nalgebra::{
    Matrix4, Point2, Point3, Rotation3, Translation3, UnitQuaternion, Vector2, Vector3,
};
use serde::{Deserialize, Serialize};

use super::body_fault::BodyFault;
use super::bystanders::without_bystanders;
use super::calves;
use super::components::without_fragments;
use super::crown;
use super::floor_plane::above_floor;
use super::layers::unlinked_share;
use super::point_cloud;
use super::soles::FloorDoubt;
use super::stance::{FeetUnclear, Stance, longest_foot_mm, stance};
use super::unit_inference::{FOOT_LENGTH_MEAN_SHARE, extent, lone_leg, whole_body};
use super::winding;
use crate::method::{Axis, FacingChoice, Method, Scope, Unit, UnitChoice, Up};
use crate::parting::cluster::clusters;
use crate::parting::leg_tracking::{link_mm, slices};
use crate::sections::hull::Hull;
use crate::sections::slice::Mesh;
use crate::side::{Side, Sides};
use crate::statistics::{GAP_MAX_DEG, largest_gap_deg};

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

/// Height of a body that ends at its neck, where heads are cut off, as a share of the stature: the feet are looked
/// for by it.
const CUT_HEIGHT_SHARE: f64 = 0.85;

/// Legs of which a larger share of points lies beside another skin are two skins, see [`unlinked_share`].
const UNLINKED_MAX_SHARE: f64 = 0.4;

/// A scan in the body frame.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Body {
    /// The skin in the body frame, fragments left out; not part of documents.
    #[serde(skip)]
    pub mesh: Mesh,
    /// Whether a whole body was scanned, and not a lone leg.
    pub is_whole: bool,
    /// Height of the crown above the floor, mm; `None` if it is not in the scan.
    pub stature_mm: Option<f64>,
    /// The stature that search heights are relative to: the body's own, or one inferred from the feet, mm.
    pub scale_mm: f64,
    /// The same before a crotch improved it, mm: the legs are followed at heights relative to it.
    pub tracking_scale_mm: f64,
    /// Standard error of `scale_mm`, as a share of it.
    pub scale_sd_share: f64,
    /// Middle of each shank that is present, looking along −Z, mm.
    pub shanks: Sides<Option<Point2<f64>>>,
    /// How far one shank stands ahead of the other, mm, if there are two and the feet show it.
    pub forward_mm: Option<f64>,
    /// Standard error of the floor's height, mm.
    pub floor_sd_mm: f64,
    /// A reason to doubt the floor.
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FacingFrom {
    /// The toes.
    Feet,
    /// The calves, because the feet do not show the facing, for this reason.
    Calves(FeetUnclear),
    /// The declaration, because the feet do not show the facing, for this reason.
    Declared(FeetUnclear),
}

impl Body {
    /// Improves the scale by another estimate of the stature with its standard error, mm: the mean of both, by their
    /// weights.
    pub fn scale_also_by(&mut self, stature_mm: f64, sd_mm: f64) {
        let own_sd_mm = self.scale_sd_share * self.scale_mm;
        let [own, other] = [own_sd_mm, sd_mm].map(|sd_mm| sd_mm.powi(-2));
        self.scale_mm = (own * self.scale_mm + other * stature_mm) / (own + other);
        // Where both disagree by more than they should, neither is as certain as its standard error.
        let apart_mm = (self.scale_mm - stature_mm).abs();
        self.scale_sd_share = (1.0 / (own + other)).sqrt().max(apart_mm) / self.scale_mm;
    }
}

/// Transforms a scan into the body frame.
///
/// # Errors
/// A [`BodyFault`] if the scan is not a whole standing body, or not a lone leg where one was
/// declared, or if its sides cannot be determined.
pub fn body(scan: &Scan, method: &Method) -> Result<Body, BodyFault> {
    let all = without_fragments(scan);
    if all.0.points.is_empty() {
        return Err(BodyFault::OnlyFragments);
    }
    let upright = upright(method.up);
    let is_whole = method.scope == Scope::Body;
    let above = if is_whole { above_floor(&all.0, &upright) } else { None };
    let (above, floor) = above.unzip();
    let above = above.map(|above| without_fragments(&above));
    let (scan, shells) = above.as_ref().unwrap_or(&all);
    let (low, high) = extent(scan.points.iter().map(|point| upright * point));
    let (unit, mut scale_mm) = match method.scope {
        Scope::Body => whole_body(method, &upright, high - low, || {
            let raised = Translation3::new(0.0, 0.0, -low.z).to_homogeneous();
            crown::is_child(&moved(scan, &(raised * upright.to_homogeneous()), Unit::Mm))
        })?,
        Scope::Leg(_) => lone_leg(scan, method, &upright, [low.z, high.z])?,
    };
    let to_mm = Translation3::new(0.0, 0.0, -low.z * unit.in_mm()).to_homogeneous()
        * Matrix4::new_scaling(unit.in_mm())
        * upright.to_homogeneous();
    let mut standing = moved(scan, &to_mm, unit);
    if is_whole && *shells > 1 {
        standing = without_bystanders(standing, scale_mm);
    }
    let is_crown_seen = is_whole && crown::is_seen(&standing);
    if is_whole && !is_crown_seen {
        scale_mm = by_feet(&standing, scale_mm);
    }
    let (stance, (wound, unlinked_share)) = rayon::join(
        || stance(&standing, scale_mm, floor.map(|floor| (floor - low.z) * unit.in_mm())),
        || (winding::check(&standing, method.winding), unlinked_share(&standing, scale_mm)),
    );
    let stance = stance?;
    let is_mirror_checked = wound?;
    if unlinked_share > UNLINKED_MAX_SHARE {
        return Err(BodyFault::Layers { percent: 100.0 * unlinked_share });
    }
    let by_calves = || calves::front(&standing, &stance.shanks, scale_mm);
    let (toes, facing_from) = facing(&stance, by_calves, method.facing, &upright)?;
    let facing = toes.x.atan2(-toes.y);
    let (sides, origin) = sides(&standing, &stance, toes, scale_mm, method.scope)?;
    let to_body = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -facing)
        * Translation3::new(-origin.x, -origin.y, -stance.floor.height_mm);
    let in_body = |p: Point2<f64>| (to_body * Point3::new(p.x, p.y, 0.0)).xy();
    let stature_mm = is_crown_seen.then(|| standing.highest_mm() - stance.floor.height_mm);
    let scale_mm = stature_mm.unwrap_or(scale_mm);
    Ok(Body {
        mesh: standing.moved(&to_body),
        is_whole,
        stature_mm,
        scale_mm,
        tracking_scale_mm: scale_mm,
        scale_sd_share: if stature_mm.is_some() { CROWN_SD_SHARE } else { FOOT_SD_SHARE },
        shanks: Sides { left: sides.left.map(in_body), right: sides.right.map(in_body) },
        forward_mm: stance.forward_mm,
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

/// The stature of a body without its crown, of which so much stands, mm: inferred from its longer foot, because
/// toes may be missing; at least what stands.
fn by_feet(standing: &Mesh, height_mm: f64) -> f64 {
    let about_mm = height_mm / CUT_HEIGHT_SHARE;
    let by_foot = longest_foot_mm(standing, about_mm);
    by_foot.map_or(about_mm, |foot_mm| (foot_mm / FOOT_LENGTH_MEAN_SHARE).max(height_mm))
}

/// Middle of each shank that is present.
type Shanks = Sides<Option<Point2<f64>>>;

/// The shank of each side, and the point on the floor that becomes the origin.
fn sides(
    standing: &Mesh,
    stance: &Stance,
    toes: Vector2<f64>,
    scale_mm: f64,
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
            let trunk = trunk_middle(standing, scale_mm).unwrap_or(shank);
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
    let hulls = outlines.filter_map(|outline| Some((Hull::from_points(&outline)?, outline)));
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

/// The direction of the toes in the upright frame, as it is seen, checked against the declaration.
fn facing(
    stance: &Stance,
    by_calves: impl Fn() -> Option<Vector2<f64>>,
    choice: FacingChoice,
    upright: &Rotation3<f64>,
) -> Result<(Vector2<f64>, FacingFrom), BodyFault> {
    let declared = match choice {
        FacingChoice::Declared(axis) => Some((upright * direction(axis)).xy()),
        FacingChoice::Auto => None,
    };
    if declared.is_some_and(|declared| declared.norm() < 0.5) {
        return Err(BodyFault::FacingVertical);
    }
    let seen = match stance.toes {
        Ok(toes) => Ok((toes, FacingFrom::Feet)),
        // The floor is not where it seems, so heights would be wrong too: a plate, or legs that are cut above the foot.
        Err(unclear @ FeetUnclear::NoFoot { .. })
            if unclear.is_larger_than_a_foot()
                || stance.floor.doubt == Some(FloorDoubt::NotTurning) =>
        {
            return Err(BodyFault::FacingUnclear(unclear));
        }
        // A foot in the air, or one that is not there, has no height to measure from.
        Err(unclear @ FeetUnclear::NotSeen { .. }) => Err(unclear),
        Err(unclear) => {
            by_calves().map(|front| (front, FacingFrom::Calves(unclear))).ok_or(unclear)
        }
    };
    match (seen, declared) {
        (Ok(seen), None) => Ok(seen),
        (Ok(seen), Some(declared)) => {
            let off_deg = declared.angle(&seen.0).to_degrees();
            let agrees = off_deg <= DECLARED_FACING_MAX_DEG;
            agrees.then_some(seen).ok_or(BodyFault::FacingContradicted { off_deg })
        }
        (Err(unclear), Some(declared)) => Ok((declared, FacingFrom::Declared(unclear))),
        (Err(unclear), None) => Err(BodyFault::FacingUnclear(unclear)),
    }
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
