//! Seams of views on round legs, and what is none.

#![allow(clippy::unwrap_used, clippy::panic)]

use nalgebra::Vector2;

use super::*;

const STATURE_MM: f64 = 1600.0;
const RADIUS_MM: f64 = 45.0;

fn seams_of(legs: &[Traces]) -> Option<Seams> {
    seams(&legs.iter().collect::<Vec<_>>())
}

/// Even numbers in [−1, 1] (Knuth's generator, The Art of Computer Programming 2, MMIX).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A leg of points 4.7 mm apart with this much noise, of which `moved` shifts each by its direction and height:
/// to the front and to the left, mm.
fn leg(noise_mm: f64, seed: u64, moved: impl Fn(f64, f64) -> [f64; 2]) -> Traces {
    leg_with(|_| noise_mm, seed, moved)
}

/// The same with noise that depends on the direction.
fn leg_with(
    noise_mm: impl Fn(f64) -> f64,
    seed: u64,
    moved: impl Fn(f64, f64) -> [f64; 2],
) -> Traces {
    let mut noise = Noise(seed);
    let (columns, rows) = (60_u32, 150_u32);
    let (mut placed, mut edges) = (Vec::new(), Vec::new());
    for row in 0..rows {
        for column in 0..columns {
            // Off the grid, so that no direction is that of a column.
            let place = f64::from(column) + 0.5 * f64::from(row % 2) + 0.3 * noise.next();
            let direction = TAU * place / f64::from(columns) - PI;
            let height_mm = 80.0 + 4.7 * (f64::from(row) + 0.3 * noise.next());
            let normal = Vector2::new(direction.cos(), direction.sin());
            let [front, left] = moved(direction, height_mm);
            let shift = Vector2::new(front, left);
            // √3 makes the standard deviation of even numbers 1.
            let outside_mm =
                shift.dot(&normal) + noise_mm(direction) * 3.0_f64.sqrt() * noise.next();
            placed.push(Some(Placed {
                height_mm,
                place: normal * RADIUS_MM + shift,
                angle: direction,
                direction,
                outside_mm,
            }));
            let index = row * columns + column;
            let beside = row * columns + (column + 1) % columns;
            edges.push([index, beside]);
            if row + 1 < rows {
                edges.extend([[index, index + columns], [beside, index + columns]]);
            }
        }
    }
    let girths: Vec<[f64; 2]> =
        (0..140).map(|row| [80.0 + 5.0 * f64::from(row), TAU * RADIUS_MM]).collect();
    Traces::new(&placed, &edges, &girths, STATURE_MM)
}

/// A camera at 35° to the left whose quarter is moved away from the leg.
fn quarter(by_mm: f64) -> impl Fn(f64, f64) -> [f64; 2] {
    let (sin, cos) = 35.0_f64.to_radians().sin_cos();
    move |direction: f64, _| {
        let is_seen = (direction.to_degrees() - 35.0).abs() < 45.0;
        if is_seen { [by_mm * cos, by_mm * sin] } else { [0.0, 0.0] }
    }
}

#[test]
fn legs_without_seams_have_none() {
    for noise_mm in [0.0, 0.4, 0.8, 1.5] {
        for seed in 0..5 {
            let legs = [2 * seed, 2 * seed + 1].map(|seed| leg(noise_mm, seed, |_, _| [0.0; 2]));
            assert_eq!(seams_of(&legs), None, "{noise_mm} mm, {seed}");
        }
    }
}

#[test]
fn a_camera_that_is_off_is_found_and_its_girths_are_in_doubt_by_as_much() {
    for by_mm in [-3.0, 2.5, 4.0_f64] {
        for noise_mm in [0.2, 0.8] {
            let found = seams_of(&[1, 2].map(|seed| leg(noise_mm, seed, quarter(by_mm)))).unwrap();
            let true_mm = by_mm.abs();
            assert!((0.6..2.2).contains(&(found.step_mm / true_mm)), "{by_mm}: {found:?}");
            // A quarter that is moved by s makes the girth √2 s larger, and up to 2 s with the hull.
            assert!(2.0 * found.girth_sd_mm > 1.42 * true_mm, "{by_mm}: {found:?}");
        }
    }
}

#[test]
fn the_back_moved_off_the_front_is_found_though_the_skin_has_no_step() {
    let back = |direction: f64, _| if direction.cos() < 0.0 { [-3.0, 0.0] } else { [0.0; 2] };
    let found = seams_of(&[1, 2].map(|seed| leg(0.5, seed, back))).unwrap();
    assert!(2.0 * found.girth_sd_mm > 6.0, "{found:?}");
}

#[test]
fn a_camera_turned_about_a_lateral_axis_is_found_by_the_lower_legs() {
    let turned = |direction: f64, height_mm: f64| {
        let off_mm = 0.5_f64.to_radians() * (height_mm - 900.0);
        if direction.abs() < 1.0 { [off_mm, 0.0] } else { [0.0; 2] }
    };
    assert!(seams_of(&[1, 2].map(|seed| leg(0.5, seed, turned))).is_some());
}

#[test]
fn what_one_leg_has_or_both_have_mirrored_is_the_legs_own() {
    let one = [leg(0.4, 1, quarter(4.0)), leg(0.4, 2, |_, _| [0.0; 2])];
    assert_eq!(seams_of(&one), None);
    let mirrored = |direction: f64, height_mm: f64| {
        let [front, left] = quarter(4.0)(-direction, height_mm);
        [front, -left]
    };
    // The quarters are -10 to 80° and -80 to 10°.
    assert_eq!(seams_of(&[leg(0.4, 1, quarter(4.0)), leg(0.4, 2, mirrored)]), None);
}

#[test]
fn a_view_with_more_noise_and_a_membrane_without_any_have_no_seams() {
    let view = |direction: f64| if (direction - 0.6).abs() < 0.6 { 1.2 } else { 0.3 };
    let membrane = |direction: f64| if direction.abs() > 2.6 { 0.0 } else { 0.4 };
    for seed in 0..5 {
        let seeds = [2 * seed, 2 * seed + 1];
        assert_eq!(seams_of(&seeds.map(|seed| leg_with(view, seed, |_, _| [0.0; 2]))), None);
        assert_eq!(seams_of(&seeds.map(|seed| leg_with(membrane, seed, |_, _| [0.0; 2]))), None);
    }
}

#[test]
fn one_leg_alone_cannot_tell() {
    assert_eq!(seams_of(&[leg(0.4, 1, quarter(4.0))]), None);
}
