//! Sections, girths, axes and surfaces of tubes that are closed forms, through the leg's own stages.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use gaiter_leg::features::feature::features;
use gaiter_leg::method::SectionFit;
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::sections::axis_fit::AxisFault;
use gaiter_leg::sections::equidistant::{Source, sections};
use gaiter_leg::sections::section::Section;
use gaiter_leg::side::Side;
use gaiter_leg::surface::nurbs::{Wanted, surface};
use nalgebra::{Point3, Vector3};
use support::solids::{
    CHORDS_MM, CROTCH_MM, REGULAR_MM, SCATTERED_MM, STATURE_MM, Tube, all, axis, contour_mm,
    curve_of, ellipse, near, off_deg, principal_axis, tape_mm,
};

const FITS: [SectionFit; 3] = [SectionFit::Skin, SectionFit::Periodic, SectionFit::Paper];

#[test]
fn a_cylinder_has_the_girth_of_its_radius_at_every_height() {
    for (radius, fit) in [28.0, 50.0, 80.0].into_iter().flat_map(|r| FITS.map(|fit| (r, fit))) {
        let shape = move |_: f64, _: f64| radius;
        for (is_scattered, tolerance) in [(false, REGULAR_MM), (true, SCATTERED_MM)] {
            if is_scattered && fit == SectionFit::Paper {
                continue;
            }
            let tube = Tube { is_scattered, ..Tube::upright(&shape) };
            for section in all(&tube.sections(fit)) {
                let what = format!("{fit:?}, scattered {is_scattered}, {} mm", section.along_mm);
                near(section.girth.tape_mm, TAU * radius, tolerance, &what);
                near(section.girth.contour_mm, TAU * radius, tolerance, &what);
                near(section.rms_mm, 0.0, 0.03, &what);
            }
        }
    }
}

#[test]
fn the_paper_s_lines_are_chords_and_its_polynomial_swings_where_they_leave_a_gap() {
    for radius in [28.0, 50.0, 80.0] {
        let shape = move |_: f64, _: f64| radius;
        let sections =
            Tube { is_scattered: true, ..Tube::upright(&shape) }.sections(SectionFit::Paper);
        let found = sections.rows.iter().filter_map(|row| row.section.as_ref());
        let mut off: Vec<f64> = found.map(|s| s.girth.tape_mm - TAU * radius).collect();
        off.sort_by(f64::total_cmp);
        assert!(off.len() > 130, "{} sections close", off.len());
        // Chords over up to 4 mm around: e²/12R on average, 2π of it in the girth.
        let median = off[off.len() / 2];
        assert!((-CHORDS_MM..-0.02).contains(&median), "{radius}: median {median}");
        let (least, most) = (off[0], off[off.len() - 1]);
        assert!(least > -CHORDS_MM && most < 0.8, "{radius}: {least} to {most}");
    }
}

#[test]
fn the_girth_curve_of_a_cylinder_is_level_and_it_has_no_feature() {
    let shape = |_: f64, _: f64| 50.0;
    let sections =
        Tube { is_scattered: true, ..Tube::upright(&shape) }.sections(SectionFit::Periodic);
    let curve = curve_of(&sections);
    let (from, to) = curve.domain();
    for along in (from as usize..to as usize).map(|along| along as f64 + 0.5) {
        near(curve.tape(along)[1], 0.0, 1e-4, "slope");
    }
    for section in all(&sections) {
        assert_eq!(
            features(&sections.axis.plane(section.along_mm), section),
            [],
            "{} mm",
            section.along_mm
        );
    }
}

#[test]
fn noise_does_not_lengthen_the_girth_and_is_told_by_the_residuals() {
    let shape = |_: f64, _: f64| 50.0;
    for noise_mm in [0.3, 0.5, 1.0] {
        let tube = Tube { noise_mm, is_scattered: true, ..Tube::upright(&shape) };
        let sections = tube.sections(SectionFit::Periodic);
        let sections = all(&sections);
        let mean = |value: fn(&Section) -> f64| {
            sections.iter().map(|section| value(section)).sum::<f64>() / sections.len() as f64
        };
        // A polygon through points with this noise 4 mm apart would be longer by 2 to 20 mm.
        near(mean(|s| s.girth.tape_mm), TAU * 50.0, 0.3 * noise_mm, "mean girth");
        // A crossing at the share t of its edge has the variance t² + (1 − t)², 2/3 in the mean.
        near(mean(|s| s.rms_mm), noise_mm * (2.0_f64 / 3.0).sqrt(), 0.1 * noise_mm, "rms");
    }
}

