//! What a person should know about a size table that has no fault: gaps, overlaps, missing names, age.

use std::collections::BTreeSet;

use jiff::civil::Date;
use serde::Serialize;

use super::parse::is_same_person;
use super::point::Point;
use super::table::{Basis, Limits, Ranged, SizeTable, Status};

/// One remark about a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "code")]
pub enum Remark {
    /// No size, or no length, holds what lies between two neighbours.
    Gap(Neighbours),
    /// Two neighbours hold the same values.
    Overlap(Neighbours),
    /// Two neighbours share a limit: with closed limits both hold it, with open ones neither.
    Touch {
        /// Which.
        #[serde(flatten)]
        at: Neighbours,
        /// Whether limits belong to their ranges.
        limits: Limits,
    },
    /// A size that is larger at the deciding point has a lower limit at another one: mostly a slip.
    OutOfOrder {
        /// That point.
        point: Point,
        /// The names of the two sizes, the smaller one first.
        names: [String; 2],
        /// The limits of the smaller one, mm.
        smaller_mm: [f64; 2],
        /// The limits of the larger one, mm.
        larger_mm: [f64; 2],
    },
    /// A size has no range of a point that other sizes have: it fits whatever is measured there.
    Lacks {
        /// The size.
        size: String,
        /// The point.
        point: Point,
    },
    /// It is no longer valid.
    Expired {
        /// The last day on which it was.
        last: Date,
    },
    /// It does not state until when it is valid.
    NoEnd,
    /// The name of who entered or of who checked the figures is missing.
    Unsigned {
        /// Whether it is that of who entered them.
        entered: bool,
        /// Whether it is that of who checked them.
        checked: bool,
    },
    /// The same person entered and checked the figures.
    SamePerson {
        /// The name.
        name: String,
    },
    /// It may be used only to try the program.
    TestOnly,
    /// Not released yet.
    Draft,
    /// Its girths are under tension: no measure of a scan is compared with it.
    Tension,
    /// It does not state whether its girths are of skin: no measure is compared with it.
    NoBasis,
    /// It does not state where its lengths begin; the floor is assumed.
    NoLengthsFrom,
    /// It names a garment of which no profile is known here.
    UnknownGarment {
        /// The garment.
        garment: String,
    },
}

/// Two neighbouring ranges of a point, the lower one first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Neighbours {
    /// The point.
    pub point: Point,
    /// The garment of which they are lengths; null for sizes.
    pub garment: Option<String>,
    /// The names of the two sizes or lengths.
    pub names: [String; 2],
    /// The upper limit of the lower one, mm.
    pub upper_mm: f64,
    /// The lower limit of the upper one, mm.
    pub lower_mm: f64,
}

impl Remark {
    /// Whether it only describes how neighbouring sizes lie: makers' tables have gaps and overlaps, which are
    /// no fault.
    pub fn is_of_neighbours(&self) -> bool {
        matches!(self, Remark::Gap(_) | Remark::Overlap(_) | Remark::Touch { .. })
    }

    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Remark::Gap(_) => "gap",
            Remark::Overlap(_) => "overlap",
            Remark::Touch { .. } => "touch",
            Remark::OutOfOrder { .. } => "out-of-order",
            Remark::Lacks { .. } => "lacks",
            Remark::Expired { .. } => "expired",
            Remark::NoEnd => "no-end",
            Remark::Unsigned { .. } => "unsigned",
            Remark::SamePerson { .. } => "same-person",
            Remark::TestOnly => "test-only",
            Remark::Draft => "draft",
            Remark::Tension => "tension",
            Remark::NoBasis => "no-basis",
            Remark::NoLengthsFrom => "no-lengths-from",
            Remark::UnknownGarment { .. } => "unknown-garment",
        }
    }
}

/// The remarks on a table, for a reader of this day who knows garments of these names.
pub fn remarks(table: &SizeTable, today: Date, garments: &[&str]) -> Vec<Remark> {
    let mut remarks = of_status(table);
    match table.valid_until {
        Some(last) if table.is_expired(today) => remarks.push(Remark::Expired { last }),
        Some(_) => {}
        None => remarks.push(Remark::NoEnd),
    }
    match table.basis {
        Some(Basis::Tension) => remarks.push(Remark::Tension),
        None => remarks.push(Remark::NoBasis),
        Some(Basis::Skin) => {}
    }
    let ranges = table.sizes.iter().flat_map(|size| &size.ranges);
    let mut ranges = ranges.chain(table.lengths.iter().flat_map(|of| &of.ranges));
    if !table.states_where_lengths_begin && ranges.any(|of| matches!(of.point, Point::Length(_))) {
        remarks.push(Remark::NoLengthsFrom);
    }
    remarks.extend(unknown_garments(table, garments));
    if let Some(point) = table.decides {
        let sizes = table.sizes.iter();
        let sizes = sizes.filter_map(|size| Some((size.name.as_str(), size.range(point)?)));
        remarks.extend(between(point, None, sizes.collect(), table.limits));
    }
    remarks.extend(of_other_points(table));
    remarks.extend(between_lengths(table));
    remarks
}

