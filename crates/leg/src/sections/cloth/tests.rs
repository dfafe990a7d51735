//! Cloth, and what is none, on legs of known shape.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use super::step::logistic;
use super::*;

const SPAN_MM: [f64; 2] = [50.0, 700.0];

/// Points 4.5 mm apart on a leg whose radius depends on the distance along and the angle, with noise.
fn noisy(noise_mm: f64, radius: impl Fn(f64, f64) -> f64) -> Cloth {
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    // The sum of twelve even numbers has a variance of 1.
    let mut noise = move || noise_mm * (0..12).map(|_| random()).sum::<f64>();
    let grid = (0..2000).flat_map(|row| (0..60).map(move |column| (row, column)));
    let points = grid.filter(|(row, column)| (row * 7 + column) % 16 == 0);
    let points: Vec<[f64; 3]> = points
        .map(|(row, column)| {
            let (along, angle) = (f64::from(row) * 0.4, TAU * f64::from(column) / 60.0 - PI);
            [along, angle, radius(along, angle) - 30.0 + noise()]
        })
        .collect();
    let fitted = |_| Some([30.0; DIRECTIONS]);
    cloth(points.into_iter(), fitted, noise_mm, SPAN_MM)
}

fn leg(radius: impl Fn(f64, f64) -> f64) -> Vec<Cover> {
    noisy(0.0, radius).covers
}

/// The only cover, if it is sure.
fn sure(covers: &[Cover]) -> Cover {
    let [cover] = covers else { panic!("{covers:?}") };
    assert!(cover.is_sure, "{cover:?}");
    *cover
}

fn assert_edge(edge: Option<Edge>, along_mm: f64, step_mm: f64) {
    let edge = edge.unwrap();
    assert!((edge.along_mm - along_mm).abs() <= 2.5, "{edge:?}");
    assert!((edge.step_mm - step_mm).abs() <= 0.4, "{edge:?}");
}

#[test]
fn trousers_begin_at_their_hem_and_stand_off_by_what_they_do() {
    let found = sure(&leg(|along, _| if along > 90.0 { 42.0 } else { 30.0 }));
    assert_edge(found.lower, 90.0, 12.0);
    assert_eq!(found.upper, None);
}

#[test]
fn a_steep_bulge_is_skin() {
    // It gains 12 mm of radius at 40° from the axis.
    let slope = 40.0_f64.to_radians().tan();
    assert_eq!(leg(|along, _| 30.0 + ((along - 90.0) * slope).clamp(0.0, 12.0)), []);
}

#[test]
fn a_cuff_of_fat_above_the_ankle_is_skin() {
    for (growth_mm, length_mm) in [(8.0, 15.0), (12.0, 15.0), (15.0, 25.0), (25.0, 40.0)] {
        let cuff = |along: f64, _| {
            let x = ((along - 100.0) / length_mm).clamp(0.0, 1.0);
            let gone = ((along - 300.0) / 150.0).clamp(0.0, 1.0);
            30.0 + growth_mm * x * x * (3.0 - 2.0 * x) * (1.0 - gone * gone * (3.0 - 2.0 * gone))
        };
        let found = noisy(0.5, cuff).covers;
        assert!(found.iter().all(|cover| !cover.is_sure), "{growth_mm} {found:?}");
    }
}

#[test]
fn a_fold_that_hangs_out_all_around_is_skin() {
    let fold = |from: f64| {
        move |along: f64, _| if (from..from + 25.0).contains(&along) { 44.0 } else { 30.0 }
    };
    assert_eq!(leg(fold(400.0)), []);
    let furrow = |along: f64, _| if (400.0..420.0).contains(&along) { 44.0 } else { 58.0 };
    assert_eq!(leg(furrow), []);
    // Trousers over it begin where they begin.
    let trousers = |along: f64| if along > 90.0 { 12.0 } else { 0.0 };
    let found = sure(&leg(|along, angle| fold(400.0)(along, angle) + trousers(along)));
    assert_edge(found.lower, 90.0, 12.0);
}

#[test]
fn a_step_on_one_side_is_no_edge() {
    let ulcer = |along: f64, angle: f64| if along > 90.0 && angle > 1.0 { 42.0 } else { 30.0 };
    assert_eq!(leg(ulcer), []);
}

#[test]
fn a_sock_covers_what_lies_below_its_edge() {
    let found = sure(&leg(|along, _| if along > 150.0 { 30.0 } else { 33.0 }));
    assert_eq!(found.lower, None);
    assert_edge(found.upper, 150.0, -3.0);
}

#[test]
fn the_mark_of_a_sock_is_skin() {
    for (depth_mm, width_mm) in [(1.0_f64, 4.0_f64), (2.0, 5.0), (3.0, 6.0)] {
        let mark = |along: f64, _| 30.0 - depth_mm * (-((along - 250.0) / width_mm).powi(2)).exp();
        assert_eq!(noisy(0.3, mark).covers, [], "{depth_mm}");
    }
}

#[test]
fn a_bandage_of_2_mm_is_found_in_noise_of_half_a_millimetre() {
    let bandage = |along: f64, _| if (150.0..320.0).contains(&along) { 32.0 } else { 30.0 };
    let found = sure(&noisy(0.5, bandage).covers);
    assert_edge(found.lower, 150.0, 2.0);
    assert_edge(found.upper, 320.0, -2.0);
}

#[test]
fn an_edge_may_lean_and_wave() {
    let edge = |angle: f64| 200.0 + 30.0 * 8.0_f64.to_radians().tan() * angle.cos();
    let waved = |angle: f64| edge(angle) + 1.5 * (4.0 * angle).sin();
    let leaning = noisy(0.3, |along, angle| if along > waved(angle) { 34.0 } else { 30.0 });
    let found = sure(&leaning.covers);
    assert_edge(found.lower, 200.0, 4.0);
}

#[test]
fn a_soft_bandage_is_known_by_its_two_edges() {
    let soft = |along: f64, at: f64| 5.0 * (logistic(along - at, 4.0) + 0.5);
    let bandage = noisy(0.4, |along, _| 30.0 + soft(along, 150.0) - soft(along, 320.0));
    let found = sure(&bandage.covers);
    let (lower, upper) = (found.lower.unwrap(), found.upper.unwrap());
    assert!((lower.along_mm - 150.0).abs() < 5.0 && (upper.along_mm - 320.0).abs() < 5.0);
    assert!(!lower.is_sharp && !upper.is_sharp);
}

#[test]
fn a_single_soft_edge_counts_if_the_other_leg_has_none() {
    let soft = |at: f64| move |along: f64, _| 30.0 + 5.0 * (logistic(along - at, 4.0) + 0.5);
    let one = noisy(0.4, soft(200.0));
    assert!(matches!(one.covers.as_slice(), [cover] if !cover.is_sure), "{one:?}");
    let mut both = one.clone();
    both.compare(&noisy(0.4, soft(210.0)));
    assert_eq!(both, one);
    let mut alone = one.clone();
    alone.compare(&noisy(0.4, |_, _| 30.0));
    sure(&alone.covers);
}
