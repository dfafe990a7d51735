//! Grids that make no surface are refused by name, and what may be bridged is.
#![allow(clippy::unwrap_used)]

use gaiter_spline::{
    BasisFault, FitFault, GridData, GridDomain, GridMethod, Knots, KnotsUsed, SurfaceFit,
    fit_grid_by,
};
use nalgebra::Point3;
use support::metric::parameters;
use support::test_leg;

const WHOLE: GridDomain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };

fn plain(control_points: [usize; 2]) -> GridMethod {
    GridMethod { control_points, knots: Knots::Adaptive, marks: Vec::new() }
}

/// Some rows and columns of the test leg.
struct Part {
    along: Vec<f64>,
    around: Vec<f64>,
    points: Vec<Point3<f64>>,
}

impl Part {
    fn new(row: impl Fn(usize) -> bool, column: impl Fn(usize) -> bool) -> Part {
        let points = test_leg::grid();
        let (along, around) = parameters(&points);
        let kept = |values: Vec<f64>, keep: &dyn Fn(usize) -> bool| {
            values.into_iter().enumerate().filter(|(i, _)| keep(*i)).map(|(_, x)| x).collect()
        };
        let places = points.iter().enumerate().map(|(k, point)| (k / 72, k % 72, point));
        let points = places.filter(|(i, j, _)| row(*i) && column(*j)).map(|(_, _, p)| *p).collect();
        Part { along: kept(along, &row), around: kept(around, &column), points }
    }

    fn fit(&self, method: &GridMethod) -> Result<SurfaceFit, FitFault> {
        let Part { along, around, points } = self;
        fit_grid_by(&GridData { along, around, points }, &WHOLE, method)
    }

    fn refused(&self, method: &GridMethod) -> FitFault {
        self.fit(method).unwrap_err()
    }
}

#[test]
fn fewer_lines_than_control_points_are_refused() {
    let few =
        |direction, found, needed| FitFault::FewerThanControlPoints { direction, found, needed };
    let one = Part::new(|i| i == 40, |_| true);
    assert_eq!(one.refused(&plain([30, 24])), few("along", 1, 30));
    let rows = Part::new(|i| i % 4 == 0, |_| true);
    assert_eq!(rows.refused(&plain([30, 24])), few("along", 20, 30));
    let columns = Part::new(|_| true, |j| j % 6 == 0);
    assert_eq!(columns.refused(&plain([30, 24])), few("around", 12, 24));
    assert_eq!(rows.fit(&plain([20, 16])).unwrap().surface.control_points().len(), 320);
}

#[test]
fn too_few_control_points_are_refused() {
    let all = Part::new(|_| true, |_| true);
    let fault = |found, needed| FitFault::Basis(BasisFault::TooFewBreakpoints { found, needed });
    assert_eq!(all.refused(&plain([3, 24])), fault(1, 2));
    assert_eq!(all.refused(&plain([30, 3])), fault(4, 5));
    assert!(all.fit(&plain([4, 4])).is_ok());
}

#[test]
fn points_that_are_no_numbers_are_refused() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut part = Part::new(|_| true, |_| true);
        part.points[100].y = wrong;
        assert_eq!(part.refused(&plain([30, 24])), FitFault::NotFinite { index: 100 });
        let mut part = Part::new(|_| true, |_| true);
        part.along[3] = wrong;
        assert_eq!(part.refused(&plain([30, 24])), FitFault::NotFinite { index: 3 * 72 });
    }
    let part = Part::new(|_| true, |_| true);
    let data = GridData { along: &part.along, around: &part.around, points: &part.points };
    let endless = GridDomain { period: f64::NAN, ..WHOLE };
    let fault = fit_grid_by(&data, &endless, &plain([30, 24])).unwrap_err();
    assert!(matches!(fault, FitFault::Basis(BasisFault::NotFinite { .. })), "{fault}");
}

