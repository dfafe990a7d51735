//! The cubic B-spline basis, clamped on an interval or periodic: knots, values, derivatives.

mod triangle;

use std::ops::Range;

use nalgebra::DMatrix;

use triangle::{COLUMNS, ONE, Raise, Triangle, raised};

/// The degree of all splines in this module.
pub const DEGREE: usize = 3;

/// The cubic B-spline functions over strictly increasing breakpoints.
///
/// Clamped: the spline lives on `[a, b]`, and its first and last coefficients are its end values.
/// Periodic: it repeats with period `b − a` and is C2 everywhere, including the seam. In both cases
/// the functions that are nonzero on interval `s` are `s..s + 4`, taken modulo [`Basis::count`] if
/// periodic.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    breakpoints: Vec<f64>,
    /// `knots[s + DEGREE] == breakpoints[s]` for every breakpoint `s`.
    knots: Vec<f64>,
    /// For each interval, the reciprocals of the knot distances by which the Cox-de Boor triangle
    /// divides there, column by column: a division costs as much as the rest of a column.
    reciprocals: Vec<[f64; 6]>,
    /// Intervals per unit of x on average.
    density: f64,
    periodic: bool,
    /// The intervals whose functions depend on knots at equal distances only, so that they are known in
    /// closed form.
    even: Range<usize>,
}

/// Why breakpoints do not form a basis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BasisFault {
    /// A clamped basis needs 2 breakpoints, a periodic one 5 (4 intervals).
    #[error("{found} breakpoints; the basis needs at least {needed}")]
    TooFewBreakpoints {
        /// Number of breakpoints given.
        found: usize,
        /// Number needed.
        needed: usize,
    },
    /// A breakpoint is infinite or NaN.
    #[error("breakpoint {index} is not finite")]
    NotFinite {
        /// 0-based index of the first such breakpoint.
        index: usize,
    },
    /// A breakpoint is not greater than the one before it.
    #[error("breakpoint {index} at {value} is not above its predecessor {before}")]
    NotIncreasing {
        /// 0-based index of the first such breakpoint, at least 1.
        index: usize,
        /// The breakpoint before it.
        before: f64,
        /// The breakpoint.
        value: f64,
    },
}

/// The basis functions, or one of their derivatives, that are nonzero at one abscissa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The indices of these coefficients; all different, below [`Basis::count`], already wrapped if
    /// the basis is periodic.
    pub indices: [usize; 4],
    /// The value of each of those functions.
    pub values: [f64; 4],
}

impl Row {
    /// The value of these functions with all `coefficients` ([`Basis::count`] of them).
    #[inline]
    pub fn dot(&self, coefficients: &[f64]) -> f64 {
        let [i, j, k, l] = self.indices.map(|index| coefficients[index]);
        let [a, b, c, d] = self.values;
        a * i + b * j + c * k + d * l
    }

    /// Adds the value of these functions with each column of `coefficients`, of which each function has a row as long
    /// as `sums`.
    #[inline]
    pub(super) fn add_to(&self, sums: &mut [f64], coefficients: &[f64]) {
        let width = sums.len();
        for (index, share) in self.indices.into_iter().zip(self.values) {
            let own = &coefficients[index * width..(index + 1) * width];
            sums.iter_mut().zip(own).for_each(|(sum, value)| *sum += share * value);
        }
    }
}

impl Basis {
    /// A basis on `[first breakpoint, last breakpoint]` with 4-fold end knots.
    ///
    /// # Errors
    /// A [`BasisFault`] unless there are 2 or more breakpoints, finite and strictly increasing.
    pub fn clamped(breakpoints: &[f64]) -> Result<Basis, BasisFault> {
        check(breakpoints, 2)?;
        let intervals = breakpoints.len() - 1;
        let mut knots = vec![breakpoints[0]; DEGREE];
        knots.extend_from_slice(breakpoints);
        knots.extend([breakpoints[intervals]; DEGREE]);
        Ok(Basis::over(breakpoints, knots, false))
    }

