//! Closed holes on tubes, and what is none.

use super::*;

const RADIUS_MM: f64 = 50.0;
const SIDES: u32 = 60;
const RINGS: u32 = 60;

/// Noise of standard deviation 1, the same in every run.
fn noise(index: u32) -> f64 {
    let part = |salt: u32| {
        let mut x = index.wrapping_mul(0x9e37_79b9).wrapping_add(salt.wrapping_mul(0x85eb_ca6b));
        x = (x ^ (x >> 15)).wrapping_mul(0x2c1b_3c6d);
        x = (x ^ (x >> 12)).wrapping_mul(0x297a_2d39);
        f64::from(x ^ (x >> 15)) / f64::from(u32::MAX) - 0.5
    };
    (0..12).map(part).sum()
}

/// Points and triangles of a round shank of 300 mm with points 5 mm apart.
fn shank(noise_mm: impl Fn(f64) -> f64) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let at = |ring: u32, side: u32| {
        let shift = if ring.is_multiple_of(2) { 0.0 } else { 0.5 };
        let angle = TAU * (f64::from(side) + shift) / f64::from(SIDES);
        let radius_mm = RADIUS_MM + noise_mm(angle) * noise(ring * SIDES + side);
        Point3::new(radius_mm * angle.cos(), radius_mm * angle.sin(), 5.0 * f64::from(ring))
    };
    let points = (0..RINGS).flat_map(|ring| (0..SIDES).map(move |side| (ring, side)));
    let points = points.map(|(ring, side)| at(ring, side)).collect();
    let mut triangles = Vec::new();
    for (ring, side) in (0..RINGS - 1).flat_map(|r| (0..SIDES).map(move |side| (r, side))) {
        let next = (side + 1) % SIDES;
        let [a, b] = [ring * SIDES + side, ring * SIDES + next];
        let [c, d] = [a + SIDES, b + SIDES];
        triangles.extend(if ring % 2 == 0 {
            [[a, b, c], [b, d, c]]
        } else {
            [[a, b, d], [a, d, c]]
        });
    }
    (points, triangles)
}

/// Half the angle of an oval hole of 110 × 70 mm at a height; not a number beyond its ends.
fn half_angle(height_mm: f64) -> f64 {
    0.7 * (1.0 - ((height_mm - 150.0) / 55.0).powi(2)).sqrt()
}

fn is_in_hole(point: &Point3<f64>) -> bool {
    point.y.atan2(point.x).abs() < half_angle(point.z)
}

/// Moves the points in the hole onto the chords between its sides.
fn stretched((mut points, triangles): (Vec<Point3<f64>>, Vec<[u32; 3]>)) -> Mesh {
    for point in points.iter_mut().filter(|point| is_in_hole(point)) {
        let (angle, half) = (point.y.atan2(point.x), half_angle(point.z));
        let aside_mm = RADIUS_MM * half.sin() * angle / half;
        *point = Point3::new(RADIUS_MM * half.cos(), aside_mm, point.z);
    }
    Mesh::new(points, triangles)
}

/// Shares of the hole's triangles that are found, and of others, by the hole's.
fn shares(mesh: &Mesh, found: &Filled) -> [f64; 2] {
    let is_inside = |corner: &u32| is_in_hole(&mesh.points()[*corner as usize]);
    let inside = |triangle: &[u32; 3]| triangle.iter().any(is_inside);
    let hole = mesh.triangles().iter().filter(|t| inside(t)).count() as f64;
    let both = mesh.triangles().iter().zip(&found.is_filled).filter(|(_, is_filled)| **is_filled);
    let (hits, others): (Vec<_>, Vec<_>) = both.partition(|(t, _)| inside(t));
    [hits.len() as f64 / hole, others.len() as f64 / hole]
}

const SPAN_MM: [f64; 2] = [30.0, 270.0];

#[test]
fn skin_is_none_with_or_without_noise() {
    for noise_mm in [0.0, 0.05, 0.3, 0.8, 1.5] {
        let (points, triangles) = shank(|_| noise_mm);
        let found = filled(&Mesh::new(points, triangles), SPAN_MM);
        assert_eq!(found.patches, [], "{noise_mm}");
    }
}

#[test]
fn a_membrane_is_found_with_or_without_noise_around() {
    for noise_mm in [0.0, 0.05, 0.3, 0.8, 1.5] {
        let mesh = stretched(shank(|_| noise_mm));
        let found = filled(&mesh, SPAN_MM);
        let [patch] = found.patches[..] else { panic!("{noise_mm}: {:?}", found.patches) };
        let [hits, others] = shares(&mesh, &found);
        assert!(hits > 0.8 && others < 0.35, "{noise_mm}: {hits} {others}");
        assert!((patch.middle.z - 150.0).abs() < 5.0, "{patch:?}");
        assert!((55.0..90.0).contains(&patch.width_mm), "{patch:?}");
    }
}

#[test]
fn a_fan_is_found() {
    for noise_mm in [0.0, 0.8] {
        let (mut points, mut triangles) = shank(|_| noise_mm);
        let inner: Vec<bool> = points.iter().map(is_in_hole).collect();
        let (cut, kept): (Vec<[u32; 3]>, Vec<[u32; 3]>) =
            triangles.iter().partition(|t| t.iter().any(|c| inner[*c as usize]));
        let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let all: Vec<[u32; 2]> = cut.iter().flat_map(sides).collect();
        let middle = points.len() as u32;
        points.push(Point3::new(42.0, 0.0, 150.0));
        let border = all.iter().filter(|[a, b]| !all.contains(&[*b, *a]));
        triangles = kept.iter().copied().chain(border.map(|[a, b]| [*a, *b, middle])).collect();
        let fan = triangles.len() - kept.len();
        let found = filled(&Mesh::new(points, triangles), SPAN_MM);
        let [_] = found.patches[..] else { panic!("{:?}", found.patches) };
        let hits = found.is_filled[kept.len()..].iter().filter(|is_filled| **is_filled).count();
        assert!(hits * 10 >= fan * 9, "{hits} of {fan}");
        let others = found.is_filled[..kept.len()].iter().filter(|is_filled| **is_filled).count();
        assert_eq!(others, 0);
    }
}

#[test]
fn a_camera_with_a_third_of_the_noise_fills_nothing() {
    let (points, triangles) = shank(|angle| if angle < PI / 2.0 { 0.3 } else { 0.9 });
    assert_eq!(filled(&Mesh::new(points, triangles), SPAN_MM).patches, []);
}

#[test]
fn a_cloud_has_none() {
    let (points, _) = shank(|_| 0.3);
    let found = filled(&Mesh::cloud(points, 5.0), SPAN_MM);
    assert!(found.is_filled.is_empty() && found.patches.is_empty());
}