#[test]
fn lines_that_coincide_are_refused() {
    let method = plain([30, 24]);
    let mut part = Part::new(|_| true, |_| true);
    part.along[20] = part.along[21];
    let fault = |lines, first, second| FitFault::Coincident { lines, first, second };
    assert_eq!(part.refused(&method), fault("rows", 20, 21));
    // The same section again, said to lie elsewhere.
    let mut part = Part::new(|_| true, |_| true);
    part.points.copy_within(20 * 72..21 * 72, 21 * 72);
    assert_eq!(part.refused(&method), fault("rows", 20, 21));
    // The first column repeated at the end, as other tools want it.
    let mut part = Part::new(|_| true, |_| true);
    part.around.push(1.0);
    let rows = part.points.chunks(72).map(|row| [row, &row[..1]].concat());
    part.points = rows.collect::<Vec<_>>().concat();
    assert_eq!(part.refused(&method), fault("columns", 0, 72));
    // Another column a hair before the seam, where the first one lies.
    for row in part.points.chunks_mut(73) {
        row[72].x += 1.0;
    }
    part.around[72] = 1.0 - 1e-12;
    assert_eq!(part.refused(&method), fault("columns", 72, 0));
}

#[test]
fn points_that_coincide_are_refused_where_they_leave_no_shape() {
    let mut part = Part::new(|_| true, |_| true);
    part.points.fill(Point3::origin());
    let refused = part.refused(&plain([30, 24]));
    assert_eq!(refused, FitFault::Coincident { lines: "rows", first: 0, second: 1 });
    // Two neighbours in one section do no harm.
    let mut part = Part::new(|_| true, |_| true);
    part.points[500] = part.points[501];
    assert!(part.fit(&plain([30, 24])).unwrap().max_mm < 5.0);
}

#[test]
fn a_hole_of_half_the_grid_is_refused() {
    let rows = Part::new(|i| !(20..60).contains(&i), |_| true);
    let FitFault::Gap { direction, from, to, functions } = rows.refused(&plain([30, 24])) else {
        panic!("not refused as a gap")
    };
    assert_eq!((direction, functions), ("along", 10));
    assert!((from - 19.0 / 79.0).abs() < 1e-9 && (to - 60.0 / 79.0).abs() < 1e-9, "{from} {to}");
    let columns = Part::new(|_| true, |j| (18..54).contains(&j));
    let fault = columns.refused(&plain([30, 24]));
    assert!(matches!(fault, FitFault::Gap { direction: "around", .. }), "{fault}");
    let words = fault.to_string();
    assert!(words.starts_with("no data around from 0.7") && words.contains("to 1.2"), "{words}");
}

#[test]
fn an_end_without_data_is_refused() {
    let part = Part::new(|i| i >= 5, |_| true);
    let fault = part.refused(&plain([30, 24]));
    let gap = |to| matches!(fault, FitFault::Gap { from: 0.0, to: end, .. } if end == to);
    assert!(gap(5.0 / 79.0), "{fault}");
    assert!(Part::new(|i| i >= 2, |_| true).fit(&plain([30, 24])).is_ok());
}

#[test]
fn a_small_gap_is_bridged() {
    // Eight sections are missing, above the knee and below the calf.
    for (first, limit_mm) in [(52, 0.5), (20, 0.6)] {
        let part = Part::new(|i| !(first..first + 8).contains(&i), |_| true);
        for knots in [Knots::Uniform, Knots::Adaptive] {
            let fit = part.fit(&GridMethod { knots, ..plain([30, 24]) }).unwrap();
            let middle = (first as f64 + 3.5) / 79.0;
            let there = (0..72).map(|j| fit.surface.point(middle, f64::from(j) / 72.0));
            let missed = there.map(|point| test_leg::outside_mm(&point).abs()).fold(0.0, f64::max);
            assert!(missed < limit_mm, "{first} {knots:?}: {missed} mm");
        }
    }
}

