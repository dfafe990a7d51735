//! Turning points of a cyclic sequence of values: the prominent peaks and valleys, the place of each
//! between the values, and the middle of all that is like it.

/// A turning point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// Index of the value.
    pub index: usize,
    /// Whether it is a peak; otherwise it is a valley.
    pub is_peak: bool,
    /// The smaller of its differences from the two neighbouring turning points.
    pub prominence: f64,
    /// The turning points before and after it.
    neighbours: [usize; 2],
}

/// Where a peak or valley has its extreme.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtremePosition {
    /// Steps from the turning point.
    pub offset: f64,
    /// The values that determine the place, each with the steps by which it moves the place per unit
    /// of its own change.
    pub pulls: Vec<(usize, f64)>,
}

/// Turning points that differ from both neighbouring ones by the gate or more, alternately peaks
/// and valleys: pairs that differ by less are removed, the closest pair first.
pub fn standing_out(values: &[f64], gate: f64) -> Vec<TurningPoint> {
    let mut turns = turns(values);
    let difference = |a: &TurningPoint, b: &TurningPoint| (values[a.index] - values[b.index]).abs();
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
fn turns(values: &[f64]) -> Vec<TurningPoint> {
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
            let turn =
                TurningPoint { index, is_peak: !rises, prominence: 0.0, neighbours: [index; 2] };
            found.push(turn);
        }
        rising = Some(rises);
    }
    found
}

impl TurningPoint {
    /// Where the extreme is: the centre of area of the stretch around it that differs from it by
    /// less than `depth`, without a gap. A stretch narrower than the steps has its place at the
    /// vertex of the parabola through the turning point and its neighbours.
    ///
    /// `depth` is what two values may differ by and count as equal; it must be greater than 0 and
    /// less than the prominence. A bump of more than that is not crossed, so the place is not on a
    /// small turning point of the opposite kind.
    pub fn place(&self, values: &[f64], depth: f64) -> ExtremePosition {
        let vertex = Vertex::new(self.index, values);
        let height =
            |step: isize| depth - (values[at(self.index, step, values)] - vertex.value).abs();
        let [back, ahead] = self.reach(values.len()).map(|steps| steps as isize);
        let is_alike = |step: &isize| height(*step) > 0.0;
        let before = (1..back).map(|step| -step).take_while(is_alike);
        let steps: Vec<isize> = before.chain([0]).chain((1..ahead).take_while(is_alike)).collect();
        if steps.len() < 3 {
            return vertex.place(self.index, values);
        }
        let area: f64 = steps.iter().map(|step| height(*step)).sum();
        let offset = steps.iter().map(|step| *step as f64 * height(*step)).sum::<f64>() / area;
        let outward = if self.is_peak { 1.0 } else { -1.0 };
        let pull = |step: isize| outward * (step as f64 - offset) / area;
        // The depth is relative to the vertex, so the vertex moves the whole rim in the opposite
        // direction.
        let all: f64 = steps.iter().map(|step| pull(*step)).sum();
        let rim = vertex.shares().map(|(step, share)| (step, -all * share));
        let pulls = steps.iter().map(|step| (*step, pull(*step))).chain(rim);
        let pulls = pulls.map(|(step, pull)| (at(self.index, step, values), pull)).collect();
        ExtremePosition { offset, pulls }
    }

    /// The middle of all that is like this value: the centre of area, in steps from it, of the part
    /// between the neighbouring turning points that differs from it by less than `depth`, which must
    /// be greater than 0. It includes smaller turning points that were removed, so a flat valley with
    /// two equal bottoms yields the middle between them and not one of them.
    pub fn middle(&self, values: &[f64], depth: f64) -> f64 {
        let [back, ahead] = self.reach(values.len()).map(|steps| steps as isize);
        let inside = |step: isize| {
            let value = values[at(self.index, step, values)];
            let height = depth - (value - values[self.index]).abs();
            (height > 0.0).then_some((step as f64, height))
        };
        let sums = (1 - back..ahead)
            .filter_map(inside)
            .fold([0.0; 2], |[sum, area], (step, height)| [sum + step * height, area + height]);
        sums[0] / sums[1]
    }

    /// Steps to the neighbouring turning points, before and after.
    fn reach(&self, count: usize) -> [usize; 2] {
        let [before, after] = self.neighbours;
        // In a lone pair each turning point is the other's neighbour on both sides.
        [self.index + count - before, after + count - self.index]
            .map(|steps| (steps - 1) % count + 1)
    }
}

/// The index some steps from another one, all around.
fn at(index: usize, step: isize, values: &[f64]) -> usize {
    (index as isize + step).rem_euclid(values.len() as isize) as usize
}

/// The vertex of the parabola through a turning point and the values beside it.
struct Vertex {
    /// Steps from the turning point, −½ to ½.
    offset: f64,
    value: f64,
    /// Its second derivative; not 0, because a value beside the turning point differs from it.
    bend: f64,
}

impl Vertex {
    fn new(index: usize, values: &[f64]) -> Vertex {
        let [before, own, after] = [-1, 0, 1].map(|step| values[at(index, step, values)]);
        let (slope, bend) = ((after - before) / 2.0, after - own + (before - own));
        let offset = -slope / bend;
        Vertex { offset, value: own + slope * offset / 2.0, bend }
    }

