//! Mean curvature of triangles by what is usual on a leg at their height.

use nalgebra::{Point3, Vector3};

use crate::sections::slice::Mesh;
use crate::statistics;

/// The usual curvature at a height is the median over this length of the leg on either side, mm, of this step.
const STEP_MM: f64 = 20.0;

/// … and at least this share of the whole leg's.
const USUAL_MIN_SHARE: f64 = 0.3;

/// This many values give a median to 2 %.
const SAMPLE_MAX: usize = 5000;

/// A median needs at least this many triangles.
const USUAL_MIN: usize = 20;

/// Half the divergence of the normals over a triangle, 1/mm; infinite if they are not known.
pub(super) fn mean_curvature(
    points: &[Point3<f64>],
    normals: &[Vector3<f64>],
    triangle: &[u32; 3],
    across: &Vector3<f64>,
) -> f64 {
    let at = triangle.map(|corner| points[corner as usize]);
    let ends = triangle.map(|corner| normals[corner as usize]);
    if ends.contains(&Vector3::zeros()) || *across == Vector3::zeros() {
        return f64::INFINITY;
    }
    let [a, b, c] = [at[2] - at[1], at[0] - at[2], at[1] - at[0]].map(|side| across.cross(&side));
    (ends[0].dot(&a) + ends[1].dot(&b) + ends[2].dot(&c)) / (2.0 * across.norm_squared())
}

/// Curvatures by the median of those at about the same height.
pub(super) fn by_usual(mesh: &Mesh, curvatures: Vec<f64>) -> Option<Vec<f64>> {
    let known = curvatures.iter().copied().filter(|curvature| curvature.is_finite());
    let whole = median(known.collect())?;
    let height = |triangle: &[u32; 3]| mesh.points()[triangle[0] as usize].z;
    let heights = mesh.triangles().iter().map(height);
    let lowest = heights.clone().fold(f64::INFINITY, f64::min);
    let step = |height: f64| ((height - lowest) / STEP_MM) as usize;
    let steps: Vec<usize> = heights.map(step).collect();
    let count = steps.iter().max()? + 1;
    let mut at = vec![Vec::new(); count];
    for (step, curvature) in steps.iter().zip(&curvatures).filter(|(_, c)| c.is_finite()) {
        at[*step].push(*curvature);
    }
    let usual = |step: usize| {
        let near = &at[step.saturating_sub(1)..(step + 2).min(count)];
        let near = near.concat();
        let middle = if near.len() < USUAL_MIN { whole } else { median(near).unwrap_or(whole) };
        // Triangles that are wound inwards make all curvatures negative.
        whole.signum() * (middle * whole.signum()).max(USUAL_MIN_SHARE * whole.abs())
    };
    let usual: Vec<f64> = (0..count).map(usual).collect();
    let by_usual = steps.iter().zip(curvatures);
    (whole != 0.0).then(|| by_usual.map(|(step, curvature)| curvature / usual[*step]).collect())
}

/// The edges of each triangle, of a list of all edges in ascending order.
pub(super) fn sides(points: usize, edges: &[[u32; 2]], triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut starts = vec![0u32; points + 1];
    edges.iter().for_each(|[from, _]| starts[*from as usize + 1] += 1);
    for point in 0..points {
        starts[point + 1] += starts[point];
    }
    let find = |a: u32, b: u32| {
        let (from, to) = if a < b { (a, b) } else { (b, a) };
        let start = starts[from as usize];
        let row = &edges[start as usize..starts[from as usize + 1] as usize];
        start + row.partition_point(|edge| edge[1] < to) as u32
    };
    triangles.iter().map(|&[a, b, c]| [find(a, b), find(b, c), find(c, a)]).collect()
}

/// The middle of some values, or of every so many if they are very many; `None` if there are none.
pub(super) fn median(values: Vec<f64>) -> Option<f64> {
    let stride = values.len().div_ceil(SAMPLE_MAX).max(1);
    statistics::median(values.into_iter().step_by(stride).collect())
}
