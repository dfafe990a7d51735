//! The floor under feet whose soles were not seen.
//!
//! A scanner sees the skin of a foot until it curves under, and the lowest visible skin is still
//! above the floor: by millimetres if the skin is seen almost down to it, by the radius of the
//! foot's edge if it is seen only from above. The direction of the skin where it ends shows how far
//! below the floor is, because the edge of a foot is round. A sole that is in the scan is its own floor.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::soles::{FloorDoubt, Soles, is_sole_seen, lowest_mm, soles};
use crate::statistics::quantile;

/// Radius of the edge of a standing foot's sole, as a share of the stature. Judgement; on generated
/// bodies of 1 650 mm the direction of the skin changes with height as on an edge of about 13 mm.
const EDGE_RADIUS_SHARE: f64 = 12.0 / 1650.0;

/// Skin up to this far above the lowest point is used to determine its direction, mm.
const BAND_MM: f64 = 3.0;

/// The direction of the skin is averaged over patches of this radius, mm, or of the larger one where
/// points are few, because the noise of single triangles is as large as the change in direction.
const PATCH_RADII_MM: [f64; 2] = [8.0, 16.0];

/// A patch with fewer points than this has no direction.
const PATCH_POINTS_MIN: usize = 6;

/// Number of patches: enough to determine a twentieth.
const PATCHES: usize = 300;

/// The patches with the lowest floor are in contact with it, at heel and ball; elsewhere the sole
/// curves up, and the skin ends higher. This share of all patches lies below the result.
const CONTACT_SHARE: f64 = 0.05;

/// Standard error of the floor where the skin is seen all the way down, mm: heels sink in, and feet
/// are not flat.
const SD_MIN_MM: f64 = 0.9;

/// The unseen height is uncertain by this share of itself.
const UNSEEN_SD_SHARE: f64 = 0.2;

/// What the edge of a foot shows below a sole that is in the scan is uncertain by this share of itself: an exporter may
/// have closed the skin where it ended.
const CLOSED_SD_SHARE: f64 = 0.5;

/// The floor's height and its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// Height, mm.
    pub height_mm: f64,
    /// Standard error, mm.
    pub sd_mm: f64,
    /// A reason to doubt it.
    pub doubt: Option<FloorDoubt>,
}

impl Floor {
    /// A floor that was scanned at this height, mm, and the feet on it, of a body with this stature.
    pub(crate) fn seen(height_mm: f64, feet: &[Vec<[f64; 3]>], stature_mm: f64) -> Floor {
        let Soles { doubt, sd_mm } = soles(feet, stature_mm);
        Floor { height_mm, sd_mm: SD_MIN_MM.hypot(sd_mm), doubt }
    }
}

/// The floor under the feet, given as points, of a body with this stature; `None` if there are no points.
pub(crate) fn floor(feet: &[Vec<[f64; 3]>], stature_mm: f64) -> Option<Floor> {
    let edge_mm = EDGE_RADIUS_SHARE * stature_mm;
    let lowest_mm = feet.iter().filter_map(|foot| lowest_mm(foot)).reduce(f64::min)?;
    let rims: Vec<Vector3<f64>> = feet
        .iter()
        .flatten()
        .filter(|point| point[2] < lowest_mm + BAND_MM + PATCH_RADII_MM[1])
        .map(|point| Vector3::from(*point))
        .collect();
    let low: Vec<&Vector3<f64>> = rims.iter().filter(|p| p.z < lowest_mm + BAND_MM).collect();
    let stride = low.len().div_ceil(PATCHES).max(1);
    let patches = low.into_iter().step_by(stride);
    let floors = patches.filter_map(|middle| floor_below(middle, &rims, edge_mm)).collect();
    let contact = quantile(floors, CONTACT_SHARE);
    let below_mm = contact.map_or(0.0, |floor| (lowest_mm - floor).max(0.0));
    let mut standing = feet.iter().filter(|foot| !foot.is_empty());
    let (height_mm, share) = if standing.all(|foot| is_sole_seen(foot, stature_mm)) {
        (lowest_mm, CLOSED_SD_SHARE)
    } else {
        (lowest_mm - below_mm, UNSEEN_SD_SHARE)
    };
    let Soles { doubt, sd_mm } = soles(feet, stature_mm);
    Some(Floor { height_mm, sd_mm: SD_MIN_MM.hypot(share * below_mm).hypot(sd_mm), doubt })
}

