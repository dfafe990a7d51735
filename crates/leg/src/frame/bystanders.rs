//! Things that stand or hang beside the legs and are no part of them: a stick, a pole of the booth, a helper's arm, the
//! patient's own. They are shells of their own, thinner than both legs.

use nalgebra::{Point2, Vector3};

use super::components::connected;
use super::stance::{Ring, SHANK_LINK_MM, ring};
use crate::parting::cluster::clusters;
use crate::sections::slice::Mesh;

/// The legs are looked at up to this share of the stature, below every crotch …
const TOP_SHARE: f64 = 0.38;

/// … every so many mm.
const STEP_MM: f64 = 20.0;

/// Both legs are thicker than what stands beside them by this factor.
const THICKER: f64 = 1.25;

/// A shell is a bystander if it stands beside the legs in this many slices, and in this share of those that show
/// it.
const SLICES_MIN: usize = 4;
const SLICES_SHARE: f64 = 0.7;

/// In how many slices a shell is seen, and in how many it stands beside the legs.
#[derive(Clone, Copy, Default)]
struct Seen {
    slices: usize,
    beside: usize,
}

/// A standing body, z up in mm, without what stands beside its legs.
pub(crate) fn without_bystanders(mesh: Mesh, stature_mm: f64) -> Mesh {
    let roots = connected(mesh.points().len(), mesh.triangles());
    let count = (TOP_SHARE * stature_mm / STEP_MM) as usize;
    let heights: Vec<f64> = (1..=count).map(|step| STEP_MM * step as f64).collect();
    let mut seen = vec![Seen::default(); roots.len()];
    for slice in mesh.slices(&Vector3::z_axis(), &heights) {
        let mut points: Vec<(u32, Point2<f64>)> = slice
            .iter()
            .map(|crossing| (roots[crossing.edge[0] as usize], crossing.position.xy()))
            .collect();
        points.sort_by_key(|(shell, _)| *shell);
        look(&points, &mut seen);
    }
    let is_bystander = |shell: u32| {
        let Seen { slices, beside } = seen[shell as usize];
        beside >= SLICES_MIN && beside as f64 >= SLICES_SHARE * slices as f64
    };
    let left_out: Vec<bool> =
        mesh.triangles().iter().map(|triangle| is_bystander(roots[triangle[0] as usize])).collect();
    if left_out.contains(&true) { mesh.without(&left_out) } else { mesh }
}

/// Looks at a slice, whose points are sorted by their shells.
fn look(points: &[(u32, Point2<f64>)], seen: &mut [Seen]) {
    // The closed outlines, each with its shell.
    let mut rings: Vec<(u32, Ring)> = Vec::new();
    for shell_points in points.chunk_by(|a, b| a.0 == b.0) {
        let shell = shell_points[0].0;
        seen[shell as usize].slices += 1;
        let places: Vec<Point2<f64>> = shell_points.iter().map(|(_, place)| *place).collect();
        let outlines = clusters(&places, SHANK_LINK_MM);
        rings.extend(outlines.iter().filter_map(|outline| Some((shell, ring(outline)?))));
    }
    for (shell, own) in &rings {
        let is_thicker =
            |(of, other): &&(u32, Ring)| of != shell && other.size_mm > THICKER * own.size_mm;
        let thicker = rings.iter().filter(is_thicker);
        let is_outside = thicker.clone().all(|(_, other)| !other.hull.contains(&own.middle));
        if is_outside && thicker.count() >= 2 {
            seen[*shell as usize].beside += 1;
        }
    }
}
