//! The way of `examples/fit_sections.rs` on its shipped table.
#![allow(clippy::unwrap_used)]

#[path = "../examples/support/section_table.rs"]
mod section_table;
mod support;

use gaiter::cad::step::{StepHeader, tube};
use gaiter::spline::{GridDomain, GridMethod, GridSmoothing, Knots, fit_grid_by};
use section_table::SectionTable;
use support::metric::true_error;
use support::test_leg;

const TABLE: &str = include_str!("../fixtures/sections/test_leg.csv");

#[test]
fn the_shipped_sections_are_the_test_leg() {
    let grid = SectionTable::parse(TABLE).unwrap().grid().unwrap();
    let points = test_leg::grid();
    let listed: Vec<_> = grid.sections().flatten().collect();
    assert_eq!(listed.len(), points.len());
    // Three decimals were written.
    assert!(points.iter().zip(listed).all(|(a, b)| (a - b).abs().max() <= 0.5001e-3));
}

#[test]
fn the_shipped_sections_become_a_surface_and_a_file() {
    let grid = SectionTable::parse(TABLE).unwrap().grid().unwrap();
    let method = GridMethod {
        control_points: [30, 24],
        knots: Knots::Polished,
        smoothing: GridSmoothing::None,
        robust: false,
        marks: [vec![], vec![]],
    };
    let domain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };
    let fit = fit_grid_by(&grid.data(), &domain, &method).unwrap();
    let [_, _, largest, percent] = true_error(&fit.surface);
    assert!(percent < 0.012 && largest < 0.2, "{percent} % {largest} mm");
    let file = tube(&fit.surface, &StepHeader::default());
    let points = String::from_utf8(file).unwrap().matches("=CARTESIAN_POINT(").count();
    assert_eq!(points, 30 * 27);
}

#[test]
fn a_line_that_is_no_point_is_named() {
    let table = |line: &str| format!("section,x,y,z\n0,1,2,3\n{line}\n");
    assert_eq!(SectionTable::parse(&table("0,1,two,3")).err(), Some(3));
    assert_eq!(SectionTable::parse(&table("0,1,2")).err(), Some(3));
}
