//! A figure with its uncertainty in parts, and the change between two of them.
//!
//! What scatters from place to place is small on a scanner: many girths average it out. What shifts all
//! girths of one scan together (the scanner's calibration, the height of the floor) does not average out, and
//! limits what a comparison can show. So the two are kept apart.
//!
//! What is common to a scan cannot be seen in that scan: the ± of one visit is that of the report of its scan, and does
//! not hold it. The ± of a change does.

use gaiter_record::rounding::MARGIN_SDS;

/// As [`MARGIN_SDS`], for each of 36 places of two legs: the normal deviate of 0.05 / 36, two-sided
/// (Bonferroni).
const PLACE_SDS: f64 = 3.2;

/// The standard uncertainty of a figure, in parts, each in the figure's unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Parts {
    /// What is independent from place to place and from scan to scan; not negative.
    pub random: f64,
    /// The effect of one standard error in common of all girths of the scan; its sign distinguishes figures
    /// that grow together from those that grow in opposite directions.
    pub girths: f64,
    /// The effect of one standard error of the floor's height, by which all places of the scan are shifted.
    pub floor: f64,
}

impl Parts {
    /// What is common to all figures of one scan.
    pub fn common(&self) -> f64 {
        self.girths.hypot(self.floor)
    }

    /// The standard uncertainty.
    pub fn total(&self) -> f64 {
        self.random.hypot(self.common())
    }
}

/// A figure with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The figure.
    pub value: f64,
    /// Its standard uncertainty at its own visit, shown as its ±: of a leg's volume, that of the report of its scan.
    pub sd: f64,
    /// What counts of its uncertainty in a change.
    pub parts: Parts,
}

impl Quantity {
    /// A figure that is as uncertain at its own visit as all its parts together.
    pub(crate) fn new(value: f64, parts: Parts) -> Quantity {
        Quantity { value, sd: parts.total(), parts }
    }

    /// This figure minus another one of the same scan: what is common to both cancels as far as it can.
    pub(crate) fn minus_within_scan(&self, other: &Quantity) -> Quantity {
        let parts = Parts {
            random: self.parts.random.hypot(other.parts.random),
            girths: self.parts.girths - other.parts.girths,
            floor: self.parts.floor - other.parts.floor,
        };
        Quantity::new(self.value - other.value, parts)
    }

    /// Its expanded uncertainty at its own visit: about 95 % of repeated scans lie within it.
    pub fn expanded(&self) -> f64 {
        MARGIN_SDS * self.sd
    }
}

gaiter_leg::word_enum! {
    /// What a comparison shows. It never states better or worse.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Shown {
        /// The later figure is larger, by more than the detectable change.
        Larger => "larger",
        /// The later figure is smaller, by more than the detectable change.
        Smaller => "smaller",
        /// The difference is within the detectable change.
        NoChange => "no-change-shown",
    }
}

/// The change of a figure from one scan to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Later minus earlier, in the figure's unit.
    pub by: f64,
    /// The same, % of the earlier figure.
    pub percent: f64,
    /// The part of the standard uncertainty of `by` that is independent from place to place.
    pub random: f64,
    /// The part that comes from errors common to all girths of a scan.
    pub common: f64,
    /// The part that comes from another stance.
    pub stance: f64,
    /// The earlier figure.
    earlier: f64,
    /// How many standard uncertainties a change must exceed to be shown.
    sds: f64,
}

impl Change {
    /// The change between figures of two scans. Their errors are independent: how far a scanner's calibration
    /// has moved between them is not known, so nothing of it is assumed to cancel.
    pub fn between(earlier: &Quantity, later: &Quantity) -> Change {
        Change::of_one(earlier, later, MARGIN_SDS)
    }

    /// The change at one of the many places of two legs. It must exceed more of its own uncertainty, so that
    /// in 95 of 100 pairs of scans no place is reported as changed by chance.
    pub(crate) fn at_place(earlier: &Quantity, later: &Quantity) -> Change {
        Change::of_one(earlier, later, PLACE_SDS)
    }