    /// A basis that repeats with period `last − first breakpoint`. The last breakpoint is the
    /// first one a period later, so `n + 1` values make `n` intervals.
    ///
    /// # Errors
    /// A [`BasisFault`] unless there are 5 or more breakpoints, finite and strictly increasing:
    /// on fewer than 4 intervals a function would meet itself.
    pub fn periodic(breakpoints: &[f64]) -> Result<Basis, BasisFault> {
        check(breakpoints, DEGREE + 2)?;
        let intervals = breakpoints.len() - 1;
        let period = breakpoints[intervals] - breakpoints[0];
        let before = breakpoints[intervals - DEGREE..intervals].iter().map(|knot| knot - period);
        let after = breakpoints[1..=DEGREE].iter().map(|knot| knot + period);
        let knots = before.chain(breakpoints.iter().copied()).chain(after).collect();
        Ok(Basis::over(breakpoints, knots, true))
    }

    fn over(breakpoints: &[f64], knots: Vec<f64>, periodic: bool) -> Basis {
        let intervals = breakpoints.len() - 1;
        let density = intervals as f64 / (breakpoints[intervals] - breakpoints[0]);
        let distances = COLUMNS.map(|to| (0..to).map(move |r| (DEGREE + r - to, DEGREE + r)));
        let pairs: Vec<(usize, usize)> = distances.into_iter().flatten().collect();
        let about = |span: usize| {
            let knots = &knots[span + 1..=span + 2 * DEGREE];
            std::array::from_fn(|place| 1.0 / (knots[pairs[place].1] - knots[pairs[place].0]))
        };
        let reciprocals = (0..intervals).map(about).collect();
        let breakpoints = breakpoints.to_vec();
        Basis { breakpoints, knots, reciprocals, density, periodic, even: 0..0 }
    }

    /// The basis, whose intervals are all of equal length.
    fn with_equal_intervals(mut self) -> Basis {
        // Functions at a clamped end depend on its multiple knot.
        let ends = if self.periodic { 0 } else { DEGREE - 1 };
        self.even = ends..self.intervals().saturating_sub(ends);
        self
    }

    /// A clamped basis on `[from, to]` with `intervals` of equal length.
    ///
    /// # Errors
    /// As [`Basis::clamped`], in particular unless `intervals ≥ 1` and `from < to`.
    pub fn uniform_clamped(from: f64, to: f64, intervals: usize) -> Result<Basis, BasisFault> {
        Ok(Basis::clamped(&equidistant(from, to, intervals))?.with_equal_intervals())
    }

    /// A periodic basis that starts at `from`, with `intervals` of equal length.
    ///
    /// # Errors
    /// As [`Basis::periodic`], in particular unless `intervals ≥ 4` and `period > 0`.
    pub fn uniform_periodic(from: f64, period: f64, intervals: usize) -> Result<Basis, BasisFault> {
        let even = Basis::periodic(&equidistant(from, from + period, intervals))?;
        Ok(even.with_equal_intervals())
    }

    /// Number of basis functions, and so of coefficients: intervals + 3 if clamped, intervals if
    /// periodic.
    pub fn count(&self) -> usize {
        if self.periodic { self.intervals() } else { self.intervals() + DEGREE }
    }

    /// Whether the basis is periodic.
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// First and last breakpoint; for a periodic basis their difference is the period.
    pub fn domain(&self) -> (f64, f64) {
        (self.breakpoints[0], self.breakpoints[self.intervals()])
    }

    /// The breakpoints as given; intervals + 1 of them.
    pub fn breakpoints(&self) -> &[f64] {
        &self.breakpoints
    }

    /// The full knot vector, intervals + 7 values: clamped with 4-fold ends, periodic with 3
    /// wrapped neighbours on each side.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The values of the functions at `x`; see [`Basis::rows`] for `x` outside the domain.
    #[inline]
    pub fn row(&self, x: f64) -> Row {
        let x = self.wrapped(x);
        match self.even_place(x) {
            Some((span, t)) => Row { indices: self.indices(span), values: even_values(t) },
            None => self.blossom(self.span(x), [x; DEGREE]),
        }
    }

