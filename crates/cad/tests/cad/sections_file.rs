//! The way of `crates/cad/examples/fit_sections.rs` on its shipped table.
#![allow(clippy::unwrap_used)]

#[path = "../../examples/support/section_table.rs"]
mod section_table;

use gaiter_cad::step::{self, Schema};
use gaiter_cad::{FileHeader, Shape};
use gaiter_spline::{GridDomain, GridMethod, Knots, fit_grid_by};
use section_table::{SectionTable, TableFault};
use support::metric::true_error;
use support::test_leg;

const TABLE: &str = include_str!("../../../../fixtures/sections/test_leg.csv");

#[test]
fn the_shipped_sections_are_the_test_leg() {
    let grid = SectionTable::parse(TABLE).unwrap().grid();
    let points = test_leg::grid();
    let listed: Vec<_> = grid.sections().flatten().collect();
    assert_eq!(listed.len(), points.len());
    // Three decimals were written.
    assert!(points.iter().zip(listed).all(|(a, b)| (a - b).abs().max() <= 0.5001e-3));
}

#[test]
fn the_shipped_sections_become_a_surface_and_a_file() {
    let grid = SectionTable::parse(TABLE).unwrap().grid();
    let knots = Knots::Adaptive;
    let method = GridMethod { control_points: [30, 24], knots, marks: Vec::new() };
    let domain = GridDomain { along: [0.0, 1.0], around_from: 0.0, period: 1.0 };
    let fit = fit_grid_by(&grid.data(), &domain, &method).unwrap();
    let [_, _, largest, percent] = true_error(&fit.surface);
    assert!(percent < 0.024 && largest < 0.4, "{percent} % {largest} mm");
    let file =
        step::write(&fit.surface, Shape::Tube, Schema::Ap214, &FileHeader::default()).unwrap();
    let points = String::from_utf8(file).unwrap().matches("=CARTESIAN_POINT(").count();
    assert_eq!(points, 30 * 27);
}

#[test]
fn a_table_that_holds_no_sections_is_refused_with_the_place() {
    let fault = |text: &str| SectionTable::parse(text).err().unwrap();
    let table = |line: &str| format!("section,x,y,z\n0,1,2,3\n{line}\n");
    for line in ["0,1,two,3", "0,1,2", "0,1,2,NaN", "0,1,2,inf", "0,1,2,3,4"] {
        assert_eq!(fault(&table(line)), TableFault::NoPoint { line: 3, text: line.to_owned() });
    }
    for text in ["", "0,1,2,3\n", "x,y,z\n1,2,3\n"] {
        assert_eq!(fault(text), TableFault::NoHeading);
    }
    let uneven = table("1,1,2,3\n1,2,3,4\n2,5,6,7");
    assert_eq!(fault(&uneven), TableFault::Uneven { section: 1.0, found: 2, needed: 1 });
    assert_eq!(fault("section,x,y,z\n"), TableFault::TooFewSections { found: 0 });
    let three: String = TABLE.lines().take(1 + 3 * 72).map(|line| format!("{line}\n")).collect();
    assert_eq!(fault(&three), TableFault::TooFewSections { found: 3 });
}

#[test]
fn a_table_as_a_spreadsheet_writes_it_is_the_same_table() {
    let written = format!("\u{feff}{}\r\n", TABLE.replace('\n', "\r\n").replace(',', ", "));
    let written = written.replacen("section, x, y, z", "section,x,y,z", 1);
    let (one, other) =
        (SectionTable::parse(TABLE).unwrap(), SectionTable::parse(&written).unwrap());
    assert!(one.grid().sections().eq(other.grid().sections()));
}
