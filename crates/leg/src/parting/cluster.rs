//! Single-linkage clusters of points in a slice, which separate legs, hands and specks.

use nalgebra::Point2;

use crate::frame::union_find::DisjointSets;

/// A cell of the plane, half a link wide, by x and y.
type Cell = [i32; 2];

/// Groups points so that each is at most `link` from another of its group; groups in the order of
/// their first point, members in the given order.
///
/// Two points of one cell are always close enough, so a crowded cell costs only linear time.
pub fn clusters(points: &[Point2<f64>], link: f64) -> Vec<Vec<Point2<f64>>> {
    let cell = |p: &Point2<f64>| [p.x, p.y].map(|value| (value / (link / 2.0)).floor() as i32);
    let mut by_cell: Vec<(Cell, u32)> =
        points.iter().zip(0..).map(|(point, index)| (cell(point), index)).collect();
    by_cell.sort_unstable();
    let mut sets = DisjointSets::new(points.len());
    let near =
        |a: u32, b: u32| (points[a as usize] - points[b as usize]).norm_squared() <= link * link;
    for own in by_cell.chunk_by(|a, b| a.0 == b.0) {
        let (place, first) = own[0];
        own[1..].iter().for_each(|&(_, other)| sets.join(first, other));
        for others in neighbours(&by_cell, place) {
            // Cells that are already connected need not be compared point by point.
            if sets.root(first) != sets.root(others[0].1)
                && own.iter().any(|&(_, a)| others.iter().any(|&(_, b)| near(a, b)))
            {
                sets.join(first, others[0].1);
            }
        }
    }
    grouped(points, &mut sets)
}

/// The points of each non-empty cell that comes after this one in order and lies within a link.
fn neighbours(by_cell: &[(Cell, u32)], [x, y]: Cell) -> impl Iterator<Item = &[(Cell, u32)]> {
    const REACH: i32 = 2;
    // The cells of one x are adjacent in the sorted list.
    (0..=REACH).flat_map(move |dx| {
        let x = x.saturating_add(dx);
        let lowest = if dx == 0 { y.saturating_add(1) } else { y.saturating_sub(REACH) };
        let highest = y.saturating_add(REACH);
        let [lowest, highest] = [lowest, highest].map(|y| [x, y]);
        let from = by_cell.partition_point(|entry| entry.0 < lowest);
        let near = by_cell[from..].iter().take_while(|entry| entry.0 <= highest).count();
        by_cell[from..from + near].chunk_by(|a, b| a.0 == b.0)
    })
}

fn grouped(points: &[Point2<f64>], sets: &mut DisjointSets) -> Vec<Vec<Point2<f64>>> {
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

    #[test]
    fn groups_are_those_of_comparing_every_pair() {
        let mut seed = 7u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / f64::from(1u32 << 31) * 100.0 - 50.0
        };
        let points: Vec<_> = (0..400).map(|_| Point2::new(next(), next())).collect();
        for link in [1.0, 3.0, 4.5, 8.0] {
            let mut sets = DisjointSets::new(points.len());
            for (a, p) in points.iter().enumerate() {
                for (b, q) in points.iter().enumerate() {
                    if (p - q).norm() <= link {
                        sets.join(a as u32, b as u32);
                    }
                }
            }
            assert_eq!(clusters(&points, link), grouped(&points, &mut sets), "link {link}");
        }
    }
}