#[test]
fn the_girth_of_a_cone_grows_evenly_and_its_surface_is_the_cone() {
    let (base, growth) = (30.0, 0.05);
    let shape = |_: f64, along: f64| base + growth * along;
    let tube = Tube::upright(&shape);
    for fit in FITS {
        let sections = tube.sections(fit);
        for section in all(&sections) {
            let expected = TAU * shape(0.0, section.along_mm);
            near(section.girth.tape_mm, expected, REGULAR_MM, "tape");
            near(section.girth.contour_mm, expected, REGULAR_MM, "contour");
        }
        let curve = curve_of(&sections);
        for along in [80.0, 203.0, 511.0, 680.0] {
            near(curve.tape(along)[0], TAU * shape(0.0, along), REGULAR_MM, "curve");
            near(curve.tape(along)[1], TAU * growth, 1e-3, "slope");
        }
        assert!(curve.r2() > 0.999_999, "{}", curve.r2());
    }

    let sections = tube.sections(SectionFit::Periodic);
    let wanted = Wanted { height_mm: [100.0, 450.0], levels_mm: &[203.0], control_points: None };
    let leg = surface(&tube.leg(), &sections, &wanted).unwrap();
    near(leg.to_sections.max_mm, 0.0, 0.01, "to sections");
    near(leg.to_points.max_mm, 0.0, 0.01, "to points");
    near(leg.height_mm[0], 100.0, 1e-6, "lower end");
    let highest = all(&sections).last().unwrap().height_mm;
    near(leg.height_mm[1], highest, 1e-6, "upper end: as far as there are sections");
    near(leg.surface.girth_mm(203.0), TAU * shape(0.0, 203.0), 0.01, "girth");
    for (along, angle) in (0..36).map(|i| (100.0 + 10.0 * f64::from(i), f64::from(i) / 6.0 - PI)) {
        let point = leg.surface.point(along, angle);
        near(point.x.hypot(point.y), shape(0.0, point.z), 0.01, "surface");
        near(point.z, along, 1e-6, "height");
    }
}

/// Perimeter of an ellipse by the arithmetic-geometric mean (Gauss; Borwein and Borwein, Pi and
/// the AGM, 1987).
fn ellipse_mm(long: f64, short: f64) -> f64 {
    let (mut a, mut b, mut c) = (long, short, (long * long - short * short).sqrt());
    let (mut sum, mut power) = (0.0, 0.5);
    while c > 1e-12 {
        sum += power * c * c;
        power *= 2.0;
        (a, b, c) = ((a + b) / 2.0, (a * b).sqrt(), (a - b) / 2.0);
    }
    TAU * (long * long - sum) / a
}

#[test]
fn an_elliptic_tube_has_the_perimeter_of_its_ellipse() {
    near(ellipse_mm(60.0, 40.0), contour_mm(|t| ellipse(60.0, 40.0)(t, 0.0)), 5e-6, "the oracles");
    let cases = [
        (60.0, 40.0, SectionFit::Periodic, false, REGULAR_MM),
        (60.0, 40.0, SectionFit::Periodic, true, SCATTERED_MM),
        (45.0, 28.0, SectionFit::Periodic, false, REGULAR_MM),
        // A polynomial of order 15 does not follow an ellipse beyond 7 : 6 to 0.05 mm.
        (52.0, 46.0, SectionFit::Paper, false, 0.05),
    ];
    for (long, short, fit, is_scattered, tolerance) in cases {
        let shape = ellipse(long, short);
        for section in all(&Tube { is_scattered, ..Tube::upright(&shape) }.sections(fit)) {
            let what = format!("{long} × {short}, {fit:?}, {} mm", section.along_mm);
            near(section.girth.tape_mm, ellipse_mm(long, short), tolerance, &what);
            near(section.girth.contour_mm, ellipse_mm(long, short), tolerance, &what);
            assert!(section.r2 > 0.9999, "{what}: R² {}", section.r2);
        }
    }
}

