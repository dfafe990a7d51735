//! STEP files read by truck, a CAD kernel of its own: the faces, the points and the knots in them
//! are ours.
#![allow(clippy::unwrap_used, clippy::panic)]

use gaiter::cad::{Schema, Shape, step};
use gaiter::leg::{Method, Side, extract};
use gaiter::scan::Format;
use gaiter::spline::Surface;
use support::geometry::bodies;
use support::geometry::tubes::{HEADER, tube};
use truck_stepio::r#in::Table;
use truck_stepio::r#in::alias;

/// What the reader makes of a file: senses and surfaces of its one shell's faces.
fn faces(surface: &Surface, shape: Shape, schema: Schema) -> Vec<(bool, alias::Surface)> {
    let file = step::write(surface, shape, schema, &HEADER).unwrap();
    let exchange = ruststep::parser::parse(std::str::from_utf8(&file).unwrap()).unwrap();
    let table = Table::from_data_section(&exchange.data[0]);
    assert_eq!(table.shell.len(), 1);
    let shell = table.to_compressed_shell(table.shell.values().next().unwrap()).unwrap();
    assert_eq!((shell.vertices.len(), shell.edges.len()), (2, 3));
    let mut uses = [0; 3];
    shell.faces.iter().flat_map(|face| &face.boundaries).flatten().for_each(|e| uses[e.index] += 1);
    // The seam borders the tube on both sides; a rim is free without its cap.
    uses.sort_unstable();
    assert_eq!(uses, if shape == Shape::Solid { [2, 2, 2] } else { [1, 1, 2] });
    shell.faces.into_iter().map(|face| (face.orientation, face.surface)).collect()
}

/// `outward`: whether u × v points out of the tube. Where it does not, the reader swaps u and v.
#[track_caller]
fn check(surface: &Surface, outward: bool) {
    let (around, expected) = surface.clamped_around();
    let (along, columns) = (surface.along().knots(), around.len() - 4);
    for schema in [Schema::Ap214, Schema::Ap242] {
        for (shape, count) in [(Shape::Tube, 1), (Shape::Solid, 3)] {
            let faces = faces(surface, shape, schema);
            assert_eq!(faces.len(), count);
            assert!(faces.iter().all(|(sense, _)| *sense));
            let alias::Surface::BSplineSurface(found) = &faces[0].1 else {
                panic!("{:?}", faces[0].1)
            };
            let (u, v) = found.knot_vecs();
            let (u, v) = if outward { (u, v) } else { (v, u) };
            assert_eq!((u.as_slice(), v.as_slice()), (along, around.as_slice()));
            let points = found.control_points();
            for (place, expected) in expected.iter().enumerate() {
                let (row, column) = (place / columns, place % columns);
                let found = if outward { points[row][column] } else { points[column][row] };
                assert_eq!([found.x, found.y, found.z], <[f64; 3]>::from(expected.coords));
            }
            assert_eq!(points.iter().flatten().count(), expected.len());
            let planes = faces[1..].iter();
            let planes =
                planes.filter(|(_, on)| matches!(on, alias::Surface::ElementarySurface(_)));
            assert_eq!(planes.count(), count - 1);
        }
    }
}

#[test]
fn tube_and_solid_of_both_hands_are_read_as_they_were_written() {
    check(&tube(1.0).0, false);
    check(&tube(-1.0).0, true);
}

#[test]
fn the_legs_of_a_body_are_read_as_they_were_written() {
    let extraction =
        extract(&bodies::export("m_average_clean"), Format::Obj, &Method::default()).unwrap();
    assert_eq!(extraction.legs.len(), 2);
    for leg in &extraction.legs {
        // The angle grows towards the lateral side, so around a right leg v runs the other way.
        check(&leg.surface.as_ref().unwrap().surface, leg.side == Side::Right);
    }
}
