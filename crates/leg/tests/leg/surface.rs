//! The surface of a leg: columns that follow ridges, holes that are bridged and told, and what is
//! refused.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use gaiter_leg::method::SectionFit;
use gaiter_leg::sections::section::Section;
use gaiter_leg::surface::nurbs::{LegSurface, NoSurface, Wanted, surface};
use gaiter_leg::surface::ridge::ridges;
use gaiter_leg::surface::ridge_parametrization::Columns;
use support::solids::{Tube, all, near};

/// Where the crest of [`crested`] is, radians: it goes 40° around the leg.
fn crest(along_mm: f64) -> f64 {
    0.5 + 0.35 * (along_mm / 150.0).sin()
}

/// An oval leg with a crest along it.
fn crested(angle: f64, along_mm: f64) -> f64 {
    let ridge = 6.0 * (14.0 * ((angle - crest(along_mm)).cos() - 1.0)).exp();
    45.0 + 0.03 * along_mm + 2.0 * (2.0 * angle).cos() + ridge
}

fn fitted(tube: &Tube, control_points: Option<[usize; 2]>) -> Result<LegSurface, NoSurface> {
    let sections = tube.sections(SectionFit::Skin);
    let wanted = Wanted { height_mm: [100.0, 450.0], levels_mm: &[], control_points };
    surface(&tube.leg(), &sections, &wanted)
}

