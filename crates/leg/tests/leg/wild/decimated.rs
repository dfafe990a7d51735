//! Meshes that were decimated: by their quadrics, or by means of cells.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix4, Vector3, Vector4};

use super::*;

/// How many are drawn.
const DRAWS: u64 = 12;

/// The share of edges, cheapest first, that a round may collapse.
const PER_ROUND: usize = 4;

/// An edge, where its two points are put together, and what that costs.
struct Collapse {
    ends: [usize; 2],
    to: Vector3<f64>,
    cost: f64,
}

/// A mesh with at most so many triangles (Garland and Heckbert, 1997, many edges at a time).
fn decimated(mesh: &Mesh, triangles: usize) -> Mesh {
    let mut points: Vec<Vector3<f64>> = mesh.points.iter().map(|p| Vector3::from(*p)).collect();
    let mut mesh = mesh.clone();
    let mut quadrics = vec![Matrix4::zeros(); points.len()];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| points[corner]);
        let normal = (b - a).cross(&(c - a));
        let (unit, area) = (normal.try_normalize(1e-12).unwrap_or_default(), normal.norm() / 2.0);
        let plane = Vector4::new(unit.x, unit.y, unit.z, -unit.dot(&a));
        corners.iter().for_each(|corner| quadrics[*corner] += plane * plane.transpose() * area);
    }
    while mesh.triangles.len() > triangles {
        let before = mesh.triangles.len();
        collapse(&mut mesh.triangles, &mut points, &mut quadrics, triangles);
        assert!(mesh.triangles.len() < before, "no edge can be collapsed any more");
    }
    mesh.points = points.into_iter().map(Into::into).collect();
    mesh.kept(|_| true)
}

/// One round: edges that do not touch each other, cheapest first.
fn collapse(
    triangles: &mut Vec<[usize; 3]>,
    points: &mut [Vector3<f64>],
    quadrics: &mut [Matrix4<f64>],
    wanted: usize,
) {
    let mut neighbours = vec![BTreeSet::new(); points.len()];
    let mut facets = vec![0; points.len()];
    for corners in triangles.iter() {
        let [a, b, c] = *corners;
        for [from, to] in [[a, b], [b, c], [c, a]] {
            neighbours[from].insert(to);
            neighbours[to].insert(from);
            facets[from] += 1;
        }
    }
    let edges = neighbours.iter().enumerate();
    let edges = edges.flat_map(|(a, others)| others.range(a + 1..).map(move |b| [a, *b]));
    let mut collapses: Vec<Collapse> = edges
        .map(|ends| {
            let [a, b] = ends;
            let quadric = quadrics[a] + quadrics[b];
            let (middle, bend) =
                ((points[a] + points[b]) / 2.0, quadric.fixed_view::<3, 3>(0, 0).into_owned());
            // Along an edge or on a plane the place is not determined: it then is the middle.
            let ridge = nalgebra::Matrix3::identity() * (1e-3 * bend.trace() + 1e-12);
            let pull = -(quadric.fixed_view::<3, 1>(0, 3) + bend * middle);
            let to = middle + (bend + ridge).try_inverse().unwrap() * pull;
            let place = to.push(1.0);
            Collapse { ends, to, cost: place.dot(&(quadric * place)) }
        })
        .collect();
    collapses.sort_by(|p, q| p.cost.total_cmp(&q.cost));
    let mut becomes: Vec<usize> = (0..points.len()).collect();
    let mut touched = vec![false; points.len()];
    let mut left = triangles.len();
    for Collapse { ends: [a, b], to, .. } in &collapses[..collapses.len().div_ceil(PER_ROUND)] {
        let (a, b) = (*a, *b);
        let is_inner = |point: usize| facets[point] == neighbours[point].len();
        let far =
            (to - (points[a] + points[b]) / 2.0).norm() > 2.0 * (points[a] - points[b]).norm();
        if touched[a] || touched[b] || far || !is_inner(a) || !is_inner(b) {
            continue;
        }
        // Otherwise facets would fold onto each other.
        if neighbours[a].intersection(&neighbours[b]).count() != 2 {
            continue;
        }
        (points[a], becomes[b]) = (*to, a);
        quadrics[a] += quadrics[b];
        neighbours[a].union(&neighbours[b]).for_each(|point| touched[*point] = true);
        left -= 2;
        if left <= wanted {
            break;
        }
    }
    triangles.iter_mut().flatten().for_each(|corner| *corner = becomes[*corner]);
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
}

/// A mesh all of whose points in a cell are replaced by their mean.
fn clustered(mesh: &Mesh, cell_mm: f64) -> Mesh {
    let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    for (index, point) in mesh.points.iter().enumerate() {
        cells.entry(point.map(|place| (place / cell_mm).floor() as i64)).or_default().push(index);
    }
    let mut becomes = vec![0; mesh.points.len()];
    let mut clustered = Mesh::default();
    for members in cells.values() {
        let sum = |axis: usize| members.iter().map(|of| mesh.points[*of][axis]).sum::<f64>();
        members.iter().for_each(|of| becomes[*of] = clustered.points.len());
        clustered.points.push([0, 1, 2].map(|axis| sum(axis) / members.len() as f64));
    }
    let triangles = mesh.triangles.iter().map(|corners| corners.map(|corner| becomes[corner]));
    clustered.triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    clustered
}

#[test]
fn girths_of_a_decimated_mesh_are_no_surer_than_they_are() {
    let (mut inside, mut girths) = (0, 0);
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let sample = &SAMPLES[chance.below(2)];
        let scanned = noisy(&sample.mesh, 0.6 * chance.unit(), &mut chance);
        let mesh = match chance.below(2) {
            0 => decimated(&scanned, 12_000 + chance.below(20_000)),
            _ => clustered(&scanned, 10.0 + 8.0 * chance.unit()),
        };
        let found = measured(&mesh);
        assert_eq!(quietly_wrong(&found, &sample.truth), [], "{seed}");
        for [own, truth] in pairs(&found, &sample.truth, &[Level::B, Level::C, Level::D]) {
            let off_mm = own.girth_tape_mm - truth.girth_tape_mm;
            girths += 1;
            inside += usize::from(off_mm.abs() < 2.0 * own.girth_of_level_sd_mm);
        }
    }
    assert!(inside * 10 >= girths * 9, "{inside} of {girths} within what is stated");
}
