//! A strip of the inner leg that nobody saw, as where thighs touch or a calf shadows the other.

use gaiter_leg::Extraction;
use gaiter_scan::Scan;
use nalgebra::Point3;

/// The strip begins at this height, mm.
const FROM_MM: f64 = 60.0;

/// The middle of the leg is that of its extents in slabs of this height, mm.
const SLAB_MM: f64 = 10.0;

/// A scan of a body without a strip of the inner skin of both legs, from above the feet to the crotch, so many
/// degrees wide as seen from the middle of the leg; `whole` is what was measured on the whole scan.
pub fn without_strip(scan: &Scan, whole: &Extraction, width_deg: f64) -> Scan {
    let in_body = |point: &Point3<f64>| whole.body.from_export.transform_point(point);
    let places: Vec<Point3<f64>> = scan.points.iter().map(in_body).collect();
    let top_mm = whole.crotch.height_mm;
    let slab = |place: &Point3<f64>| (place.z / SLAB_MM) as usize * 2 + usize::from(place.x > 0.0);
    // Hands hang further out.
    let is_leg = |p: &&Point3<f64>| (FROM_MM..top_mm).contains(&p.z) && p.x.abs() < 300.0;
    let slabs = (top_mm / SLAB_MM) as usize * 2 + 4;
    let mut extents =
        vec![[f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY]; slabs];
    for place in places.iter().filter(is_leg) {
        let [low_x, high_x, low_y, high_y] = &mut extents[slab(place)];
        (*low_x, *high_x) = (low_x.min(place.x), high_x.max(place.x));
        (*low_y, *high_y) = (low_y.min(place.y), high_y.max(place.y));
    }
    let is_gone = |place: &Point3<f64>| {
        is_leg(&place) && {
            let [low_x, high_x, low_y, high_y] = extents[slab(place)];
            let inwards = ((low_x + high_x) / 2.0 - place.x) * place.x.signum();
            let aside = place.y - (low_y + high_y) / 2.0;
            aside.atan2(inwards).to_degrees().abs() < width_deg / 2.0
        }
    };
    let mut numbers: Vec<Option<u32>> = Vec::new();
    let mut points = Vec::new();
    for (point, place) in scan.points.iter().zip(&places) {
        numbers.push((!is_gone(place)).then_some(points.len() as u32));
        if !is_gone(place) {
            points.push(*point);
        }
    }
    let seen = scan.triangles.iter().filter_map(|&[a, b, c]| {
        Some([numbers[a as usize]?, numbers[b as usize]?, numbers[c as usize]?])
    });
    Scan { points, triangles: seen.collect() }
}
