//! Levels of tubes whose girth over height is a closed form.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "support/solids.rs"]
mod solids;

use std::f64::consts::TAU;

use gaiter::leg::Level;
use gaiter::leg::finding::Doubt;
use gaiter::leg::landmark::{Landmark, landmarks};
use gaiter::leg::method::SectionFit;
use gaiter::leg::sections::Sections;
use nalgebra::Vector3;
use solids::{CHORDS_MM, CROTCH_MM, SCATTERED_MM, STATURE_MM, Tube, curve_of, near};

const FITS: [SectionFit; 3] = [SectionFit::Skin, SectionFit::Periodic, SectionFit::Paper];

fn levels(sections: &Sections) -> Vec<Landmark> {
    let near = |along_mm: f64| sections.nearest(along_mm);
    landmarks(&curve_of(sections), STATURE_MM, CROTCH_MM, near)
}

fn names(found: &[Landmark]) -> Vec<Level> {
    found.iter().map(|landmark| landmark.level).collect()
}

#[test]
fn a_cylinder_and_a_cone_have_no_level() {
    let cylinder = |_: f64, _: f64| 50.0;
    let cone = |_: f64, along: f64| 30.0 + 0.05 * along;
    let shapes: [&dyn Fn(f64, f64) -> f64; 2] = [&cylinder, &cone];
    for (radius, fit) in shapes.into_iter().flat_map(|shape| FITS.map(|fit| (shape, fit))) {
        assert_eq!(levels(&Tube { is_scattered: true, ..Tube::of(radius) }.sections(fit)), []);
    }
}

#[test]
fn noise_alone_makes_no_level() {
    let shape = |_: f64, _: f64| 50.0;
    for (seed, noise_mm) in (1..=8).flat_map(|seed| [(seed, 0.3), (seed, 0.7)]) {
        let tube = Tube { seed, noise_mm, is_scattered: true, ..Tube::of(&shape) };
        assert_eq!(levels(&tube.sections(SectionFit::Periodic)), [], "seed {seed}, {noise_mm} mm");
    }
}

/// A leg of revolution: r = mean − amplitude · cos(2π (s − 120) / 400), least at 120 and 520 mm,
/// largest at 320 mm, steepest at 220 mm.
fn wave(mean: f64, amplitude: f64) -> impl Fn(f64, f64) -> f64 {
    move |_, along| mean - amplitude * (TAU * (along - 120.0) / 400.0).cos()
}

#[test]
fn b_b1_c_and_d_of_a_wave_are_at_its_turning_points_and_its_steepest_place() {
    let shape = wave(45.0, 8.0);
    let expected = [
        (Level::B, 120.0, 37.0, 0.5),
        (Level::B1, 220.0, 45.0, 1.5),
        (Level::C, 320.0, 53.0, 0.5),
        (Level::D, 520.0, 37.0, 0.5),
    ];
    for fit in FITS {
        let found = levels(&Tube { is_scattered: true, ..Tube::of(&shape) }.sections(fit));
        assert_eq!(names(&found), Level::ALL);
        for (level, (_, height, radius, tolerance)) in found.iter().zip(expected) {
            let what = format!("{fit:?} {:?}", level.level);
            // The paper's girths err with every plane anew, which moves the extrema.
            let is_paper = fit == SectionFit::Paper;
            let tolerance = if is_paper { 2.0 * tolerance } else { tolerance };
            let reach_mm = if is_paper { CHORDS_MM } else { SCATTERED_MM };
            near(level.height_mm, height, tolerance, &what);
            // The girth at B1 moves with its height; at a turning point it does not.
            let slope = if level.level == Level::B1 { TAU * 8.0 * TAU / 400.0 } else { 0.0 };
            near(level.girth_tape_mm, TAU * radius, reach_mm + slope * tolerance, &what);
            near(level.girth_contour_mm, TAU * radius, reach_mm + slope * tolerance, &what);
            assert_eq!(level.doubts, [], "{what}");
        }
    }
}

#[test]
fn heights_are_vertical_and_distances_along_the_axis_are_not() {
    let shape = wave(45.0, 8.0);
    let direction = Vector3::new(0.15, -0.1, 1.0);
    let upright = direction.normalize().z;
    let found = levels(&Tube { direction, ..Tube::of(&shape) }.sections(SectionFit::Periodic));
    for (level, along) in found.iter().zip([120.0, 220.0, 320.0, 520.0]) {
        let what = format!("{:?}", level.level);
        let tolerance = if level.level == Level::B1 { 1.5 } else { 0.5 };
        near(level.along_mm, along, tolerance, &what);
        near(level.height_mm, level.along_mm * upright, 0.05, &what);
    }
    assert_eq!(found.len(), 4);
}

#[test]
fn a_level_that_is_not_there_is_absent() {
    // Falls on above the calf: no D.
    let falling = |_: f64, along: f64| match along {
        ..=320.0 => wave(45.0, 8.0)(0.0, along),
        _ => 53.0 - 1e-4 * (along - 320.0).powi(2),
    };
    let no_d = levels(&Tube::of(&falling).sections(SectionFit::Periodic));
    assert_eq!(names(&no_d), [Level::B, Level::B1, Level::C]);
    // Rises on above the ankle: neither C nor D, and so no B1.
    let rising = |_: f64, along: f64| 37.0 + 1e-4 * (along - 120.0).powi(2);
    let only_b = levels(&Tube::of(&rising).sections(SectionFit::Periodic));
    assert_eq!(names(&only_b), [Level::B]);
}

#[test]
fn an_extremum_that_stands_out_by_less_than_a_tape_reads_is_doubted_and_d_is_never_shallow() {
    // Girth goes up and down by 2π · 0.2 = 1.26 mm.
    let shape = wave(45.0, 0.1);
    let found = levels(&Tube::of(&shape).sections(SectionFit::Periodic));
    assert_eq!(names(&found), [Level::B, Level::B1, Level::C]);
    for level in found.iter().filter(|level| level.level != Level::B1) {
        let [Doubt::Shallow { prominence_mm }] = level.doubts[..] else {
            panic!("{level:?}");
        };
        let expected = match level.level {
            // From the lower end of the search at 0.045 of stature.
            Level::B => TAU * (wave(45.0, 0.1)(0.0, 67.5) - 44.9),
            _ => TAU * 0.2,
        };
        near(prominence_mm, expected, 0.05, "prominence");
    }
}