#[test]
fn the_paper_s_section_has_the_girth_of_two_and_three_waves() {
    for (waves, amplitude) in [(2.0, 5.0), (3.0, 3.0)] {
        let radius = move |t: f64| 50.0 + amplitude * (waves * (t - 0.35)).cos();
        let shape = move |angle: f64, _: f64| radius(angle);
        let (contour, tape) = (contour_mm(radius), tape_mm(radius));
        for section in all(&Tube::upright(&shape).sections(SectionFit::Paper)) {
            near(section.girth.contour_mm, contour, REGULAR_MM, "contour");
            near(section.girth.tape_mm, tape, REGULAR_MM, "tape");
        }
    }
}

#[test]
fn a_tape_bridges_hollows_and_the_contour_does_not() {
    let radius = |t: f64| 50.0 + 10.0 * (3.0 * (t - 0.35)).cos();
    let shape = |angle: f64, _: f64| radius(angle);
    let (tape, contour) = (tape_mm(radius), contour_mm(radius));
    assert!(contour - tape > 1.5, "the section must be hollow: {tape} and {contour}");
    for fit in FITS {
        // An odd number, so that no column stands at the back, where the paper's polynomial is open.
        let tube = Tube { columns: 71, ..Tube::upright(&shape) };
        for section in all(&tube.sections(fit)) {
            near(section.girth.tape_mm, tape, REGULAR_MM, "tape");
            near(section.girth.contour_mm, contour, REGULAR_MM, "contour");
        }
    }
}

#[test]
fn the_axis_of_a_tilted_tube_is_found_with_its_foot_and_its_heights() {
    let shape = ellipse(55.0, 45.0);
    let round = |_: f64, _: f64| 50.0;
    let tilts = [Vector3::new(0.14, -0.08, 1.0), Vector3::new(-0.2, 0.1, 1.0), Vector3::z()];
    for (side, tilt) in Side::BOTH.into_iter().flat_map(|side| tilts.map(|tilt| (side, tilt))) {
        let shapes: [&dyn Fn(f64, f64) -> f64; 2] = [&shape, &round];
        for (radius, girth) in shapes.into_iter().zip([ellipse_mm(55.0, 45.0), TAU * 50.0]) {
            let foot = Point3::new(90.0, -20.0, 0.0);
            let tube =
                Tube { side, foot, direction: tilt, is_scattered: true, ..Tube::upright(radius) };
            let sections = tube.sections(SectionFit::Periodic);
            let axis = &sections.axis;
            let off_deg = axis.foot.normal.angle(&tilt).to_degrees();
            assert!(off_deg < 0.05, "{side:?} {tilt}: {off_deg}° off");
            near(axis.tilt_deg(), tilt.angle(&Vector3::z()).to_degrees(), 0.05, "tilt");
            assert!((axis.foot.origin - foot).norm() < 0.2, "{}", axis.foot.origin);
            assert!(axis.foot.front.y < -0.9 && axis.foot.lateral.x * side.lateral_sign() > 0.9);
            let upright = tilt.normalize().z;
            for section in all(&sections) {
                near(section.height_mm, section.along_mm * upright, 0.1, "height");
                near(section.girth.tape_mm, girth, SCATTERED_MM, "tape");
            }
        }
    }
}

#[test]
fn the_principal_axis_of_an_even_tube_is_its_own_and_points_up() {
    let oval = ellipse(55.0, 45.0);
    for side in Side::BOTH {
        let foot = Point3::new(90.0, -20.0, 0.0);
        let leg = Tube { side, foot, is_scattered: true, ..Tube::upright(&oval) }.leg();
        let axis = principal_axis(&leg, CROTCH_MM).unwrap();
        assert!(axis.foot.normal.z > 0.0 && axis.tilt_deg() < 0.1, "{}", axis.tilt_deg());
        assert!((axis.foot.origin - foot).norm() < 0.5, "{}", axis.foot.origin);
        assert!(axis.foot.front.y < -0.99 && axis.foot.lateral.x * side.lateral_sign() > 0.99);
    }
    // The horizontal cut at the crotch, oblique to a leaning leg, turns it a little.
    let direction = Vector3::new(0.14, -0.08, 1.0);
    let leg = Tube { direction, ..Tube::upright(&oval) }.leg();
    let off_deg =
        principal_axis(&leg, CROTCH_MM).unwrap().foot.normal.angle(&direction).to_degrees();
    assert!(off_deg < 0.5, "{off_deg}° off");
}

