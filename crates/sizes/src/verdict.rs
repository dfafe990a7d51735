//! A size table's verdict on a leg: every size with each point's margins and probability, never a choice.

use serde::Serialize;

use super::garment::Garment;
use super::point::Point;
use super::probability::within;
use super::table::{Basis, Code, LengthRow, Ranged, Required, Size, SizeTable};

/// A point fits if it lies inside its range with at least this probability.
pub const SURE: f64 = 0.95;

/// A point outside its range does not fit if it lies inside with at most this probability.
pub const UNLIKELY: f64 = 0.05;

/// What is known of a point of a leg.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "is")]
pub enum Reading {
    /// Its value.
    Given(Given),
    /// There is no value to judge by: it is to be measured by hand.
    NotGiven {
        /// Why.
        why: NotGiven,
    },
}

/// The value of a point, not rounded.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Given {
    /// The value, mm.
    pub mm: f64,
    /// Its standard uncertainty, mm; null if it is unknown.
    pub uncertainty_mm: Option<f64>,
    /// Whether a person set it.
    pub is_by_hand: bool,
}

gaiter_leg::word_enum! {
    /// Why a point has no value to judge by.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    pub enum NotGiven as serde {
        /// The scan does not show it, and no person measured it.
        NotFound => "not-found",
        /// A person noted that it cannot be measured.
        NotMeasurable => "not-measurable",
        /// It is estimated by a proportion of the body.
        Estimated => "estimated",
        /// There is a doubt about it.
        Doubtful => "doubtful",
        /// No scan of the legs gives it.
        Beyond => "beyond",
    }
}

gaiter_leg::word_enum! {
    /// How a value or a size fits.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
    pub enum Fit as serde {
        /// At least one point does not.
        DoesNotFit => "does-not-fit",
        /// A required point is not given.
        NotDecided => "not-decided",
        /// Nothing contradicts it but a value near a limit.
        FitsWithinUncertainty => "fits-within-uncertainty",
        /// Every required point does, surely.
        Fits => "fits",
    }
}

/// How a point lies to its range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointVerdict {
    /// The point.
    pub point: Point,
    /// Lower and upper limit, mm.
    pub limits_mm: [f64; 2],
    /// The leg's value.
    pub reading: Reading,
    /// How far it lies above the lower and below the upper limit, mm; negative outside. Null without a value.
    pub margins_mm: Option<[f64; 2]>,
    /// The probability that it lies inside; null if its uncertainty is unknown.
    pub probability: Option<f64>,
    /// How it fits; without a probability by the value alone.
    pub fit: Fit,
    /// Whether the size fits only if this point does.
    pub is_required: bool,
}

/// A size, or a variant of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizeVerdict {
    /// The size.
    pub size: String,
    /// Its variant; null for the size itself.
    pub variant: Option<String>,
    /// Whether the deciding point allows it.
    pub is_candidate: bool,
    /// How it fits.
    pub fit: Fit,
    /// The required points that are not given.
    pub missing: Vec<Point>,
    /// Its points, in the order of the table.
    pub points: Vec<PointVerdict>,
    /// Its article codes for the garment.
    pub codes: Vec<Code>,
}

/// A length in which the garment is made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LengthVerdict {
    /// The length's name.
    pub length: String,
    /// How it fits.
    pub fit: Fit,
    /// Its points that are not given.
    pub missing: Vec<Point>,
    /// Its points.
    pub points: Vec<PointVerdict>,
}

/// A table's verdict on a leg.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegVerdict {
    /// The best that any of its sizes and any of its lengths allow together.
    pub fit: Fit,
    /// Every size with its variants, in the order of the table.
    pub sizes: Vec<SizeVerdict>,
    /// Every length, in the order of the table; empty if it has none for the garment.
    pub lengths: Vec<LengthVerdict>,
}

gaiter_leg::word_enum! {
    /// Why a table has no verdict on a garment.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    pub enum NotComparable as serde {
        /// Its girths are under tension, the measures are of skin. Nothing is converted.
        Tension => "tension",
        /// It does not state whether its girths are of skin.
        BasisUnknown => "basis-unknown",
        /// It is not for this garment, or has none of its points.
        OtherGarment => "other-garment",
    }
}

/// Judges a leg by a table.
///
/// # Errors
/// See [`NotComparable`].
pub fn leg_verdict(
    table: &SizeTable,
    garment: &Garment,
    reading: impl Fn(Point) -> Reading,
) -> Result<LegVerdict, NotComparable> {
    match table.basis {
        Some(Basis::Skin) => {}
        Some(Basis::Tension) => return Err(NotComparable::Tension),
        None => return Err(NotComparable::BasisUnknown),
    }
    let is_for = |of: &String| of == garment.name();
    if !table.garments.is_empty() && !table.garments.iter().any(is_for) {
        return Err(NotComparable::OtherGarment);
    }
    let judge = Judge { table, garment, reading: &reading };
    let sizes = judge.sizes();
    if sizes.iter().all(|size| size.points.is_empty()) {
        return Err(NotComparable::OtherGarment);
    }
    let lengths: Vec<LengthVerdict> =
        table.lengths_for(garment.name()).map(|row| judge.length(row)).collect();
    let best = sizes.iter().map(|of| of.fit).max().unwrap_or(Fit::DoesNotFit);
    let best_length = lengths.iter().map(|of| of.fit).max().unwrap_or(Fit::Fits);
    Ok(LegVerdict { fit: best.min(best_length), sizes, lengths })
}