    /// How much the values before, at and after the turning point count for the vertex's value.
    fn shares(&self) -> impl Iterator<Item = (isize, f64)> {
        let t = self.offset;
        [(-1, t * (t - 1.0) / 2.0), (0, 1.0 - t * t), (1, t * (t + 1.0) / 2.0)].into_iter()
    }

    fn place(&self, index: usize, values: &[f64]) -> ExtremePosition {
        let Vertex { offset, bend, .. } = *self;
        let pulls = [(-1, 0.5 - offset), (0, 2.0 * offset), (1, -0.5 - offset)];
        let pulls = pulls.map(|(step, pull)| (at(index, step, values), pull / bend));
        ExtremePosition { offset, pulls: pulls.into() }
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
    fn the_place_of_a_flat_top_is_its_middle_across_the_seam_too() {
        // The peak is flat on top from 9 to 2; its two flanks fall equally.
        let values = [5.0, 5.0, 5.0, 4.0, 2.0, 0.0, 0.5, 2.0, 4.0, 5.0];
        let peak = standing_out(&values, 1.0)[0];
        assert_eq!((peak.index, peak.is_peak, peak.prominence), (2, true, 5.0));
        assert!((peak.place(&values, 0.5).offset + 1.5).abs() < 1e-12);
        assert!((peak.middle(&values, 2.0) + 1.5).abs() < 1e-12);
    }

    #[test]
    fn ripples_on_a_flat_side_do_not_choose_its_place() {
        for phase in [0.0, 1.0, 2.0, 3.0, 4.0, 5.0] {
            let value = |i: i32| {
                let off = f64::from(i - 60);
                let side = ((off.abs() - 20.0).max(0.0) / 10.0).powi(2);
                side + 0.003 * (0.7 * off + phase).sin()
            };
            let values: Vec<f64> = (0..120).map(value).collect();
            let turns = standing_out(&values, 1.0);
            let valley = turns.iter().find(|turn| !turn.is_peak).unwrap();
            let place = valley.index as f64 + valley.place(&values, 0.01).offset;
            assert!((place - 60.0).abs() < 2.0, "{phase}: {place}");
        }
    }

    #[test]
    fn of_two_bottoms_the_lower_is_the_place_unless_nothing_that_counts_parts_them() {
        // Bottoms at 40 and 60, the second lower; a bump between them at 50.
        let valley = |bump: f64| {
            let value = |i: i32| {
                let off = f64::from(i - 50) / 10.0;
                bump * (off * off - 1.0).powi(2) - 0.01 * off
            };
            let values: Vec<f64> = (0..101).map(value).collect();
            let turns = standing_out(&values, 3.0);
            assert_eq!(turns.len(), 2);
            let valley = turns.into_iter().find(|turn| !turn.is_peak).unwrap();
            valley.index as f64 + valley.place(&values, 0.1).offset
        };
        assert!((valley(0.5) - 60.0).abs() < 0.5, "{}", valley(0.5));
        assert!((valley(0.03) - 50.0).abs() < 2.0, "{}", valley(0.03));
    }

    #[test]
    fn the_middle_is_that_of_both_bottoms() {
        let values = [9.0, 4.0, 1.0, 1.5, 2.0, 1.5, 1.0, 4.0];
        let turns = standing_out(&values, 3.0);
        let valley = turns.iter().find(|turn| !turn.is_peak).unwrap();
        assert!((valley.index as f64 + valley.middle(&values, 3.0) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn the_place_of_a_parabola_is_its_vertex_between_the_steps_too() {
        // Deep enough for the three values around the vertex only, and for many.
        for (depth, tolerance) in [(0.1, 1e-9), (2.0, 0.06), (20.0, 0.01)] {
            for part in [-0.5, -0.3, 0.0, 0.2, 0.45] {
                let parabola = |i: i32| (f64::from(i) - 12.0 - part).powi(2);
                let values: Vec<f64> = (0..25).map(parabola).collect();
                let turns = standing_out(&values, 30.0);
                let valley = turns.iter().find(|turn| !turn.is_peak).unwrap();
                let found = valley.index as f64 + valley.place(&values, depth).offset;
                assert!((found - 12.0 - part).abs() < tolerance, "{depth}, {part}: {found}");
            }
        }
    }

    #[test]
    fn pulls_tell_how_a_change_of_the_values_moves_the_place() {
        let values = [7.0, 3.0, 1.2, 1.0, 1.9, 2.5, 6.0, 6.3];
        for depth in [0.1, 0.6, 2.9] {
            let place = |values: &[f64]| standing_out(values, 3.0)[1].place(values, depth);
            let before = place(&values);
            for index in 0..values.len() {
                let mut changed = values;
                changed[index] += 1e-6;
                let pulls = before.pulls.iter().filter(|(of, _)| *of == index);
                let expected: f64 = pulls.map(|(_, pull)| pull).sum();
                let found = (place(&changed).offset - before.offset) / 1e-6;
                assert!((found - expected).abs() < 1e-5, "{index}: {found} for {expected}");
            }
        }
    }
}
