//! Turning points of a cyclic sequence of values: the prominent peaks and valleys, and the middle
//! of each.

/// A turning point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Index of the value.
    pub index: usize,
    /// Whether it is a peak; otherwise it is a valley.
    pub is_peak: bool,
    /// The smaller of its differences from the two neighbouring turning points.
    pub prominence: f64,
    /// The turning points before and after it.
    neighbours: [usize; 2],
}

/// The part of a peak or valley that differs from its extreme by less than a given depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Cap {
    /// Its centre of area, in steps from the turning point.
    pub middle: f64,
    /// The values that determine the middle, each with the steps by which it moves the middle per
    /// unit of its own change.
    pub pulls: Vec<(usize, f64)>,
}

/// Turning points that differ from both neighbouring ones by the gate or more, alternately peaks
/// and valleys: pairs that differ by less are removed, the closest pair first.
pub fn standing_out(values: &[f64], gate: f64) -> Vec<Turn> {
    let mut turns = turns(values);
    let difference = |a: &Turn, b: &Turn| (values[a.index] - values[b.index]).abs();
    while turns.len() >= 2 {
        let next = |place: usize| (place + 1) % turns.len();
        let gap = |place: &usize| difference(&turns[*place], &turns[next(*place)]);
        let Some(closest) = (0..turns.len()).min_by(|a, b| gap(a).total_cmp(&gap(b))) else {
            break;
        };
        if gap(&closest) >= gate {
            break;
        }
        let (first, second) = (closest.min(next(closest)), closest.max(next(closest)));
        turns.remove(second);
        turns.remove(first);
    }
    let around = turns.clone();
    let count = around.len();
    for (place, turn) in turns.iter_mut().enumerate() {
        let neighbours = [around[(place + count - 1) % count], around[(place + 1) % count]];
        let gaps = neighbours.map(|neighbour| difference(turn, &neighbour));
        turn.prominence = gaps[0].min(gaps[1]);
        turn.neighbours = neighbours.map(|neighbour| neighbour.index);
    }
    turns
}

/// Where a cyclic sequence stops rising or falling. Of a run of equal values the last one counts.
fn turns(values: &[f64]) -> Vec<Turn> {
    let count = values.len();
    let rises = |index: usize| {
        let (own, after) = (values[index], values[(index + 1) % count]);
        (own != after).then_some(after > own)
    };
    let mut rising = (0..count).rev().find_map(rises);
    let mut found = Vec::new();
    for index in 0..count {
        let Some(rises) = rises(index) else { continue };
        if rising == Some(!rises) {
            let turn = Turn { index, is_peak: !rises, prominence: 0.0, neighbours: [index; 2] };
            found.push(turn);
        }
        rising = Some(rises);
    }
    found
}

impl Turn {
    /// The part between the neighbouring turning points that differs from this value by less than
    /// `depth`, which must be greater than 0. It includes smaller turning points that were removed,
    /// so a flat valley with two equal bottoms yields the middle between them and not one of them.
    pub fn cap(&self, values: &[f64], depth: f64) -> Cap {
        let count = values.len();
        let [before, after] = self.neighbours;
        // In a lone pair each turning point is the other's neighbour on both sides.
        let [back, ahead] = [self.index + count - before, after + count - self.index]
            .map(|steps| (steps - 1) % count + 1);
        let inside = |step: usize| {
            let index = (self.index + count + step - back) % count;
            let height = depth - (values[index] - values[self.index]).abs();
            (height > 0.0).then_some((index, step as f64 - back as f64, height))
        };
        let cap: Vec<(usize, f64, f64)> = (1..back + ahead).filter_map(inside).collect();
        let area: f64 = cap.iter().map(|(.., height)| height).sum();
        let middle = cap.iter().map(|(_, step, height)| step * height).sum::<f64>() / area;
        let outward = if self.is_peak { 1.0 } else { -1.0 };
        let pull = |step: f64| outward * (step - middle) / area;
        let mut pulls: Vec<(usize, f64)> =
            cap.iter().map(|(index, step, _)| (*index, pull(*step))).collect();
        // The depth is relative to this value, so this value moves the whole rim in the opposite
        // direction.
        let all: f64 = pulls.iter().map(|(_, pull)| pull).sum();
        pulls.push((self.index, -all));
        Cap { middle, pulls }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ripples_below_the_gate_are_no_turning_points() {
        let values: Vec<f64> = (0..360)
            .map(|i| f64::from(i).to_radians())
            .map(|t| (3.0 * t).cos() + 0.05 * (40.0 * t).cos())
            .collect();
        let turns = standing_out(&values, 0.5);
        assert_eq!(turns.len(), 6);
        assert_eq!(turns.iter().filter(|turn| turn.is_peak).count(), 3);
        assert!(turns.iter().all(|turn| turn.prominence > 1.9));
        assert_eq!(standing_out(&values, 3.0).len(), 0);
    }

    #[test]
    fn a_flat_stretch_on_the_way_up_is_no_turning_point_and_one_on_top_is_one() {
        let values = [0.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0, 1.0, 0.0, 0.0];
        let found: Vec<_> = turns(&values).iter().map(|t| (t.index, t.is_peak)).collect();
        assert_eq!(found, [(0, false), (6, true)]);
        assert_eq!(turns(&[1.0; 5]), []);
        assert_eq!(turns(&[]), []);
    }

    #[test]
    fn the_middle_is_that_of_the_whole_cap_across_the_seam_too() {
        // The peak is flat on top from 9 to 2; its two flanks fall equally.
        let values = [5.0, 5.0, 5.0, 4.0, 2.0, 0.0, 0.5, 2.0, 4.0, 5.0];
        let peak = standing_out(&values, 1.0)[0];
        assert_eq!((peak.index, peak.is_peak, peak.prominence), (2, true, 5.0));
        assert!((peak.cap(&values, 2.0).middle + 1.5).abs() < 1e-12);
    }

    #[test]
    fn of_two_alike_bottoms_neither_is_the_middle() {
        let values = [9.0, 4.0, 1.0, 1.5, 2.0, 1.5, 1.0, 4.0];
        let turns = standing_out(&values, 3.0);
        assert_eq!(turns.len(), 2);
        let valley = turns.iter().find(|turn| !turn.is_peak).unwrap();
        assert!((valley.index as f64 + valley.cap(&values, 3.0).middle - 4.0).abs() < 1e-12);
    }

    #[test]
    fn pulls_tell_how_a_change_of_the_values_moves_the_middle() {
        let values = [7.0, 3.0, 1.2, 1.0, 1.9, 2.5, 6.0, 6.3];
        let middle = |values: &[f64]| standing_out(values, 3.0)[1].cap(values, 3.0);
        let cap = middle(&values);
        for index in 0..values.len() {
            let mut changed = values;
            changed[index] += 1e-6;
            let pulls = cap.pulls.iter().filter(|(of, _)| *of == index);
            let expected: f64 = pulls.map(|(_, pull)| pull).sum();
            let found = (middle(&changed).middle - cap.middle) / 1e-6;
            assert!((found - expected).abs() < 1e-5, "{index}: {found} for {expected}");
        }
    }
}