#[test]
fn a_gap_of_three_functions_is_bridged_and_one_of_four_is_refused() {
    let missing = |count: usize| {
        let part = Part::new(|i| !(20..20 + count).contains(&i), |_| true);
        part.fit(&GridMethod { knots: Knots::Uniform, ..plain([30, 24]) })
    };
    let fewest = (1..40).find(|count| missing(*count).is_err()).unwrap();
    let fault = missing(fewest).unwrap_err();
    assert!(matches!(fault, FitFault::Gap { functions: 4, .. }), "{fewest} rows: {fault}");
}

#[test]
fn a_gap_between_parabolas_is_bridged_as_if_it_were_not_there() {
    let tube = |kept: &dyn Fn(usize) -> bool| {
        let rows: Vec<usize> = (0..40).filter(|i| kept(*i)).collect();
        let along: Vec<f64> = rows.iter().map(|i| *i as f64 / 39.0).collect();
        let around: Vec<f64> = (0..36).map(|j| f64::from(j) / 36.0).collect();
        let point = |u: f64, v: f64| {
            let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
            let radius = 40.0 + 30.0 * u * u;
            Point3::new(radius * cos, radius * sin, 400.0 * u)
        };
        let points = along.iter().flat_map(|u| around.iter().map(move |v| point(*u, *v))).collect();
        let part = Part { along, around, points };
        part.fit(&GridMethod { knots: Knots::Uniform, ..plain([16, 12]) }).unwrap()
    };
    let (whole, gap) = (tube(&|_| true), tube(&|i| !(17..24).contains(&i)));
    for i in 0..=50 {
        let u = f64::from(i) / 50.0;
        let apart = (whole.surface.point(u, 0.3) - gap.surface.point(u, 0.3)).norm();
        assert!(apart < 1e-6, "{u}: {apart} mm");
    }
}

#[test]
fn a_section_alone_at_the_end_is_enough_to_bridge() {
    let part = Part::new(|i| i == 0 || i >= 6, |_| true);
    let fit = part.fit(&plain([30, 24])).unwrap();
    let row = (0..72).map(|j| fit.surface.point(3.0 / 79.0, f64::from(j) / 72.0));
    let missed = row.map(|point| test_leg::outside_mm(&point).abs()).fold(0.0, f64::max);
    assert!(missed < 8.0, "{missed} mm");
}

#[test]
fn columns_are_bridged_across_the_seam() {
    let part = Part::new(|_| true, |j| (3..69).contains(&j));
    let fit = part.fit(&plain([30, 24])).unwrap();
    let seam = (0..40).map(|i| fit.surface.point(f64::from(i) / 39.0, 0.0));
    let missed = seam.map(|point| test_leg::outside_mm(&point).abs()).fold(0.0, f64::max);
    assert!(missed < 3.0, "{missed} mm");
}

#[test]
fn knots_are_widened_where_the_data_are_too_thin_for_them() {
    // As many sections as control points, which adaptive knots do not share evenly.
    let part = Part::new(|i| i % 2 == 0, |_| true);
    let fit = part.fit(&plain([40, 24])).unwrap();
    assert_eq!(fit.knots[0], KnotsUsed::Widened);
    assert!(fit.rms_mm < 0.05 && fit.max_mm < 1.0, "{} {}", fit.rms_mm, fit.max_mm);
}

#[test]
fn marks_outside_the_domain_are_refused() {
    let part = Part::new(|_| true, |_| true);
    let marked = |marks| GridMethod { marks, ..plain([30, 24]) };
    let outside = FitFault::MarkOutside { mark: 1.5, from: 0.0, to: 1.0 };
    assert_eq!(part.refused(&marked(vec![0.5, 1.5])), outside);
    let fault = part.refused(&marked(vec![f64::NAN]));
    assert!(matches!(fault, FitFault::MarkOutside { .. }), "{fault}");
}
