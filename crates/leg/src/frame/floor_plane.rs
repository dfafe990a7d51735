//! A floor, plate or platform under the feet that was scanned with them: it is the floor, and no skin.
//!
//! The skin of a standing body faces upwards only on the backs of the feet, which are small and no plane. Soles that
//! an exporter closed face downwards.

use std::collections::BTreeMap;

use gaiter_scan::Scan;
use nalgebra::{Point3, Rotation3, Vector3};

use super::components::renumbered;
use super::winding::volume;
use crate::statistics::range;

/// Heights up to this share of the scan's may be a floor: what a patient is made to stand on is hardly higher than
/// 250 mm.
const FLOOR_SHARE: f64 = 0.15;

/// The body above this share of the scan's height shows which side of its triangles is outside.
const BODY_SHARE: f64 = 0.2;

/// A facet of a level floor turns up by this at least (cosine): within 32°, which noise of 1.5 mm turns facets of an
/// edge of 5 mm.
const UP_MIN_COSINE: f64 = 0.85;

/// Facets of one plane lie within this height, as a share of the scan's: 6 mm of 1.6 m, four times that noise.
const THICKNESS_SHARE: f64 = 6.0 / 1600.0;

/// The least area of a floor, as a share of the squared height of the scan: 80 cm² at 1.6 m. Backs of feet have up to
/// 45 cm² in such a height. A smaller piece that hangs on no foot is left out as a fragment.
const AREA_MIN_SHARE: f64 = 0.0031;

/// What lies less than this above the plane is the floor's, in standard deviations of its facets …
const ABOVE_SDS: f64 = 3.0;

/// … and at least this share of the scan's height: 2 mm of 1.6 m.
const ABOVE_MIN_SHARE: f64 = 2.0 / 1600.0;

/// The plane is looked at in squares of this width, in that distance: 16 mm, three edges …
const CELL_BESIDES: f64 = 8.0;

/// … which belong to it if facets of it fill this share; its rim lies in the squares beside.
const CELL_MIN_SHARE: f64 = 0.25;

/// Of the points below a floor at least this share lies under it.
const UNDER_MIN_SHARE: f64 = 0.9;

/// The triangles of a scan above its floor, and the floor's height along `upright` z, in the export's unit. `None` if
/// no floor was scanned. A bare cloud shows none.
pub(crate) fn above_floor(scan: &Scan, upright: &Rotation3<f64>) -> Option<(Scan, f64)> {
    let up = upright.inverse() * Vector3::z();
    let heights: Vec<f64> = scan.points.iter().map(|point| up.dot(&point.coords)).collect();
    let [low, high] = range(heights.iter().copied());
    let height = high - low;
    let height_of = |corners: &[u32; 3]| heights[corners[0] as usize];
    let area_min = AREA_MIN_SHARE * height * height;
    let near =
        scan.triangles.iter().filter(|corners| height_of(corners) < low + FLOOR_SHARE * height);
    let level: Vec<Facet> =
        near.filter_map(|corners| Facet::from_corners(scan, corners, &up)).collect();
    let turned = |is_up: bool| {
        let facets = level.iter().filter(|facet| facet.is_up == is_up).copied().collect();
        largest(facets, THICKNESS_SHARE * height).filter(|plane| plane.area >= area_min)
    };
    // Nearly no scan has so much level skin: only then is it worth asking which side is outside.
    let (up_plane, down_plane) = (turned(true), turned(false));
    if up_plane.is_none() && down_plane.is_none() {
        return None;
    }
    let body =
        scan.triangles.iter().filter(|corners| height_of(corners) > low + BODY_SHARE * height);
    let plane = if volume(&scan.points, body) > 0.0 { up_plane } else { down_plane }?;
    let beside = (ABOVE_SDS * plane.sd).max(ABOVE_MIN_SHARE * height);
    if !lies_under(&plane, scan, &heights, upright, beside) {
        return None;
    }
    let top = plane.height + beside;
    let middle =
        |corners: &[u32; 3]| corners.iter().map(|c| heights[*c as usize]).sum::<f64>() / 3.0;
    let above = scan.triangles.iter().filter(|corners| middle(corners) > top).copied();
    let (triangles, used) = renumbered(scan.points.len(), above.collect());
    let points = used.iter().map(|point| scan.points[*point as usize]).collect();
    Some((Scan { points, triangles }, plane.height))
}

