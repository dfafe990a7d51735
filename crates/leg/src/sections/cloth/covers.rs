//! Which steps are edges of cloth, and what lies between them.

use super::reading::Reading;
use super::rows::ROW_MM;
use super::search::APART;
use super::{Cover, Edge};

/// A single soft edge is suspected of being cloth between these steps, mm: the bend of a calf resembles smaller ones,
/// cuffs of fat begin above.
const SUSPECT_MM: [f64; 2] = [2.5, 8.0];

/// Two soft ones bound cloth between these; folds are larger.
const SOFT_MM: [f64; 2] = [0.0, 10.0];

/// An edge of cloth, as it was read.
#[derive(Clone, Copy)]
struct Found<'r> {
    reading: &'r Reading,
    is_sharp: bool,
}

impl Found<'_> {
    fn edge(&self) -> Edge {
        self.reading.edge(self.is_sharp)
    }

    fn is_near(&self, other: &Found) -> bool {
        (self.reading.along_mm - other.reading.along_mm).abs() < APART as f64 * ROW_MM
    }

    /// Whether the cloth that begins here ends at the next edge.
    fn ends_at(&self, next: &Found) -> bool {
        let (begins, ends) = (self.reading, next.reading);
        begins.step.height_mm > 0.0
            && ends.step.height_mm < 0.0
            && (self.is_sharp && next.is_sharp || begins.pairs(ends))
    }
}

/// The edges of cloth among steps, lowest first.
fn found(readings: &[Reading]) -> Vec<Found<'_>> {
    let is_skin = |reading: &Reading| {
        readings.iter().any(|other| reading.folds_back(other) || reading.is_furrow_by(other))
    };
    let edges = readings.iter().filter_map(|reading| {
        let is_sharp = reading.is_sharp();
        let is_edge = (is_sharp || reading.is_soft()) && reading.is_even() && !is_skin(reading);
        is_edge.then_some(Found { reading, is_sharp })
    });
    let mut edges: Vec<Found> = edges.collect();
    // Of several readings of one edge the sharp one counts, and of those the clearest.
    let clearer = |a: &Found, b: &Found| b.reading.sds().total_cmp(&a.reading.sds());
    edges.sort_by(|a, b| b.is_sharp.cmp(&a.is_sharp).then(clearer(a, b)));
    let mut apart: Vec<Found> = Vec::new();
    for edge in edges {
        if !apart.iter().any(|other| other.is_near(&edge)) {
            apart.push(edge);
        }
    }
    apart.sort_by(|a, b| a.reading.along_mm.total_cmp(&b.reading.along_mm));
    apart
}

/// What lies between edges.
pub(super) fn covers(readings: &[Reading]) -> Vec<Cover> {
    let edges = found(readings);
    let mut covers = Vec::new();
    let mut rest = edges.as_slice();
    while let [first, after @ ..] = rest {
        rest = after;
        match after {
            [next, beyond @ ..] if first.ends_at(next) => {
                let [lower, upper] = [first, next].map(|found| Some(found.edge()));
                covers.push(Cover { lower, upper, is_sure: true });
                rest = beyond;
            }
            _ if first.is_sharp => covers.push(Cover::from_edge(first.edge(), None)),
            _ => {
                let partner = first.reading.partner(readings);
                let partner = partner.map(|reading| reading.edge(false));
                covers.push(Cover::from_edge(first.edge(), partner));
            }
        }
    }
    let is_likely = |cover: &Cover| {
        let [least_mm, most_mm] = if cover.is_sure { SOFT_MM } else { SUSPECT_MM };
        cover.is_sharp() || (least_mm..=most_mm).contains(&cover.thickness_mm())
    };
    covers.into_iter().filter(is_likely).collect()
}
