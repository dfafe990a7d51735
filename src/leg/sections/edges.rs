//! The edges of triangles, each once.

/// The edges of triangles over so many points, smaller index first, in ascending order.
///
/// Each goes into the list of its smaller index, unless it is there already; these lists have three
/// entries on average.
pub fn edges(points: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = || {
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        sides.map(|[from, to]| if from < to { [from, to] } else { [to, from] })
    };
    // Where the list of each point begins, if it held all its sides.
    let mut starts = vec![0u32; points + 1];
    sides().for_each(|[from, _]| starts[from as usize + 1] += 1);
    (0..points).for_each(|point| starts[point + 1] += starts[point]);
    let mut ends = starts.clone();
    let mut others = vec![0; 3 * triangles.len()];
    for [from, to] in sides() {
        let (start, end) = (starts[from as usize] as usize, &mut ends[from as usize]);
        if !others[start..*end as usize].contains(&to) {
            others[*end as usize] = to;
            *end += 1;
        }
    }
    let mut edges = Vec::with_capacity(others.len() / 2 + 1);
    for ((from, start), end) in (0..).zip(&starts[..points]).zip(&ends) {
        let own = &mut others[*start as usize..*end as usize];
        insertion_sort(own);
        edges.extend(own.iter().map(|to| [from, *to]));
    }
    edges
}

/// Sorts a list of a few entries, for which the library's own way prepares too much.
fn insertion_sort(list: &mut [u32]) {
    for sorted in 1..list.len() {
        let mut place = sorted;
        while place > 0 && list[place - 1] > list[place] {
            list.swap(place - 1, place);
            place -= 1;
        }
    }
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