    fn of_one(earlier: &Quantity, later: &Quantity, sds: f64) -> Change {
        let by = later.value - earlier.value;
        Change {
            by,
            percent: 100.0 * by / earlier.value,
            random: earlier.parts.random.hypot(later.parts.random),
            common: earlier.parts.common().hypot(later.parts.common()),
            stance: 0.0,
            earlier: earlier.value,
            sds,
        }
    }

    /// The change with the part of its uncertainty that comes from another stance.
    pub(crate) fn with_stance(self, stance: f64) -> Change {
        Change { stance, ..self }
    }

    /// The smallest change that is distinguished from none, which clinics call the minimal detectable change (MDC95): a
    /// difference of two scans of an unchanged leg exceeds it in about 5 of 100 comparisons.
    pub fn detectable(&self) -> f64 {
        self.sds * self.random.hypot(self.common).hypot(self.stance)
    }

    /// The same, % of the earlier figure.
    pub fn detectable_percent(&self) -> f64 {
        100.0 * self.detectable() / self.earlier.abs()
    }

    /// What the comparison shows.
    pub fn shown(&self) -> Shown {
        let detectable = self.detectable();
        if self.by > detectable {
            Shown::Larger
        } else if self.by < -detectable {
            Shown::Smaller
        } else {
            Shown::NoChange
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(value: f64, [random, girths, floor]: [f64; 3]) -> Quantity {
        Quantity::new(value, Parts { random, girths, floor })
    }

    #[test]
    fn parts_add_as_squares() {
        let parts = Parts { random: 2.0, girths: 3.0, floor: -6.0 };
        assert_eq!((parts.common(), parts.total()), (45_f64.sqrt(), 7.0));
    }

    #[test]
    fn what_two_legs_of_a_scan_have_in_common_cancels_and_noise_does_not() {
        let [left, right] =
            [quantity(8000.0, [3.0, 40.0, 20.0]), quantity(7000.0, [4.0, 38.0, 20.0])];
        let excess = left.minus_within_scan(&right);
        assert_eq!(excess, quantity(1000.0, [5.0, 2.0, 0.0]));
    }

    #[test]
    fn nothing_cancels_between_two_scans() {
        let one = quantity(7000.0, [0.0, 30.0, 40.0]);
        let change = Change::between(&one, &quantity(7100.0, [0.0, 30.0, 40.0]));
        assert_eq!((change.by, change.random), (100.0, 0.0));
        assert!((change.common - 5000_f64.sqrt()).abs() < 1e-9);
        assert!((change.percent - 100.0 / 70.0).abs() < 1e-9);
    }

    #[test]
    fn a_change_is_shown_beyond_two_standard_uncertainties_and_not_at_them() {
        let earlier = quantity(1000.0, [3.0, 0.0, 0.0]);
        let shown =
            |value: f64| Change::between(&earlier, &quantity(value, [4.0, 0.0, 0.0])).shown();
        assert_eq!(shown(1010.0), Shown::NoChange);
        assert_eq!(shown(990.0), Shown::NoChange);
        assert_eq!(shown(1010.1), Shown::Larger);
        assert_eq!(shown(989.9), Shown::Smaller);
    }

    #[test]
    fn another_stance_adds_to_what_a_change_must_exceed() {
        let earlier = quantity(1000.0, [0.0, 3.0, 0.0]);
        let change = Change::between(&earlier, &earlier).with_stance(5.0);
        assert!((change.detectable() - 2.0 * 43_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn an_unknown_uncertainty_shows_no_change() {
        for unknown in [f64::INFINITY, f64::NAN] {
            let change = Change::between(
                &quantity(1000.0, [1.0, 0.0, 0.0]),
                &quantity(2000.0, [unknown, 0.0, 0.0]),
            );
            assert_eq!(change.shown(), Shown::NoChange);
        }
    }
}
