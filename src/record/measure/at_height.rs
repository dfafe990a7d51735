//! The girth of a leg at a height at which no level was found.

use crate::record::schema::LegFigures;

/// The girth of a leg at a height above the floor, mm, straight between the two sections around it; `None`
/// where one of them was not measured. Sections lie a few millimetres apart, so the line is within 0.1 mm of
/// the curve on an ordinary leg.
pub(in crate::record) fn girth_mm_at(leg: &LegFigures, height_mm: f64) -> Option<f64> {
    let curve = &leg.girth_curve;
    let measured: Vec<(f64, Option<f64>)> = curve
        .height_mm
        .iter()
        .zip(&curve.tape_mm)
        .filter_map(|(height_mm, tape_mm)| Some(((*height_mm)?, *tape_mm)))
        .collect();
    let around =
        measured.windows(2).find(|pair| pair[0].0 <= height_mm && height_mm <= pair[1].0)?;
    let [(low_mm, low), (high_mm, high)] = around.try_into().ok()?;
    let share = if high_mm > low_mm { (height_mm - low_mm) / (high_mm - low_mm) } else { 0.0 };
    Some(low? + share * (high? - low?))
}