    /// The interval that contains `x` (wrapped), to rounding, and its share of it, if its functions are
    /// known in closed form.
    #[inline]
    fn even_place(&self, x: f64) -> Option<(usize, f64)> {
        let place = (x - self.breakpoints[0]) * self.density;
        let span = (place as usize).min(self.breakpoints.len() - 2);
        self.even.contains(&span).then_some((span, place - span as f64))
    }

    /// The values of all functions at each position: positions × functions.
    pub(super) fn design(&self, places: &[f64]) -> DMatrix<f64> {
        let mut design = DMatrix::zeros(places.len(), self.count());
        for (i, place) in places.iter().enumerate() {
            let row = self.row(*place);
            row.indices.into_iter().zip(row.values).for_each(|(j, value)| design[(i, j)] += value);
        }
        design
    }

    /// The functions' derivatives 0 to 3 at `x`, the third from the right at a breakpoint (from the
    /// left at a clamped end). A periodic `x` is wrapped; a clamped `x` outside the domain is moved
    /// to the nearer end.
    #[inline]
    pub fn rows(&self, x: f64) -> [Row; 4] {
        // At a breakpoint, the third derivative depends on the side from which it is seen.
        let span = self.span(self.wrapped(x));
        let [value, first, second] = self.triangle_to_second(span, self.wrapped(x));
        let triangle = self.triangle(span);
        let third = raised::<1>(&triangle, ONE, Raise::Slope);
        let third =
            raised::<3>(&triangle, raised::<2>(&triangle, third, Raise::Slope), Raise::Slope);
        let indices = self.indices(span);
        [value, first, second, third].map(|values| Row { indices, values })
    }

    /// The interval that contains `x`, and the functions' values and derivatives 1 and 2 there.
    #[inline]
    pub fn rows_to_second(&self, x: f64) -> (usize, [[f64; 4]; 3]) {
        let x = self.wrapped(x);
        if let Some((span, t)) = self.even_place(x) {
            let first = even_slopes(t).map(|slope| slope * self.density);
            let second = even_bends(t).map(|bend| bend * self.density * self.density);
            return (span, [even_values(t), first, second]);
        }
        let span = self.span(x);
        (span, self.triangle_to_second(span, x))
    }

    /// The value and the slope at `x` of the spline with these coefficients ([`Basis::count`] of them).
    #[inline]
    pub fn value_and_slope(&self, x: f64, coefficients: &[f64]) -> [f64; 2] {
        let (span, [values, slopes, _]) = self.rows_to_second(x);
        let indices = self.indices(span);
        [values, slopes].map(|values| Row { indices, values }.dot(coefficients))
    }

    /// The values and derivatives 1 and 2 at `x` of the functions on an interval.
    #[inline]
    fn triangle_to_second(&self, span: usize, x: f64) -> [[f64; 4]; 3] {
        let triangle = self.triangle(span);
        let (value, slope) = (Raise::Value(x), Raise::Slope);
        let linear = raised::<1>(&triangle, ONE, value);
        let quadratic = raised::<2>(&triangle, linear, value);
        let first = raised::<3>(&triangle, quadratic, slope);
        let second = raised::<3>(&triangle, raised::<2>(&triangle, linear, slope), slope);
        [raised::<3>(&triangle, quadratic, value), first, second]
    }

    /// The functions' polar forms on interval `span` (below the number of intervals) at three
    /// arguments; for three equal arguments these are the functions' values. At three consecutive
    /// knots of a refined basis they give the refined coefficient (Ramshaw 1989).
    #[inline]
    pub fn blossom(&self, span: usize, arguments: [f64; DEGREE]) -> Row {
        let (knots, [a, b, c]) = (self.triangle(span), arguments.map(Raise::Value));
        let values = raised::<2>(&knots, raised::<1>(&knots, ONE, a), b);
        Row { indices: self.indices(span), values: raised::<3>(&knots, values, c) }
    }