fn turned(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

#[test]
fn a_crest_keeps_its_column_although_it_runs_around_the_leg() {
    let tube = Tube::upright(&crested);
    let sections = tube.sections(SectionFit::Skin);
    let rows: Vec<&Section> = all(&sections);
    let found = ridges(&rows);
    let crests: Vec<_> =
        found.iter().filter(|ridge| turned(ridge.angle() - 0.5).abs() < 0.4).collect();
    assert_eq!(crests.len(), 1, "{found:?}");
    let (low, high) = (rows[0].along_mm, rows[rows.len() - 1].along_mm);
    let columns = Columns::following(&found, low, high).unwrap();
    let column = |along_mm: f64| {
        // The crest about the section's own centre, which lies off the axis.
        let section = sections.nearest(along_mm).unwrap();
        let peak = crested(crest(along_mm), along_mm);
        let (sin, cos) = crest(along_mm).sin_cos();
        let arm = nalgebra::Point2::new(peak * cos, peak * sin) - section.centre;
        columns.column(along_mm, arm.y.atan2(arm.x))
    };
    let along = (0..=40).map(|i| low + 30.0 + (high - low - 60.0) * f64::from(i) / 40.0);
    for along_mm in along {
        let off_deg = turned(column(along_mm) - crests[0].angle()).to_degrees();
        assert!(off_deg.abs() < 4.0, "{off_deg}° at {along_mm} mm; the crest itself moves by 20°");
    }
}

#[test]
fn columns_and_angles_are_inverse_and_no_two_columns_cross() {
    let tube = Tube::upright(&crested);
    let sections = tube.sections(SectionFit::Skin);
    let rows: Vec<&Section> = all(&sections);
    let columns = Columns::following(&ridges(&rows), 40.0, 700.0).unwrap();
    for along_mm in [40.0, 133.0, 377.0, 700.0] {
        let angles: Vec<f64> =
            (0..=90).map(|i| columns.angle(along_mm, TAU * f64::from(i) / 90.0 - PI)).collect();
        assert!(angles.windows(2).all(|pair| pair[1] - pair[0] > 0.5 * TAU / 90.0 - 1e-3));
        near(angles[90] - angles[0], TAU, 1e-12, "one turn");
        for i in 0..90 {
            let v = TAU * f64::from(i) / 90.0 - PI;
            near(turned(columns.column(along_mm, angles[i as usize]) - v), 0.0, 1e-6, "inverse");
        }
    }
}

#[test]
fn columns_of_a_round_leg_are_straight() {
    let tube = Tube::upright(&|_, along| 40.0 + 0.02 * along);
    let sections = tube.sections(SectionFit::Skin);
    let rows: Vec<&Section> = all(&sections);
    let found = ridges(&rows);
    assert_eq!(found, []);
    let columns = Columns::following(&found, 40.0, 700.0).unwrap();
    assert_eq!(columns.angle(300.0, 1.25), 1.25);
}

#[test]
fn a_hole_is_bridged_and_told_with_its_place_and_size() {
    let hole = |angle: f64, along: f64| (along - 250.0).hypot(55.0 * turned(angle - 2.0)) < 22.0;
    let tube = Tube { hole: &hole, ..Tube::upright(&crested) };
    let found = fitted(&tube, None).unwrap();
    let [at] = found.holes() else { panic!("{:?}", found.holes()) };
    near(at.along_mm, 250.0, 3.0, "height of the hole");
    let angle = found.columns.angle(at.along_mm, at.column);
    near(turned(angle - 2.0).to_degrees(), 0.0, 4.0, "direction of the hole");
    // 44 mm less the corners of cells whose points other triangles keep.
    let about = 36.0..48.0;
    assert!(about.contains(&at.length_mm) && about.contains(&at.width_mm), "{at:?}");
    // The bridge is as smooth as the leg around it: within a millimetre of what nobody saw.
    let middle = found.surface.point(at.along_mm, at.column);
    let radius = middle.x.hypot(middle.y);
    near(radius, crested(middle.x.atan2(-middle.y), middle.z), 1.0, "bridge");
    assert!(found.in_holes.is_some());
    assert!(found.coverage.is_in_hole(at.along_mm, at.column));
    assert!(!found.coverage.is_in_hole(at.along_mm, at.column + PI));
}

#[test]
fn without_holes_none_are_told() {
    // A net too coarse for the crest lies off the skin, which was seen all the same.
    for control_points in [None, Some([8, 8])] {
        let found = fitted(&Tube::upright(&crested), control_points).unwrap();
        assert!(found.holes().is_empty() && found.in_holes.is_none());
    }
}

#[test]
fn a_narrow_band_is_bridged_and_a_wide_one_ends_the_surface() {
    let band = |to_mm: f64| move |_: f64, along: f64| (250.0..to_mm).contains(&along);
    let narrow = band(275.0);
    let found = fitted(&Tube { hole: &narrow, ..Tube::upright(&crested) }, None).unwrap();
    let [at] = found.holes() else { panic!("{:?}", found.holes()) };
    near(at.width_mm, found.surface.girth_mm(at.along_mm), 8.0, "all around");
    let wide = band(330.0);
    let found = fitted(&Tube { hole: &wide, ..Tube::upright(&crested) }, None);
    let (_, top_mm) = found.unwrap().surface.along().domain();
    assert!((230.0..=260.0).contains(&top_mm), "{top_mm}");
}

#[test]
fn a_level_may_lie_on_a_section_on_another_level_or_at_an_end() {
    let tube = Tube::upright(&crested);
    let sections = tube.sections(SectionFit::Skin);
    let rows: Vec<f64> = all(&sections).iter().map(|section| section.along_mm).collect();
    let at = |index: usize| rows[index];
    for levels_mm in [vec![at(40)], vec![at(12)], vec![203.0, 203.0], vec![at(rows.len() - 1)]] {
        let height_mm = [100.0, 450.0];
        let wanted = Wanted { height_mm, levels_mm: &levels_mm, control_points: None };
        let found = surface(&tube.leg(), &sections, &wanted);
        assert!(found.is_ok(), "{levels_mm:?}: {:?}", found.unwrap_err());
    }
}

#[test]
fn a_bump_is_no_ridge() {
    let bumped = |angle: f64, along: f64| {
        let bump = 6.0 * (14.0 * ((angle - 1.0).cos() - 1.0)).exp();
        45.0 + bump * (-((along - 300.0) / 20.0).powi(2)).exp()
    };
    let tube = Tube::upright(&bumped);
    let sections = tube.sections(SectionFit::Skin);
    let found = ridges(&all(&sections));
    let near_it = found.iter().filter(|ridge| turned(ridge.angle() - 1.0).abs() < 0.3);
    assert_eq!(near_it.count(), 0, "{found:?}");
}

#[test]
fn half_a_leg_makes_no_surface() {
    let hole = |angle: f64, along: f64| along < 600.0 && turned(angle - 1.0).abs() < PI / 2.0;
    let tube = Tube { hole: &hole, ..Tube::upright(&crested) };
    let Err(NoSurface::TooFewRows { rows, needed, .. }) = fitted(&tube, None) else {
        panic!("a surface")
    };
    assert!(rows < needed, "{rows} of {needed}");
}

#[test]
fn more_control_points_than_sections_are_refused_with_both_figures() {
    let Err(NoSurface::Fit { why: refused }) = fitted(&Tube::upright(&crested), Some([160, 24]))
    else {
        panic!("a surface")
    };
    assert!(refused.to_string().contains("160"), "{refused}");
}

#[test]
fn a_surface_of_noisy_points_is_the_leg_within_the_noise() {
    let tube = Tube { noise_mm: 0.5, is_scattered: true, ..Tube::upright(&crested) };
    let found = fitted(&tube, None).unwrap();
    let (low, high) = found.surface.along().domain();
    let places = (0..60).flat_map(|i| (0..60).map(move |j| (f64::from(i), f64::from(j))));
    let off = places.map(|(i, j)| {
        let u = low + (high - low) * (i + 0.5) / 60.0;
        let point = found.surface.point(u, TAU * j / 60.0);
        let radius = point.x.hypot(point.y);
        (radius - crested(point.x.atan2(-point.y), point.z)) / radius
    });
    let mean = off.map(f64::abs).sum::<f64>() / 3600.0;
    // A third of the noise of 0.5 mm on 50 mm of radius.
    assert!(mean < 0.003_5, "{mean}");
    near(found.to_points.rms_mm, 0.5, 0.05, "the noise is what is left");
}