#[test]
fn the_principal_axis_leans_towards_what_was_seen_and_that_of_centroids_does_not() {
    let round = |_: f64, _: f64| 50.0;
    // A sixth of the skin unseen, at the back of the upper half of the leg.
    let hole = |angle: f64, along: f64| along > 350.0 && off_deg(angle.to_degrees(), 180.0) < 30.0;
    let leg = Tube { hole: &hole, ..Tube::upright(&round) }.leg();
    let principal = principal_axis(&leg, CROTCH_MM).unwrap();
    let centroids = axis(&leg, STATURE_MM, CROTCH_MM).unwrap();
    // Towards the front, −y.
    assert!(principal.foot.normal.y < -0.015, "{}", principal.foot.normal.y);
    assert!(principal.tilt_deg() > 4.0 * centroids.tilt_deg(), "{}", centroids.tilt_deg());
}

#[test]
fn a_leg_that_lies_or_has_hardly_a_point_has_no_principal_axis() {
    let round = |_: f64, _: f64| 50.0;
    let lying = Tube { direction: Vector3::new(1.0, 0.0, 1.0), ..Tube::upright(&round) }.leg();
    let fault = principal_axis(&lying, CROTCH_MM).unwrap_err();
    assert!(matches!(fault, AxisFault::Leaning { tilt_deg } if tilt_deg > 35.0), "{fault}");
    let fault = principal_axis(&Tube::upright(&round).leg(), -60.0).unwrap_err();
    assert!(matches!(fault, AxisFault::TooFewPoints { found: 72, .. }), "{fault}");
}

#[test]
fn the_axis_goes_through_the_centroid_of_the_area_inside_not_of_the_hull() {
    let radius = |t: f64| 50.0 + 9.0 * (3.0 * t).cos() + 8.0 * t.cos() + 5.0 * (2.0 * t).sin();
    let shape = |angle: f64, _: f64| radius(angle);
    // Area and first moments in polar coordinates, by the trapezoid rule, exact for such a sum.
    let integral = |f: &dyn Fn(f64) -> f64| {
        (0..360).map(|i| f(f64::from(i).to_radians())).sum::<f64>() * TAU / 360.0
    };
    let area = integral(&|t| radius(t).powi(2) / 2.0);
    let ahead = integral(&|t| radius(t).powi(3) * t.cos() / 3.0) / area;
    let aside = integral(&|t| radius(t).powi(3) * t.sin() / 3.0) / area;
    let foot = Tube::upright(&shape).sections(SectionFit::Periodic).axis.foot.origin;
    near(foot.y, -ahead, 0.05, "front");
    near(foot.x, aside, 0.05, "lateral");
}

/// A hole of this width around this direction, at all heights, degrees.
fn hole(width_deg: f64, at_deg: f64) -> impl Fn(f64, f64) -> bool {
    move |angle: f64, _| off_deg(angle.to_degrees(), at_deg) < width_deg / 2.0
}

#[test]
fn a_hole_of_up_to_40_degrees_costs_less_than_a_fifth_of_a_millimetre_of_girth() {
    let (round, oval) = (|_: f64, _: f64| 50.0, ellipse(60.0, 40.0));
    let shapes: [&dyn Fn(f64, f64) -> f64; 2] = [&round, &oval];
    for (radius, girth) in shapes.into_iter().zip([TAU * 50.0, ellipse_mm(60.0, 40.0)]) {
        for (width, at) in
            [20.0, 40.0].into_iter().flat_map(|w| [0.0, 60.0, 90.0, 180.0].map(|at| (w, at)))
        {
            let hole = hole(width, at);
            let tube = Tube { columns: 360, ring_mm: 10.0, hole: &hole, ..Tube::upright(radius) };
            for section in all(&tube.sections(SectionFit::Periodic)) {
                let what = format!("{width}° at {at}°");
                near(section.girth.tape_mm, girth, 0.2, &what);
                near(section.largest_gap_deg, width, 2.0, &what);
            }
        }
    }
}