/// What no size holds at a point, what one of them lacks, and limits that do not grow with the size. Sizes
/// overlap at these points, so overlaps and touching limits mean nothing.
fn of_other_points(table: &SizeTable) -> Vec<Remark> {
    let (mut remarks, mut seen) = (Vec::new(), BTreeSet::new());
    let points = table.sizes.iter().flat_map(|size| &size.ranges).map(|of| of.point);
    let is_other = |point: &Point| Some(*point) != table.decides && seen.insert(*point);
    for point in points.filter(is_other) {
        let own = table.sizes.iter().filter_map(|of| Some((of.name.as_str(), of.range(point)?)));
        let of_variants = table.sizes.iter().flat_map(|size| {
            let ranges = size.variants.iter().flat_map(|(_, ranges)| ranges);
            ranges.filter(|of| of.point == point).map(|of| (size.name.as_str(), of.mm))
        });
        let all = between(point, None, own.chain(of_variants).collect(), table.limits);
        remarks.extend(all.into_iter().filter(|of| matches!(of, Remark::Gap(_))));
        remarks.extend(out_of_order(table, point));
        let lacking = table.sizes.iter().filter(|of| of.range(point).is_none());
        let lacking = lacking.filter(|_| table.required.is_empty());
        remarks.extend(lacking.map(|of| Remark::Lacks { size: of.name.clone(), point }));
    }
    remarks
}

/// A size with its limits at the deciding point and at another one, mm.
struct Row<'a> {
    name: &'a str,
    deciding_mm: [f64; 2],
    other_mm: [f64; 2],
}

/// The neighbours by the deciding point of which the larger one has a lower limit at this point.
fn out_of_order(table: &SizeTable, point: Point) -> Vec<Remark> {
    let Some(deciding) = table.decides else { return Vec::new() };
    let rows = table.sizes.iter().filter_map(|size| {
        let (deciding_mm, other_mm) = (size.range(deciding)?, size.range(point)?);
        Some(Row { name: &size.name, deciding_mm, other_mm })
    });
    let mut rows: Vec<Row<'_>> = rows.collect();
    rows.sort_by(|a, b| a.deciding_mm[0].total_cmp(&b.deciding_mm[0]));
    let is_below = |low: [f64; 2], high: [f64; 2]| low[0] < high[0] && low[1] < high[1];
    let falls = rows.windows(2).filter(|pair| {
        let [smaller, larger] = [&pair[0], &pair[1]];
        is_below(smaller.deciding_mm, larger.deciding_mm)
            && (0..2).any(|limit| larger.other_mm[limit] < smaller.other_mm[limit])
    });
    let remark = |pair: &[Row<'_>]| Remark::OutOfOrder {
        point,
        names: [pair[0].name.to_owned(), pair[1].name.to_owned()],
        smaller_mm: pair[0].other_mm,
        larger_mm: pair[1].other_mm,
    };
    falls.map(remark).collect()
}

fn of_status(table: &SizeTable) -> Vec<Remark> {
    let mut remarks = Vec::new();
    match table.status {
        Status::TestOnly => remarks.push(Remark::TestOnly),
        Status::Draft => remarks.push(Remark::Draft),
        Status::Released => {}
    }
    match (&table.entered_by, &table.checked_by) {
        (Some(entered), Some(checked)) if is_same_person(entered, checked) => {
            remarks.push(Remark::SamePerson { name: checked.clone() });
        }
        (Some(_), Some(_)) => {}
        (entered, checked) => remarks
            .push(Remark::Unsigned { entered: entered.is_none(), checked: checked.is_none() }),
    }
    remarks
}

/// The garments of a table of which no profile is known, each once.
fn unknown_garments(table: &SizeTable, known: &[&str]) -> Vec<Remark> {
    let codes = table.sizes.iter().flat_map(|size| &size.codes);
    let named = table.garments.iter();
    let named = named.chain(table.variants.iter().flat_map(|of| &of.applies_to));
    let named = named.chain(table.lengths.iter().map(|of| &of.garment));
    let named = named.chain(table.required.iter().filter_map(|of| of.garment.as_ref()));
    let named = named.chain(codes.filter_map(|of| of.garment.as_ref()));
    let mut seen = BTreeSet::new();
    let unknown = named.filter(|of| !known.contains(&of.as_str()) && seen.insert(of.as_str()));
    unknown.map(|of| Remark::UnknownGarment { garment: of.clone() }).collect()
}

/// The neighbours among the lengths of each garment, by each point that they have.
fn between_lengths(table: &SizeTable) -> Vec<Remark> {
    let (mut remarks, mut seen) = (Vec::new(), BTreeSet::new());
    for row in &table.lengths {
        for Ranged { point, .. } in &row.ranges {
            let garment = row.garment.as_str();
            if !seen.insert((garment, *point)) {
                continue;
            }
            let its = table.lengths_for(garment).filter_map(|of| {
                let range = of.ranges.iter().find(|of| of.point == *point)?;
                Some((of.name.as_str(), range.mm))
            });
            remarks.extend(between(*point, Some(garment), its.collect(), table.limits));
        }
    }
    remarks
}

/// What lies between neighbouring ranges of a point. A range within others hides no gap: what counts is the
/// highest upper limit so far.
fn between(
    point: Point,
    garment: Option<&str>,
    mut ranges: Vec<(&str, [f64; 2])>,
    limits: Limits,
) -> Vec<Remark> {
    ranges.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut remarks = Vec::new();
    let mut ranges = ranges.into_iter();
    let Some(mut highest) = ranges.next() else { return remarks };
    for (name, [low_mm, high_mm]) in ranges {
        let (below, [_, upper_mm]) = highest;
        let at = Neighbours {
            point,
            garment: garment.map(str::to_owned),
            names: [below.to_owned(), name.to_owned()],
            upper_mm,
            lower_mm: low_mm,
        };
        remarks.push(if upper_mm < low_mm {
            Remark::Gap(at)
        } else if upper_mm > low_mm {
            Remark::Overlap(at)
        } else {
            Remark::Touch { at, limits }
        });
        if high_mm >= upper_mm {
            highest = (name, [low_mm, high_mm]);
        }
    }
    remarks
}
