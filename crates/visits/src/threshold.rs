//! Thresholds that a clinic sets itself, with their sources. There are none unless it does.

use gaiter_leg::Side;

use super::comparison::Comparison;

/// A limit that a change or an excess may reach.
#[derive(Debug, Clone, PartialEq)]
pub struct Threshold {
    /// Its name.
    pub name: String,
    /// Where it comes from: a paper, a guideline.
    pub source: String,
    /// What it limits.
    pub of: Limited,
    /// The limit, in the unit of `of`; positive.
    pub limit: f64,
}

gaiter_leg::word_enum! {
    /// What a threshold limits. There is no limit in mL: 200 mL is a threshold for arms, and the legs of healthy
    /// persons differ by more.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Limited {
        /// The percent change of a leg's volume, %.
        LegChange => "leg-change",
        /// The excess volume of the affected leg at the later visit, % of the other leg. A leg that is smaller than the
        /// other one has none.
        Excess => "excess",
        /// The largest change of a girth at a fixed place, mm.
        GirthChange => "girth-change",
    }
}

gaiter_leg::word_enum! {
    /// How a figure relates to a threshold.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Reached {
        /// It is reached, also less the uncertainty.
        Yes => "reached",
        /// It is not reached, also with the uncertainty.
        No => "not-reached",
        /// The uncertainty is too large to decide it.
        Open => "open",
    }
}

/// A threshold and the figure that it is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThresholdVerdict<'a> {
    /// The threshold.
    pub threshold: &'a Threshold,
    /// The leg.
    pub side: Side,
    /// The figure, in the unit of the threshold.
    pub value: f64,
    /// How far it is uncertain, about 95 %.
    pub expanded: f64,
}

impl Limited {
    /// The unit of its limits.
    pub fn unit(self) -> &'static str {
        match self {
            Limited::LegChange | Limited::Excess => "%",
            Limited::GirthChange => "mm",
        }
    }
}

impl ThresholdVerdict<'_> {
    /// Whether the threshold is reached.
    pub fn reached(&self) -> Reached {
        // A change may reach its limit in both directions, an excess in one only.
        let value = match self.threshold.of {
            Limited::LegChange | Limited::GirthChange => self.value.abs(),
            Limited::Excess => self.value,
        };
        if value - self.expanded >= self.threshold.limit {
            Reached::Yes
        } else if value + self.expanded < self.threshold.limit {
            Reached::No
        } else {
            Reached::Open
        }
    }
}

/// The verdicts of a comparison on thresholds, in their order, the patient's right leg first.
pub(crate) fn verdicts<'a>(
    thresholds: &'a [Threshold],
    of: &Comparison,
) -> Vec<ThresholdVerdict<'a>> {
    let of_side = |threshold: &'a Threshold, side: Side| {
        let [value, expanded] = figure(threshold.of, of, side)?;
        Some(ThresholdVerdict { threshold, side, value, expanded })
    };
    let each = |threshold| Side::FROM_FRONT.map(|side| of_side(threshold, side));
    thresholds.iter().flat_map(each).flatten().collect()
}

/// A figure that can be limited and its expanded uncertainty.
fn figure(limited: Limited, of: &Comparison, side: Side) -> Option<[f64; 2]> {
    match limited {
        Limited::LegChange => {
            let volume = of.volume(side)?;
            Some([volume.percent, volume.detectable_percent()])
        }
        Limited::GirthChange => {
            let changes = of.girths(side).iter().map(|place| place.change);
            let largest = changes.max_by(|one, other| one.by.abs().total_cmp(&other.by.abs()))?;
            Some([largest.by, largest.detectable()])
        }
        Limited::Excess => {
            let excess = of.later_excess.filter(|excess| excess.affected == side)?;
            Some([excess.percent, 100.0 * excess.ml.expanded() / excess.other_ml])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How a figure relates to a limit of 3.
    fn reached(of: Limited, value: f64, expanded: f64) -> Reached {
        let (name, source) = ("mild".to_owned(), "a paper".to_owned());
        let threshold = &Threshold { name, source, of, limit: 3.0 };
        ThresholdVerdict { threshold, side: Side::Left, value, expanded }.reached()
    }

    #[test]
    fn a_threshold_is_told_as_reached_or_not_only_beyond_the_uncertainty() {
        let reached = |value: f64, expanded: f64| reached(Limited::LegChange, value, expanded);
        assert_eq!(reached(4.5, 1.5), Reached::Yes);
        assert_eq!(reached(-4.5, 1.5), Reached::Yes);
        assert_eq!(reached(4.4, 1.5), Reached::Open);
        assert_eq!(reached(1.6, 1.5), Reached::Open);
        assert_eq!(reached(1.4, 1.5), Reached::No);
    }

    #[test]
    fn a_leg_that_is_smaller_than_the_other_reaches_no_threshold_of_an_excess() {
        assert_eq!(reached(Limited::Excess, -4.5, 1.5), Reached::No);
        assert_eq!(reached(Limited::Excess, 4.5, 1.5), Reached::Yes);
        assert_eq!(reached(Limited::Excess, -1.0, 4.5), Reached::Open);
        assert_eq!(reached(Limited::GirthChange, -4.5, 1.5), Reached::Yes);
    }
}