/// A level facet, in the export's coordinates.
#[derive(Clone, Copy)]
struct Facet {
    middle: Point3<f64>,
    /// Of its middle.
    height: f64,
    area: f64,
    /// Whether it turns up, if triangles turn outwards.
    is_up: bool,
}

impl Facet {
    /// The facet of a triangle; `None` if it is not level.
    fn from_corners(scan: &Scan, corners: &[u32; 3], up: &Vector3<f64>) -> Option<Facet> {
        let [a, b, c] = corners.map(|corner| scan.points[corner as usize].coords);
        let normal = (b - a).cross(&(c - a));
        let rise = normal.dot(up);
        (rise * rise > UP_MIN_COSINE * UP_MIN_COSINE * normal.norm_squared()).then(|| {
            let middle = (a + b + c) / 3.0;
            let (height, area) = (middle.dot(up), normal.norm() / 2.0);
            Facet { height, middle: middle.into(), area, is_up: rise > 0.0 }
        })
    }
}

/// Facets at one height.
struct Plane {
    /// Mean, weighted by area.
    height: f64,
    /// Standard deviation of their heights.
    sd: f64,
    area: f64,
    facets: Vec<Facet>,
}

/// Whether what is lower than the plane by more than `beside` lies under it, as the walls of a platform: a floor has no
/// feet below.
fn lies_under(
    plane: &Plane,
    scan: &Scan,
    heights: &[f64],
    upright: &Rotation3<f64>,
    beside: f64,
) -> bool {
    let width = CELL_BESIDES * beside;
    let cell = |point: &Point3<f64>| -> [i64; 2] {
        let across = (upright * point).xy();
        [0, 1].map(|axis| (across[axis] / width).floor() as i64)
    };
    let mut areas: BTreeMap<[i64; 2], f64> = BTreeMap::new();
    for facet in &plane.facets {
        *areas.entry(cell(&facet.middle)).or_default() += facet.area;
    }
    areas.retain(|_, area| *area > CELL_MIN_SHARE * width * width);
    let is_covered = |[x, y]: [i64; 2]| {
        (-1..=1).any(|dx| (-1..=1).any(|dy| areas.contains_key(&[x + dx, y + dy])))
    };
    let low_points = scan.points.iter().zip(heights);
    let below: Vec<&Point3<f64>> = low_points
        .filter_map(|(point, height)| (*height < plane.height - beside).then_some(point))
        .collect();
    let covered = below.iter().filter(|point| is_covered(cell(point))).count();
    covered as f64 >= UNDER_MIN_SHARE * below.len() as f64
}

/// The largest area of facets within a height of `thickness`; `None` if there are none.
fn largest(mut facets: Vec<Facet>, thickness: f64) -> Option<Plane> {
    facets.sort_by(|a, b| a.height.total_cmp(&b.height));
    let (mut first, mut area) = (0, 0.0);
    let mut best = (0.0, 0..0);
    for (index, facet) in facets.iter().enumerate() {
        area += facet.area;
        while facets[first].height < facet.height - thickness {
            area -= facets[first].area;
            first += 1;
        }
        if area > best.0 {
            best = (area, first..index + 1);
        }
    }
    let plane = &facets[best.1];
    let area: f64 = plane.iter().map(|facet| facet.area).sum();
    let mean = |of: &dyn Fn(f64) -> f64| {
        plane.iter().map(|facet| of(facet.height) * facet.area).sum::<f64>() / area
    };
    let height = mean(&|height| height);
    let sd = mean(&|other| (other - height).powi(2)).sqrt();
    (area > 0.0).then(|| Plane { height, sd, area, facets: plane.to_vec() })
}
