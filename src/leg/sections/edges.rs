//! The edges of triangles, each once.

/// The edges of triangles over so many points, smaller index first, in ascending order.
///
/// They are put into one list per smaller index by counting, and only these short lists are sorted.
pub fn edges(points: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = || {
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        sides.map(|[from, to]| [from.min(to), from.max(to)])
    };
    // Where the list of each point ends while it is filled, and so where it begins at first.
    let mut ends = vec![0u32; points + 1];
    sides().for_each(|[from, _]| ends[from as usize + 1] += 1);
    (0..points).for_each(|point| ends[point + 1] += ends[point]);
    let mut others = vec![0; 3 * triangles.len()];
    for [from, to] in sides() {
        let end = &mut ends[from as usize];
        others[*end as usize] = to;
        *end += 1;
    }
    let mut edges = Vec::with_capacity(others.len() / 2 + 1);
    let mut start = 0;
    for (from, end) in (0..).zip(&ends[..points]) {
        let own = &mut others[start..*end as usize];
        own.sort_unstable();
        let own = own.chunk_by(|a, b| a == b);
        edges.extend(own.map(|same| [from, same[0]]));
        start = *end as usize;
    }
    edges
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
}
