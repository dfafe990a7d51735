//! Single-linkage clusters of points in a slice: legs, hands and specks apart.

use nalgebra::Point2;

use super::shell::DisjointSets;

/// Groups points so that each is at most `link` from another of its group; groups in the order of
/// their first point, members in the given order.
pub fn clusters(points: &[Point2<f64>], link: f64) -> Vec<Vec<Point2<f64>>> {
    let mut by_x: Vec<u32> = (0..points.len() as u32).collect();
    by_x.sort_by(|&a, &b| points[a as usize].x.total_cmp(&points[b as usize].x));
    let mut sets = DisjointSets::new(points.len());
    for (rank, &a) in by_x.iter().enumerate() {
        let p = points[a as usize];
        let near = by_x[rank + 1..].iter().take_while(|&&b| points[b as usize].x - p.x <= link);
        for &b in near {
            if (points[b as usize] - p).norm_squared() <= link * link {
                sets.join(a, b);
            }
        }
    }
    let mut group_of_root = vec![usize::MAX; points.len()];
    let mut groups: Vec<Vec<Point2<f64>>> = Vec::new();
    for (index, &point) in points.iter().enumerate() {
        let root = sets.root(index as u32) as usize;
        if group_of_root[root] == usize::MAX {
            group_of_root[root] = groups.len();
            groups.push(Vec::new());
        }
        groups[group_of_root[root]].push(point);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_near_points_is_one_group_and_a_gap_parts_two() {
        let points: Vec<_> = [0.0, 3.0, 1.5, 9.0, 10.0].map(|x| Point2::new(x, 0.0)).to_vec();
        let groups = clusters(&points, 2.0);
        assert_eq!(groups, [points[..3].to_vec(), points[3..].to_vec()]);
        assert_eq!(clusters(&points, 6.0).len(), 1);
    }
}
