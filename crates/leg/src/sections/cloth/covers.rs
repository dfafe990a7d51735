//! Which steps are edges of cloth, and what lies between them.

use super::Cover;
use super::reading::Reading;
use super::rows::ROW_MM;
use super::search::APART;

/// A single soft edge is suspected of being cloth between these steps, mm: the bend of a calf resembles smaller ones,
/// cuffs of fat begin above.
const SUSPECT_MM: [f64; 2] = [2.5, 8.0];

/// Two soft ones bound cloth between these; folds are larger.
const SOFT_MM: [f64; 2] = [0.0, 10.0];

/// The edges of cloth among steps, lowest first.
fn edges(readings: &[Reading]) -> Vec<&Reading> {
    let is_skin = |reading: &Reading| {
        readings.iter().any(|other| reading.folds_back(other) || reading.is_furrow_by(other))
    };
    let is_edge = |reading: &&Reading| {
        (reading.is_sharp() || reading.is_soft()) && reading.is_even() && !is_skin(reading)
    };
    let mut edges: Vec<&Reading> = readings.iter().filter(is_edge).collect();
    // Of several readings of one edge the sharp one counts, and of those the clearest.
    edges.sort_by(|a, b| b.is_sharp().cmp(&a.is_sharp()).then(b.sds().total_cmp(&a.sds())));
    let mut apart: Vec<&Reading> = Vec::new();
    for edge in edges {
        let far_mm = |other: &&Reading| (other.along_mm - edge.along_mm).abs();
        if apart.iter().all(|other| far_mm(other) >= APART as f64 * ROW_MM) {
            apart.push(edge);
        }
    }
    apart.sort_by(|a, b| a.along_mm.total_cmp(&b.along_mm));
    apart
}

/// Whether cloth that begins at one edge ends at the next.
fn is_between(begins: &Reading, ends: &Reading) -> bool {
    begins.step.height_mm > 0.0
        && ends.step.height_mm < 0.0
        && (begins.is_sharp() && ends.is_sharp() || begins.pairs(ends))
}

/// What lies between edges.
pub(super) fn covers(readings: &[Reading]) -> Vec<Cover> {
    let edges = edges(readings);
    let edge = |reading: &Reading| reading.edge(reading.is_sharp());
    let mut covers = Vec::new();
    let mut rest = edges.as_slice();
    while let [first, after @ ..] = rest {
        rest = after;
        match after {
            [next, beyond @ ..] if is_between(first, next) => {
                let [lower, upper] = [first, next].map(|reading| Some(edge(reading)));
                covers.push(Cover { lower, upper, is_sure: true });
                rest = beyond;
            }
            _ => {
                let partner = if first.is_sharp() { None } else { first.partner(readings) };
                let partner = partner.map(|reading| reading.edge(false));
                let edge = edge(first);
                let is_sure = edge.is_sharp || partner.is_some();
                let [lower, upper] =
                    if edge.step_mm > 0.0 { [Some(edge), partner] } else { [partner, Some(edge)] };
                covers.push(Cover { lower, upper, is_sure });
            }
        }
    }
    let is_likely = |cover: &Cover| {
        let [least_mm, most_mm] = if cover.is_sure { SOFT_MM } else { SUSPECT_MM };
        cover.is_sharp() || (least_mm..=most_mm).contains(&cover.thickness_mm())
    };
    covers.into_iter().filter(is_likely).collect()
}