    /// The Greville abscissa of each function, the mean of its three inner knots; wrapped into the
    /// domain if periodic. A clamped spline with these as coefficients is the identity.
    pub fn greville(&self) -> Vec<f64> {
        (0..self.count())
            .map(|i| self.wrapped(self.knots[i + 1..=i + DEGREE].iter().sum::<f64>() / 3.0))
            .collect()
    }

    fn intervals(&self) -> usize {
        self.breakpoints.len() - 1
    }

    /// The functions that are nonzero on interval `span`.
    #[inline]
    pub fn indices(&self, span: usize) -> [usize; 4] {
        let count = self.count();
        // At most one wrap is needed, and a division would take as long as the functions themselves.
        let folded = |index: usize| if index < count { index } else { index - count };
        [0, 1, 2, 3].map(|i| folded(span + i))
    }

    /// The knots that the functions of interval `span` depend on; the interval lies between the
    /// middle two.
    #[inline]
    fn triangle(&self, span: usize) -> Triangle {
        let mut knots = [0.0; 2 * DEGREE];
        knots.copy_from_slice(&self.knots[span + 1..=span + 2 * DEGREE]);
        Triangle { knots, reciprocals: self.reciprocals[span] }
    }

    /// `x` wrapped or clamped into the domain; the end of a period becomes its start.
    #[inline]
    pub(super) fn wrapped(&self, x: f64) -> f64 {
        let (from, to) = self.domain();
        if !self.periodic {
            return x.clamp(from, to);
        }
        if from <= x && x < to {
            return x;
        }
        let wrapped = from + (x - from).rem_euclid(to - from);
        // Rounding can put the wrapped value slightly outside.
        if wrapped < from || wrapped >= to { from } else { wrapped }
    }

    /// The interval that contains `x` within the domain; the last one for the end of the domain.
    /// The search begins at the interval that `x` would have among equal intervals, because most
    /// intervals are equal.
    #[inline]
    pub(super) fn span(&self, x: f64) -> usize {
        let last = self.intervals() - 1;
        let inner = &self.breakpoints[1..=last];
        let mut span = (((x - self.breakpoints[0]) * self.density) as usize).min(last);
        while span > 0 && x < inner[span - 1] {
            span -= 1;
        }
        while span < last && inner[span] <= x {
            span += 1;
        }
        span
    }
}

/// The values of the four cubic functions in closed form at a share of an interval among knots at distances of 1 (The NURBS
/// Book, 2.2; de Boor, A Practical Guide to Splines, chapter IX).
#[inline]
fn even_values(t: f64) -> [f64; 4] {
    let (u, square, cube) = (1.0 - t, t * t, t * t * t);
    let sixth = 1.0 / 6.0;
    [
        sixth * (u * u * u),
        sixth * (3.0 * cube - 6.0 * square + 4.0),
        sixth * (3.0 * (square - cube) + 3.0 * t + 1.0),
        sixth * cube,
    ]
}

#[inline]
fn even_slopes(t: f64) -> [f64; 4] {
    let (u, square) = (1.0 - t, t * t);
    [-0.5 * (u * u), 1.5 * square - 2.0 * t, 0.5 + t - 1.5 * square, 0.5 * square]
}

/// Their second derivatives.
#[inline]
fn even_bends(t: f64) -> [f64; 4] {
    [1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t]
}

pub(super) fn equidistant(from: f64, to: f64, intervals: usize) -> Vec<f64> {
    let step = (to - from) / intervals as f64;
    // The last value is exactly `to`, so that rounding does not put data at the end outside.
    (0..intervals).map(|i| from + step * i as f64).chain([to]).collect()
}

fn check(breakpoints: &[f64], needed: usize) -> Result<(), BasisFault> {
    if breakpoints.len() < needed {
        return Err(BasisFault::TooFewBreakpoints { found: breakpoints.len(), needed });
    }
    if let Some(index) = breakpoints.iter().position(|value| !value.is_finite()) {
        return Err(BasisFault::NotFinite { index });
    }
    match breakpoints.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(i) => {
            let (before, value) = (breakpoints[i], breakpoints[i + 1]);
            Err(BasisFault::NotIncreasing { index: i + 1, before, value })
        }
        None => Ok(()),
    }
}
