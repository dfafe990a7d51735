//! The edges of triangles, each once.

/// A point of a regular mesh has three neighbours of larger index on average; this many have a place in its
/// row.
const PLACES: usize = 8;

/// Marks a place without a neighbour.
const NONE: u32 = u32::MAX;

/// The edges of triangles over this many points, smaller index first, in ascending order.
///
/// Each goes into the row of its smaller index, unless it is there already, so that only rows are sorted.
pub fn edges(points: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut rows = vec![[NONE; PLACES]; points];
    let mut others = Vec::new();
    for &[a, b, c] in triangles {
        put(&mut rows, &mut others, a, b);
        put(&mut rows, &mut others, b, c);
        put(&mut rows, &mut others, c, a);
    }
    others.sort_unstable();
    others.dedup();
    let mut others = others.as_slice();
    let mut edges = Vec::with_capacity(3 * triangles.len() / 2 + 1);
    for (from, row) in (0..).zip(&mut rows) {
        let count = row.iter().position(|other| *other == NONE).unwrap_or(PLACES);
        let start = edges.len();
        row[..count].iter().for_each(|to| edges.push([from, *to]));
        while let [next, rest @ ..] = others
            && next[0] == from
        {
            edges.push(*next);
            others = rest;
        }
        edges[start..].sort_unstable_by_key(|[_, to]| *to);
    }
    edges
}

/// Puts an edge into the row of its smaller index; or to the others, if that is full.
fn put(rows: &mut [[u32; PLACES]], others: &mut Vec<[u32; 2]>, a: u32, b: u32) {
    let (from, to) = if a < b { (a, b) } else { (b, a) };
    for place in &mut rows[from as usize] {
        if *place == to {
            return;
        }
        if *place == NONE {
            *place = to;
            return;
        }
    }
    others.push([from, to]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_edge_comes_once_and_in_order_however_triangles_are_wound() {
        let triangles = [[3, 1, 0], [1, 2, 3], [4, 3, 2], [2, 3, 1]];
        let expected = [[0, 1], [0, 3], [1, 2], [1, 3], [2, 3], [2, 4], [3, 4]];
        assert_eq!(edges(6, &triangles), expected);
        assert!(edges(3, &[]).is_empty());
    }

    #[test]
    fn a_point_may_have_any_number_of_neighbours() {
        let fan: Vec<[u32; 3]> = (1..40).map(|i| [0, i, i % 39 + 1]).collect();
        let found = edges(40, &fan);
        let spokes = found.iter().filter(|edge| edge[0] == 0);
        assert_eq!((spokes.count(), found.len()), (39, 78));
        assert!(found.is_sorted_by(|a, b| a < b));
    }
}
