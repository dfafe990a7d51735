//! Gauss-Legendre quadrature.

/// Nodes and weights on [−1, 1], exact up to degree 9. Source: Abramowitz, Stegun, table 25.4.
pub const NODES: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// The nodes of each interval between ascending breakpoints, with their weights.
pub fn composite(breakpoints: &[f64]) -> Vec<(f64, f64)> {
    let nodes = |pair: &[f64]| {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        NODES.map(|(node, weight)| (middle + half * node, half * weight))
    };
    breakpoints.windows(2).flat_map(nodes).collect()
}