/// The floor below a point of the skin, from the smallest patch that has enough points.
fn floor_below(middle: &Vector3<f64>, rims: &[Vector3<f64>], edge_mm: f64) -> Option<f64> {
    PATCH_RADII_MM
        .into_iter()
        .find_map(|radius_mm| floor_by_patch(middle, rims, radius_mm, edge_mm))
}

/// The floor below a round edge of radius `edge_mm`; the skin within `radius_mm` of `middle` is a piece
/// of that edge.
fn floor_by_patch(
    middle: &Vector3<f64>,
    rims: &[Vector3<f64>],
    radius_mm: f64,
    edge_mm: f64,
) -> Option<f64> {
    let reach = radius_mm * radius_mm;
    let (mut count, mut sum, mut squares) = (0usize, Vector3::zeros(), Matrix3::zeros());
    for arm in rims.iter().map(|point| point - middle) {
        if arm.norm_squared() <= reach {
            count += 1;
            sum += arm;
            squares += arm * arm.transpose();
        }
    }
    if count < PATCH_POINTS_MIN {
        return None;
    }
    let mean = sum / count as f64;
    let eigen = SymmetricEigen::new(squares / count as f64 - mean * mean.transpose());
    let down = eigen.eigenvectors.column(eigen.eigenvalues.imin()).z.abs();
    // The mean of a round patch lies inside the skin by R²/8ρ.
    let inside_mm = reach / (8.0 * edge_mm) * down;
    Some(middle.z + mean.z - inside_mm - edge_mm * (1.0 - down))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATURE_MM: f64 = 1650.0;
    const EDGE_MM: f64 = EDGE_RADIUS_SHARE * STATURE_MM;

    /// A foot with a round edge, seen down to where the skin has turned by `turn_deg` from
    /// upright, standing at `floor_mm`.
    fn foot(floor_mm: f64, turn_deg: i32) -> Vec<[f64; 3]> {
        let around = (0..160).map(|i| f64::from(i) * 2.25_f64.to_radians());
        let seen = (-66..=turn_deg).step_by(12).map(|turn| f64::from(turn).to_radians());
        around
            .flat_map(|angle| seen.clone().map(move |turn| (angle, turn)))
            .map(|(angle, turn)| {
                // An ellipse, with the round edge perpendicular to it.
                let out = nalgebra::Vector2::new(angle.cos() / 35.0, angle.sin() / 110.0);
                let out = out.normalize() * (EDGE_MM * turn.cos());
                let z = floor_mm + EDGE_MM * (1.0 - turn.sin());
                [35.0 * angle.cos() + out.x, 110.0 * angle.sin() + out.y, z]
            })
            .collect()
    }

    #[test]
    fn the_floor_is_found_below_soles_that_were_not_seen() {
        for turn_deg in [30, 45, 60, 75] {
            let feet = [foot(7.0, turn_deg), foot(7.0, turn_deg)];
            let found = floor(&feet, STATURE_MM).unwrap();
            let lowest = feet[0].iter().map(|p| p[2]).fold(f64::INFINITY, f64::min);
            let off = (found.height_mm - 7.0).abs();
            assert!(off < 2.0 && off < 2.0 * found.sd_mm, "{turn_deg}: {found:?}, {lowest}");
            assert!(turn_deg > 60 || off < (lowest - 7.0) / 2.0, "{turn_deg}: {found:?}, {lowest}");
        }
    }

    #[test]
    fn a_sole_that_was_seen_is_the_floor() {
        let grid = (-20..=20).flat_map(|i| (-60..=60).map(move |j| (i, j)));
        let sole: Vec<[f64; 3]> =
            grid.map(|(i, j)| [2.0 * f64::from(i), 2.0 * f64::from(j), 0.0]).collect();
        let found = floor(&[sole], STATURE_MM).unwrap();
        assert!(found.height_mm.abs() < 1.0, "{found:?}");
    }

    #[test]
    fn a_foot_that_was_closed_flat_stands_on_that() {
        let grid = (-6..=6).flat_map(|i| (-18..=18).map(move |j| (i, j)));
        let cap: Vec<[f64; 3]> =
            grid.map(|(i, j)| [6.0 * f64::from(i), 6.0 * f64::from(j), 13.0]).collect();
        // The skin ends 6 mm above the floor, and is closed there.
        let closed = || [foot(7.0, 30), cap.clone()].concat();
        let found = floor(&[closed(), closed()], STATURE_MM).unwrap();
        assert!((found.height_mm - 13.0).abs() < 1.0, "{found:?}");
        assert!((found.height_mm - 7.0).abs() < 4.0 * found.sd_mm, "{found:?}");
    }

    #[test]
    fn toes_that_lie_high_are_a_doubt_and_the_standard_error_holds_the_sole() {
        for sole_mm in [0.0, 10.0, 20.0, 30.0, 40.0] {
            // The edge is that of the sole, the skin above it that of the foot.
            let on_sole = || -> Vec<[f64; 3]> {
                let raised = |[x, y, z]: [f64; 3]| [x, y, if z > 9.0 { z + sole_mm } else { z }];
                foot(0.0, 60).into_iter().map(raised).collect()
            };
            let found = floor(&[on_sole(), on_sole()], STATURE_MM).unwrap();
            let is_said = matches!(found.doubt, Some(FloorDoubt::Raised { .. }));
            assert_eq!(is_said, sole_mm >= 20.0, "{sole_mm}: {found:?}");
            assert!(sole_mm < 5.0 + 3.0 * found.sd_mm, "{sole_mm}: {found:?}");
        }
    }

    #[test]
    fn feet_on_the_floor_leave_no_doubt() {
        for turn_deg in [45, 60, 75] {
            assert_eq!(
                floor(&[foot(7.0, turn_deg), foot(7.0, turn_deg)], STATURE_MM).unwrap().doubt,
                None
            );
        }
    }

    #[test]
    fn skin_that_ends_upright_is_cut_and_the_standard_error_holds_what_is_missing() {
        let found = floor(&[foot(7.0, 0), foot(7.0, 0)], STATURE_MM).unwrap();
        assert_eq!(found.doubt, Some(FloorDoubt::NotTurning));
        assert!((found.height_mm - 7.0).abs() < 2.0 * found.sd_mm, "{found:?}");
    }

    #[test]
    fn feet_of_a_body_that_leans_do_not_lie_in_a_level_plane() {
        for (lean_deg, doubted) in [(1.0_f64, false), (6.0, true)] {
            let lean = lean_deg.to_radians();
            let aside = |feet_mm: f64| {
                let leans = move |[x, y, z]: [f64; 3]| {
                    let x = x + feet_mm;
                    [x * lean.cos() + z * lean.sin(), y, z * lean.cos() - x * lean.sin()]
                };
                foot(0.0, 60).into_iter().map(leans).collect()
            };
            let found = floor(&[aside(-120.0), aside(120.0)], STATURE_MM).unwrap();
            let uneven_mm = match found.doubt {
                Some(FloorDoubt::Uneven { spread_mm }) => Some(spread_mm),
                _ => None,
            };
            assert_eq!(uneven_mm.is_some(), doubted, "{found:?}");
            // 240 mm between the feet.
            let expected_mm = 240.0 * lean.sin();
            assert!(uneven_mm.is_none_or(|mm| (mm - expected_mm).abs() < 3.0), "{found:?}");
        }
    }

    #[test]
    fn no_foot_has_no_floor() {
        assert_eq!(floor(&[Vec::new(), Vec::new()], STATURE_MM), None);
    }
}
