//! Levels of tubes whose girth over height is a closed form.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::TAU;

use gaiter_leg::Level;
use gaiter_leg::doubt::Doubt;
use gaiter_leg::level::By;
use gaiter_leg::levels::extremum::Absence;
use gaiter_leg::levels::landmark::Landmark;
use gaiter_leg::levels::search::{self, Levels};
use gaiter_leg::method::{B1, SectionFit};
use gaiter_leg::sections::equidistant::Sections;
use nalgebra::Vector3;
use support::solids::{CHORDS_MM, CROTCH_MM, SCATTERED_MM, Tube, curve_of, near};

/// The stature for which the waves below have their turns where people have B, C and D, mm.
const TALL_MM: f64 = 1600.0;

const FITS: [SectionFit; 3] = [SectionFit::Skin, SectionFit::Periodic, SectionFit::Paper];

fn search(sections: &Sections, b1: B1) -> Levels {
    search::levels(&curve_of(sections), TALL_MM, CROTCH_MM, b1, sections)
}

fn levels(sections: &Sections) -> Vec<Landmark> {
    search(sections, B1::Steepest).found
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
        assert_eq!(levels(&Tube { is_scattered: true, ..Tube::upright(radius) }.sections(fit)), []);
    }
}

#[test]
fn noise_alone_makes_no_level() {
    let shape = |_: f64, _: f64| 50.0;
    for (seed, noise_mm) in (1..=8).flat_map(|seed| [(seed, 0.3), (seed, 0.7)]) {
        let tube = Tube { seed, noise_mm, is_scattered: true, ..Tube::upright(&shape) };
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
        let found = levels(&Tube { is_scattered: true, ..Tube::upright(&shape) }.sections(fit));
        assert_eq!(names(&found), Level::SOUGHT);
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
    let found = levels(&Tube { direction, ..Tube::upright(&shape) }.sections(SectionFit::Periodic));
    for (level, along) in found.iter().zip([120.0, 220.0, 320.0, 520.0]) {
        let what = format!("{:?}", level.level);
        let tolerance = if level.level == Level::B1 { 1.5 } else { 0.5 };
        near(level.along_mm, along, tolerance, &what);
        near(level.height_mm, level.along_mm * upright, 0.05, &what);
    }
    assert_eq!(found.len(), 4);
}

/// Why each level of an exact tube is absent.
fn absences(shape: &dyn Fn(f64, f64) -> f64) -> (Vec<Level>, Vec<(Level, Absence)>) {
    let Levels { found, absent } =
        search(&Tube::upright(shape).sections(SectionFit::Periodic), B1::Steepest);
    (names(&found), absent)
}

#[test]
fn a_level_that_is_not_there_is_absent_and_says_why() {
    let needs = |level, from| (level, Absence::Needs { level: from });
    // Falls on above the calf: no D up to 0.8 of the crotch's height.
    let falling = |_: f64, along: f64| match along {
        ..=320.0 => wave(45.0, 8.0)(0.0, along),
        _ => 53.0 - 1e-4 * (along - 320.0).powi(2),
    };
    let (found, absent) = absences(&falling);
    assert_eq!(found, [Level::B, Level::B1, Level::C]);
    assert_eq!(absent, [(Level::D, Absence::AboveSearch { along_mm: 0.8 * CROTCH_MM })]);
    // Rises on above the ankle: neither C nor D, and so no B1.
    let rising = |_: f64, along: f64| 37.0 + 1e-4 * (along - 120.0).powi(2);
    let (found, absent) = absences(&rising);
    assert_eq!(found, [Level::B]);
    let no_c = (Level::C, Absence::AboveSearch { along_mm: 0.8 * CROTCH_MM });
    assert_eq!(absent, [needs(Level::B1, Level::C), no_c, needs(Level::D, Level::C)]);
    // Rises from the floor on: the smallest girth is below the search.
    let (found, absent) = absences(&|_: f64, along: f64| 30.0 + 0.05 * along);
    assert_eq!(found, []);
    let no_b = (Level::B, Absence::BelowSearch { along_mm: 0.045 * TALL_MM });
    let above = [(Level::B1, Level::B), (Level::D, Level::C)];
    assert_eq!(absent.len(), 4);
    assert!(absent.contains(&no_b), "{absent:?}");
    assert!(above.iter().all(|&(level, from)| absent.contains(&needs(level, from))), "{absent:?}");
    // Falls from the floor on.
    let (found, absent) = absences(&|_: f64, along: f64| 80.0 - 0.05 * along);
    assert_eq!((found.len(), absent[0]), (0, (Level::B, Absence::NoTurn)));
}

#[test]
fn an_extremum_that_stands_out_by_less_than_a_tape_reads_is_doubted_and_d_is_never_shallow() {
    // Girth goes up and down by 2π · 0.2 = 1.26 mm.
    let shape = wave(45.0, 0.1);
    let found = levels(&Tube::upright(&shape).sections(SectionFit::Periodic));
    assert_eq!(names(&found), [Level::B, Level::B1, Level::C]);
    for level in found.iter().filter(|level| level.level != Level::B1) {
        let [Doubt::Shallow { prominence_mm }] = level.doubts[..] else {
            panic!("{level:?}");
        };
        let expected = match level.level {
            // From the lower end of the search at 0.045 of stature.
            Level::B => TAU * (wave(45.0, 0.1)(0.0, 72.0) - 44.9),
            _ => TAU * 0.2,
        };
        near(prominence_mm, expected, 0.05, "prominence");
    }
}

#[test]
fn an_extremum_at_the_end_of_the_search_is_doubted() {
    // B is at 80 mm, 2π · 37 mm around, and the search begins at 0.045 of 1600 mm; D is 2π · 45 mm.
    let shape = |_: f64, along: f64| {
        let amplitude = if along < 280.0 { 8.0 } else { 4.0 };
        53.0 - amplitude * (1.0 + (TAU * (along - 80.0) / 400.0).cos())
    };
    let found = levels(&Tube::upright(&shape).sections(SectionFit::Periodic));
    assert_eq!(names(&found), Level::SOUGHT);
    near(found[0].height_mm, 80.0, 0.5, "B");
    let [Doubt::Shallow { prominence_mm }, Doubt::Edge { end_mm }] = found[0].doubts[..] else {
        panic!("{found:?}")
    };
    near(end_mm, 8.0, 0.5, "distance to the end");
    near(prominence_mm, TAU * (shape(0.0, 72.0) - 37.0), 0.05, "prominence");
    assert!(found[1..].iter().all(|level| level.doubts.is_empty()), "{found:?}");
}

#[test]
fn an_extremum_that_noise_moves_by_more_than_a_finger_s_breadth_is_doubted() {
    // One wide valley: B is at 180 mm and nothing else is there.
    let shape = |_: f64, along: f64| 45.0 - (TAU * (along - 180.0) / 800.0).cos();
    let of = |noise_mm: f64| {
        let tube = Tube { noise_mm, is_scattered: true, ..Tube::upright(&shape) };
        let [b] = <[Landmark; 1]>::try_from(levels(&tube.sections(SectionFit::Skin))).unwrap();
        b
    };
    let (exact, noisy) = (of(0.0), of(1.5));
    assert!(exact.height_sd_mm < 15.0 && noisy.height_sd_mm > 15.0, "{exact:?} {noisy:?}");
    assert_eq!(exact.doubts, []);
    assert_eq!(noisy.doubts, [Doubt::Flat { height_sd_mm: noisy.height_sd_mm }]);
    near(noisy.height_mm, 180.0, 3.0 * noisy.height_sd_mm, "height");
}

/// A wave whose valley at 120 mm has a bump of 1.2 mm in it: two minima 18.3 mm to both sides of
/// it, where exp(−x²/800) = 8 (2π/400)² · 400/1.2, and a step of `lean` mm per mm between them.
fn two_valleys(lean: f64) -> impl Fn(f64, f64) -> f64 {
    move |_, along| {
        let off = along - 120.0;
        wave(45.0, 8.0)(0.0, along) + 1.2 * (-off * off / 800.0).exp() + lean * off
    }
}

#[test]
fn two_minima_that_cannot_be_told_apart_are_doubted_and_the_other_is_named() {
    for fit in FITS {
        let shape = two_valleys(0.0);
        let found = levels(&Tube::upright(&shape).sections(fit));
        assert_eq!(names(&found), Level::SOUGHT, "{fit:?}");
        let [Doubt::Double { other_height_mm }] = found[0].doubts[..] else { panic!("{found:?}") };
        near((found[0].height_mm - 120.0).abs(), 18.3, 1.0, "B");
        near(other_height_mm + found[0].height_mm, 240.0, 1.5, "the other minimum");
        // One valley lower than the other by 2π · 0.005 · 36 mm = 1.1 mm of girth.
        let shape = two_valleys(0.005);
        let found = levels(&Tube::upright(&shape).sections(fit));
        assert_eq!(found[0].doubts, [], "{fit:?}");
        assert!(found[0].height_mm < 110.0, "{fit:?}: {}", found[0].height_mm);
    }
}

#[test]
fn b1_at_a_fixed_height_above_b_is_there_and_says_so() {
    let (shape, direction) = (wave(45.0, 8.0), Vector3::new(0.15, -0.1, 1.0));
    let upright = direction.normalize().z;
    let sections = Tube { direction, ..Tube::upright(&shape) }.sections(SectionFit::Periodic);
    let b1_of = |distance_mm: f64| {
        let Levels { found, absent } = search(&sections, B1::AboveB { distance_mm });
        let b1 = found.into_iter().find(|landmark| landmark.level == Level::B1);
        b1.ok_or_else(|| absent.into_iter().find(|(level, _)| *level == Level::B1).unwrap().1)
    };
    let b1 = b1_of(80.0).unwrap();
    assert_eq!(b1.by, By::AboveB { distance_mm: 80.0 });
    near(b1.height_mm, 120.0 * upright + 80.0, 0.5, "height");
    // The distance is vertical, the wave runs along the axis; its girth grows by 0.75 mm per mm.
    let girth_mm = TAU * shape(0.0, 120.0 + 80.0 / upright);
    near(b1.girth_tape_mm, girth_mm, 0.5, "girth");
    assert_eq!(b1.doubts, []);
    assert_eq!(b1_of(230.0), Err(Absence::Beyond { level: Level::C }));
}

#[test]
fn b1_at_a_fixed_height_needs_b_but_no_calf() {
    let rising = |_: f64, along: f64| 37.0 + 1e-4 * (along - 120.0).powi(2);
    let cone = |_: f64, along: f64| 30.0 + 0.05 * along;
    let of = |shape: &dyn Fn(f64, f64) -> f64| {
        let sections = Tube::upright(shape).sections(SectionFit::Periodic);
        search(&sections, B1::AboveB { distance_mm: 80.0 })
    };
    let found = of(&rising).found;
    assert_eq!(names(&found), [Level::B, Level::B1]);
    near(found[1].height_mm, 200.0, 0.5, "height");
    near(found[1].girth_tape_mm, TAU * 37.64, 0.1, "girth");
    assert!(of(&cone).absent.contains(&(Level::B1, Absence::Needs { level: Level::B })));
}

#[test]
fn the_edge_of_a_sock_is_not_the_calf_but_is_told() {
    // It stands out by 2.4 mm at 255 mm; the calf is at 320 mm.
    let sock = |along: f64| 2.4 * (-((along - 255.0) / 12.0).powi(2)).exp();
    let shape = move |_: f64, along: f64| wave(45.0, 8.0)(0.0, along) + sock(along);
    let found = levels(&Tube::upright(&shape).sections(SectionFit::Periodic));
    let c = found.iter().find(|landmark| landmark.level == Level::C).unwrap();
    near(c.height_mm, 320.0, 1.0, "C");
    let [Doubt::Several { other_height_mm }] = c.doubts[..] else { panic!("{c:?}") };
    near(other_height_mm, 257.0, 6.0, "the sock's edge");
}

#[test]
fn a_fold_narrower_than_the_fit_can_follow_is_in_the_girth_s_error() {
    // A furrow at B, 5 mm deep and 16 mm wide: 31 mm of girth.
    let furrow = |along: f64| 5.0 * (-((along - 120.0) / 7.0).powi(2)).exp();
    let shape = move |_: f64, along: f64| wave(45.0, 8.0)(0.0, along) - furrow(along);
    let plain = levels(&Tube::upright(&wave(45.0, 8.0)).sections(SectionFit::Skin));
    let found = levels(&Tube::upright(&shape).sections(SectionFit::Skin));
    let (off_mm, sd_mm) = (found[0].girth_tape_mm - TAU * (37.0 - 5.0), found[0].girth_sd_mm);
    assert!(off_mm.abs() < 3.0 * sd_mm, "{off_mm}, sd {sd_mm}");
    assert!(sd_mm > 3.0 * plain[0].girth_sd_mm, "{:?}", plain[0]);
}