/// Sections are open exactly where, between 300 and 400 mm, the hole is `wide` and not `narrow`.
fn open_where_wide(fit: SectionFit, at: f64, [narrow, wide]: [f64; 2]) {
    let round = |_: f64, _: f64| 50.0;
    let (wide, narrow) = (hole(wide, at), hole(narrow, at));
    let hole = |angle: f64, along: f64| {
        if (300.0..400.0).contains(&along) { wide(angle, along) } else { narrow(angle, along) }
    };
    let tube = Tube { columns: 360, hole: &hole, ..Tube::upright(&round) };
    for row in &tube.sections(fit).rows {
        let is_wide = (300.0..400.0).contains(&row.along_mm);
        // The skin sees a plane by the points of a few millimetres to either side of it.
        let rim_mm = if fit == SectionFit::Skin { 12.0 } else { 6.0 };
        let at_rim = [300.0, 400.0].iter().any(|end| (row.along_mm - end).abs() < rim_mm);
        let is_right = at_rim || row.section.is_none() == is_wide;
        assert!(is_right, "{fit:?} {at}° {} mm", row.along_mm);
    }
}

#[test]
fn a_gap_beyond_150_degrees_or_60_in_a_plane_leaves_a_section_open_and_one_below_does_not() {
    for at in [0.0, 75.0, 180.0] {
        open_where_wide(SectionFit::Skin, at, [147.0, 155.0]);
        open_where_wide(SectionFit::Periodic, at, [57.0, 65.0]);
    }
}

#[test]
fn the_paper_s_polynomial_which_swings_in_gaps_bridges_none_beyond_20_degrees() {
    for at in [0.0, 75.0, 180.0] {
        open_where_wide(SectionFit::Paper, at, [17.0, 25.0]);
    }
}

#[test]
fn a_wide_hole_over_a_hand_s_breadth_does_not_bend_the_girth_curve() {
    let round = |_: f64, _: f64| 50.0;
    let wide = hole(120.0, 30.0);
    let hole = |angle: f64, along: f64| (300.0..380.0).contains(&along) && wide(angle, along);
    let sections = Tube { hole: &hole, ..Tube::upright(&round) }.sections(SectionFit::Periodic);
    let curve = curve_of(&sections);
    assert!(!curve.is_seen(340.0));
    assert!(curve.is_seen(250.0));
    near(curve.tape(340.0)[0], TAU * 50.0, 0.1, "bridged girth");
}

#[test]
fn the_girth_of_a_leaning_tube_in_a_horizontal_plane_changes_with_the_tilt_as_an_ellipse_does() {
    let (radius_mm, lean_deg) = (50.0, 8.0_f64);
    // Half axes r and r / cos β; Ramanujan's perimeter is good to 1e-8 for these.
    let perimeter = |deg: f64| {
        let (a, b) = (radius_mm, radius_mm / deg.to_radians().cos());
        PI * (3.0 * (a + b) - ((3.0 * a + b) * (a + 3.0 * b)).sqrt())
    };
    let expected = (perimeter(lean_deg + 0.5) - perimeter(lean_deg - 0.5)).abs();
    for (x, y) in [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8)] {
        let lean = lean_deg.to_radians().tan();
        let direction = Vector3::new(x * lean, y * lean, 1.0);
        let leg = Tube { direction, ..Tube::upright(&|_, _| radius_mm) }.leg();
        let horizontal = LegAxis::straight(Point3::origin(), &Vector3::z(), leg.side);
        let found = sections(&leg, horizontal, [60.0, 600.0], SectionFit::Skin).unwrap();
        let Source::Skin(skin) = &found.source else { panic!("no skin") };
        let [front, lateral] = skin.girth_per_deg(300.0).unwrap();
        near(front.hypot(lateral), expected, 0.02, "mm per degree");
        // Nearer to square is shorter: a normal that leans with the tube makes it so.
        let with_lean = -y * front + x * leg.side.lateral_sign() * lateral;
        near(with_lean, -expected, 0.02, "towards the tube's own direction");
    }
}
