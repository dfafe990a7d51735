//! Connected shells of the mesh: the body in one or more large ones, and small fragments that are
//! specks in the air or pieces of the floor.

/// A shell with fewer than this share of all points is a fragment. Body parts that scanners export
/// as shells of their own hold 4 % and more; floor pieces and specks 0.3 % and less.
const FRAGMENT_MAX_SHARE: f64 = 0.005;

/// The triangles of all shells that are no fragments, in their given order.
pub fn without_fragments(point_count: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut shells = DisjointSets::new(point_count);
    for &[a, b, c] in triangles {
        shells.join(a, b);
        shells.join(b, c);
    }
    let mut sizes = vec![0usize; point_count];
    let roots: Vec<u32> = (0..point_count as u32).map(|point| shells.root(point)).collect();
    roots.iter().for_each(|&root| sizes[root as usize] += 1);
    let least = FRAGMENT_MAX_SHARE * point_count as f64;
    let large = |t: &&[u32; 3]| sizes[roots[t[0] as usize] as usize] as f64 > least;
    triangles.iter().filter(large).copied().collect()
}

/// Disjoint sets of indices with path halving and union by size (Tarjan 1975).
pub struct DisjointSets {
    parents: Vec<u32>,
    sizes: Vec<u32>,
}

impl DisjointSets {
    /// `count` sets of one member each.
    pub fn new(count: usize) -> DisjointSets {
        DisjointSets { parents: (0..count as u32).collect(), sizes: vec![1; count] }
    }

    /// The member that stands for the set of `member`.
    pub fn root(&mut self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            let grandparent = self.parents[self.parents[member as usize] as usize];
            self.parents[member as usize] = grandparent;
            member = grandparent;
        }
        member
    }

    /// Makes one set of the two sets of `a` and `b`.
    pub fn join(&mut self, a: u32, b: u32) {
        let (mut large, mut small) = (self.root(a), self.root(b));
        if large == small {
            return;
        }
        if self.sizes[large as usize] < self.sizes[small as usize] {
            std::mem::swap(&mut large, &mut small);
        }
        self.parents[small as usize] = large;
        self.sizes[large as usize] += self.sizes[small as usize];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speck_goes_and_two_large_shells_stay() {
        let strip = |first: u32, count: u32| (first..first + count).map(|i| [i, i + 1, i + 2]);
        let mut triangles: Vec<_> = strip(0, 500).chain(strip(502, 500)).collect();
        let both = triangles.clone();
        triangles.push([1004, 1005, 1006]);
        assert_eq!(without_fragments(1007, &triangles), both);
    }
}
