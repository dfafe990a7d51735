//! The girth of a leg at a height at which no level was found.

use crate::schema::LegFigures;

/// The girth of a leg at a height above the floor, mm. Sections lie a few millimetres apart, so it is within 0.1 mm
/// of the curve on an ordinary leg.
pub(crate) fn girth_mm_at(leg: &LegFigures, height_mm: f64) -> Option<f64> {
    at_height(leg, leg.girth_curve.tape_mm.iter().copied(), height_mm)
}

/// Where a height above the floor lies along the axis of a leg, mm.
pub(crate) fn along_mm_at(leg: &LegFigures, height_mm: f64) -> Option<f64> {
    at_height(leg, leg.girth_curve.along_axis_mm.iter().copied().map(Some), height_mm)
}

/// A column of the girth curve at a height, straight between the two sections around it; `None` beyond the sections,
/// and where one of the two has no figure.
fn at_height(
    leg: &LegFigures,
    column: impl Iterator<Item = Option<f64>>,
    height_mm: f64,
) -> Option<f64> {
    let rows = leg.girth_curve.height_mm.iter().zip(column);
    let rows: Vec<(f64, Option<f64>)> =
        rows.filter_map(|(height_mm, figure)| Some(((*height_mm)?, figure))).collect();
    let around = rows.windows(2).find(|pair| pair[0].0 <= height_mm && height_mm <= pair[1].0)?;
    let [(low_mm, low), (high_mm, high)] = around.try_into().ok()?;
    let share = if high_mm > low_mm { (height_mm - low_mm) / (high_mm - low_mm) } else { 0.0 };
    Some(low? + share * (high? - low?))
}

/// The larger standard error of the girths next to a height, below and above it, mm; `None` if one of them
/// is unknown.
pub(super) fn girth_sd_mm_near(leg: &LegFigures, height_mm: f64) -> Option<f64> {
    let profile = &leg.profile;
    let above = profile.iter().position(|at| at.height_mm >= height_mm)?;
    let below = profile.get(above.saturating_sub(1))?;
    Some(below.girth_sd_mm?.max(profile[above].girth_sd_mm?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::VolumeFigures;
    use crate::shape::ShapeFigures;

    /// A cone of sections 10 mm apart: the girth grows by 0.2 mm per mm.
    fn cone() -> LegFigures {
        let heights: Vec<f64> = (0..10).map(|step| 100.0 + 10.0 * f64::from(step)).collect();
        let girths: Vec<f64> = heights.iter().map(|height| 200.0 + 0.2 * height).collect();
        let at = |height_mm: f64, sd_mm: f64| {
            serde_json::json!({"height_mm": height_mm, "girth_tape_mm": 200.0 + 0.2 * height_mm,
                "girth_contour_mm": null, "girth_sd_mm": sd_mm, "doubts": []})
        };
        serde_json::from_value(serde_json::json!({
            "side": "left", "tilt_deg": 0.0,
            "axis": {"foot_mm": vec![0.0; 3], "direction": vec![0.0; 3],
                "front": vec![0.0; 3], "lateral": vec![0.0; 3]},
            "landmarks": {}, "estimates": {},
            "girth_curve": {"height_mm": heights, "along_axis_mm": heights, "tape_mm": girths,
                "contour_mm": girths, "slope": vec![0.2; heights.len()], "r2": 1.0, "rms_mm": 0.0},
            "sections": [], "features": [], "surface": null, "volume": VolumeFigures::default(),
            "at": [], "profile": [at(120.0, 0.3), at(160.0, 0.5)], "along": [],
            "shape": ShapeFigures::default(),
        }))
        .unwrap()
    }

    #[test]
    fn between_sections_a_cone_has_the_girth_of_a_cone() {
        let leg = cone();
        for height_mm in [100.0, 104.0, 117.5, 190.0] {
            let girth_mm = girth_mm_at(&leg, height_mm).unwrap();
            assert!((girth_mm - (200.0 + 0.2 * height_mm)).abs() < 1e-9, "{height_mm}: {girth_mm}");
        }
        assert_eq!(girth_mm_at(&leg, 99.0), None);
        assert_eq!(girth_mm_at(&leg, 191.0), None);
    }

    #[test]
    fn the_uncertainty_there_is_the_larger_of_those_beside_it() {
        let leg = cone();
        assert_eq!(girth_sd_mm_near(&leg, 140.0), Some(0.5));
        assert_eq!(girth_sd_mm_near(&leg, 120.0), Some(0.3));
        assert_eq!(girth_sd_mm_near(&leg, 170.0), None);
    }
}
