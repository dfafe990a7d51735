//! The solid of an IGES file: entities 502 to 514 and 186 (IGES 5.3, 4.49 and 4.142 to 4.147).

use gaiter_spline::Surface;

use super::Net;
use super::notation::{Entities, Entity, Pointer, real};
use crate::ends::EndPlane;

/// An edge with the direction in which a loop runs along it.
struct Side {
    /// Position in the list of edges, from 1.
    edge: usize,
    /// Whether the loop runs in the edge's own direction.
    own_way: bool,
    /// The edge in the surface's parameters, where the edge alone is ambiguous.
    parameters: Option<[[f64; 2]; 2]>,
}

/// The positions of the edges in their list, from 1.
const BOTTOM: usize = 1;
const TOP: usize = 2;
const SEAM: usize = 3;

/// Adds the solid inside a tube and the planes at its ends.
pub fn solid(file: &mut Entities, surface: &Surface, net: &Net, planes: &[EndPlane; 2]) {
    let outward = surface.along_cross_around_is_outward();
    let edges = edges(file, net, planes);
    let tube = net.surface(file, false);
    let [[u0, u1], [v0, v1]] = net.domain();
    // Counter-clockwise in (u, v), the seam once at each end of v.
    let side = |edge, own_way, from, to| Side { edge, own_way, parameters: Some([from, to]) };
    let round = [
        side(SEAM, true, [u0, v0], [u1, v0]),
        side(TOP, true, [u1, v0], [u1, v1]),
        side(SEAM, false, [u1, v1], [u0, v1]),
        side(BOTTOM, false, [u0, v1], [u0, v0]),
    ];
    let tube = face(file, tube, edges, &round);
    // Seen from outside, each end face runs along its rim in the opposite direction to the tube.
    let caps = [(BOTTOM, outward), (TOP, !outward)];
    let [bottom, top] = std::array::from_fn(|i| {
        let plane = plane(file, &planes[i]);
        let (edge, own_way) = caps[i];
        face(file, plane, edges, &[Side { edge, own_way, parameters: None }])
    });
    // A face has its surface's own normal; the shell states whether that normal points outward.
    let faces = [(tube, outward), (bottom, true), (top, true)];
    let faces = faces.iter().flat_map(|(face, same)| [face.parameter(), logical(*same)]);
    let shell = file.add(&Entity::SHELL, std::iter::once("3".to_owned()).chain(faces).collect());
    // The shell in its own orientation, without voids.
    file.add(&Entity::SOLID, vec![shell.parameter(), logical(true), "0".to_owned()]);
}

/// The list of edges: the two rims, which run in the direction of v, and the seam.
fn edges(file: &mut Entities, net: &Net, [first, last]: &[EndPlane; 2]) -> Pointer {
    let (points, columns) = (&net.points, net.columns());
    let (low, high) = (&points[..columns], &points[points.len() - columns..]);
    let [below, above] = [first, last].map(|plane| Some(plane.outward.into_inner().into()));
    let bottom = Net::curve(file, &net.around, low.iter(), below);
    let top = Net::curve(file, &net.around, high.iter(), above);
    let seam = Net::curve(file, &net.along, points.iter().step_by(columns), None);

    let places = [low[0], high[0]].into_iter().flatten().map(real);
    let vertices = std::iter::once("2".to_owned()).chain(places).collect();
    let vertices = file.add(&Entity::VERTICES, vertices).parameter();
    let edge = |curve: Pointer, from: &str, to: &str| {
        let words = [&curve.parameter(), &vertices, from, &vertices, to];
        words.map(|word| word.to_owned())
    };
    let edges = [edge(bottom, "1", "1"), edge(top, "2", "2"), edge(seam, "1", "2")];
    let parameters = std::iter::once("3".to_owned()).chain(edges.into_iter().flatten());
    file.add(&Entity::EDGES, parameters.collect())
}

/// A face on a surface, inside one loop, counter-clockwise about the surface's normal.
fn face(file: &mut Entities, surface: Pointer, edges: Pointer, round: &[Side]) -> Pointer {
    let mut parameters = vec![round.len().to_string()];
    for Side { edge, own_way, parameters: ends } in round {
        // 0: an edge, not a vertex.
        let own_way = logical(*own_way);
        parameters.extend(["0".to_owned(), edges.parameter(), edge.to_string(), own_way]);
        let curve = ends.map(|ends| line(file, ends));
        parameters.push(usize::from(curve.is_some()).to_string());
        // The curve is isoparametric (constant u or v).
        let curve = curve.map(|curve| [logical(true), curve.parameter()]);
        parameters.extend(curve.into_iter().flatten());
    }
    let round = file.add(&Entity::LOOP, parameters);
    // One loop, and it is the outer one.
    let one = || "1".to_owned();
    file.add(&Entity::FACE, vec![surface.parameter(), one(), one(), round.parameter()])
}

/// A line between two parameter pairs.
fn line(file: &mut Entities, [from, to]: [[f64; 2]; 2]) -> Pointer {
    let reals = [from[0], from[1], 0.0, to[0], to[1], 0.0];
    file.add(&Entity::SIDE, reals.map(real).to_vec())
}

fn plane(file: &mut Entities, plane: &EndPlane) -> Pointer {
    let numbers = |xyz: &[f64]| xyz.iter().map(|value| real(*value)).collect::<Vec<_>>();
    // A point has no symbol.
    let place = [numbers(plane.place.coords.as_slice()), vec!["0".to_owned()]].concat();
    let place = file.add(&Entity::POINT, place);
    let outward = file.add(&Entity::DIRECTION, numbers(plane.outward.as_slice()));
    let across = file.add(&Entity::DIRECTION, numbers(plane.across.as_slice()));
    file.add(&Entity::PLANE, [place, outward, across].map(Pointer::parameter).to_vec())
}

fn logical(value: bool) -> String {
    u8::from(value).to_string()
}
