//! How far the facets of a mesh lie inside the skin through its points, and so how uncertain the skin is.
//!
//! A scanner's points lie on the skin, and the facets between them inside it. Software that decimates a mesh by its
//! quadrics (Garland and Heckbert, Surface simplification using quadric error metrics, 1997) keeps the mean of the
//! facets instead, so that the points lie outside the skin: with 20 000 facets a body, calves become 2 mm larger.
//! Software that puts the points of a cell together in their mean leaves them inside it by as much.
//!
//! The neighbours of the points show that a mesh was decimated: collapsed edges and merged cells leave points with four
//! neighbours beside points with nine. They do not show how, and neither does the facets' shape.

use std::f64::consts::TAU;

use gaiter_spline::Tensor;
use nalgebra::Vector3;

use super::slice::Mesh;

/// Standard deviation of the number of facets around a point. Up to the first, a mesh is no decimated one: exports of
/// scanners, also thinned ones, have 0.25 to 0.79. From the second on it surely is: quadrics leave 1.1 to 1.35 of a scan
/// with noise, and 0.9 to 1.05 of a body without; means of cells 1.36.
const DECIMATED_FROM: [f64; 2] = [0.8, 1.1];

/// A mesh none of whose points has more facets than this is a grid of squares, halved one way or the other.
const GRID_MAX: f64 = 8.0;

/// Standard error of where points lie, as a share of what the facets lie inside them: of any mesh …
const SHARE_SD: f64 = 0.2;

/// … and of a decimated one. Quadrics leave points outside the skin by 0.5 to 0.85 of it on two bodies with noise of 0.4
/// and 0.8 mm and 6 000 to 40 000 facets, by 0.1 to 0.5 without noise; means of points leave them inside by 0.3 to 0.5.
const SHARE_SD_DECIMATED: f64 = 0.6;

/// Facets are averaged over bands of this length along the leg, mm: within one the leg is about equally round, and it
/// holds 20 facets of the coarsest mesh that is measured.
const BAND_MM: f64 = 30.0;

/// This many facets give their mean in each band to 2 %.
const FACETS_MAX: usize = 5000;

/// The middle of an edge that is less than this share of the radius from the leg's middle is that of a chord over more
/// than 50°, which bridges a hole.
const CHORD_MIN: f64 = 0.9;

/// How far the facets of a leg's mesh lie inside its points' skin.
#[derive(Debug, Clone)]
pub struct Sag {
    /// Where the first band begins, along the axis, mm.
    from_mm: f64,
    /// The mean in each band, mm.
    bands: Vec<f64>,
    /// The share of it that is the standard error of where points lie.
    share_sd: f64,
}

impl Sag {
    /// Of a mesh whose points lie at these distances along and angles on a fitted skin; of a point cloud there is none.
    pub fn measure(mesh: &Mesh, places: &[Option<[f64; 2]>], skin: &Tensor) -> Sag {
        let (from_mm, to_mm) = skin.along().domain();
        let mut sums = vec![[0.0; 2]; ((to_mm - from_mm) / BAND_MM).ceil().max(1.0) as usize];
        let last = sums.len() - 1;
        let stride = mesh.triangles().len().div_ceil(FACETS_MAX).max(1);
        for corners in mesh.triangles().iter().step_by(stride) {
            let [Some(a), Some(b), Some(c)] = corners.map(|corner| places[corner as usize]) else {
                continue;
            };
            let Some((sag_mm, area)) = facet(&[a, b, c], skin) else { continue };
            let along_mm = (a[0] + b[0] + c[0]) / 3.0;
            let band = &mut sums[(((along_mm - from_mm) / BAND_MM) as usize).min(last)];
            *band = [band[0] + area * sag_mm, band[1] + area];
        }
        let [whole, area] =
            sums.iter().fold([0.0; 2], |sum, band| [sum[0] + band[0], sum[1] + band[1]]);
        let usual = if area > 0.0 { whole / area } else { 0.0 };
        let mean = |[sum, area]: [f64; 2]| if area > 0.0 { sum / area } else { usual };
        let [none, sure] = DECIMATED_FROM;
        let decimated = ((irregularity(mesh, places) - none) / (sure - none)).clamp(0.0, 1.0);
        let share_sd = SHARE_SD + (SHARE_SD_DECIMATED - SHARE_SD) * decimated;
        Sag { from_mm, bands: sums.into_iter().map(mean).collect(), share_sd }
    }

    /// Standard error of a girth by it, mm.
    pub fn girth_sd_mm(&self, along_mm: f64) -> f64 {
        TAU * self.share_sd * self.at(along_mm).abs()
    }

    /// How far the facets lie inside the points, mm; between the middles of bands it is interpolated.
    fn at(&self, along_mm: f64) -> f64 {
        let last = self.bands.len() - 1;
        let place = ((along_mm - self.from_mm) / BAND_MM - 0.5).clamp(0.0, last as f64);
        let (below, share) = (place as usize, place.fract());
        (1.0 - share) * self.bands[below] + share * self.bands[(below + 1).min(last)]
    }
}

/// How far a facet lies inside the skin on average, mm, if its corners lie on it, and its area; `None` if it bridges a
/// hole. The distance is quadratic, so its mean is that of the middles of the edges.
fn facet(places: &[[f64; 2]; 3], skin: &Tensor) -> Option<(f64, f64)> {
    let corners = places.map(|[along_mm, angle]| {
        let radius_mm = skin.value(along_mm, angle);
        Vector3::new(radius_mm * angle.cos(), radius_mm * angle.sin(), along_mm)
    });
    let [a, b, c] = corners;
    let mut sum_mm = 0.0;
    for middle in [a + b, b + c, c + a].map(|sum| sum / 2.0) {
        let (radius_mm, angle) = (middle.x.hypot(middle.y), middle.y.atan2(middle.x));
        let skin_mm = skin.value(middle.z, angle);
        if radius_mm < CHORD_MIN * skin_mm {
            return None;
        }
        sum_mm += skin_mm - radius_mm;
    }
    Some((sum_mm / 3.0, (b - a).cross(&(c - a)).norm() / 2.0))
}

/// Standard deviation of the number of facets around a point, of those points that facets surround; 0 for a grid.
fn irregularity(mesh: &Mesh, places: &[Option<[f64; 2]>]) -> f64 {
    let around = mesh.around();
    let on_skin = around.iter().zip(places).filter(|(_, place)| place.is_some());
    let surrounded = on_skin.map(|(around, _)| around).filter(|around| around.is_surrounded());
    let counts: Vec<f64> = surrounded.map(|around| f64::from(around.facets)).collect();
    if counts.iter().all(|count| *count <= GRID_MAX) {
        return 0.0;
    }
    let number = counts.len() as f64;
    let mean = counts.iter().sum::<f64>() / number;
    (counts.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / number).sqrt()
}
