//! A clean body made worse: fewer points, and noise.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use gaiter_scan::Scan;
use nalgebra::Vector3;

use support::chance::Chance;

/// Halvings of the range in which the least distance of kept points is sought.
const HALVINGS: usize = 14;

/// The body with one in `one_in` of its points, as evenly spread as such points can be: in random
/// order each point is kept unless a kept one lies within a distance, which is chosen to leave as
/// many as wanted. So all that are kept are points of the scan, none of them moved.
///
/// The others belong to the kept point that is nearest along the edges; a triangle whose corners
/// belong to three kept points becomes a triangle of these (the dual of a Voronoi diagram).
pub fn thinned(scan: &Scan, one_in: usize, seed: u64) -> Scan {
    if one_in <= 1 {
        return scan.clone();
    }
    let around = neighbours(scan);
    let mut chance = Chance(seed);
    let mut order: Vec<u32> = (0..scan.points.len() as u32).collect();
    for last in (1..order.len()).rev() {
        order.swap(last, chance.below(last + 1));
    }
    let wanted = scan.points.len() / one_in;
    let (mut low, mut high) = (0.0, 4.0 * mean_edge(scan) * (one_in as f64).sqrt());
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        let is_too_dense = apart(scan, &around, &order, middle).len() > wanted;
        *(if is_too_dense { &mut low } else { &mut high }) = middle;
    }
    dual(scan, &around, &apart(scan, &around, &order, high))
}

/// Mean length of the triangles' edges, in the export's unit.
pub fn mean_edge(scan: &Scan) -> f64 {
    let edges = scan.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let sum: f64 = edges.map(|(a, b)| length(scan, a, b)).sum();
    sum / (3 * scan.triangles.len()) as f64
}

/// The points with normal noise of this standard deviation, in the export's unit, along the
/// normals of the mesh.
pub fn noisy(scan: &Scan, sigma: f64, seed: u64) -> Scan {
    let mut chance = Chance(seed);
    let along = scan.points.iter().zip(normals(scan));
    let moved = along.map(|(point, normal)| point + normal * (sigma * chance.normal()));
    Scan { points: moved.collect(), triangles: scan.triangles.clone() }
}

/// Unit normals of the points: area-weighted means over their triangles.
fn normals(scan: &Scan) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); scan.points.len()];
    for triangle in &scan.triangles {
        let [a, b, c] = triangle.map(|corner| scan.points[corner as usize]);
        let normal = (b - a).cross(&(c - a));
        triangle.iter().for_each(|&corner| normals[corner as usize] += normal);
    }
    normals.iter().map(|normal| normal.try_normalize(0.0).unwrap_or_default()).collect()
}

fn length(scan: &Scan, a: u32, b: u32) -> f64 {
    (scan.points[a as usize] - scan.points[b as usize]).norm()
}

/// The points at the other ends of each point's edges.
fn neighbours(scan: &Scan) -> Vec<Vec<u32>> {
    let mut around = vec![Vec::new(); scan.points.len()];
    for &[a, b, c] in &scan.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            around[from as usize].push(to);
            around[to as usize].push(from);
        }
    }
    for ends in &mut around {
        ends.sort_unstable();
        ends.dedup();
    }
    around
}

/// The points that come first in an order and lie further than `least` from each other, as far as
/// edges lead from one to the other within that distance.
fn apart(scan: &Scan, around: &[Vec<u32>], order: &[u32], least: f64) -> Vec<u32> {
    let mut is_taken = vec![false; scan.points.len()];
    let mut kept = Vec::new();
    for &point in order {
        if is_taken[point as usize] {
            continue;
        }
        kept.push(point);
        is_taken[point as usize] = true;
        let (mut seen, mut reached) = (BTreeSet::from([point]), vec![point]);
        while let Some(from) = reached.pop() {
            for &to in &around[from as usize] {
                if length(scan, point, to) <= least && seen.insert(to) {
                    is_taken[to as usize] = true;
                    reached.push(to);
                }
            }
        }
    }
    kept
}

/// The kept points with the triangles between their cells.
fn dual(scan: &Scan, around: &[Vec<u32>], kept: &[u32]) -> Scan {
    let owner = owners(scan, around, kept);
    let (mut known, mut triangles) = (BTreeSet::new(), Vec::new());
    for triangle in &scan.triangles {
        let [a, b, c] = triangle.map(|corner| owner[corner as usize]);
        let mut corners = [a, b, c];
        corners.sort_unstable();
        if a != b && b != c && c != a && known.insert(corners) {
            triangles.push([a, b, c]);
        }
    }
    Scan { points: kept.iter().map(|&point| scan.points[point as usize]).collect(), triangles }
}

/// The place in `kept` of the point that is nearest to each point along the edges (Dijkstra).
fn owners(scan: &Scan, around: &[Vec<u32>], kept: &[u32]) -> Vec<u32> {
    let mut owner = vec![u32::MAX; scan.points.len()];
    let starts = kept.iter().zip(0..).map(|(&point, place)| Reverse((0, point, place)));
    let mut next: BinaryHeap<Reverse<(u64, u32, u32)>> = starts.collect();
    // Positive numbers have the order of their bits.
    while let Some(Reverse((far, point, place))) = next.pop() {
        if owner[point as usize] != u32::MAX {
            continue;
        }
        owner[point as usize] = place;
        for &to in around[point as usize].iter().filter(|&&to| owner[to as usize] == u32::MAX) {
            let far = f64::from_bits(far) + length(scan, point, to);
            next.push(Reverse((far.to_bits(), to, place)));
        }
    }
    owner
}