/// A table, and what it is asked.
struct Judge<'a> {
    table: &'a SizeTable,
    garment: &'a Garment,
    reading: &'a dyn Fn(Point) -> Reading,
}

impl Judge<'_> {
    /// Every size, each followed by its variants for the garment.
    fn sizes(&self) -> Vec<SizeVerdict> {
        let of_size = |size: &Size| {
            let variants = self.table.variants_for(self.garment.name());
            let variants = variants.filter_map(|variant| {
                let ranges = size.ranges_of(&variant.name)?;
                Some(self.size(size, Some(&variant.name), &ranges))
            });
            let own = self.size(size, None, &size.ranges);
            std::iter::once(own).chain(variants).collect::<Vec<_>>()
        };
        self.table.sizes.iter().flat_map(of_size).collect()
    }

    fn size(&self, size: &Size, variant: Option<&str>, ranges: &[Ranged]) -> SizeVerdict {
        let points: Vec<PointVerdict> =
            ranges.iter().filter(|of| self.is_asked(of.point)).map(|of| self.point(of)).collect();
        let deciding = points.iter().find(|of| Some(of.point) == self.table.decides);
        let is_its = |code: &&Code| {
            let is_for = code.garment.as_deref().is_none_or(|of| of == self.garment.name());
            code.variant.as_deref() == variant && is_for
        };
        let (fit, missing) = together(&points);
        SizeVerdict {
            size: size.name.clone(),
            variant: variant.map(str::to_owned),
            is_candidate: deciding.is_none_or(|of| of.fit != Fit::DoesNotFit),
            fit,
            missing,
            codes: size.codes.iter().filter(is_its).cloned().collect(),
            points,
        }
    }

    fn length(&self, row: &LengthRow) -> LengthVerdict {
        let point = |of: &Ranged| PointVerdict { is_required: true, ..self.point(of) };
        let points: Vec<PointVerdict> = row.ranges.iter().map(point).collect();
        let (fit, missing) = together(&points);
        LengthVerdict { length: row.name.clone(), fit, missing, points }
    }

    /// Whether a point of a size concerns the garment.
    fn is_asked(&self, point: Point) -> bool {
        self.garment.has(point) || self.is_required(point)
    }

    /// Whether a size fits only if the point does: those that the table requires, else all.
    fn is_required(&self, point: Point) -> bool {
        match self.table.required_for(self.garment.name()) {
            // What is required for each garment is asked of those that have it.
            Some(Required { garment: None, points }) => {
                points.contains(&point) && self.garment.has(point)
            }
            Some(Required { points, .. }) => points.contains(&point),
            None => self.garment.has(point),
        }
    }

    fn point(&self, of: &Ranged) -> PointVerdict {
        let reading = (self.reading)(of.point);
        let given = match reading {
            Reading::Given(given) => Some(given),
            Reading::NotGiven { .. } => None,
        };
        let [low_mm, high_mm] = of.mm;
        let known = given.and_then(|of| Some((of.mm, of.uncertainty_mm.filter(|mm| *mm > 0.0)?)));
        let probability = known.map(|(mm, uncertainty_mm)| within(mm, uncertainty_mm, of.mm));
        PointVerdict {
            point: of.point,
            limits_mm: of.mm,
            reading,
            margins_mm: given.map(|of| [of.mm - low_mm, high_mm - of.mm]),
            probability,
            fit: given.map_or(Fit::NotDecided, |given| {
                fit(self.table.limits.hold(of.mm, given.mm), probability)
            }),
            is_required: self.is_required(of.point),
        }
    }
}

/// How a value fits. A value inside never counts as one that does not fit, however narrow the range is to its
/// uncertainty.
fn fit(is_inside: bool, probability: Option<f64>) -> Fit {
    match probability {
        Some(share) if share >= SURE => Fit::Fits,
        Some(share) if share <= UNLIKELY && !is_inside => Fit::DoesNotFit,
        Some(_) => Fit::FitsWithinUncertainty,
        None if is_inside => Fit::Fits,
        None => Fit::DoesNotFit,
    }
}

/// How required points fit together, and which of them are not given. The worst of them counts: probabilities
/// are not multiplied, because errors of a scan are common to its points. One point that does not fit decides
/// whatever others would be.
fn together(points: &[PointVerdict]) -> (Fit, Vec<Point>) {
    let required = || points.iter().filter(|of| of.is_required);
    let missing = required().filter(|of| of.margins_mm.is_none()).map(|of| of.point).collect();
    let fit = required().map(|of| of.fit).min().unwrap_or(Fit::NotDecided);
    (fit, missing)
}

impl PointVerdict {
    /// Whether a person set its value.
    pub fn is_by_hand(&self) -> bool {
        matches!(self.reading, Reading::Given(given) if given.is_by_hand)
    }
}
