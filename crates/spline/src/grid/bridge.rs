//! Bridges gaps in a grid with cubics.
//!
//! Where data are missing, least squares leave a basis undetermined or nearly so, and an
//! unconstrained surface oscillates by metres; a penalty on its derivatives controls it only if it
//! is strong enough to flatten the rest. So lines are inserted into a gap. Each of their points
//! lies on a cubic that continues the data on both sides with their position and slope.

use nalgebra::Point3;

use super::given::{self, GridData, points, transposed};
use crate::knots::profiles::{Domain, Profiles};

/// A range without data is a gap if it exceeds this many median line distances …
const WIDE: f64 = 2.5;

/// … and this many mean spans of the basis.
const WIDE_SPANS: f64 = 1.0;

/// A grid without gaps: the given lines first, then the inserted ones.
#[derive(Debug, Clone)]
pub struct Bridged {
    /// Parameters along.
    pub along: Vec<f64>,
    /// Parameters around.
    pub around: Vec<f64>,
    /// The points, row-major.
    pub points: Vec<Point3<f64>>,
}

impl Bridged {
    /// Fills the gaps of a grid, for these numbers of spans along and around.
    pub fn new(data: &GridData, domains: [Domain; 2], spans: [usize; 2]) -> Bridged {
        let mut rows = data.profiles_along();
        fill(&mut rows, &domains[0], spans[0]);
        let points = points(&rows.values);
        let mut columns =
            GridData { along: &rows.places, points: &points, ..*data }.profiles_around();
        fill(&mut columns, &domains[1], spans[1]);
        let values = transposed(&columns.values, columns.places.len(), rows.places.len());
        let points = given::points(&values);
        Bridged { along: rows.places, around: columns.places, points }
    }

    /// The grid as data.
    pub fn data(&self) -> GridData<'_> {
        GridData { along: &self.along, around: &self.around, points: &self.points }
    }
}

/// Inserts lines into the gaps.
fn fill(profiles: &mut Profiles, domain: &Domain, spans: usize) {
    let lines = Lines::new(profiles, domain);
    let mut lengths: Vec<f64> = lines.at.windows(2).map(|pair| pair[1] - pair[0]).collect();
    lengths.sort_by(f64::total_cmp);
    let Some(usual) = lengths.get(lengths.len() / 2).copied() else { return };
    let wide = (WIDE * usual).max(WIDE_SPANS * (domain.to - domain.from) / spans as f64);
    let mut added = (Vec::new(), Vec::new());
    for (i, pair) in lines.at.windows(2).enumerate().filter(|(_, p)| p[1] - p[0] > wide) {
        let count = ((pair[1] - pair[0]) / usual).floor() as usize;
        for line in 1..count {
            let share = line as f64 / count as f64;
            if let Some(values) = lines.bridge(i, share) {
                added.0.push(pair[0] + (pair[1] - pair[0]) * share);
                added.1.extend(values);
            }
        }
    }
    profiles.places.extend(added.0);
    profiles.values.extend(added.1);
}

/// Lines in ascending order; if periodic, followed by the first line again, one period later.
struct Lines {
    at: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// Number of lines per turn; `None` if clamped.
    turn: Option<usize>,
    period: f64,
}

impl Lines {
    fn new(profiles: &Profiles, domain: &Domain) -> Lines {
        let width = profiles.values.len() / profiles.places.len();
        let home = |i: &usize| domain.wrap(profiles.places[*i], domain.from);
        let mut order: Vec<usize> = (0..profiles.places.len()).collect();
        order.sort_by(|a, b| home(a).total_cmp(&home(b)));
        let mut at: Vec<f64> = order.iter().map(home).collect();
        let line = |i: &usize| profiles.values[i * width..(i + 1) * width].to_vec();
        let values = order.iter().map(line).collect();
        let period = domain.to - domain.from;
        let turn = domain.periodic.then_some(order.len());
        at.extend(turn.map(|_| at[0] + period));
        Lines { at, values, turn, period }
    }

    /// Position and values of a line, continued across the seam; `None` beyond a clamped end.
    fn line(&self, i: isize) -> Option<(f64, &[f64])> {
        let Some(turn) = self.turn else {
            let i = usize::try_from(i).ok()?;
            return Some((*self.at.get(i)?, self.values.get(i)?));
        };
        let (turns, i) = (i.div_euclid(turn as isize), i.rem_euclid(turn as isize) as usize);
        Some((self.at[i] + turns as f64 * self.period, &self.values[i]))
    }

    /// The values at a fraction `share` of the way from line `i` to the next: a cubic with the
    /// slopes of the data or, next to a single line, with the slope across the gap.
    fn bridge(&self, i: usize, share: f64) -> Option<Vec<f64>> {
        let i = i as isize;
        let ((from, start), (to, end)) = (self.line(i)?, self.line(i + 1)?);
        let (t, rest, length) = (share, 1.0 - share, to - from);
        let across = || start.iter().zip(end).map(|(a, b)| (b - a) / length).collect();
        let leaving: Vec<f64> = self.slopes([i, i - 1, i - 2]).unwrap_or_else(across);
        let arriving: Vec<f64> = self.slopes([i + 1, i + 2, i + 3]).unwrap_or_else(across);
        let column = |c: usize| {
            let [left, right] = [rest * rest * (1.0 + 2.0 * t), t * t * (1.0 + 2.0 * rest)];
            let slope = length * t * rest * (rest * leaving[c] - t * arriving[c]);
            left * start[c] + right * end[c] + slope
        };
        Some((0..start.len()).map(column).collect())
    }

    /// The slopes at the first of three lines: of the parabola through them, or of the straight
    /// line if there are only two; `None` if there is only one.
    fn slopes(&self, [first, second, third]: [isize; 3]) -> Option<Vec<f64>> {
        let ((x, y), second) = (self.line(first)?, self.line(second)?);
        let slope = |(x2, y2): (f64, &[f64]), c: usize| (y2[c] - y[c]) / (x2 - x);
        let Some(third) = self.line(third) else {
            return Some((0..y.len()).map(|c| slope(second, c)).collect());
        };
        let (near, far) = (second.0 - x, third.0 - x);
        let column = |c| (far * slope(second, c) - near * slope(third, c)) / (far - near);
        Some((0..y.len()).map(column).collect())
    }
}
